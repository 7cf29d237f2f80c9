// SPDX-License-Identifier: GPL-3.0-or-later
// The bounds hold on ten million hits, well- and ill-conditioned, and they are not slack.
#include "harness/bounds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "harness/session.h"
#include "reference/exact_values.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr std::size_t kHits = 10'000'000;
constexpr std::size_t kBatch = 1 << 18;
constexpr std::uint32_t kPrimitives = 2000;

/// Triangles from equilateral to needles of 1 : 10^4, sizes over four decades, strewn far enough apart that most rays
/// see the one they are aimed at.
Scene random_triangles() {
  Scene scene;
  scene.name = "random_triangles";
  scene.materials.emplace_back();
  for (std::uint32_t i = 0; i < kPrimitives; ++i) {
    Random random(1, name_hash("bounds_test triangles"), i);
    const glm::dvec3 center = 100.0 * random.direction() * std::cbrt(random.uniform());
    const double size = std::pow(10.0, random.uniform(-3.0, 1.0)), thin = std::pow(10.0, -random.uniform(0.0, 4.0));
    const glm::dvec3 a = random.direction(), b = glm::normalize(glm::cross(a, random.direction()));
    for (const glm::dvec3& corner : {center, center + size * a, center + size * random.uniform() * a + size * thin * b})
      scene.positions.emplace_back(corner);
    scene.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  return scene;
}

Scene random_spheres() {
  Scene scene;
  scene.name = "random_spheres";
  scene.materials.emplace_back();
  for (std::uint32_t i = 0; i < kPrimitives; ++i) {
    Random random(1, name_hash("bounds_test spheres"), i);
    const glm::dvec3 center = 100.0 * random.direction() * std::cbrt(random.uniform());
    scene.spheres.push_back({glm::vec3(center), static_cast<float>(std::pow(10.0, random.uniform(-3.0, 0.5))), 0});
  }
  return scene;
}

/// A ray at a random point of a random primitive, from near and far, straight on and at grazing angles, with directions
/// of any length.
Ray aimed_ray(const Scene& scene, std::uint64_t index) {
  Random random(2, name_hash(scene.name), index);
  const std::uint32_t p = random.below(scene.primitive_count());
  glm::dvec3 target, normal;
  double size = 0.0;
  if (scene.is_triangle(p)) {
    const auto v = scene.corners(p);
    double a = random.uniform(), b = random.uniform();
    if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
    const glm::dvec3 e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]), e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
    target = glm::dvec3(v[0]) + a * e1 + b * e2;
    normal = glm::normalize(glm::cross(e1, e2));
    size = glm::length(e1);
  } else {
    normal = random.direction();
    size = scene.sphere(p).radius;
    target = glm::dvec3(scene.sphere(p).center) + size * normal;
  }
  // The angle to the surface: half of the rays anywhere, half within 10^-4 to 1 of grazing.
  glm::dvec3 direction = random.direction();
  if (random.below(2) == 0) {
    const double rise = std::pow(10.0, random.uniform(-4.0, 0.0));
    direction = glm::normalize(glm::normalize(glm::cross(normal, direction)) + rise * normal);
  }
  if (glm::dot(direction, normal) > 0.0) direction = -direction;
  const double distance = size * std::pow(10.0, random.uniform(-1.0, 4.0)),
               length = std::pow(2.0, random.uniform(-20.0, 20.0));
  return {glm::vec3(target - distance * direction), glm::vec3(length * direction)};
}

/// How errors stand against their bounds, over many hits.
struct Outcome {
  std::uint64_t hits = 0;      ///< with exact values to compare with
  std::uint64_t outside = 0;   ///< hits with a value outside its bound
  std::uint64_t above = 0;     ///< hits with a value of least_value_bounds above that of value_bounds
  double worst = 0.0;          ///< largest error over its bound
  std::vector<double> ratios;  ///< a sample: the error of t over its bound
  std::vector<double> sizes;   ///< the same sample: the bound of t over the distance
};

Outcome combine(Outcome a, const Outcome& b) {
  a.hits += b.hits, a.outside += b.outside, a.above += b.above;
  a.worst = std::max(a.worst, b.worst);
  a.ratios.insert(a.ratios.end(), b.ratios.begin(), b.ratios.end());
  a.sizes.insert(a.sizes.end(), b.sizes.begin(), b.sizes.end());
  return a;
}

/// How far away the hit is, in units of t: what errors of t are relative to.
double distance_scale(const BoundsContext& context, const Ray& ray, double t) {
  const double reach =
      std::min(glm::length(glm::dvec3(ray.origin) - context.world.ball.center), 2.0 * context.world.ball.radius) +
      context.world.ball.radius;
  return reach / glm::length(glm::dvec3(ray.direction)) + std::abs(t);
}

Outcome examine(const Scene& scene, std::size_t count) {
  Session session;
  const Stage& stage = session.stage(scene.name, scene);
  Probe& probe = session.probe(stage);
  std::vector<Ray> rays(kBatch);
  std::vector<Hit> hits(kBatch);
  Outcome total;
  for (std::size_t first = 0; total.hits < count; first += kBatch) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kBatch), [&](const auto& r) {
      for (std::size_t i = r.begin(); i != r.end(); ++i) rays[i] = aimed_ray(stage.scene, first + i);
    });
    probe.trace(rays, hits);
    total = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, kBatch), total,
        [&](const auto& r, Outcome o) {
          for (std::size_t i = r.begin(); i != r.end(); ++i) {
            if (hits[i].kind != HitKind::hit) continue;
            const ReferenceHit truth = exact_hit(stage.scene, rays[i], hits[i].instance, hits[i].primitive);
            if (truth.kind != HitKind::hit) continue;  // grazing: judged by its margin, not by its values
            const PlacedRay placed = place_ray(stage.judge.bounds, rays[i], hits[i].instance);
            const ValueBounds b = value_bounds(stage.judge.bounds, placed, hits[i].primitive, truth.t);
            const ValueBounds least = least_value_bounds(stage.judge.bounds, placed, hits[i].primitive, truth.t);
            o.above += !(least.t <= b.t && least.position <= b.position && least.normal <= b.normal &&
                         least.barycentrics <= b.barycentrics);
            const double dt = std::abs(hits[i].t - truth.t);
            const glm::dvec2 dw = glm::abs(glm::dvec2(hits[i].barycentrics) - truth.barycentrics);
            const bool numbers = std::isfinite(hits[i].t) && glm::length(hits[i].position) < 1e30f &&
                                 glm::length(hits[i].normal) < 2.0f && dw.x + dw.y < 4.0;
            const double ratio =
                !numbers ? INFINITY
                         : std::max({dt / b.t, glm::length(glm::dvec3(hits[i].position) - truth.position) / b.position,
                                     glm::length(glm::dvec3(hits[i].normal) - truth.normal) / b.normal,
                                     b.barycentrics > 0.0 ? std::max(dw.x, dw.y) / b.barycentrics
                                                          : std::max(dw.x, dw.y) * 1e30});
            ++o.hits;
            o.outside += !(ratio <= 1.0);
            o.worst = std::max(o.worst, ratio);
            if (i % 64 != 0) continue;
            o.ratios.push_back(dt / b.t);
            o.sizes.push_back(b.t / distance_scale(stage.judge.bounds, rays[i], truth.t));
          }
          return o;
        },
        [](Outcome a, const Outcome& b) { return combine(std::move(a), b); });
  }
  return total;
}

void check_bounds(const Scene& scene, std::size_t count) {
  Outcome o = examine(scene, count);
  std::sort(o.ratios.begin(), o.ratios.end());
  std::sort(o.sizes.begin(), o.sizes.end());
  const double median = o.ratios[o.ratios.size() / 2], typical = o.sizes[o.sizes.size() / 2];
  const double caught =
      static_cast<double>(std::lower_bound(o.sizes.begin(), o.sizes.end(), 64.0 * typical) - o.sizes.begin()) /
      static_cast<double>(o.sizes.size());
  WARN(scene.name << ": " << o.hits << " hits, largest error " << o.worst << " of its bound; t: median error " << median
                  << " of its bound, typical bound " << typical / 0x1p-24
                  << " * 2^-24 of the distance, an error of 64 times that is outside the bound of " << 100.0 * caught
                  << " % of the hits");
  CHECK(o.outside == 0);
  CHECK(o.above == 0);
  // Not slack: the worst of so many hits comes near its bound; and an error of 64 times the typical bound is seen on
  // nearly all hits, half of them grazing.
  CHECK(o.worst > 1.0 / 16.0);
  CHECK(typical < 256.0 * 0x1p-24);
  CHECK(caught > 0.8);
}

}  // namespace

TEST_CASE("Bounds hold on millions of hits of triangles, and a gross error is outside them") {
  check_bounds(random_triangles(), kHits / 2);
}

TEST_CASE("Bounds hold on millions of hits of spheres, and a gross error is outside them") {
  check_bounds(random_spheres(), kHits / 2);
}
