// SPDX-License-Identifier: GPL-3.0-or-later
// Exact values against 4000-bit arithmetic, from easy hits to triangles seen edge-on and rays that graze.
#include "reference/exact_values.h"

#include <catch2/catch.hpp>

#include "reference/brute_force_test.h"
#include "reference/lattice_test.h"

using namespace plumbline;
using brute::Real;

namespace {

struct RealVec {
  Real x, y, z;
};
RealVec real(const glm::vec3& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }
RealVec operator-(const RealVec& a, const RealVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
RealVec operator+(const RealVec& a, const RealVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
RealVec operator*(const RealVec& a, const Real& k) { return {a.x * k, a.y * k, a.z * k}; }
RealVec cross(const RealVec& a, const RealVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot(const RealVec& a, const RealVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
RealVec unit(const RealVec& a) { return a * Real(1 / sqrt(dot(a, a))); }

/// The largest error in units of 2^-53 of the largest component.
double error(const glm::dvec3& v, const RealVec& truth) {
  const Real scale = std::max({Real(abs(truth.x)), Real(abs(truth.y)), Real(abs(truth.z))});
  const Real worst = std::max({Real(abs(v.x - truth.x)), Real(abs(v.y - truth.y)), Real(abs(v.z - truth.z))});
  return scale == 0 ? (worst == 0 ? 0.0 : 1e300) : static_cast<double>(Real(ldexp(worst / scale, 53)));
}
double error(double x, const Real& truth) {
  return truth == 0 ? (x == 0.0 ? 0.0 : 1e300) : static_cast<double>(Real(ldexp(abs((x - truth) / truth), 53)));
}

/// The largest error of all values, in units of 2^-53.
double error(const Scene& scene, const Ray& ray, std::uint32_t primitive, const brute::Answer& truth) {
  const ReferenceHit hit = exact_hit(scene, ray, primitive);
  REQUIRE(hit.primitive == primitive);
  REQUIRE((hit.kind == HitKind::hit) == truth.hit);
  const RealVec point = real(ray.origin) + real(ray.direction) * truth.t;
  const Solid solid = solid_of(scene, primitive);
  const RealVec v0 = real(solid.corners[0]);
  // t is promised to one unit in the last place, which may be 2 * 2^-53.
  double worst = std::max(error(hit.t, truth.t) / 2.0, error(hit.position, point));
  if (solid.is_sphere) return std::max(worst, error(hit.normal, unit(point - v0)));
  const RealVec e1 = real(solid.corners[1]) - v0, e2 = real(solid.corners[2]) - v0, n = cross(e1, e2);
  worst = std::max(worst, error(hit.normal, unit(n)));
  const Real u = dot(cross(point - v0, e2), n) / dot(n, n), v = dot(cross(e1, point - v0), n) / dot(n, n);
  const auto weight_error = [](double x, const Real& w) {
    return static_cast<double>(Real(ldexp(abs(x - w) / std::max(Real(1), Real(abs(w))), 53)));
  };
  return std::max({worst, weight_error(hit.barycentrics.x, u), weight_error(hit.barycentrics.y, v)});
}

/// Over all primitives that a ray meets or whose plane it crosses.
template <class MakeRay>
void check_scene(const Scene& scene, int rays, MakeRay&& make_ray, int at_least) {
  int compared = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = make_ray(i);
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      const brute::Answer truth = brute::answer(scene, ray, p);
      if (!truth.meets && truth.facing == 0) continue;  // nothing to tell
      CAPTURE(i, p);
      REQUIRE(error(scene, ray, p, truth) <= 1.01);
      ++compared;
    }
  }
  CHECK(compared > at_least);
}

}  // namespace

TEST_CASE("Exact values are right on lattices and beside them") {
  const Scene scene = lattice::scene(1, 14, 6);
  check_scene(
      scene, 150, [&](int i) { return lattice::ray(scene, 1, i); }, 1000);
  check_scene(
      scene, 150, [&](int i) { return lattice::nudged(lattice::ray(scene, 2, i), 2, i); }, 1000);
}

TEST_CASE("Exact values are right at any size and distance") {
  const Scene plain = lattice::scene(3, 14, 6);
  for (const float factor : {0x1p-140f, 0x1p120f}) {
    const Scene scene = lattice::scaled(plain, factor);
    const auto make_ray = [&](int i) {
      Ray ray = lattice::ray(plain, 3, i);
      ray.origin *= factor;
      return ray;
    };
    check_scene(scene, 60, make_ray, 300);
  }
  const auto far_ray = [&](int i) {
    Ray ray = lattice::nudged(lattice::ray(plain, 3, i), 3, i);
    ray.origin -= 0x1p18f * ray.direction;
    return ray;
  };
  check_scene(plain, 100, far_ray, 300);
}

TEST_CASE("Exact values are right on triangles seen edge-on, and where spheres are grazed") {
  Scene scene;
  scene.materials.resize(1);
  std::vector<Ray> rays;
  for (int i = 0; i < 300; ++i) {
    Random random(4, 4, i);
    const glm::dvec3 corner = random.direction(), along = random.direction(), across = random.direction();
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const glm::dvec3& p : {corner, corner + along, corner + 0.3 * along + 0.01 * across})
      scene.positions.emplace_back(p);
    scene.triangles.push_back({.position = {first, first + 1, first + 2}});
  }
  for (int i = 0; i < 300; ++i) {
    // In the plane up to rounding.
    Random random(5, 5, i);
    const auto corners = scene.corners(static_cast<std::uint32_t>(i));
    const glm::vec3 along = corners[1] - corners[0], target = corners[2] + 0.5f * (corners[0] - corners[2]);
    const Ray ray{target - static_cast<float>(random.uniform(1.0, 3.0)) * along, along, INFINITY};
    rays.push_back(ray);
  }
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const brute::Answer truth = brute::answer(scene, rays[i], static_cast<std::uint32_t>(i));
    if (truth.facing == 0) continue;
    CAPTURE(i);
    REQUIRE(error(scene, rays[i], static_cast<std::uint32_t>(i), truth) <= 1.01);
    ++compared;
  }
  CHECK(compared > 200);

  Scene ball;
  ball.materials.resize(1);
  ball.spheres.push_back({{0.3f, -0.2f, 0.7f}, 0.6f, 0});
  int grazing = 0;
  for (int i = 0; i < 500; ++i) {
    Random random(6, 6, i);
    const glm::dvec3 outwards = random.direction(), tangent = glm::normalize(glm::cross(outwards, random.direction()));
    const double radius = 0.6f;
    const glm::dvec3 touch = glm::dvec3(ball.spheres[0].center) + radius * outwards;
    const Ray ray{glm::vec3(touch - random.uniform(0.5, 2.0) * tangent), glm::vec3(tangent), INFINITY};
    const brute::Answer truth = brute::answer(ball, ray, 0);
    if (!truth.meets) continue;
    REQUIRE(error(ball, ray, 0, truth) <= 1.01);
    ++grazing;
  }
  CHECK(grazing > 100);
}

TEST_CASE("Exact values tell misses and undefined rays") {
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.push_back({.position = {0, 1, 2}});
  scene.spheres.push_back({{0, 0, 5}, 1.0f, 0});
  ReferenceHit hit = exact_hit(scene, {{2, 0.25f, -1}, {0, 0, 1}, INFINITY}, 0);
  CHECK(hit.kind == HitKind::miss);
  CHECK(hit.t == 1.0);
  CHECK(hit.barycentrics == glm::dvec2(2.0, 0.25));
  hit = exact_hit(scene, {{0.25f, 0.25f, 1}, {0, 0, 1}, INFINITY}, 0);
  CHECK(hit.kind == HitKind::miss);
  CHECK(hit.t == -1.0);
  hit = exact_hit(scene, {{0, 0, 0}, {0, 0, 1}, 3.5f}, 1);
  CHECK(hit.kind == HitKind::miss);
  CHECK(hit.t == 4.0);
  CHECK(exact_hit(scene, {{0, 3, 0}, {0, 0, 1}, INFINITY}, 1).kind == HitKind::miss);
  CHECK(exact_hit(scene, {{0, 0, 0}, {1, 0, 0}, INFINITY}, 0).kind == HitKind::miss);
  CHECK(exact_hit(scene, {{0, 0, 0}, {0, 0, 0}, INFINITY}, 0).kind == HitKind::undefined);
}
