// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: what a ray hits in a scene with instances, by a loop over all pairs in fractions: triangles are brought
// into the world, where the arbiter brings rays out of it.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <vector>

#include "reference/arbiter.h"
#include "reference/exact.h"

namespace plumbline::brute {

using Fraction = boost::multiprecision::mpq_rational;
/// 12,000 bits. Values are roots of quadratics with integer coefficients that have fewer than 2,500 bits in these
/// tests; two of them that differ do so by more than 2^-(4 * 2500).
using Wide = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<3620, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

struct FractionVec {
  Fraction x, y, z;
};
inline FractionVec fractions(const glm::vec3& v) {
  return {Fraction(static_cast<double>(v.x)), Fraction(static_cast<double>(v.y)), Fraction(static_cast<double>(v.z))};
}
inline FractionVec operator-(const FractionVec& a, const FractionVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline FractionVec operator+(const FractionVec& a, const FractionVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline FractionVec operator*(const FractionVec& a, const Fraction& k) { return {a.x * k, a.y * k, a.z * k}; }
inline Fraction dot(const FractionVec& a, const FractionVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline FractionVec cross(const FractionVec& a, const FractionVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline int sign(const Fraction& x) { return x < 0 ? -1 : x > 0 ? 1 : 0; }
inline Wide wide(const Fraction& x) { return Wide(numerator(x)) / Wide(denominator(x)); }

/// Columns and translation, composed in fractions; the identity for kNone.
struct FractionMap {
  FractionVec a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1}, translation{0, 0, 0};
  FractionVec linear(const FractionVec& v) const { return a * v.x + b * v.y + c * v.z; }
  FractionVec point(const FractionVec& v) const { return linear(v) + translation; }
  Fraction determinant() const { return dot(a, cross(b, c)); }
  /// L^-1 v, by Cramer's rule.
  FractionVec solve(const FractionVec& v) const {
    const Fraction d = determinant();
    return {dot(v, cross(b, c)) / d, dot(a, cross(v, c)) / d, dot(a, cross(b, v)) / d};
  }
};
inline FractionMap map_of(const Scene& scene, std::uint32_t instance) {
  FractionMap map;
  const auto chain = chain_of(scene, instance);
  for (auto node = chain.rbegin(); node != chain.rend(); ++node) {  // from the inside out
    const Transform& t = scene.nodes[*node].transform;
    const FractionMap outer{fractions(t.linear[0]), fractions(t.linear[1]), fractions(t.linear[2]),
                            fractions(t.translation)};
    map = {outer.linear(map.a), outer.linear(map.b), outer.linear(map.c), outer.point(map.translation)};
  }
  return map;
}

inline int compare(const Wide& a, const Wide& b) {
  const Wide difference = a - b, scale = abs(a) + abs(b);
  if (abs(difference) <= ldexp(scale, -11000)) return 0;
  return difference < 0 ? -1 : 1;
}

struct PlacedAnswer {
  bool meets = false, hit = false, touches = false;
  int facing = 0;
  Wide t = 0, enter = 0, leave = 0;
};

inline bool in_range(const Ray& ray, const Wide& t) {
  return compare(t, Wide(0)) > 0 && (std::isinf(ray.t_max) ? ray.t_max > 0 : compare(t, Wide(ray.t_max)) <= 0);
}

inline PlacedAnswer placed_answer(const Scene& scene, const FractionMap& map, const Ray& ray, std::uint32_t primitive) {
  const Solid solid = solid_of(scene, primitive);
  const FractionVec o = fractions(ray.origin), d = fractions(ray.direction);
  PlacedAnswer answer;
  if (solid.is_sphere) {
    const FractionVec local_d = map.solve(d), m = map.solve(o - map.translation) - fractions(solid.corners[0]);
    const Fraction r(static_cast<double>(solid.radius)), a = dot(local_d, local_d), b = dot(m, local_d),
                                                         discriminant = b * b - a * (dot(m, m) - r * r);
    if (discriminant < 0) return answer;
    answer.meets = true;
    answer.touches = discriminant == 0;
    const Wide root = sqrt(wide(discriminant));
    answer.enter = (wide(-b) - root) / wide(a);
    answer.leave = (wide(-b) + root) / wide(a);
    answer.hit = in_range(ray, answer.enter) || in_range(ray, answer.leave);
    answer.t = compare(answer.enter, Wide(0)) > 0 ? answer.enter : answer.leave;
    return answer;
  }
  const FractionVec v[3] = {map.point(fractions(solid.corners[0])), map.point(fractions(solid.corners[1])),
                            map.point(fractions(solid.corners[2]))};
  const FractionVec n = cross(v[1] - v[0], v[2] - v[0]);
  const Fraction slope = dot(n, d);
  // The normal is the part's own: a mirror turns the cross product of its corners round.
  answer.facing = sign(slope) * sign(map.determinant());
  if (slope == 0) return answer;
  const Fraction t = dot(n, v[0] - o) / slope;
  const FractionVec point = o + d * t;
  answer.meets = true;
  for (int i = 0; i < 3; ++i) {
    const int side = sign(dot(cross(v[(i + 1) % 3] - v[i], point - v[i]), n));
    if (side < 0) answer.meets = false;
    if (side == 0) answer.touches = true;
  }
  answer.touches = answer.touches && answer.meets;
  answer.t = answer.enter = answer.leave = wide(t);
  answer.hit = answer.meets && in_range(ray, answer.t);
  return answer;
}

/// Every pair that the scene shows, with what the ray does there.
struct Shown {
  Placed placed;
  PlacedAnswer answer;
};
/// `maps`: of the world and then of instances_of(scene).
inline std::vector<Shown> all_answers(const Scene& scene, const std::vector<FractionMap>& maps, const Ray& ray) {
  std::vector<Shown> all;
  std::vector<std::uint32_t> places = instances_of(scene);
  places.insert(places.begin(), kNone);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      if (scene.is_placed(places[i], p)) all.push_back({{places[i], p}, placed_answer(scene, maps[i], ray, p)});
    }
  }
  return all;
}
inline std::vector<FractionMap> all_maps(const Scene& scene) {
  std::vector<FractionMap> maps{FractionMap{}};
  for (const std::uint32_t instance : instances_of(scene)) maps.push_back(map_of(scene, instance));
  return maps;
}

/// All nearest pairs in ascending order.
inline std::vector<Placed> nearest(const std::vector<Shown>& all) {
  std::vector<Placed> best;
  Wide best_t = 0;
  for (const Shown& one : all) {
    if (!one.answer.hit) continue;
    const int order = best.empty() ? -1 : compare(one.answer.t, best_t);
    if (order > 0) continue;
    if (order < 0) best.clear(), best_t = one.answer.t;
    best.push_back(one.placed);
  }
  return best;
}

}  // namespace plumbline::brute
