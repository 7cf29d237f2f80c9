// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts on answers made up by hand: each of the eight is reached, and only where it should be.
#include "harness/verdict.h"

#include <catch2/catch.hpp>
#include <cmath>

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

Scene triangles(std::vector<glm::vec3> positions, std::vector<std::array<std::uint32_t, 3>> faces) {
  Scene s;
  s.name = "by_hand";
  s.positions = std::move(positions);
  s.materials.emplace_back();
  for (const auto& f : faces) s.triangles.push_back({f});
  return s;
}

/// Two triangles that make the square [0, 1]^2 in the plane z = 0; the diagonal runs from (0, 0) to (1, 1).
Scene square() { return triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}); }

/// The exact answer for a primitive, rounded to the tracer's 32 bits.
Hit tracer_hit(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  const ReferenceHit truth = exact_hit(scene, ray, primitive);
  Hit h;
  h.kind = HitKind::hit, h.primitive = primitive;
  h.t = static_cast<float>(truth.t), h.position = truth.position, h.normal = truth.normal,
  h.barycentrics = glm::max(truth.barycentrics, 0.0);  // the tracer's are never negative
  return h;
}

ReferenceHit reference_hit(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  return exact_hit(scene, ray, primitive);
}

}  // namespace

TEST_CASE("The same primitive within bounds agrees, and a value outside its bound is the tracer's fault") {
  const Bench b(square());
  const Ray ray{{0.7f, 0.2f, 2.0f}, {0, 0, -1}};
  const Hit good = tracer_hit(b.scene, ray, 0);
  const ReferenceHit truth = reference_hit(b.scene, ray, 0);
  CHECK(judge(b.judge, ray, good, truth).verdict == Verdict::agree);
  CHECK(judge(b.judge, ray, good, truth, true).verdict == Verdict::agree);
  const auto with = [&](auto change) {
    Hit h = good;
    change(h);
    return judge(b.judge, ray, h, truth).verdict;
  };
  CHECK(with([](Hit& h) { h.t *= 1.0f + 1e-5f; }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.t = std::nanf(""); }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.position.x += 1e-4f; }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.normal = -h.normal; }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.barycentrics.y += 1e-4f; }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.primitive = 77; }) == Verdict::tracer_wrong);
  CHECK(with([](Hit& h) { h.kind = HitKind::capped; }) == Verdict::capped);
  CHECK(with([](Hit& h) { h.kind = HitKind::undefined; }) == Verdict::tracer_wrong);
}

TEST_CASE("On a shared edge either primitive is right: a tie") {
  const Bench b(square());
  const Ray ray{{0.5f, 0.5f, 2.0f}, {0, 0, -1}};
  const Judgement j = judge(b.judge, ray, tracer_hit(b.scene, ray, 0), reference_hit(b.scene, ray, 1));
  CHECK(j.verdict == Verdict::tie);
  CHECK(j.arbitrated);
  CHECK(judge(b.judge, ray, Hit{}, reference_hit(b.scene, ray, 1)).verdict != Verdict::tie);
}

TEST_CASE("A hair beside the edge is grazing, a thousandth beside it is wrong") {
  const Bench b(square());
  const Ray hair{{std::nextafter(0.5f, 1.0f), 0.5f, 2.0f}, {0, 0, -1}};
  const Judgement j = judge(b.judge, hair, tracer_hit(b.scene, hair, 1), reference_hit(b.scene, hair, 0));
  CHECK(j.verdict == Verdict::grazing);
  CHECK(j.margin > 0.0);
  CHECK(j.margin < j.bound);
  Hit nonsense = tracer_hit(b.scene, hair, 1);
  nonsense.normal = glm::vec3(std::nanf(""));
  CHECK(judge(b.judge, hair, nonsense, reference_hit(b.scene, hair, 0)).verdict == Verdict::tracer_wrong);
  const Ray wide{{0.501f, 0.5f, 2.0f}, {0, 0, -1}};
  CHECK(judge(b.judge, wide, tracer_hit(b.scene, wide, 1), reference_hit(b.scene, wide, 0)).verdict ==
        Verdict::tracer_wrong);
  CHECK(judge(b.judge, wide, tracer_hit(b.scene, wide, 0), reference_hit(b.scene, wide, 1)).verdict ==
        Verdict::reference_wrong);
}

TEST_CASE("The first hit instead of the nearest is wrong") {
  const Bench b(
      triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {1, 0, -1}, {0, 1, -1}}, {{0, 1, 2}, {3, 4, 5}}));
  const Ray ray{{0.25f, 0.25f, 2.0f}, {0, 0, -1}};
  CHECK(judge(b.judge, ray, tracer_hit(b.scene, ray, 1), reference_hit(b.scene, ray, 0)).verdict ==
        Verdict::tracer_wrong);
  CHECK(judge(b.judge, ray, Hit{}, reference_hit(b.scene, ray, 0)).verdict == Verdict::tracer_wrong);
}

TEST_CASE("Both wrong together is seen by the arbiter alone") {
  const Bench b(square());
  const Ray ray{{0.7f, 0.2f, 2.0f}, {0, 0, -1}};
  CHECK(judge(b.judge, ray, Hit{}, ReferenceHit{}).verdict == Verdict::agree);
  CHECK(judge(b.judge, ray, Hit{}, ReferenceHit{}, true).verdict == Verdict::tracer_wrong);
}

TEST_CASE("A ray that slips through an edge of a closed mesh is a leak, one that passes by a silhouette is grazing") {
  const Bench b(generate_scene("icosphere", 0));
  // Aim at the middle of an edge from straight above it: both triangles face the ray.
  const auto c = b.scene.corners(0);
  const glm::vec3 middle = 0.5f * (c[0] + c[1]);
  const Ray through{3.0f * middle, -middle};
  ReferenceHit truth;
  for (const Placed& p : b.arbiter.nearest(through)) truth = reference_hit(b.scene, through, p.primitive);
  REQUIRE(truth.kind == HitKind::hit);
  const Judgement leak = judge(b.judge, through, Hit{}, truth);
  // The edge's middle is rounded to floats: the ray passes within what 32 bits resolve of the edge.
  CHECK(leak.verdict == Verdict::leak);

  // Aim at the corner that is farthest in x along z: there the surface turns round.
  glm::vec3 tip = b.scene.positions[0];
  for (const glm::vec3& p : b.scene.positions)
    if (p.x > tip.x) tip = p;
  const Ray past{tip + glm::vec3(0, 0, 4), {0, 0, -1}};
  const auto nearest = b.arbiter.nearest(past);
  REQUIRE_FALSE(nearest.empty());
  const Judgement graze = judge(b.judge, past, Hit{}, reference_hit(b.scene, past, nearest.front().primitive));
  CHECK(graze.verdict == Verdict::grazing);
}

TEST_CASE("Rays without an answer are undefined, and a tracer that answers them is wrong") {
  const Bench b(square());
  const Ray ray{{0, 0, std::nanf("")}, {0, 0, -1}};
  Hit h;
  h.kind = HitKind::undefined;
  ReferenceHit r;
  r.kind = HitKind::undefined;
  CHECK(judge(b.judge, ray, h, r).verdict == Verdict::undefined);
  CHECK(judge(b.judge, ray, Hit{}, r).verdict == Verdict::tracer_wrong);
}

TEST_CASE("A batch counts every ray once and keeps the first few of each verdict, of the reference's errors all") {
  const Bench b(square());
  std::vector<Ray> rays(5000, Ray{{0.7f, 0.2f, 2.0f}, {0, 0, -1}});
  std::vector<Hit> hits(rays.size(), tracer_hit(b.scene, rays[0], 0));
  std::vector<ReferenceHit> truths(rays.size(), reference_hit(b.scene, rays[0], 0));
  for (std::size_t i = 100; i < 200; ++i) hits[i] = Hit{};
  for (std::size_t i = 1000; i < 2500; ++i) truths[i] = ReferenceHit{};
  Tally tally;
  judge_batch(b.judge, rays, hits, truths, 1000, 1, 16, tally);
  CHECK(tally.rays() == 5000);
  CHECK(tally[Verdict::tracer_wrong] == 100);
  CHECK(tally[Verdict::reference_wrong] == 1500);
  CHECK(tally[Verdict::agree] == 3400);
  CHECK(tally.sampled > 200);
  CHECK(tally.sampled < 450);
  REQUIRE(tally.kept.size() == 24 + 1500);
  CHECK(tally.kept.front().index == 1100);
  CHECK(tally.kept[23].index == 1123);
  CHECK(tally.kept[24].index == 2000);
  CHECK(tally.kept.back().index == 3499);
}
