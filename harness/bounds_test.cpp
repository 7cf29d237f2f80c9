// SPDX-License-Identifier: GPL-3.0-or-later
// The bounds hold on ten million hits, well- and ill-conditioned, and they are not slack.
#include "harness/bounds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "harness/session.h"
#include "reference/exact_values.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr std::size_t kHits = 10'000'000, kInstanceHits = 1'000'000;
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

/// A point on a primitive, in its own space.
struct Target {
  glm::dvec3 point{0.0}, normal{0.0};
  double size = 0.0;
};
Target target_on(const Scene& scene, std::uint32_t p, Random& random) {
  if (!scene.is_triangle(p)) {
    const glm::dvec3 normal = random.direction();
    const double radius = scene.sphere(p).radius;
    return {glm::dvec3(scene.sphere(p).center) + radius * normal, normal, radius};
  }
  const auto v = scene.corners(p);
  double a = random.uniform(), b = random.uniform();
  if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
  const glm::dvec3 e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]), e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
  return {glm::dvec3(v[0]) + a * e1 + b * e2, glm::normalize(glm::cross(e1, e2)), glm::length(e1)};
}

/// A ray at a point, from near and far, straight on and at grazing angles, with directions of any length.
Ray ray_at(const Target& target, Random& random) {
  // The angle to the surface: half of the rays anywhere, half within 10^-4 to 1 of grazing.
  glm::dvec3 direction = random.direction();
  if (random.below(2) == 0) {
    const double rise = std::pow(10.0, random.uniform(-4.0, 0.0));
    direction = glm::normalize(glm::normalize(glm::cross(target.normal, direction)) + rise * target.normal);
  }
  if (glm::dot(direction, target.normal) > 0.0) direction = -direction;
  const double distance = target.size * std::pow(10.0, random.uniform(-1.0, 4.0)),
               length = std::pow(2.0, random.uniform(-20.0, 20.0));
  return {glm::vec3(target.point - distance * direction), glm::vec3(length * direction)};
}

/// A ray at a random point of a random primitive.
Ray aimed_ray(const Scene& scene, std::uint64_t index) {
  Random random(2, name_hash(scene.name), index);
  return ray_at(target_on(scene, random.below(scene.primitive_count()), random), random);
}

constexpr std::uint32_t kInstances = 400, kParts = 16, kInPart = 24;

/// Sixteen parts of triangles or spheres, each in about the unit ball.
void add_parts(Scene& scene) {
  scene.materials.emplace_back();
  for (std::uint32_t p = 0; p < kParts; ++p) {
    Random random(1, name_hash("bounds_test parts"), p);
    Part part{"part " + std::to_string(p), static_cast<std::uint32_t>(scene.triangles.size()), 0,
              static_cast<std::uint32_t>(scene.spheres.size()), 0};
    for (std::uint32_t i = 0; i < kInPart; ++i) {
      const glm::dvec3 center = random.direction() * std::cbrt(random.uniform());
      const double size = std::pow(10.0, random.uniform(-2.0, 0.0));
      if (p % 2 == 0) {
        scene.spheres.push_back({glm::vec3(center), static_cast<float>(0.3 * size), 0});
        ++part.sphere_count;
        continue;
      }
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      const glm::dvec3 a = random.direction(), b = random.direction();
      for (const glm::dvec3& corner : {center, center + size * a, center + size * b})
        scene.positions.emplace_back(corner);
      scene.triangles.push_back({{first, first + 1, first + 2}});
      ++part.triangle_count;
    }
    scene.parts.push_back(part);
  }
}

/// Instances at the ends of chains of one to four nodes: rotations, shears, mirrors, scales from 10^-3 to 10^3 that
/// take each other back, and translations of up to 10^3 scene sizes that the next node takes back.
Scene random_instances() {
  Scene scene;
  scene.name = "random_instances";
  add_parts(scene);
  for (std::uint32_t i = 0; i < kInstances; ++i) {
    Random random(1, name_hash("bounds_test chains"), i);
    const std::uint32_t depth = 1 + random.below(4);
    const glm::dvec3 place = 100.0 * random.direction() * std::cbrt(random.uniform());
    TransformD so_far;
    std::uint32_t parent = kNone;
    for (std::uint32_t level = 0; level < depth; ++level) {
      const bool last = level + 1 == depth;
      glm::dmat3 linear = glm::mat3_cast(glm::angleAxis(random.uniform(0.0, 6.0), random.direction()));
      if (random.below(2)) linear[0] += random.uniform(-1.0, 1.0) * linear[1];
      if (random.below(3) == 0) linear[2] = -linear[2];
      if (random.below(3) == 0)
        for (int c = 0; c < 3; ++c) linear[c] *= std::pow(10.0, random.uniform(-1.0, 1.0));
      linear *= std::pow(10.0, last ? random.uniform(-1.0, 1.0) : random.uniform(-3.0, 3.0)) /
                std::cbrt(std::abs(glm::determinant(so_far.linear)));
      // The last node brings the part to its place, wherever the others have led.
      const glm::dvec3 somewhere =
          random.below(4) == 0 ? std::pow(10.0, random.uniform(0.0, 5.0)) * random.direction() : place;
      const glm::dvec3 translation = transform_point(inverse(so_far), last ? place : somewhere);
      Node node;
      node.name = "node " + std::to_string(scene.nodes.size());
      node.parent = parent;
      node.part = last ? i % kParts : kNone;
      node.transform = node.rest = {glm::mat3(linear), glm::vec3(translation)};
      so_far = compose(so_far, to_double(node.transform));
      parent = static_cast<std::uint32_t>(scene.nodes.size());
      scene.nodes.push_back(node);
    }
  }
  return scene;
}

/// A ray at a random point of a random primitive of a random instance.
Ray aimed_at_instance(const Scene& scene, std::uint64_t index) {
  static const std::vector<std::uint32_t> instances = instances_of(random_instances());
  Random random(3, name_hash(scene.name), index);
  const std::uint32_t instance = instances[random.below(static_cast<std::uint32_t>(instances.size()))];
  const Part& part = scene.parts[scene.nodes[instance].part];
  const std::uint32_t p = part.triangle_count ? part.first_triangle + random.below(part.triangle_count)
                                              : static_cast<std::uint32_t>(scene.triangles.size()) + part.first_sphere +
                                                    random.below(part.sphere_count);
  Target target = target_on(scene, p, random);
  const TransformD place = to_world(scene, instance);
  target.point = transform_point(place, target.point);
  target.normal = glm::normalize(target.normal * inverse(place).linear);
  target.size *= std::cbrt(std::abs(glm::determinant(place.linear)));
  return ray_at(target, random);
}

/// How errors stand against their bounds, over many hits.
struct Outcome {
  std::uint64_t hits = 0;     ///< with exact values to compare with
  std::uint64_t outside = 0;  ///< hits with a value outside its bound
  std::uint64_t above = 0;    ///< hits with a value of least_value_bounds above that of value_bounds
  double worst = 0.0;         ///< largest error over its bound
  double median = 0.0, typical = 0.0, caught = 0.0;  ///< what the two lists come to
  std::vector<double> ratios;                        ///< a sample: the error of t over its bound
  std::vector<double> sizes;                         ///< the same sample: the bound of t over the distance
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

/// The hit on a primitive of an instance in plain double: as much finer than the bounds as double is finer than float,
/// and a hundred times faster than exact_hit. `kind` is hit where the line meets the primitive and t is valid.
ReferenceHit double_hit(const Stage& stage, const PlacedRay& ray, std::uint32_t primitive) {
  ReferenceHit hit;
  hit.primitive = primitive, hit.instance = ray.instance;
  const TransformD place =
      ray.instance == kNone ? TransformD{} : stage.judge.bounds.spaces.instances[ray.instance].to_world;
  const glm::dvec3& d = ray.direction;
  double from_origin = 0.0;
  glm::dvec3 normal;
  bool met = false;
  if (stage.scene.is_triangle(primitive)) {
    const auto v = stage.scene.corners(primitive);
    const glm::dvec3 e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]), e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
    const glm::dvec3 across = glm::cross(d, e2), to = ray.origin - glm::dvec3(v[0]), turned = glm::cross(to, e1);
    const double det = glm::dot(e1, across);
    hit.barycentrics = {glm::dot(to, across) / det, glm::dot(d, turned) / det};
    from_origin = glm::dot(e2, turned) / det;
    met = hit.barycentrics.x >= 0.0 && hit.barycentrics.y >= 0.0 && hit.barycentrics.x + hit.barycentrics.y <= 1.0;
    normal = glm::cross(e1, e2);
  } else {
    const Sphere& sphere = stage.scene.sphere(primitive);
    const glm::dvec3 m = glm::dvec3(sphere.center) - ray.origin, n = d / ray.length;
    const double foot = glm::dot(m, n), r = sphere.radius;
    const glm::dvec3 f = m - foot * n;
    const double rest = r * r - glm::dot(f, f), half = std::sqrt(std::max(rest, 0.0));
    met = rest >= 0.0;
    from_origin = (ray.t_origin * ray.length + foot - half > 0.0 ? foot - half : foot + half) / ray.length;
    normal = from_origin * d - m;
  }
  hit.t = ray.t_origin + from_origin;
  hit.position = transform_point(place, ray.origin + from_origin * d);
  hit.normal = glm::normalize(normal * inverse(place).linear);
  if (met && hit.t > 0.0) hit.kind = HitKind::hit;
  return hit;
}

/// Whether the tracer may have taken a sphere's other root: one of the two lies within rounding of the origin.
bool roots_are_open(const Scene& scene, const PlacedRay& ray, std::uint32_t primitive, double t, double bound) {
  if (scene.is_triangle(primitive)) return false;
  const glm::dvec3 m = glm::dvec3(scene.sphere(primitive).center) - ray.origin;
  const double foot = ray.t_origin + glm::dot(m, ray.direction) / (ray.length * ray.length);
  return std::min(std::abs(t), std::abs(2.0 * foot - t)) <= bound;
}

/// The largest of the errors of a hit over their bounds; infinite for what is no number.
double error_ratio(const ValueBounds& b, const Hit& hit, const ReferenceHit& truth) {
  const glm::dvec2 dw = glm::abs(glm::dvec2(hit.barycentrics) - truth.barycentrics);
  const double weights = std::max(dw.x, dw.y);
  const bool numbers =
      std::isfinite(hit.t) && glm::length(hit.position) < 1e30f && glm::length(hit.normal) < 2.0f && dw.x + dw.y < 4.0;
  if (!numbers) return INFINITY;
  return std::max({std::abs(hit.t - truth.t) / b.t, glm::length(glm::dvec3(hit.position) - truth.position) / b.position,
                   glm::length(glm::dvec3(hit.normal) - truth.normal) / b.normal,
                   b.barycentrics > 0.0 ? weights / b.barycentrics : weights * 1e30});
}

/// Adds one hit to the outcome. Hits are held against double_hit, and against exact_hit where they come near their
/// bounds, and a sample of them.
void examine_hit(const Stage& stage, const Judge& judge, const Ray& ray, const Hit& hit, bool sample, Outcome& o) {
  const PlacedRay placed = place_ray(judge.bounds, ray, hit.instance, left_by(judge, hit));
  const auto bounds_at = [&](double t) { return value_bounds(judge.bounds, placed, hit.primitive, t); };
  ReferenceHit truth = double_hit(stage, placed, hit.primitive);
  if (sample || !(error_ratio(bounds_at(truth.t), hit, truth) <= 0.5))
    truth = exact_hit(stage.scene, ray, hit.instance, hit.primitive);
  if (truth.kind != HitKind::hit) return;  // grazing: judged by its margin, not by its values
  const ValueBounds b = bounds_at(truth.t);
  if (roots_are_open(stage.scene, placed, hit.primitive, truth.t, b.t)) return;
  const ValueBounds least = least_value_bounds(judge.bounds, placed, hit.primitive, truth.t);
  o.above += !(least.t <= b.t && least.position <= b.position && least.normal <= b.normal &&
               least.barycentrics <= b.barycentrics);
  const double ratio = error_ratio(b, hit, truth);
  ++o.hits;
  o.outside += !(ratio <= 1.0);
  o.worst = std::max(o.worst, ratio);
  if (!sample) return;
  o.ratios.push_back(std::abs(hit.t - truth.t) / b.t);
  o.sizes.push_back(b.t / distance_scale(stage.judge.bounds, ray, truth.t));
}

Outcome examine(const Scene& scene, std::size_t count, TransformOut out, Ray (*aim)(const Scene&, std::uint64_t)) {
  Session session;
  const Stage& stage = session.stage(scene.name, scene);
  const Judge judge = stage.judge_of(out);
  Probe& probe = session.probe(stage, out);
  std::vector<Ray> rays(kBatch);
  std::vector<Hit> hits(kBatch);
  Outcome total;
  for (std::size_t first = 0; total.hits < count; first += kBatch) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kBatch), [&](const auto& r) {
      for (std::size_t i = r.begin(); i != r.end(); ++i) rays[i] = aim(stage.scene, first + i);
    });
    probe.trace(rays, hits);
    const Outcome batch = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, kBatch), Outcome{},
        [&](const auto& r, Outcome o) {
          for (std::size_t i = r.begin(); i != r.end(); ++i) {
            if (hits[i].kind == HitKind::hit) examine_hit(stage, judge, rays[i], hits[i], i % 64 == 0, o);
          }
          return o;
        },
        [](Outcome a, const Outcome& b) { return combine(std::move(a), b); });
    total = combine(std::move(total), batch);
  }
  return total;
}

/// Prints how the bounds stand and checks that none is broken.
Outcome check_bounds(const Scene& scene, std::size_t count, TransformOut out, Ray (*aim)(const Scene&, std::uint64_t)) {
  Outcome o = examine(scene, count, out, aim);
  std::sort(o.ratios.begin(), o.ratios.end());
  std::sort(o.sizes.begin(), o.sizes.end());
  o.median = o.ratios[o.ratios.size() / 2], o.typical = o.sizes[o.sizes.size() / 2];
  o.caught = static_cast<double>(std::lower_bound(o.sizes.begin(), o.sizes.end(), 64.0 * o.typical) - o.sizes.begin()) /
             static_cast<double>(o.sizes.size());
  WARN(scene.name << ", " << name_of(out) << ": " << o.hits << " hits, largest error " << o.worst
                  << " of its bound; t: median error " << o.median << " of its bound, typical bound "
                  << o.typical / 0x1p-24
                  << " * 2^-24 of the distance, an error of 64 times that is outside the bound of " << 100.0 * o.caught
                  << " % of the hits");
  CHECK(o.hits >= count);
  CHECK(o.outside == 0);
  CHECK(o.above == 0);
  return o;
}

/// Not slack: the worst of so many hits comes near its bound; and an error of 64 times the typical bound is seen on
/// nearly all hits, half of them grazing.
void check_not_slack(const Outcome& o) {
  CHECK(o.worst > 1.0 / 16.0);
  CHECK(o.typical < 256.0 * 0x1p-24);
  CHECK(o.caught > 0.8);
}

}  // namespace

TEST_CASE("Bounds hold on millions of hits of triangles, and a gross error is outside them") {
  check_not_slack(check_bounds(random_triangles(), kHits / 2, TransformOut::restore, aimed_ray));
}

TEST_CASE("Bounds hold on millions of hits of spheres, and a gross error is outside them") {
  check_not_slack(check_bounds(random_spheres(), kHits / 2, TransformOut::restore, aimed_ray));
}

TEST_CASE("Bounds hold through chains of shears, mirrors, scales and far translations") {
  const Outcome restored = check_bounds(random_instances(), kInstanceHits, TransformOut::restore, aimed_at_instance);
  CHECK(restored.worst > 1.0 / 16.0);
  CHECK(restored.caught > 0.8);
  // Leaving by inverses, these chains wear a ray away: its bounds hold, but tell little.
  check_bounds(random_instances(), kInstanceHits / 10, TransformOut::inverse, aimed_at_instance);
}
