// SPDX-License-Identifier: MIT
// The renderer's rays are the probe's: every ray of every batch, tapped from the shaders, is traced again by the probe.
#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <set>

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

}  // namespace plumbline
