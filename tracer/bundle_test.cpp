// SPDX-License-Identifier: MIT
// Bundles: rays that walk the tree together answer, bit for bit, as each does alone.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/rays.h"
#include "scenes/read.h"
#include "tracer/probe.h"
#include "tracer/tree_test_scenes.h"

namespace plumbline {
namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

std::vector<Hit> traced(Probe& probe, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  return hits;
}

bool same_answer(Hit a, Hit b) {
  a.steps = b.steps = a.primitive_tests = b.primitive_tests = a.transforms = b.transforms = 0;
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}
std::size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += !same_answer(a[i], b[i]);
  return n;
}

/// Camera rays first, side by side; then rays of all families in turn, so that each bundle mixes them: rays without an
/// answer, from far away and seen edge-on beside ordinary ones.
std::vector<Ray> company(const Scene& scene, std::size_t each) {
  const RaySource source(scene, {});
  std::vector<std::vector<Ray>> families;
  for (const RayFamilyInfo& info : ray_families())
    generate_rays(source, info.family, 1, 0, families.emplace_back(each));
  std::vector<Ray> rays = families[0];
  for (std::size_t i = 0; i < each; ++i)
    for (const auto& family : families) rays.push_back(family[i]);
  return rays;
}

std::vector<BakeOptions> bakes(bool has_nodes) {
  std::vector<BakeOptions> all;
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
      for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
        if (out == TransformOut::inverse && !has_nodes) continue;
        BakeOptions options;
        options.layout = layout, options.bounds = bounds, options.transform_out = out;
        options.links = bounds == Bounds::aabb ? Links::threaded : Links::octant;
        all.push_back(options);
      }
  return all;
}

}  // namespace

TEST_CASE("a ray of a bundle answers as it does alone", "[bundle]") {
  for (const std::string name : {"soup", "sphereflake"}) {
    const Scene scene = name == "soup" ? random_scene(3, 300, 100, 0.3f) : generate_scene(name, 2);
    const std::vector<Ray> rays = company(scene, 96);
    for (const BakeOptions& options : bakes(false)) {
      const GeometryImage image = bake(scene, options);
      Probe single(context(), image);
      const std::vector<Hit> alone = traced(single, rays);
      for (const int size : {2, 3, 4}) {
        Probe bundled(context(), image, BundleSize{size});
        INFO(name << " " << name_of(options.layout) << " " << name_of(options.bounds) << ", bundles of " << size);
        CHECK(differences(traced(bundled, rays), alone) == 0);
        CHECK(bundled.rays_left_alone() > 0);
        CHECK(bundled.rays_left_alone() < rays.size() / 2);
      }
    }
  }
}

TEST_CASE("a ray of a bundle goes in and out of transforms as it does alone", "[bundle]") {
  const Scene scene = load_scene("nested");
  const std::vector<Ray> rays = company(scene, 96);
  for (const BakeOptions& options : bakes(true)) {
    const GeometryImage image = bake(scene, options);
    Probe single(context(), image);
    const std::vector<Hit> alone = traced(single, rays);
    for (const int size : {options.layout == Layout::compact ? 4 : 2}) {
      Probe bundled(context(), image, BundleSize{size});
      INFO(name_of(options.layout) << " " << name_of(options.bounds) << " "
                                   << (options.transform_out == TransformOut::inverse ? "inverse" : "restore")
                                   << ", bundles of " << size);
      CHECK(differences(traced(bundled, rays), alone) == 0);
      // Those that drift walk alone where the others look another way.
      CHECK(bundled.rays_left_alone() < rays.size() * (options.transform_out == TransformOut::inverse ? 4 : 2) / 4);
    }
  }
}

TEST_CASE("bundles are filled from rays in their order, the last one too", "[bundle]") {
  const Scene scene = generate_scene("sphereflake", 2);
  const GeometryImage image = bake(scene);
  Probe single(context(), image), bundled(context(), image, BundleSize{4});
  const std::vector<Ray> rays = company(scene, 16);
  for (const std::size_t count : {0, 1, 3, 4, 5, 31}) {
    const std::vector<Ray> some(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(count));
    CHECK(differences(traced(bundled, some), traced(single, some)) == 0);
  }
}

TEST_CASE("a bundle of one ray many times takes the steps of that ray", "[bundle]") {
  const Scene scene = generate_scene("sphereflake", 2);
  const GeometryImage image = bake(scene);
  Probe single(context(), image), bundled(context(), image, BundleSize{4});
  std::vector<Ray> rays;
  for (const Ray& ray : company(scene, 64)) rays.insert(rays.end(), 4, ray);
  const std::vector<Hit> alone = traced(single, rays), together = traced(bundled, rays);
  std::size_t walked = 0, differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (together[i].primitive_tests > 0) continue;  // it walked alone
    walked += together[i].steps > 1;
    differing += together[i].steps != alone[i].steps;
  }
  CHECK(walked > 100);
  CHECK(differing == 0);
}

TEST_CASE("a fault in what a bundle shares is seen", "[bundle]") {
  const Scene scene = generate_scene("sphereflake", 2);
  const GeometryImage image = bake(scene);
  const std::vector<Ray> rays = company(scene, 96);
  Probe single(context(), image);
  const std::array patches{ShaderPatch{"bundle.glsl", "nearest = bundle_nearest[K]", "nearest = bundle_nearest[0]"}};
  Probe faulty(context(), image, BundleSize{2}, patches);
  CHECK(differences(traced(faulty, rays), traced(single, rays)) > 0);
}

}  // namespace plumbline
