// SPDX-License-Identifier: GPL-3.0-or-later
// Values from extended precision with running error bounds, from exact arithmetic where these bounds are too wide.
#include "reference/exact_values.h"

#include <algorithm>
#include <cmath>

#include "reference/filter.h"
#include "reference/formulas.h"
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

/// Fills `hit` where the bounds are good enough everywhere.
bool bounded_values(const Filter& filter, const Solid& solid, Root root, ReferenceHit& hit) {
  const Line& line = filter.line();
  const BoundedT s = filter.s_of(solid, root), t = BoundedT(line.shift) + s;
  const auto d = vec<BoundedT>(line.direction);
  const auto position = vec<BoundedT>(line.point) + (vec<BoundedT>(line.rest) + d * s);
  if (!(t.error <= 0x1p-54L * std::fabs(t.value)) || !good(position)) return false;
  hit.t = static_cast<double>(t.value) * line.unit;
  hit.position = rounded(position);
  Vec<BoundedT> normal;
  if (solid.is_sphere) {
    normal = d * s - from_line<BoundedT>(line, solid.corners[0]);
  } else {
    const auto& [v0, v1, v2] = solid.corners;
    const auto terms = plane_terms<BoundedT>(line, solid.corners);
    const BoundedT u = edge_moment<BoundedT>(line, v2, v0) / terms.determinant;
    const BoundedT v = edge_moment<BoundedT>(line, v0, v1) / terms.determinant;
    if (!(u.error <= 0x1p-54L && v.error <= 0x1p-54L)) return false;
    hit.barycentrics = {static_cast<double>(u.value), static_cast<double>(v.value)};
    normal = terms.normal;
  }
  const BoundedT length = sqrt(dot(normal, normal));
  const Vec<BoundedT> unit{normal.x / length, normal.y / length, normal.z / length};
  hit.normal = rounded(unit);
  return good(unit);
}

}  // namespace

ReferenceHit exact_hit(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  PLUMBLINE_ASSERT(primitive < scene.primitive_count());
  ReferenceHit hit;
  hit.primitive = primitive;
  if (!is_defined(ray)) {
    hit.kind = HitKind::undefined;
    return hit;
  }
  const Solid solid = solid_of(scene, primitive);
  // A ball around this primitive alone: the closer the line's point, the less cancels.
  const glm::dvec3 center(solid.corners[0]);
  const double radius = solid.is_sphere ? static_cast<double>(solid.radius)
                                        : std::max(glm::length(glm::dvec3(solid.corners[1]) - center),
                                                   glm::length(glm::dvec3(solid.corners[2]) - center));
  const Line line = line_near(ray, {center, radius});
  Filter filter(line);
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
  met = met && filter.compare_t(solid, root, t, 0.0) > 0 && filter.compare_t(solid, root, t, line.t_max) <= 0;
  if (!bounded_values(filter, solid, root, hit)) hit = exact_values_at(line, solid, root);
  hit.primitive = primitive;
  hit.kind = met ? HitKind::hit : HitKind::miss;
  return hit;
}

}  // namespace plumbline
