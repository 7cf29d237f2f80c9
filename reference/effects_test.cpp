// SPDX-License-Identifier: GPL-3.0-or-later
// Each effect alone against its closed form: the share of samples that see something. Shares are counted among
// independent samples, so their standard deviations are known (share_agrees).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "reference/render_scenes_test.h"

using namespace plumbline;

namespace {

constexpr std::uint32_t kSamples = 200000;

/// The share of samples of a black thing before a white background that are black.
double black_share(const Scene& scene, std::uint32_t samples = kSamples) {
  ReferenceSettings settings;
  settings.frames = samples;
  const auto picture = ReferenceRenderer(scene, settings).render();
  return 1.0 - picture->mean[0].g;
}

/// A pixel that looks along -z from (0, 0, height), before white; the light is where it lights nothing.
Scene looking_down(float height) {
  Scene scene = one_pixel_scene({0, 0, height}, {0, 0, 0});
  scene.background = {1, 1, 1};
  scene.lights.push_back({{0, 0, -1000}});
  return scene;
}

/// Of a glossy mirror at z = 0 looked at from straight above: the share of reflections that pass beyond the edge x = e
/// at z = 1. With the perturbed normal (x, y, w) = (g px, g py, 1 + g pz), of any length, the reflected direction is (2
/// w x, 2 w y, w^2 - x^2 - y^2), and passes there if e x^2 + 2 w x + e y^2 - e w^2 > 0, that is, for x above the
/// greater root. What is left are lengths in x, summed over a grid in py and pz (midpoint rule).
double glossy_share(double g, double e, bool ball) {
  constexpr int kGrid = 400;
  double beyond = 0.0, all = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double py = (2.0 * i + 1.0) / kGrid - 1.0, pz = (2.0 * j + 1.0) / kGrid - 1.0;
      const double half2 = ball ? 1.0 - py * py - pz * pz : 1.0;
      if (!(half2 > 0.0)) continue;
      const double half = std::sqrt(half2), y = g * py, w = 1.0 + g * pz;
      const double root = (std::sqrt(w * w + e * e * (w * w - y * y)) - w) / e;
      beyond += std::clamp(half - root / g, 0.0, 2.0 * half);
      all += 2.0 * half;
    }
  }
  return beyond / all;
}

}  // namespace

TEST_CASE("Soft shadow: the visible part of cube and ball over a half plane") {
  // From the origin the edge x = e at z = 2 hides what has x > e z / 2 of a light around (0, 0, 4) of radius 1. Of the
  // cube, for each z, the share (1 + e z / 2) / 2 is seen: on average 1/2 + e. The ball's centre is s = 2 e / sqrt(1 +
  // e^2 / 4) from that plane, and of the ball 1/2 + 3/4 s - s^3 / 4 is seen.
  for (const float e : {-0.3f, 0.0f, 0.1f}) {
    for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
      const bool ball = model == Effects::Model::physical;
      CAPTURE(e, ball);
      Scene scene = one_pixel_scene({0, -5, 1}, {0, 0, 0}, {0, 0, 1});
      scene.lights.push_back({{0, 0, 4}, {}, false, 1.0f});
      scene.effects.soft_shadows = true;
      scene.effects.model = model;
      add_level(scene, -1, -1, 1, 1, 0, add_surface(scene, {}));
      add_level(scene, e, -100, 100, 100, 2, add_surface(scene, black()));
      ReferenceRenderer renderer(scene, {});
      std::uint32_t lit = 0;
      SampleRecord record;
      for (std::uint32_t frame = 0; frame < kSamples; ++frame) {
        renderer.sample(0, 0, frame, &record);
        lit += record.lights[0] == LightOutcome::lit;
      }
      const double d = static_cast<double>(e), s = 2.0 * d / std::sqrt(1.0 + d * d / 4.0);
      const double expected = ball ? 0.5 + 0.75 * s - 0.25 * s * s * s : 0.5 + d;
      CHECK(share_agrees(static_cast<double>(lit) / kSamples, expected, kSamples));
    }
  }
}

TEST_CASE("Depth of field: an edge is blurred over its circle of confusion, and sharp in focus") {
  // Through a place a (px, py, pz) of the lens, pz along the view, the ray to the focal point on the axis at F is at x
  // = a px (F - D) / (F - a pz) at distance D. On the disc pz = 0: x is c px with c = a |F - D| / F, and beyond e = s c
  // lies the segment of a disc, (acos s - s sqrt(1 - s^2)) / pi. In the cube the bound on px is s (F - a pz) / F, on
  // average s: (1 - s) / 2.
  for (const float distance : {1.0f, 3.0f}) {
    for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
      const bool disc = model == Effects::Model::physical;
      CAPTURE(distance, disc);
      Scene scene = looking_down(4);
      scene.camera.aperture = 0.2f;
      scene.camera.focus = 2.0f;
      scene.effects.depth_of_field = true;
      scene.effects.model = model;
      const double c = 0.2 * std::fabs(2.0 - static_cast<double>(distance)) / 2.0, s = 0.3;
      add_level(scene, static_cast<float>(s * c), -10, 10, 10, 4.0f - distance, add_surface(scene, black()));
      const double expected = disc ? (std::acos(s) - s * std::sqrt(1.0 - s * s)) / std::numbers::pi : (1.0 - s) / 2.0;
      CHECK(share_agrees(black_share(scene), expected, kSamples));
      scene.camera.focus = distance;
      CHECK(black_share(scene, 1000) == 0.0);
      for (glm::vec3& p : scene.positions) p.x -= 0.01f;
      CHECK(black_share(scene, 1000) == Approx(s * c > 0.01 ? 0.0 : 1.0).margin(0.0));
    }
  }
}

TEST_CASE("The paper's lens has a depth") {
  // As above with s = 1: px above 1 - (a / F) pz, which flat lenses do not have: (a / F) / 8 of the cube.
  Scene scene = looking_down(4);
  scene.camera.aperture = 1.0f;
  scene.camera.focus = 2.0f;
  scene.effects.depth_of_field = true;
  add_level(scene, 0.5f, -10, 10, 10, 1, add_surface(scene, black()));
  CHECK(share_agrees(black_share(scene), 0.5 / 8.0, kSamples));
}

TEST_CASE("Glossy reflection: the step of a half plane seen in a perturbed mirror") {
  for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
    const bool ball = model == Effects::Model::physical;
    CAPTURE(ball);
    Scene scene = looking_down(0.5f);
    scene.effects.glossy_reflections = true;
    scene.effects.model = model;
    scene.effects.glossy = 0.1f;
    const std::uint32_t mirror = add_surface(scene, {.name = {}, .diffuse = 0, .specular = 1});
    add_level(scene, -1, -1, 1, 1, 0, mirror);
    add_level(scene, 0.05f, -10, 10, 10, 1, add_surface(scene, black()));
    CHECK(share_agrees(black_share(scene), glossy_share(0.1, 0.05, ball), kSamples));
    scene.materials[mirror].glossy = 0.2f;  // the surface's own goes before the scene's
    CHECK(share_agrees(black_share(scene), glossy_share(0.2, 0.05, ball), kSamples));
    scene.materials[mirror].glossy = 0.0f;
    CHECK(black_share(scene, 100) == 0.0);
  }
}

TEST_CASE("Anti-aliasing: an edge covers the part of the pixel that lies behind it") {
  Scene scene = looking_down(1);
  scene.effects.antialias = true;
  // The one pixel's side at z = 0 is 2 tan(angle / 2). Of its unit square the triangle x + y > 0.25 (from its centre)
  // covers (1 - 0.25)^2 / 2.
  const auto side = static_cast<float>(2.0 * std::tan(0.5 * static_cast<double>(scene.camera.angle_radians)));
  const float q = 0.25f * side, far = 100.0f;
  add_quad(scene, {glm::vec3{far, q - far, 0}, {far, far, 0}, {q - far, far, 0}, {q / 2, q / 2, 0}},
           add_surface(scene, black()));
  CHECK(share_agrees(black_share(scene), 0.75 * 0.75 / 2.0, kSamples));
}

TEST_CASE("Motion blur: a bar at constant speed covers a place for its width over the way") {
  constexpr std::uint32_t kFrames = 1500;
  Scene scene = looking_down(1);
  scene.effects.motion_blur = true;
  scene.camera.shutter_open = 0.5f;
  scene.camera.shutter_close = 1.5f;
  add_level(scene, -0.125f, -1, 0.125f, 1, 0, add_surface(scene, black()));
  scene.parts.push_back({"bar", 0, 2, 0, 0});
  scene.nodes.push_back({"bar", kNone, 0, {}, {}});
  // From x = -0.8 at the picture's time + 0.5 to x = 0.2 one second later.
  Animation animation;
  animation.node = 0;
  animation.translation = {{2.5, {-0.8, 0, 0}}, {3.5, {0.2, 0, 0}}};
  scene.animation.push_back(animation);
  ReferenceSettings settings;
  settings.time = 2.0;
  settings.frames = kFrames;
  ReferenceRenderer renderer(scene, settings);
  const double share = 1.0 - renderer.render()->mean[0].g;
  CHECK(share_agrees(share, 0.25, kFrames));
  settings.effects = scene.effects;
  settings.effects->motion_blur = false;
  settings.frames = 1;
  settings.time = 3.3;  // the bar stands on the axis
  const auto still = ReferenceRenderer(scene, settings).render();
  CHECK(still->mean[0].g == 0.0);
  CHECK(still->instance[0] == 0);
}
