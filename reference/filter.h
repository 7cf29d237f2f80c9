// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions about one line and one primitive: by floating point where its error bound leaves no doubt, else by exact
// arithmetic.
#pragma once

#include <array>
#include <cstdint>

#include "reference/bounded.h"
#include "reference/exact.h"

namespace plumbline {

/// t in units of Line::direction, counted from the ray's origin (as Line::t_max is), with its error bound.
using BoundedT = Bounded<long double>;

/// How the line passes a triangle, exact.
struct TrianglePass {
  bool meets = false;   ///< in one point of the closed triangle
  bool beside = false;  ///< the edges are passed on two different sides: the line misses
  // Neither: every edge's own line is met, so the line lies in the triangle's plane, or the triangle has no area.
};

/// A line and the number of decisions that had to be exact. One per query; not shared between threads.
class Filter {
 public:
  explicit Filter(const Line& line) : line_(line) {}

  const Line& line() const { return line_; }
  std::uint64_t exact_decisions() const { return exact_decisions_; }

  TrianglePass pass_triangle(const Solid& triangle);
  int facing(const Solid& triangle);
  bool in_plane(const Solid& triangle);
  /// The sign of radius minus distance.
  int sphere_side(const Solid& sphere);

  /// Distances from the whole line to a relative 2^-18; zero exactly where they are zero.
  double segment_distance(const glm::vec3& from, const glm::vec3& to);
  double sphere_distance(const Solid& sphere);

  /// Where the line meets the primitive, which it must (for a triangle: its plane): s counts from the line's point, t
  /// from the ray's origin.
  BoundedT s_of(const Solid& solid, Root root) const;
  BoundedT t_of(const Solid& solid, Root root) const { return BoundedT(line_.shift) + s_of(solid, root); }
  /// The sign of t - limit; limit may be infinite.
  int compare_t(const Solid& solid, Root root, const BoundedT& t, double limit);
  /// The sign of one's t minus the other's.
  int compare_t(const Solid& a, Root root_a, const BoundedT& t_a, const Solid& b, Root root_b, const BoundedT& t_b);
  /// t of the ray to within one unit in the last place.
  double ray_t(const Solid& solid, Root root, const BoundedT& t);

 private:
  const Line& line_;
  std::uint64_t exact_decisions_ = 0;
};

}  // namespace plumbline
