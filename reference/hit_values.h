// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a hit in plain double precision, once it is known which primitive was hit.
#pragma once

#include <array>

#include "reference/line.h"

namespace plumbline {

/// The roots of a sphere on a line, in units and from the start of `line.direction` (s, not t); met is false where the
/// line passes by, and both roots are then its closest approach.
struct SphereRoots {
  bool met = false;
  double enter = 0.0, leave = 0.0;
};
SphereRoots sphere_roots(const Line& line, const glm::dvec3& center, double radius);

/// The root that a ray hits: the first with 0 < t <= t_max; where neither is valid, the one nearest to being so.
double nearest_root(const Line& line, const SphereRoots& roots);

/// Values of the hit on a triangle (corners in the line's space, as are position and normal). Where rounding puts the
/// point outside the triangle or the segment, weights are clamped to [0, 1] and t to (0, t_max]; where the ray lies in
/// the triangle's plane, t is `fallback_s` (as of Line). `primitive` is left for the caller.
ReferenceHit triangle_values(const Line& line, const std::array<glm::dvec3, 3>& corners, double fallback_s);

/// Values of the hit on a sphere, by nearest_root. `primitive` is left for the caller.
ReferenceHit sphere_values(const Line& line, const glm::dvec3& center, double radius);

}  // namespace plumbline
