// SPDX-License-Identifier: GPL-3.0-or-later
// The arbiter against a loop over all primitives in big integers, where exact coincidences abound.
#include <catch2/catch.hpp>

#include "reference/arbiter.h"
#include "reference/brute_force_test.h"
#include "reference/lattice_test.h"
#include "reference/small_scenes_test.h"

using namespace plumbline;

namespace {

bool close(double a, const brute::Real& exact) {
  // One unit in the last place.
  return abs(brute::Real(a) - exact) <= ldexp(abs(exact), -52);
}

struct Counts {
  int hits = 0, ties = 0, touches = 0, in_plane = 0, tangents = 0;
};

/// Everything that the arbiter says of a ray, against the loop.
void compare_with_loop(const Scene& scene, const Arbiter& arbiter, const Ray& ray, Counts& counts) {
  const std::vector<std::uint32_t> expected = brute::nearest(scene, ray);
  const std::vector<std::uint32_t> nearest = nearest_in_world(arbiter, ray);
  CAPTURE(ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max);
  REQUIRE(nearest == expected);
  counts.hits += !expected.empty();
  counts.ties += expected.size() > 1;

  const std::vector<Crossing> crossings = arbiter.crossings(ray, 0.0, 0.0);
  std::vector<bool> seen(scene.primitive_count());
  const Crossing* before = nullptr;
  for (const Crossing& c : crossings) {
    REQUIRE(!seen[c.primitive]);
    seen[c.primitive] = true;
    const brute::Answer truth = brute::answer(scene, ray, c.primitive);
    CAPTURE(c.primitive, c.t, c.margin);
    REQUIRE(c.on_line == truth.meets);
    REQUIRE(c.hit == truth.hit);
    REQUIRE(c.facing == truth.facing);
    REQUIRE(c.nearest == std::binary_search(expected.begin(), expected.end(), c.primitive));
    counts.in_plane += c.in_plane;
    if (!c.on_line) {
      REQUIRE(c.margin == 0.0);  // reach is zero
      continue;
    }
    REQUIRE(close(c.t, truth.t));
    REQUIRE(close(c.t_enter, truth.enter));
    REQUIRE(close(c.t_leave, truth.leave));
    REQUIRE(c.margin >= 0.0);
    REQUIRE((c.margin == 0.0) == truth.touches);
    if (scene.is_triangle(c.primitive)) REQUIRE((c.near_edges != 0) == truth.touches);
    counts.touches += truth.touches;
    counts.tangents += truth.touches && !scene.is_triangle(c.primitive);
    if (before != nullptr) {
      const int order = brute::compare(brute::answer(scene, ray, before->primitive).t, truth.t);
      REQUIRE((order < 0 || (order == 0 && before->primitive < c.primitive)));
    }
    before = &c;
  }
  for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
    if (!seen[p]) REQUIRE(!brute::answer(scene, ray, p).hit);
  }
}

}  // namespace

TEST_CASE("The arbiter agrees with big integers on lattices") {
  Counts counts;
  for (int n = 0; n < 6; ++n) {
    const Scene scene = lattice::scene(n, 24, 8);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 500; ++i) compare_with_loop(scene, arbiter, lattice::ray(scene, n, i), counts);
  }
  // The lattice must give what it is there for.
  CHECK(counts.hits > 1500);
  CHECK(counts.ties > 300);
  CHECK(counts.touches > 1000);
  CHECK(counts.tangents > 5);
  CHECK(counts.in_plane > 100);
}

TEST_CASE("The arbiter agrees with big integers next to lattices") {
  Counts counts;
  for (int n = 0; n < 6; ++n) {
    const Scene scene = lattice::scene(10 + n, 24, 8);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 400; ++i) {
      compare_with_loop(scene, arbiter, lattice::nudged(lattice::ray(scene, n, i), n, i), counts);
    }
  }
  CHECK(counts.hits > 1000);
}

TEST_CASE("The arbiter agrees with big integers at any size") {
  Counts counts;
  // The smallest has denormal coordinates: a quarter is 2^-146. The largest reaches 2^127.
  for (const float factor : {0x1p-144f, 0x1p-100f, 0x1p100f, 0x1p126f}) {
    const Scene scene = lattice::scaled(lattice::scene(20, 24, 8), factor);
    const Scene plain = lattice::scene(20, 24, 8);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 300; ++i) {
      Ray ray = lattice::ray(plain, 20, i);
      ray.origin *= factor;
      const float longer[] = {0x1p-120f, 1.0f, 0x1p120f};
      ray.direction *= longer[i % 3];
      ray.t_max = static_cast<float>(ray.t_max * static_cast<double>(factor) / longer[i % 3]);
      compare_with_loop(scene, arbiter, ray, counts);
    }
  }
  CHECK(counts.hits > 400);
  CHECK(counts.ties > 100);
}

TEST_CASE("The arbiter agrees with big integers from far away") {
  Counts counts;
  for (const float distance : {64.0f, 0x1p20f, 0x1p40f}) {
    const Scene scene = lattice::scene(30, 24, 8);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 400; ++i) {
      Ray ray = lattice::ray(scene, 30, i);
      // The first two stay exact on the lattice, the last and the nudged ones do not.
      ray.origin -= distance * ray.direction;
      ray.t_max += distance;
      if (i % 2 == 1) ray = lattice::nudged(ray, 30, i);
      compare_with_loop(scene, arbiter, ray, counts);
    }
  }
  CHECK(counts.hits > 200);
  CHECK(counts.touches > 100);
}

namespace {

/// The distance of the whole line from a segment, by golden-section search: slow, plain, good to 1e-8.
double distance(const Ray& ray, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction)), o(ray.origin);
  const auto at = [&](double where) { return glm::length(glm::cross(d, from + where * (to - from) - o)); };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double a = low + 0.381966 * (high - low), b = low + 0.618034 * (high - low);
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return std::min({at(0.0), at(1.0), at(0.5 * (low + high))});
}

/// How far the line passes from the primitive's outline.
double distance(const Ray& ray, const Solid& solid) {
  const auto& [v0, v1, v2] = solid.corners;
  if (!solid.is_sphere) return std::min({distance(ray, v0, v1), distance(ray, v1, v2), distance(ray, v2, v0)});
  return std::abs(distance(ray, v0, v0) - solid.radius);
}

}  // namespace

TEST_CASE("Slack and reach name the neighbours, and say how far they are") {
  const Scene scene = lattice::scene(40, 24, 8);
  const Arbiter arbiter(scene);
  const double reach = 0.1;
  int beside = 0, before = 0, in_plane = 0;
  for (int i = 0; i < 600; ++i) {
    Ray ray = lattice::nudged(lattice::ray(scene, 40, i), 40, i);
    // Everything on the line; else only what is hit, or is so within a slack of half.
    const double slack = i % 2 == 0 ? 1e6 : 0.5;
    std::vector<const Crossing*> found(scene.primitive_count(), nullptr);
    const std::vector<Crossing> crossings = arbiter.crossings(ray, reach, slack);
    for (const Crossing& c : crossings) found[c.primitive] = &c;
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      CAPTURE(i, p);
      const brute::Answer truth = brute::answer(scene, ray, p);
      const double far = distance(ray, solid_of(scene, p));
      const auto in_slack = [&](const brute::Real& t) { return t > -slack && t <= brute::Real(ray.t_max) + slack; };
      if (truth.meets && (in_slack(truth.enter) || in_slack(truth.leave))) {
        REQUIRE(found[p] != nullptr);
        before += !truth.hit;
      }
      if (!truth.meets && i % 2 == 0) REQUIRE((found[p] != nullptr) == (far <= reach));
      if (found[p] == nullptr) continue;
      const Crossing& c = *found[p];
      REQUIRE(c.on_line == truth.meets);
      REQUIRE(std::abs(c.margin) == Approx(far).margin(1e-7));
      if (!c.on_line) {
        REQUIRE(c.margin <= 0.0);
        REQUIRE((c.margin < 0.0 || c.in_plane));
        ++beside;
        in_plane += c.in_plane;
      }
    }
  }
  CHECK(beside > 200);
  CHECK(before > 100);
  CHECK(in_plane > 20);
}
