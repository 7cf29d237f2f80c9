// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: what a ray hits, by a loop over all primitives in big integers, with formulas and a number library that
// the arbiter does not use.
#pragma once

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <vector>

#include "reference/exact.h"
#include "scenes/ray.h"

namespace plumbline::brute {

using Int = boost::multiprecision::mpz_int;
/// 4000 bits. Values that differ here do so within 2^-1800 or not at all: they are roots of quadratics whose integer
/// coefficients have fewer than 450 bits in these tests, and two such roots, or their difference, lie farther apart
/// than 2^-(4 * 450).
using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<1200, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

struct IntVec {
  Int x, y, z;
};

/// Every float is a multiple of 2^-149.
inline Int integer(float f) { return Int(std::ldexp(static_cast<double>(f), 149)); }
inline IntVec integer(const glm::vec3& v) { return {integer(v.x), integer(v.y), integer(v.z)}; }
inline IntVec minus(const IntVec& a, const IntVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Int dot(const IntVec& a, const IntVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline IntVec cross(const IntVec& a, const IntVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline IntVec scaled(const IntVec& a, const Int& k) { return {a.x * k, a.y * k, a.z * k}; }
inline IntVec plus(const IntVec& a, const IntVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

inline int sign(const Int& x) { return x < 0 ? -1 : x > 0 ? 1 : 0; }
inline int compare(const Real& a, const Real& b) {
  const Real difference = a - b, scale = abs(a) + abs(b);
  if (abs(difference) <= ldexp(scale, -3000)) return 0;
  return difference < 0 ? -1 : 1;
}

struct Answer {
  bool meets = false;  ///< in a point of the closed primitive
  bool hit = false;
  bool touches = false;  ///< meets it on an edge, in a corner, or as a tangent
  int facing = 0;
  Real t = 0, enter = 0, leave = 0;
};

inline bool in_range(const Ray& ray, const Real& t) {
  return compare(t, Real(0)) > 0 && (std::isinf(ray.t_max) ? ray.t_max > 0 : compare(t, Real(ray.t_max)) <= 0);
}

inline Answer triangle(const Ray& ray, const Solid& solid) {
  const IntVec o = integer(ray.origin), d = integer(ray.direction);
  const IntVec v[3] = {integer(solid.corners[0]), integer(solid.corners[1]), integer(solid.corners[2])};
  const IntVec n = cross(minus(v[1], v[0]), minus(v[2], v[0]));
  const Int slope = dot(n, d), height = dot(n, minus(v[0], o));
  Answer answer;
  answer.facing = sign(slope);
  if (slope == 0) return answer;
  // The point in the plane, times |slope|.
  const Int divisor = abs(slope), numerator = height * answer.facing;
  const IntVec point = plus(scaled(o, divisor), scaled(d, numerator));
  answer.meets = true;
  for (int i = 0; i < 3; ++i) {
    const IntVec edge = minus(v[(i + 1) % 3], v[i]);
    const int side = sign(dot(cross(edge, minus(point, scaled(v[i], divisor))), n));
    if (side < 0) answer.meets = false;
    if (side == 0) answer.touches = true;
  }
  answer.touches = answer.touches && answer.meets;
  answer.t = answer.enter = answer.leave = Real(numerator) / Real(divisor);
  answer.hit = answer.meets && in_range(ray, answer.t);
  return answer;
}

inline Answer sphere(const Ray& ray, const Solid& solid) {
  const IntVec d = integer(ray.direction), m = minus(integer(ray.origin), integer(solid.corners[0]));
  const Int r = integer(solid.radius), a = dot(d, d), b = dot(m, d), c = dot(m, m) - r * r,
            discriminant = b * b - a * c;
  Answer answer;
  if (discriminant < 0) return answer;
  answer.meets = true;
  answer.touches = discriminant == 0;
  const Real root = sqrt(Real(discriminant));
  answer.enter = (Real(-b) - root) / Real(a);
  answer.leave = (Real(-b) + root) / Real(a);
  answer.hit = in_range(ray, answer.enter) || in_range(ray, answer.leave);
  answer.t = compare(answer.enter, Real(0)) > 0 ? answer.enter : answer.leave;
  return answer;
}

inline Answer answer(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  const Solid solid = solid_of(scene, primitive);
  return solid.is_sphere ? sphere(ray, solid) : triangle(ray, solid);
}

/// All nearest primitives in ascending order.
inline std::vector<std::uint32_t> nearest(const Scene& scene, const Ray& ray) {
  std::vector<std::uint32_t> best;
  Real best_t = 0;
  for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
    const Answer one = answer(scene, ray, p);
    if (!one.hit) continue;
    const int order = best.empty() ? -1 : compare(one.t, best_t);
    if (order > 0) continue;
    if (order < 0) best.clear(), best_t = one.t;
    best.push_back(p);
  }
  return best;
}

}  // namespace plumbline::brute
