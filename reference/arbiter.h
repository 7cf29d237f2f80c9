// SPDX-License-Identifier: GPL-3.0-or-later
// Who is right: the arbiter takes a ray's floats as exact numbers and decides with exact arithmetic what it hits. It
// knows nothing of either tracer. Its exact numbers are CGAL's, see exact.h.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "reference/instance_map.h"
#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// A primitive where an instance shows it: what a ray hits. In order: the world first, then by instance, then by
/// number.
struct Placed {
  std::uint32_t instance = kNone;  ///< kNone in world space
  std::uint32_t primitive = kNone;
  friend bool operator==(const Placed&, const Placed&) = default;
  friend bool operator<(const Placed& a, const Placed& b) {
    // kNone + 1 is 0.
    return a.instance != b.instance ? a.instance + 1 < b.instance + 1 : a.primitive < b.primitive;
  }
};

/// One primitive that the ray's line meets, or passes within `reach` of. Lengths and distances are in the primitive's
/// own space: the instance's, or the world. t is the ray's in every space.
struct Crossing {
  std::uint32_t primitive = kNone;
  std::uint32_t instance = kNone;  ///< that shows it; kNone in world space
  /// Exact: the line meets the closed primitive in a point (SEMANTICS 2), and 0 < t <= t_max for that point.
  bool hit = false;
  /// Exact: the line meets the primitive, whatever t is.
  bool on_line = false;
  /// Exact: no other crossing that is a hit has a smaller t. Several may be nearest: a tie.
  bool nearest = false;
  /// Where on_line, t of the meeting to within one unit in the last place; of a sphere the nearest valid root, or where
  /// none is valid the one nearest to being so. Where the line passes by or lies in the plane, t of its closest
  /// approach to the triangle's edges or to the sphere's centre, in plain double.
  double t = 0.0;
  /// Where on_line, the two roots on a sphere, as t is, or t and t on a triangle. Elsewhere the first and the last t
  /// abreast of the primitive, in plain double.
  double t_enter = 0.0, t_leave = 0.0;
  /// How far the line passes inside (positive) or outside (negative) of the primitive's outline as seen along the ray,
  /// perpendicular to the ray in the primitive's own space and units: of a triangle the distance to the nearest edge,
  /// of a sphere radius minus the distance to the centre. Zero exactly where the line meets an edge, a corner, or is
  /// tangent; its sign is exact, its magnitude good to a relative 2^-18. In a triangle's plane it is zero or negative.
  double margin = 0.0;
  /// sign of direction . normal in the primitive's own space, exact: -1 meets the front of the triangle, +1 its back, 0
  /// is parallel to its plane. 0 for spheres and triangles without area. A mirror changes nothing: the world's normal
  /// is the part's, by the inverse transpose.
  int facing = 0;
  /// Bits 0 to 2: the line passes within `reach` of the triangle's edge (corner i, corner i+1).
  std::uint8_t near_edges = 0;
  bool in_plane = false;  ///< exact: the ray lies in the triangle's plane, or the triangle has no area
};

/// How far beside a ray primitives are of interest, perpendicular to it, >= 0.
struct Reach {
  /// For the primitives of the world, in world units; and for instances: one whose box lies farther from the ray is not
  /// looked into.
  double world = 0.0;
  /// For the primitives of an instance, in its own units; asked only of instances whose box the ray comes near. Absent:
  /// 0. Called by the thread that asks for crossings.
  std::function<double(std::uint32_t instance)> local;
};

class Arbiter {
 public:
  explicit Arbiter(const Scene& scene);
  ~Arbiter();
  Arbiter(Arbiter&&) noexcept;
  Arbiter& operator=(Arbiter&&) noexcept;

  /// Everything that the line of a defined ray meets in a point with t in (-slack, t_max + slack], or passes within
  /// `reach` of while abreast of it there. slack is `t_slack`, in units of t, >= 0. First what the line meets, by exact
  /// t, the world before instances, then by instance and by number; then what it passes by, by t. Thread-safe.
  std::vector<Crossing> crossings(const Ray& ray, const Reach& reach, double t_slack) const;
  /// The same reach for the whole world. Where the scene has instances it must be 0.
  std::vector<Crossing> crossings(const Ray& ray, double reach, double t_slack) const;

  /// The exact answer alone: all nearest primitives (empty: a miss), in ascending order. The ray is defined.
  /// Thread-safe.
  std::vector<Placed> nearest(const Ray& ray) const;

  /// The way to and from an instance's space: of a node that holds a part.
  const InstanceMap& map_of(std::uint32_t instance) const;

  /// How many decisions since construction floating point left open, so that exact arithmetic took them.
  std::uint64_t exact_decisions() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
