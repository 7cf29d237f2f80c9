// SPDX-License-Identifier: MIT
// Captured walks end in the production's own hits, bit for bit, and tell how they got there.
#include "tracer/walk_trace.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "tracer/probe.h"
#include "tracer/shader_words.h"
#include "tracer/walk_analysis.h"

using namespace plumbline;

namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

std::vector<Ray> some_rays(const Scene& scene, std::size_t count, std::uint64_t seed) {
  const Ball ball = bounding_ball(scene);
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, 1, i);
    const double distance = i % 4 == 0 ? 3e5 : i % 4 == 1 ? 0.2 : 1.5;
    rays[i].origin = glm::vec3(ball.center + random.direction() * (ball.radius * distance));
    const glm::dvec3 at = ball.center + random.direction() * (ball.radius * 0.7 * random.uniform());
    rays[i].direction = glm::vec3((at - glm::dvec3(rays[i].origin)) * random.uniform(0.5, 2.0));
    if (i % 5 == 4) rays[i].t_max = static_cast<float>(random.uniform(0.0, 2.0));
  }
  return rays;
}

/// Rays along the planes of triangles, which are then seen edge-on.
void add_edge_on(const Scene& scene, std::vector<Ray>& rays) {
  for (std::uint32_t p = 0; p < scene.triangles.size() && p < 200; p += 41) {
    const auto corners = scene.corners(p);
    Ray ray;
    ray.origin = corners[0] - 2.0f * (corners[1] - corners[0]) + 0.3f * (corners[2] - corners[0]);
    ray.direction = corners[1] - corners[0];
    rays.push_back(ray);
  }
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof(Hit)) == 0; }

/// What a walk must be in itself.
void check_consistent(const Walk& walk) {
  CHECK(walk.driver_agrees);
  CHECK(walk.skipped == 0);
  std::uint32_t tests = 0, transforms = 0, last = 0;
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    const WalkStep& step = walk.steps[i];
    CHECK(step.number == last + (step.again ? 0 : 1));
    last = step.number;
    CHECK(step.node != kNone);
    CHECK(step.next == (i + 1 < walk.steps.size() ? walk.steps[i + 1].cell : kNone));
    for (const TestedPrimitive& tested : step.primitives) {
      tests += !tested.resolved;
      CHECK(tested.primitive != kNone);
      CHECK((tested.nearest_after != tested.nearest_before) <= (tested.outcome == PrimitiveTest::new_nearest));
    }
    for (const SpaceChange& change : step.changes)
      transforms += change.kind == SpaceChange::Kind::entered || change.kind == SpaceChange::Kind::missed;
  }
  CHECK(last == walk.hit.steps);
  CHECK(tests == walk.hit.primitive_tests);
  CHECK(transforms == walk.hit.transforms);
  if (!walk.steps.empty()) CHECK(walk.steps.back().ended == (walk.hit.kind != HitKind::capped));
}

std::vector<BakeOptions> variants(bool with_transforms) {
  std::vector<BakeOptions> all;
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      BakeOptions options;
      options.layout = layout, options.bounds = bounds;
      options.links = bounds == Bounds::aabb ? Links::threaded : Links::octant;
      options.transform_out = layout == Layout::paper ? TransformOut::inverse : TransformOut::restore;
      all.push_back(options);
    }
  }
  if (with_transforms) {
    all.push_back(all[0]);
    all.back().transform_out = TransformOut::inverse;
  }
  return all;
}

}  // namespace

TEST_CASE("a captured walk ends in the production's hit, bit for bit", "[walk]") {
  std::vector<Scene> scenes{generate_scene("creature"), generate_scene("sphereflake", 2)};
  for (const char* file : {"figure_1", "nested", "ellipsoids", "far_away", "mirror"})
    scenes.push_back(read_scene("scenes/" + std::string(file) + ".json"));
  std::size_t again = 0, edge_on = 0, left = 0, walks = 0;
  double seconds = 0.0;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    std::vector<Ray> rays = some_rays(scenes[s], 8, s);
    add_edge_on(scenes[s], rays);
    for (const BakeOptions& options : variants(!scenes[s].nodes.empty())) {
      INFO(scenes[s].name << ", " << name_of(options.layout) << ", " << name_of(options.bounds) << ", "
                          << name_of(options.transform_out));
      const GeometryImage image = bake(scenes[s], options);
      std::vector<Hit> hits(rays.size());
      Probe(context(), image).trace(rays, hits);
      WalkRecorder recorder(context(), image);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        INFO("ray " << i);
        const Walk walk = recorder.record(rays[i]);
        CHECK(same_bits(walk.hit, hits[i]));
        check_consistent(walk);
        for (const WalkStep& step : walk.steps) {
          again += step.again;
          for (const TestedPrimitive& tested : step.primitives) edge_on += tested.resolved;
          for (const SpaceChange& change : step.changes) left += change.kind == SpaceChange::Kind::left;
        }
        seconds += walk.seconds;
        ++walks;
      }
    }
  }
  CHECK(again > 0);
  CHECK(edge_on > 0);
  CHECK(left > 0);
  WARN("a capture took " << 1e3 * seconds / static_cast<double>(walks) << " ms");
}
