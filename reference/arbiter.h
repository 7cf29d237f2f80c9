// SPDX-License-Identifier: GPL-3.0-or-later
// Who is right: the arbiter takes a ray's floats as exact numbers and decides with exact arithmetic what it hits. It
// knows nothing of either tracer. The only file that names CGAL is arbiter.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// One primitive that the ray's line meets, or passes within `reach` of.
struct Crossing {
  std::uint32_t primitive = kNone;
  /// Exact: the line meets the closed primitive in a point (SEMANTICS 2), and 0 < t <= t_max for that point.
  bool hit = false;
  /// Exact: the line meets the primitive, whatever t is.
  bool on_line = false;
  /// Exact: no other crossing that is a hit has a smaller t. Several may be nearest: a tie.
  bool nearest = false;
  /// t of the meeting (of the nearest valid root on a sphere); where the line passes by, of the line's closest approach
  /// to the primitive. Rounded once to double from the exact value.
  double t = 0.0;
  /// The two roots on a sphere (equal to t, t on a triangle), rounded once. Only meaningful where on_line.
  double t_enter = 0.0, t_leave = 0.0;
  /// How far the line passes inside (positive) or outside (negative) of the primitive's outline as seen along the ray,
  /// in world units perpendicular to the ray: of a triangle the distance to the nearest edge, of a sphere radius minus
  /// the distance to the centre. Zero exactly where the line meets an edge, a corner, or is tangent.
  double margin = 0.0;
  /// sign of direction . normal, exact: -1 meets the front of the triangle, +1 its back, 0 lies in its plane. 0 for
  /// spheres.
  int facing = 0;
  /// Bits 0 to 2: the line passes within `reach` of the triangle's edge (corner i, corner i+1).
  std::uint8_t near_edges = 0;
  bool in_plane = false;  ///< exact: the ray lies in the triangle's plane, or the triangle has no area
};

class Arbiter {
 public:
  explicit Arbiter(const Scene& scene);
  ~Arbiter();
  Arbiter(Arbiter&&) noexcept;
  Arbiter& operator=(Arbiter&&) noexcept;

  /// Everything that the line of a defined ray meets or passes within `reach` (world units, perpendicular to the ray,
  /// >= 0) of, with t in (-slack, t_max + slack] where slack is `t_slack` (units of t, >= 0), ordered by exact t where
  /// on_line. Thread-safe.
  std::vector<Crossing> crossings(const Ray& ray, double reach, double t_slack) const;

  /// The exact answer alone: all nearest primitives (empty: a miss), in ascending order. Thread-safe.
  std::vector<std::uint32_t> nearest(const Ray& ray) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
