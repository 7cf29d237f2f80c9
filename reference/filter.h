// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions about one line and one primitive: by floating point where its error bound leaves no doubt, else by exact
// arithmetic.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "reference/bounded.h"
#include "reference/exact.h"
#include "reference/formulas.h"
#include "reference/instance_map.h"

namespace plumbline {

/// How the line passes a triangle, exact.
struct TrianglePass {
  bool meets = false;   ///< in one point of the closed triangle
  bool beside = false;  ///< the edges are passed on two different sides: the line misses
  // Neither: every edge's own line is met, so the line lies in the triangle's plane, or the triangle has no area.
};

/// A line in one space, with what is computed from it, and the number of decisions that had to be exact. One per query
/// and space; not shared between threads.
class Filter {
 public:
  /// In the world. The line must outlive the filter.
  explicit Filter(const Line& world) : line_(world), world_(world) { set_slacks(); }
  /// In the space of an instance. All three must outlive the filter.
  Filter(const LocalLine& local, const Line& world, const InstanceMap& map)
      : line_(local.line), world_(world), local_(&local), map_(&map) {
    set_slacks();
  }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  const Line& line() const { return line_; }
  /// Calls f with the line as numbers that carry bounds: of double precision, or of more bits. In the world their
  /// errors are zero, which the compiler is to know: hence two calls.
  template <class F>
  auto with_bounded(F&& f) const {
    return local_ == nullptr ? f(WorldLineOf<double>{line_}) : f(bounded_line<double>(line_));
  }
  template <class F>
  auto with_wide(F&& f) const {
    return local_ == nullptr ? f(WorldLineOf<long double>{line_}) : f(local_->wide);
  }
  /// The line in exact numbers, made when it is first asked for.
  const ExactLine& exact();
  std::uint64_t exact_decisions() const { return exact_decisions_; }

  TrianglePass pass_triangle(const Solid& triangle);
  int facing(const Solid& triangle);
  bool in_plane(const Solid& triangle);
  /// The sign of radius minus distance.
  int sphere_side(const Solid& sphere);

  /// Distances from the whole line to a relative 2^-18, in the filter's space; zero exactly where they are zero.
  double segment_distance(const glm::vec3& from, const glm::vec3& to);
  double sphere_distance(const Solid& sphere);

  /// Where the line meets the primitive, which it must (for a triangle: its plane): s counts from the line's point, t
  /// is the ray's.
  BoundedT s_of(const Solid& solid, Root root) const;
  BoundedT t_of(const BoundedT& s) const {
    return scaled(BoundedT(line_.shift) + s, static_cast<long double>(line_.unit));
  }
  BoundedT t_of(const Solid& solid, Root root) const { return t_of(s_of(solid, root)); }
  /// The sign of t - limit; limit may be infinite.
  int compare_t(const Solid& solid, Root root, const BoundedT& t, double limit);
  /// The sign of one's t minus the t of another, which is in the space of `filter_b`; both of the same ray.
  int compare_t(const Solid& a, Root root_a, const BoundedT& t_a, Filter& filter_b, const Solid& b, Root root_b,
                const BoundedT& t_b);
  /// t of the ray to within one unit in the last place.
  double ray_t(const Solid& solid, Root root, const BoundedT& t);

 private:
  void set_slacks();
  const ExactLine& decide_exactly() {
    ++exact_decisions_;
    return exact();
  }

  const Line& line_;
  const Line& world_;
  const LocalLine* local_ = nullptr;
  const InstanceMap* map_ = nullptr;
  double moment_slope_ = 0.0, moment_slack_ = 0.0;  ///< see pass_triangle
  std::optional<ExactLine> exact_;
  std::uint64_t exact_decisions_ = 0;
};

}  // namespace plumbline
