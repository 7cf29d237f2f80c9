// SPDX-License-Identifier: GPL-3.0-or-later
// Values from extended precision with running error bounds, from exact arithmetic where these bounds are too wide.
#include "reference/exact_values.h"

#include <algorithm>
#include <cmath>

#include "reference/filter.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

/// Every component known to 2^-54 of the largest; the rounding to double takes the other half.
bool good(const Vec<BoundedT>& v) {
  const long double scale = std::max({std::fabs(v.x.value), std::fabs(v.y.value), std::fabs(v.z.value)});
  return std::max({v.x.error, v.y.error, v.z.error}) <= 0x1p-54L * scale;
}

glm::dvec3 rounded(const Vec<BoundedT>& v) {
  return {static_cast<double>(v.x.value), static_cast<double>(v.y.value), static_cast<double>(v.z.value)};
}

Vec<BoundedT> unit(const Vec<BoundedT>& v) {
  const BoundedT length = sqrt(dot(v, v));
  return {v.x / length, v.y / length, v.z / length};
}

/// Fills `hit` where the bounds are good enough everywhere. `line` is the filter's; `map` is null in the world.
template <class L>
bool bounded_values(const Filter& filter, const L& line, const Line& world, const InstanceMap* map, const Solid& solid,
                    Root root, ReferenceHit& hit) {
  const BoundedT s = filter.s_of(solid, root), t = filter.t_of(s);
  if (!std::isfinite(t.value) || !(t.error <= 0x1p-54L * std::fabs(t.value))) return false;
  // t is the same in the world. The shifts are long and have few bits: their difference loses next to nothing.
  const long double ratio = static_cast<long double>(filter.line().unit) / world.unit;
  const BoundedT s_world =
      map == nullptr ? s : (scaled(BoundedT(filter.line().shift), ratio) - BoundedT(world.shift)) + scaled(s, ratio);
  const auto d = vec<BoundedT>(world.direction);
  const auto position = vec<BoundedT>(world.point) + (vec<BoundedT>(world.rest) + d * s_world);
  if (!good(position)) return false;
  hit.t = static_cast<double>(t.value);
  hit.position = rounded(position);
  Vec<BoundedT> normal;
  if (solid.is_sphere) {
    normal = line.heading() * s - line.see(solid.corners[0]);
  } else {
    const auto& [v0, v1, v2] = solid.corners;
    const auto terms = plane_terms(line, solid.corners);
    const BoundedT u = edge_moment(line, v2, v0) / terms.determinant;
    const BoundedT v = edge_moment(line, v0, v1) / terms.determinant;
    if (!(u.error <= 0x1p-54L && v.error <= 0x1p-54L)) return false;
    hit.barycentrics = {static_cast<double>(u.value), static_cast<double>(v.value)};
    normal = terms.normal;
  }
  if (map != nullptr) {
    const auto& [a, b, c] = map->inverse_rows;
    normal = a * normal.x + b * normal.y + c * normal.z;
  }
  const Vec<BoundedT> of_unit_length = unit(normal);
  hit.normal = rounded(of_unit_length);
  return good(of_unit_length);
}

/// A ball around a primitive alone: the closer the line's point, the less cancels.
Ball ball_around(const Solid& solid) {
  const glm::dvec3 center(solid.corners[0]);
  if (solid.is_sphere) return {center, static_cast<double>(solid.radius)};
  return {center, std::max(glm::length(glm::dvec3(solid.corners[1]) - center),
                           glm::length(glm::dvec3(solid.corners[2]) - center))};
}

/// The hit on a solid in the filter's space; its numbers are left for the caller.
ReferenceHit hit_on(Filter& filter, const Ray& ray, const Line& world, const InstanceMap* map, const Solid& solid) {
  ReferenceHit hit;
  Root root = Root::enter;
  bool met = true;
  if (solid.is_sphere) {
    if (filter.sphere_side(solid) < 0) return hit;
    const BoundedT enter = filter.t_of(solid, Root::enter);
    if (filter.compare_t(solid, Root::enter, enter, 0.0) <= 0) root = Root::leave;
  } else {
    if (filter.facing(solid) == 0) return hit;
    met = filter.pass_triangle(solid).meets;
  }
  const BoundedT t = filter.t_of(solid, root);
  met = met && filter.compare_t(solid, root, t, 0.0) > 0 && filter.compare_t(solid, root, t, ray.t_max) <= 0;
  const bool bounded =
      filter.with_wide([&](const auto& line) { return bounded_values(filter, line, world, map, solid, root, hit); });
  if (!bounded) hit = exact_values_at(filter.exact(), solid, root);
  hit.kind = met ? HitKind::hit : HitKind::miss;
  return hit;
}

ReferenceHit exact_hit(const Scene& scene, const Ray& ray, const InstanceMap* map, std::uint32_t primitive) {
  ReferenceHit hit;
  if (is_defined(ray)) {
    const Solid solid = solid_of(scene, primitive);
    const Ball ball = ball_around(solid);
    if (map == nullptr) {
      const Line line = line_near(ray, ball);
      Filter filter(line);
      hit = hit_on(filter, ray, line, nullptr, solid);
    } else {
      const auto& columns = map->to_world.linear;
      const double stretch = glm::length(columns[0]) + glm::length(columns[1]) + glm::length(columns[2]);
      const Line world = line_near(ray, {transform_point(map->to_world, ball.center), stretch * ball.radius});
      const LocalLine local = fine_local_line(ray, *map, ball);
      Filter filter(local, world, *map);
      hit = hit_on(filter, ray, world, map, solid);
    }
  } else {
    hit.kind = HitKind::undefined;
  }
  hit.primitive = primitive;
  hit.instance = map == nullptr ? kNone : map->instance;
  return hit;
}

}  // namespace

ReferenceHit exact_hit(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  return exact_hit(scene, ray, kNone, primitive);
}

ReferenceHit exact_hit(const Scene& scene, const Ray& ray, std::uint32_t instance, std::uint32_t primitive) {
  PLUMBLINE_ASSERT(scene.is_placed(instance, primitive));
  if (instance == kNone) return exact_hit(scene, ray, nullptr, primitive);
  const InstanceMap map = instance_map(scene, instance);
  return exact_hit(scene, ray, &map, primitive);
}

ReferenceHit exact_hit(const Scene& scene, const Ray& ray, const InstanceMap& map, std::uint32_t primitive) {
  return exact_hit(scene, ray, &map, primitive);
}

}  // namespace plumbline
