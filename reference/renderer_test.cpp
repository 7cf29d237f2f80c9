// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as sums of samples: variance, threads, given numbers, the sharp ray's channels, cancellation, wrong input;
// and Embree's single rays, which samples are made of.
#include "reference/renderer.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "reference/render_scenes_test.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

Scene all_effects() {
  Scene scene = load_scene("figure_1");
  scene.effects.glossy = 0.1f;
  return scene;
}

ReferenceSettings small_settings() {
  ReferenceSettings settings;
  settings.width = 40, settings.height = 30;
  settings.frames = 5;
  return settings;
}

class Halves final : public RandomSource {
 public:
  void fill(const Draw&, std::span<double> numbers) const override {
    for (double& number : numbers) number = 0.5;
  }
  double time(std::uint32_t) const override { return 0.5; }
};

}  // namespace

TEST_CASE("Mean and variance are those of the samples") {
  const ReferenceSettings settings = small_settings();
  ReferenceRenderer renderer(all_effects(), settings);
  const auto picture = renderer.render();
  REQUIRE(picture);
  std::size_t noisy = 0;
  for (const auto& [x, y] : {std::pair(20u, 15u), std::pair(5u, 25u), std::pair(33u, 12u), std::pair(0u, 0u)}) {
    std::vector<double> values;
    double mean = 0.0, squares = 0.0;
    for (std::uint32_t frame = 0; frame < settings.frames; ++frame) values.push_back(renderer.sample(x, y, frame).g);
    for (const double v : values) mean += v / settings.frames;
    for (const double v : values) squares += (v - mean) * (v - mean);
    const std::size_t at = y * 40 + x;
    CHECK(picture->mean[at].g == Approx(mean).epsilon(1e-12));
    CHECK(picture->variance[at].g == Approx(squares / 4.0).epsilon(1e-9));
    noisy += squares > 0.0;
  }
  CHECK(noisy >= 2);
}

TEST_CASE("A picture does not depend on the number of threads, but on its seed") {
  ReferenceSettings settings = small_settings();
  const Scene scene = all_effects();
  const auto many = ReferenceRenderer(scene, settings).render();
  {
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    const auto one = ReferenceRenderer(scene, settings).render();
    CHECK((many->mean == one->mean));
    CHECK((many->variance == one->variance));
  }
  settings.seed = 1;
  CHECK((many->mean != ReferenceRenderer(scene, settings).render()->mean));
}

TEST_CASE("Given numbers are used: halves are the pixel's centre and the light's, bit for bit") {
  Scene scene = all_effects();
  scene.effects.motion_blur = scene.effects.depth_of_field = scene.effects.glossy_reflections = false;
  ReferenceSettings settings = small_settings();
  settings.frames = 2;
  const Halves halves;
  const auto perturbed = ReferenceRenderer(scene, settings).render({}, &halves);
  settings.effects = scene.effects;
  settings.effects->antialias = settings.effects->soft_shadows = false;
  const auto sharp = ReferenceRenderer(scene, settings).render();
  CHECK((perturbed->mean == sharp->mean));
  for (const glm::dvec3& variance : sharp->variance) CHECK(variance == glm::dvec3(0.0));
}

TEST_CASE("The sharp ray's channels are those of the pixel's centre") {
  const ReferenceSettings settings = small_settings();
  const Scene scene = all_effects();
  const auto picture = ReferenceRenderer(scene, settings).render();
  Camera camera = scene.camera;
  camera.width = 40, camera.height = 30;
  Scene still = scene;
  set_time(still, 0.0);
  const EmbreeScene hits(still);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const ReferenceHit hit = hits.first_hit(camera_ray(camera, x, y));
      const auto at = static_cast<std::size_t>(y * 40 + x);
      REQUIRE(picture->primitive[at] == hit.primitive);
      REQUIRE(picture->instance[at] == hit.instance);
      REQUIRE(picture->depth[at] == hit.t);
      REQUIRE(picture->normal[at] == hit.normal);
    }
  }
}

TEST_CASE("In the scenes for pictures the ground shows where its plane comes before everything else") {
  std::size_t on_ground = 0, before_it = 0;
  for (const std::string& name : picture_scenes()) {
    CAPTURE(name);
    Scene scene = load_scene(name);
    if (scene.ground.radius == 0.0f) continue;
    if (!scene.animation.empty()) set_time(scene, 0.0);
    ReferenceSettings settings;
    settings.width = 48, settings.height = 32;
    const auto picture = ReferenceRenderer(scene, settings).render();
    Camera camera = scene.camera;
    camera.width = 48, camera.height = 32;
    const EmbreeScene hits(scene);
    const glm::dvec3 center(scene.ground.center), normal(scene.ground.normal);
    for (int i = 0; i < 48 * 32; ++i) {
      const Ray ray = camera_ray(camera, i % 48, i / 48);
      const glm::dvec3 o(ray.origin), d(ray.direction);
      const ReferenceHit thing = hits.first_hit(ray);
      const double t = glm::dot(center - o, normal) / glm::dot(d, normal);
      const bool seen = t > 0.0 && glm::length(o + t * d - center) <= static_cast<double>(scene.ground.radius);
      const auto at = static_cast<std::size_t>(i);
      if (seen && !(thing.t <= t)) {
        ++on_ground;
        REQUIRE(picture->primitive[at] == scene.primitive_count());
        REQUIRE(picture->instance[at] == kNone);
        REQUIRE(picture->depth[at] == Approx(t).epsilon(1e-14));
        REQUIRE(picture->normal[at] == normal);
      } else {
        before_it += seen;
        REQUIRE(picture->primitive[at] == thing.primitive);
      }
    }
  }
  CHECK(on_ground > 1000);
  CHECK(before_it > 100);
}

TEST_CASE("A rendering ends when it is told to") {
  ReferenceRenderer renderer(all_effects(), small_settings());
  double last = 0.0;
  int calls = 0;
  CHECK_FALSE(renderer.render([&](double share) {
    CHECK(share >= last);
    last = share;
    return ++calls < 3;
  }));
  CHECK(calls >= 3);
  CHECK(renderer.render([&](double share) { return last = share, true; }));
  CHECK(last == Approx(1.0));
}

TEST_CASE("A scene without lights is lit, and wrong settings are refused") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  add_level(scene, -1, -1, 1, 1, 0, add_surface(scene, {}));
  ReferenceRenderer renderer(scene, {});
  CHECK(renderer.lit_by_default());
  CHECK(renderer.sample(0, 0, 0).r > 0.25);
  CHECK_THROWS_AS(ReferenceRenderer(scene, {.frames = 0}), InputError);
  CHECK_THROWS_AS(ReferenceRenderer(scene, {.width = 70000, .height = 1}), InputError);
  CHECK_THROWS_AS(ReferenceRenderer(scene, {.time = NAN}), InputError);
  scene.effects.depth_of_field = true;
  scene.camera.aperture = 6.0f;
  CHECK_THROWS_AS(ReferenceRenderer(scene, {}), InputError);
}

TEST_CASE("Rays one by one hit what they hit together, and are blocked if they hit") {
  for (const char* const name : {"sphereflake:2", "figure_1", "ellipsoids", "gears:1"}) {
    CAPTURE(name);
    const Scene scene = load_scene(name);
    const EmbreeScene hits(scene);
    const Ball ball = bounding_ball(scene);
    std::vector<Ray> rays;
    Random random(5, 0, 0);
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 from(ball.center + 1.5 * ball.radius * random.direction());
      const glm::vec3 to(ball.center + 0.7 * ball.radius * random.direction());
      rays.push_back({from, to - from, static_cast<float>(random.uniform(0.1, 2.0))});
    }
    rays.push_back({{NAN, 0, 0}, {0, 0, 1}});
    std::vector<ReferenceHit> together(rays.size());
    hits.intersect(rays, together);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const ReferenceHit alone = hits.first_hit(rays[i]);
      REQUIRE(alone.kind == together[i].kind);
      REQUIRE(alone.primitive == together[i].primitive);
      REQUIRE(alone.instance == together[i].instance);
      REQUIRE(alone.t == together[i].t);
      REQUIRE(hits.is_blocked(rays[i]) == (alone.kind == HitKind::hit));
    }
  }
}

TEST_CASE("Nodes that are moved are hit where a new scene has them") {
  Scene scene = load_scene("walk");
  EmbreeScene moved(scene);
  const TimeRange range = time_range(scene);
  set_time(scene, 0.5 * (range.first + range.last) + 0.1);
  moved.move_nodes(scene);
  const EmbreeScene fresh(scene);
  Camera camera = scene.camera;
  camera.width = camera.height = 48;
  std::size_t in_instances = 0;
  for (int i = 0; i < 48 * 48; ++i) {
    const Ray ray = camera_ray(camera, i % 48, i / 48);
    const ReferenceHit a = moved.first_hit(ray), b = fresh.first_hit(ray);
    REQUIRE(a.instance == b.instance);
    REQUIRE(a.primitive == b.primitive);
    REQUIRE(a.t == b.t);
    in_instances += a.instance != kNone;
  }
  CHECK(in_instances > 50);
}
