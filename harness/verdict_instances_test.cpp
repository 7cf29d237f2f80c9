// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts where geometry is placed by transforms, on answers made up by hand: the instance is part of the answer.
#include <catch2/catch.hpp>
#include <cmath>

#include "harness/exact_view.h"
#include "harness/verdict.h"
#include "reference/exact_values.h"
#include "scenes/generate.h"

using namespace plumbline;

namespace {

/// What judging needs, for a scene made by hand.
struct Bench {
  Scene scene;
  Topology topology;
  Arbiter arbiter;
  SceneTree tree;
  Judge judge;
  explicit Bench(Scene s)
      : scene(std::move(s)),
        topology(make_topology(scene)),
        arbiter(scene),
        tree(build_scene_tree(scene)),
        judge(make_judge(scene, arbiter, topology, tree)) {}
};

Node node(const std::string& name, std::uint32_t parent, std::uint32_t part, const Transform& transform) {
  return {name, parent, part, transform, transform};
}

/// The unit square in z = 0 and an icosphere of radius 1 as parts; a sheared group with the square in it, the same
/// square again where the group puts it, and the icosphere far to the right.
Scene placed() {
  Scene s = generate_scene("icosphere", 0);
  const auto faces = static_cast<std::uint32_t>(s.triangles.size());
  const auto first = static_cast<std::uint32_t>(s.positions.size());
  for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)})
    s.positions.push_back(p);
  s.triangles.push_back({{first, first + 1, first + 2}});
  s.triangles.push_back({{first, first + 2, first + 3}});
  s.parts = {{"ball", 0, faces, 0, 0}, {"square", faces, 2, 0, 0}};
  Transform shear;
  shear.linear[2] = {0.5f, 0.0f, 2.0f};  // x grows with z, and z is doubled
  shear.linear[0] = {4.0f, 0.0f, 1.0f};  // the square is tilted, too
  Transform right;
  right.translation = {100.0f, 0.0f, 0.0f};
  s.nodes = {node("group", kNone, kNone, shear), node("group/square", 0, 1, {}), node("copy", kNone, 1, shear),
             node("ball", kNone, 0, right)};
  return s;
}

Hit tracer_hit(const ReferenceHit& truth) {
  Hit h;
  h.kind = truth.kind, h.primitive = truth.primitive, h.instance = truth.instance;
  h.t = static_cast<float>(truth.t), h.position = truth.position, h.normal = truth.normal;
  h.barycentrics = glm::max(truth.barycentrics, 0.0);
  return h;
}

const Ray kThroughSquare{{2.8f, 0.25f, 5.0f}, {0, 0, -1}};

}  // namespace

TEST_CASE("Coincident instances tie, and the wrong one is told where they part") {
  const Bench b(placed());
  const std::uint32_t lower = static_cast<std::uint32_t>(b.scene.triangles.size()) - 2;
  const ReferenceHit one = exact_hit(b.scene, kThroughSquare, 1, lower),
                     other = exact_hit(b.scene, kThroughSquare, 2, lower);
  REQUIRE(one.kind == HitKind::hit);
  CHECK(judge(b.judge, kThroughSquare, tracer_hit(one), one).verdict == Verdict::agree);
  CHECK(judge(b.judge, kThroughSquare, tracer_hit(one), one, true).verdict == Verdict::agree);
  const Judgement tie = judge(b.judge, kThroughSquare, tracer_hit(one), other);
  CHECK(tie.verdict == Verdict::tie);
  CHECK_THAT(tie.exact, Catch::Contains("of instance 1 and " + std::to_string(lower) + " of instance 2"));
}

TEST_CASE("An instance that does not hold the primitive is no answer") {
  const Bench b(placed());
  const std::uint32_t lower = static_cast<std::uint32_t>(b.scene.triangles.size()) - 2;
  const ReferenceHit truth = exact_hit(b.scene, kThroughSquare, 1, lower);
  for (const std::uint32_t wrong : {0u, 3u, 99u, kNone}) {  // a group, another part, none at all, the world
    Hit h = tracer_hit(truth);
    h.instance = wrong;
    const Judgement j = judge(b.judge, kThroughSquare, h, truth);
    CHECK(j.verdict == Verdict::tracer_wrong);
    CHECK_THAT(j.reason, Catch::Contains("does not exist"));
  }
}

TEST_CASE("The normal comes out by the inverse transpose") {
  const Bench b(placed());
  const std::uint32_t lower = static_cast<std::uint32_t>(b.scene.triangles.size()) - 2;
  const ReferenceHit truth = exact_hit(b.scene, kThroughSquare, 1, lower);
  Hit h = tracer_hit(truth);
  h.normal = glm::vec3(glm::normalize(glm::dmat3(b.scene.nodes[0].transform.linear) * glm::dvec3(0, 0, 1)));
  REQUIRE(glm::length(glm::dvec3(h.normal) - truth.normal) > 1e-3);
  const Judgement j = judge(b.judge, kThroughSquare, h, truth);
  CHECK(j.verdict == Verdict::tracer_wrong);
  CHECK_THAT(j.reason, Catch::Contains("normal"));
}

TEST_CASE("A ray that slips through a closed mesh leaks, wherever an instance shows it") {
  const Bench b(placed());
  const auto c = b.scene.corners(0);
  const glm::vec3 middle = 0.5f * (c[0] + c[1]), far(100.0f, 0.0f, 0.0f);
  const Ray through{far + 3.0f * middle, -middle};
  const auto nearest = b.arbiter.nearest(through);
  REQUIRE_FALSE(nearest.empty());
  REQUIRE(nearest.front().instance == 3);
  const Judgement j = judge(b.judge, through, Hit{}, exact_hit(b.scene, through, 3, nearest.front().primitive));
  CHECK(j.verdict == Verdict::leak);
  CHECK_THAT(j.reason, Catch::Contains("of instance 3 (ball)"));
}

TEST_CASE("What drift explains depends on how many transforms were left") {
  const Bench b(placed());
  const std::uint32_t lower = static_cast<std::uint32_t>(b.scene.triangles.size()) - 2;
  const ReferenceHit truth = exact_hit(b.scene, kThroughSquare, 1, lower);
  const PlacedRay once = place_ray(b.judge.bounds, kThroughSquare, 1);
  const auto all = static_cast<std::uint32_t>(b.scene.nodes.size());
  const PlacedRay often = place_ray(b.judge.bounds, kThroughSquare, 1, all);
  const double bound = value_bounds(b.judge.bounds, once, lower, truth.t).t,
               drifted = value_bounds(b.judge.bounds, often, lower, truth.t).t;
  REQUIRE(drifted > 1.1 * bound);
  Hit h = tracer_hit(truth);
  h.t += static_cast<float>(0.5 * (bound + drifted));
  h.transforms = all;
  CHECK(judge(b.judge, kThroughSquare, h, truth).verdict == Verdict::tracer_wrong);
  Judge drifting = b.judge;
  drifting.drifts = true;
  CHECK(judge(drifting, kThroughSquare, h, truth).verdict == Verdict::agree);
  h.transforms = all + 1;  // no walk leaves more than there are
  CHECK(judge(drifting, kThroughSquare, h, truth).verdict == Verdict::tracer_wrong);
  h.transforms = 0;
  CHECK(judge(drifting, kThroughSquare, h, truth).verdict == Verdict::tracer_wrong);
}

TEST_CASE("Bounds of rays in the world do not know of instances elsewhere") {
  Scene plain = generate_scene("icosphere", 1);
  const Bench b(plain);
  const Ray ray{{0.1f, 0.2f, 5.0f}, {0, 0, -1}};
  const PlacedRay placed_ray = place_ray(b.judge.bounds, ray, kNone);
  CHECK(placed_ray.is_exact);
  CHECK(placed_ray.t_origin == 0.0);
  CHECK(lateral_bound_of_scene(b.judge.bounds, ray) == lateral_bound_of_space(b.judge.bounds, placed_ray));
}
