// SPDX-License-Identifier: GPL-3.0-or-later
// Exact arithmetic on the floats of a ray and of primitives, as functions of plain numbers: signs are right whatever
// the input. The only file that names CGAL is exact.cpp.
#pragma once

#include <array>

#include "reference/line.h"

namespace plumbline {

/// A primitive's floats, apart from its scene.
struct Solid {
  bool is_sphere = false;
  std::array<glm::vec3, 3> corners{};  ///< of a triangle; corners[0] is a sphere's centre
  float radius = 0.0f;                 ///< of a sphere
};

Solid solid_of(const Scene& scene, std::uint32_t primitive);

/// Which of the points where the line meets a sphere. Both are the same on a triangle.
enum class Root { enter, leave };

/// The sign of edge_moment (formulas.h): on which side the line passes the segment; 0 where it meets the segment's own
/// line.
int exact_edge_sign(const Line& line, const glm::vec3& from, const glm::vec3& to);

/// The sign of direction . normal; 0 where the line is parallel to the triangle's plane, or the triangle has no area.
int exact_facing(const Line& line, const Solid& triangle);

/// Whether the line lies in the triangle's plane, or the triangle has no area.
bool exact_in_plane(const Line& line, const Solid& triangle);

/// The sign of (radius - distance of the line from the centre).
int exact_sphere_side(const Line& line, const Solid& sphere);

/// Distances in space from the whole line, to within a few units in the last place; zero exactly where they are zero.
/// The sphere's is that of the line from its surface, |radius - distance from the centre|.
double exact_segment_distance(const Line& line, const glm::vec3& from, const glm::vec3& to);
double exact_sphere_distance(const Line& line, const Solid& sphere);

/// The sign of t - limit, where t and limit are in units of `line.direction` and counted from the ray's origin (as
/// `line.t_max` is). The line must meet the sphere, or cross the triangle's plane.
int exact_compare_t(const Line& line, const Solid& solid, Root root, double limit);

/// The sign of t of the one minus t of the other.
int exact_compare_t(const Line& line, const Solid& a, Root root_a, const Solid& b, Root root_b);

/// t of the ray, rounded once.
double exact_t(const Line& line, const Solid& solid, Root root);

/// All values, each rounded once (lengths of normals to 2^-128 before). kind is `hit`; `primitive` is left for the
/// caller.
ReferenceHit exact_values_at(const Line& line, const Solid& solid, Root root);

}  // namespace plumbline
