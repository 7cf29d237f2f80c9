// SPDX-License-Identifier: GPL-3.0-or-later
// The exact picture of one ray: what its line meets or passes close by, and whether an answer that is not the exact one
// can be had by rounding.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/bounds.h"
#include "harness/verdict.h"

namespace plumbline {

/// What somebody answered for a ray.
struct Answer {
  HitKind kind = HitKind::miss;
  std::uint32_t instance = kNone, primitive = kNone;
  double t = 0.0;  ///< tells which of a sphere's two roots is meant
  bool is(const Crossing& c) const {
    return kind == HitKind::hit && c.instance == instance && c.primitive == primitive;
  }
};
inline Answer answer_of(const Hit& hit) { return {hit.kind, hit.instance, hit.primitive, hit.t}; }
inline Answer answer_of(const ReferenceHit& hit) { return {hit.kind, hit.instance, hit.primitive, hit.t}; }
/// The same kind, and of a hit the same primitive of the same instance.
inline bool is_same(const Answer& a, const Answer& b) {
  return a.kind == b.kind && a.primitive == b.primitive && a.instance == b.instance;
}

/// A relaxation that explains an answer: `amount` of what 32 bits resolve (`bound`) was used.
struct Relaxation {
  double amount = 0.0, bound = 0.0;
  double ratio() const {
    return bound > 0.0 ? amount / bound : (amount > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
  }
};

/// The ray in the spaces that were asked for, each made once.
class PlacedRays {
 public:
  PlacedRays(const BoundsContext& context, const Ray& ray, std::uint32_t left, double blur)
      : context_(context), ray_(ray), left_(left), blur_(blur) {}
  PlacedRay in(std::uint32_t instance) const;

 private:
  const BoundsContext& context_;
  const Ray& ray_;
  std::uint32_t left_;
  double blur_;
  mutable std::vector<PlacedRay> placed_;
};

/// Built for one ray and asked from one thread.
class ExactView {
 public:
  /// `left`: how many transforms the tracer may have left by their inverses; `blur`: how far what it sees may stand
  /// from its place, world units (both bounds.h).
  ExactView(const Judge& judge, const Ray& ray, std::uint32_t left, double blur = 0.0);

  const std::vector<Crossing>& crossings() const { return crossings_; }
  const Crossing* find(const Answer& answer) const;
  bool is_exact(const Answer& answer) const;
  /// Whether `t` is a sphere's other root than the exact one, and not the exact one within its bound.
  bool is_other_root(const Crossing& c, double t) const;
  /// What 32 bits resolve of the values on this primitive, at the exact t.
  ValueBounds values(const Crossing& c) const;
  /// What 32 bits resolve across the ray, in units of the primitive's own space.
  double lateral(const Crossing& c) const;

  /// Whether 32-bit evaluation may have come to this answer although it is not the exact one; if so, the relaxation
  /// that used most of its bound.
  std::optional<Relaxation> explained(const Answer& answer) const;

  /// Whether the answer went through a closed surface: the triangle that it went through, or null. Every triangle that
  /// was skipped is near, that is met within what 32 bits resolve of its outline; rounding may take the ray past such
  /// triangles, but not through the surface:
  ///   - Triangles of one instance that are near and hang together by their corners form a patch. Past a patch that has
  ///     two facings (a silhouette) or belongs to no closed surface a ray may go; through a patch that faces one way it
  ///     may not, unless it is the patch that answered, or one in which the ray starts or ends, or that goes on behind
  ///     the answer.
  ///   - A ray that goes past a surface crosses it an even number of times. This is asked only where the number is
  ///     certain: not where a near triangle is seen exactly edge-on, nor where a crossing lies within rounding of the
  ///     ray's origin, of its end, or of the answer.
  const Crossing* leaked(const Answer& answer) const;

  /// What is wrong with the values of an answer that is not the exact one; empty if nothing is. On a primitive that the
  /// line meets all of them are known. Where it passes by, t is known to within the primitive's bound, the normal of a
  /// triangle too, and weights lie in [0, 1].
  std::string value_error_beside(const Hit& hit) const;
  /// Of the exact answer: which value lies outside its bound, empty if none does. `other_root`: of a sphere's two roots
  /// the one that is not nearest is meant.
  std::string value_error(const Hit& hit, bool other_root) const;

  std::string describe_truth() const;

 private:
  double dt(const Crossing& c) const { return values(c).t; }
  /// t of the root that an answer means.
  double meant_t(const Crossing& c, double answered_t) const;
  bool any_hit() const;
  bool is_in_closed_surface(const Crossing& c) const;
  int side_of(const Crossing& c) const;
  bool is_within(const Crossing& c, double t) const;
  std::vector<const Crossing*> patch_of(const Crossing& x, std::vector<const Crossing*> near) const;
  bool crosses_oddly(const std::vector<const Crossing*>& list) const;

  const Judge& judge_;
  const Ray& ray_;
  double length_;
  PlacedRays placed_;
  std::vector<Crossing> crossings_;
};

/// Name of the value that lies outside its bound, empty if none does. Written so that NaN is outside.
std::string value_outside_bound(const ValueBounds& bounds, const Hit& hit, const ReferenceHit& truth);
/// The same without words.
bool is_within_bounds(const ValueBounds& bounds, const Hit& hit, const ReferenceHit& truth);

/// "primitive 12", "primitive 12 of instance 7 (walker/leg)".
std::string primitive_name(const Scene& scene, std::uint32_t instance, std::uint32_t primitive);

}  // namespace plumbline
