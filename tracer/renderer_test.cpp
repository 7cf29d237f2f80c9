// SPDX-License-Identifier: MIT
// The renderer's rays are the probe's: every ray of every batch, tapped from the shaders, is traced again by the probe.
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <set>

#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/read.h"
#include "tracer/renderer.h"
#include "tracer/tree_test_scenes.h"

namespace plumbline {
namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

bool same_answer(Hit a, Hit b) {
  a.steps = b.steps = a.primitive_tests = b.primitive_tests = a.transforms = b.transforms = 0;
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

/// Traces all tapped rays again.
class Retracing final : public RenderTap {
 public:
  std::size_t rays_seen = 0, shadow_rays = 0, wrong = 0, wrong_shadows = 0;
  std::set<std::uint32_t> numbers_seen;

  explicit Retracing(Renderer& renderer) : renderer_(&renderer) {}
  void rays(const TappedBatch&, std::uint32_t ray, std::uint32_t light, std::span<const Ray> rays,
            std::span<const Hit> hits) override {
    Probe probe(context(), renderer_->image());
    std::vector<Ray> real;
    std::vector<Hit> told;
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (is_defined(rays[i])) real.push_back(rays[i]), told.push_back(hits[i]);
    std::vector<Hit> again(real.size());
    probe.trace(real, again);
    numbers_seen.insert(ray);
    for (std::size_t i = 0; i < real.size(); ++i) {
      if (light == kNone) {
        ++rays_seen;
        wrong += !same_answer(told[i], again[i]);
      } else {
        ++shadow_rays;
        wrong_shadows += told[i].kind != again[i].kind;
      }
    }
  }
  void numbers(const TappedBatch&, std::uint32_t, std::uint32_t, std::span<const glm::vec4>) override {}
  void samples(const TappedBatch&, std::span<const glm::vec4>) override {}

 private:
  Renderer* renderer_;
};

}  // namespace

TEST_CASE("rays of a picture hit what the probe says that they hit", "[render]") {
  for (const std::string name : {"sphereflake:2", "figure_1", "motion"}) {
    const Scene scene = load_scene(name);
    for (const Layout layout : {Layout::compact, Layout::paper}) {
      for (const int bundle : {1, 2, 3, 4}) {
        if (layout == Layout::paper && bundle != 1 && bundle != 4) continue;
        RenderSettings settings;
        settings.width = 40, settings.height = 30;
        settings.frames = static_cast<std::uint32_t>(bundle) + 1;
        settings.bundle = {bundle};
        settings.bake.layout = layout;
        Renderer renderer(context(), scene, settings);
        Retracing tap(renderer);
        renderer.set_tap(&tap);
        const auto picture = renderer.render();
        INFO(name << ", " << name_of(layout) << ", bundles of " << bundle);
        CHECK(tap.rays_seen > 1000);
        CHECK(tap.shadow_rays > 500);
        CHECK(tap.wrong == 0);
        CHECK(tap.wrong_shadows == 0);
        CHECK(tap.rays_seen + tap.shadow_rays <= renderer.rays_traced());
      }
    }
  }
}

namespace {

RenderSettings settings_of(int width, int height, std::uint32_t frames) {
  RenderSettings settings;
  settings.width = width, settings.height = height;
  settings.frames = frames;
  return settings;
}
RenderedPicture rendered(const Scene& scene, const RenderSettings& settings) {
  return *Renderer(context(), scene, settings).render();
}

}  // namespace

TEST_CASE("Tiles, batches and bundles change no bit of a picture", "[render]") {
  const Scene scene = load_scene("soft_shadow");
  // 37 frames need batches of several shapes.
  const RenderedPicture whole = rendered(scene, settings_of(24, 18, 37));
  for (const int bundle : {2, 3, 4}) {
    RenderSettings settings = settings_of(24, 18, 37);
    settings.bundle = {bundle};
    CHECK(rendered(scene, settings).mean == whole.mean);
  }
  Renderer by_parts(context(), scene, settings_of(24, 18, 37));
  CHECK(by_parts.add_frames(0, 1));
  CHECK(by_parts.add_frames(1, 35));
  CHECK(by_parts.add_frames(36, 1));
  const RenderedPicture parts = by_parts.picture();
  CHECK(parts.frames == 37);
  CHECK(parts.mean == whole.mean);
  CHECK(parts.variance == whole.variance);
}

TEST_CASE("The same seed gives the same picture, another one another", "[render]") {
  const Scene scene = load_scene("dof");
  RenderSettings settings = settings_of(16, 12, 2);
  const RenderedPicture first = rendered(scene, settings), again = rendered(scene, settings);
  CHECK(first.mean == again.mean);
  settings.seed = 1;
  CHECK(rendered(scene, settings).mean != first.mean);
  settings.seed = 0, settings.first_frame = 2;
  CHECK(rendered(scene, settings).mean != first.mean);
}

TEST_CASE("A picture wider than a batch has no seams", "[render]") {
  const Scene scene = load_scene("sphereflake:1");
  RenderSettings settings = settings_of(1100, 3, 1);
  settings.effects = scene.effects;
  settings.effects->antialias = false;
  Renderer renderer(context(), scene, settings);
  Retracing tap(renderer);
  renderer.set_tap(&tap);
  const auto picture = renderer.render();
  CHECK(tap.wrong == 0);
  const CameraFrame frame = [&] {
    Camera camera = scene.camera;
    camera.width = 1100, camera.height = 3;
    return camera_frame(camera);
  }();
  // Every pixel's depth is that of its own ray.
  std::vector<Ray> rays;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 1100; ++x) rays.push_back(camera_ray(frame, x, y));
  std::vector<Hit> hits(rays.size());
  Probe(context(), renderer.image()).trace(rays, hits);
  std::size_t others = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) others += picture->primitive[i] != hits[i].primitive;
  CHECK(others <= 2);  // the shader's camera is a float's rounding away: at an outline it may see the other side
}

TEST_CASE("Motion blur spreads frames over the shutter, and the picture of one time is sharp again", "[render]") {
  const Scene scene = load_scene("motion");
  RenderSettings settings = settings_of(32, 24, 8);
  const RenderedPicture blurred = rendered(scene, settings);
  settings.effects = scene.effects;
  settings.effects->motion_blur = false;
  const RenderedPicture still = rendered(scene, settings);
  std::size_t varies = 0, varies_still = 0;
  for (std::size_t i = 0; i < still.mean.size(); ++i)
    varies += blurred.variance[i].r > 1e-3, varies_still += still.variance[i].r > 1e-3;
  CHECK(varies > varies_still);
  CHECK(blurred.primitive == still.primitive);  // of the sharp ray
}

TEST_CASE("Every effect and source of random numbers varies where it should", "[render]") {
  for (const RandomKind random : {RandomKind::hash, RandomKind::md5, RandomKind::texture})
    for (const Effects::Model model : {Effects::Model::paper, Effects::Model::physical})
      for (const std::string name : {"dof", "soft_shadow", "glossy"}) {
        const Scene scene = load_scene(name);
        RenderSettings settings = settings_of(24, 18, 16);
        settings.random = random;
        settings.effects = scene.effects;
        settings.effects->antialias = false;
        settings.effects->model = model;
        const RenderedPicture picture = rendered(scene, settings);
        std::size_t varies = 0, constant = 0;
        for (const glm::dvec3& v : picture.variance) varies += v.r > 0.0, constant += v == glm::dvec3(0.0);
        CAPTURE(name, name_of(random));
        CHECK(varies > 20);
        if (name == "glossy") CHECK(constant > 20);  // all of the others: what is out of focus, and every n.l
      }
}

TEST_CASE("What sharp rays tell does not depend on bundles, and needs no frame", "[render]") {
  const Scene scene = load_scene("sphereflake:1");
  RenderSettings settings = settings_of(25, 7, 1);
  Renderer alone(context(), scene, settings);
  const RenderedPicture wanted = alone.picture();
  settings.bundle = {3};
  settings.random = RandomKind::texture;
  Renderer together(context(), scene, settings);
  const RenderedPicture told = together.picture();
  CHECK(told.steps == wanted.steps);
  CHECK(told.primitive == wanted.primitive);
  CHECK(told.depth == wanted.depth);
}

TEST_CASE("A picture of several tiles has the noise of its frames in each", "[render]") {
  const Scene scene = load_scene("soft_shadow");
  RenderSettings settings = settings_of(600, 2, 3);
  settings.random = RandomKind::texture;
  const RenderedPicture whole = rendered(scene, settings);
  Renderer by_parts(context(), scene, settings);
  for (std::uint32_t f = 0; f < 3; ++f) CHECK(by_parts.add_frames(f, 1));
  const RenderedPicture parts = by_parts.picture();
  CHECK(parts.mean == whole.mean);
  CHECK(parts.variance == whole.variance);
}

TEST_CASE("What no picture has is refused", "[render]") {
  const Scene scene = load_scene("dof");
  const auto refused = [&](const RenderSettings& settings) {
    CHECK_THROWS_AS(Renderer(context(), scene, settings), InputError);
  };
  refused(settings_of(0, 5, 1));
  refused(settings_of(65537, 1, 1));
  refused(settings_of(65536, 65536, 1));
  refused(settings_of(8, 8, 0));
  RenderSettings settings = settings_of(8, 8, 1);
  settings.time = std::numeric_limits<double>::quiet_NaN();
  refused(settings);
  settings = settings_of(8, 8, 1);
  settings.bundle = {5};
  refused(settings);
  settings.bundle = {1};
  settings.patches = {{"no_such_file.glsl", "a", "b"}};
  refused(settings);
  Scene wide = scene;
  wide.camera.aperture = 1e6f;
  CHECK_THROWS_AS(Renderer(context(), wide, settings_of(8, 8, 1)), InputError);
}

}  // namespace plumbline
