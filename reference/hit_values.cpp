// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms for the line through a triangle and a sphere, in double precision.
#include "reference/hit_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumbline {

namespace {

/// A valid t nearest to `t`: SEMANTICS has 0 < t <= t_max.
double clamped_t(const Line& line, double t) {
  const double last = line.t_max * line.unit;
  return std::min(std::max(t, std::numeric_limits<double>::denorm_min()), last);
}

}  // namespace

SphereRoots sphere_roots(const Line& line, const glm::dvec3& center, double radius) {
  const glm::dvec3 m = (center - line.point) - line.rest;
  const glm::dvec3& d = line.direction;
  const double dd = glm::dot(d, d), middle = glm::dot(m, d) / dd;
  // The distance to the centre from the perpendicular, not from |m|^2 - (m.d)^2: nothing large cancels.
  const glm::dvec3 perpendicular = m - middle * d;
  const double distance = glm::length(perpendicular);
  const double discriminant = (radius - distance) * (radius + distance) / dd;
  if (!(discriminant >= 0.0)) return {false, middle, middle};
  const double half = std::sqrt(discriminant);
  return {true, middle - half, middle + half};
}

double nearest_root(const Line& line, const SphereRoots& roots) {
  return line.shift + roots.enter > 0.0 ? roots.enter : roots.leave;
}

ReferenceHit triangle_values(const Line& line, const std::array<glm::dvec3, 3>& corners, double fallback_s) {
  const glm::dvec3& d = line.direction;
  const auto& [v0, v1, v2] = corners;
  const glm::dvec3 a0 = (v0 - line.point) - line.rest, a1 = (v1 - line.point) - line.rest,
                   a2 = (v2 - line.point) - line.rest;
  const glm::dvec3 e0 = v1 - v0, e1 = v2 - v1, e2 = v0 - v2;
  const glm::dvec3 n = glm::cross(e0, e1);
  // Weights by the edges' moments about the line: edge i lies opposite to corner i + 2.
  const double w0 = glm::dot(e1, glm::cross(d, a1)), w1 = glm::dot(e2, glm::cross(d, a2)),
               w2 = glm::dot(e0, glm::cross(d, a0));
  const double determinant = glm::dot(n, d), sum = w0 + w1 + w2;
  ReferenceHit hit;
  hit.kind = HitKind::hit;
  hit.normal = n / glm::length(n);
  const double s = determinant != 0.0 ? glm::dot(n, a0) / determinant : fallback_s;
  hit.t = clamped_t(line, line.ray_t(s));
  hit.position = line.point + (line.rest + s * d);
  if (sum != 0.0) {
    hit.barycentrics.x = std::clamp(w1 / sum, 0.0, 1.0);
    hit.barycentrics.y = std::clamp(w2 / sum, 0.0, 1.0 - hit.barycentrics.x);
  }
  return hit;
}

ReferenceHit sphere_values(const Line& line, const glm::dvec3& center, double radius) {
  const double s = nearest_root(line, sphere_roots(line, center, radius));
  ReferenceHit hit;
  hit.kind = HitKind::hit;
  hit.t = clamped_t(line, line.ray_t(s));
  // The normal from differences to the centre, so that it does not suffer from the centre's coordinates.
  const glm::dvec3 outwards = ((line.point - center) + line.rest) + s * line.direction;
  hit.position = line.point + (line.rest + s * line.direction);
  hit.normal = outwards / glm::length(outwards);
  return hit;
}

}  // namespace plumbline
