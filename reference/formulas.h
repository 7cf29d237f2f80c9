// SPDX-License-Identifier: GPL-3.0-or-later
// The polynomials that decide what a line meets, written once for every kind of number: exact ones, and floating-point
// ones that carry their error bound.
#pragma once

#include <array>

#include "reference/line.h"

namespace plumbline {

template <class N>
struct Vec {
  N x, y, z;
};

template <class N>
Vec<N> vec(const glm::dvec3& v) {
  return {N(v.x), N(v.y), N(v.z)};
}
template <class N>
Vec<N> operator-(const Vec<N>& a, const Vec<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
Vec<N> operator+(const Vec<N>& a, const Vec<N>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class N>
Vec<N> operator*(const Vec<N>& a, const N& k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <class N>
N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class N>
Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// `v` as seen from the line's point.
template <class N>
Vec<N> from_line(const Line& line, const glm::vec3& v) {
  const Vec<N> a = vec<N>(glm::dvec3(v)) - vec<N>(line.point);
  return line.shift == 0.0 ? a : a - vec<N>(line.rest);
}

/// d . (a x b) of the segment's ends a and b: on which side the line passes the segment, as six times a volume.
template <class N>
N edge_moment(const Line& line, const glm::vec3& from, const glm::vec3& to) {
  const Vec<N> edge = vec<N>(glm::dvec3(to)) - vec<N>(glm::dvec3(from));
  return dot(cross(vec<N>(line.direction), from_line<N>(line, from)), edge);
}

/// The line meets a triangle's plane at s = numerator / determinant.
template <class N>
struct PlaneTerms {
  Vec<N> normal;  ///< (v1 - v0) x (v2 - v0)
  N numerator, determinant;
};

template <class N>
PlaneTerms<N> plane_terms(const Line& line, const std::array<glm::vec3, 3>& corners) {
  const Vec<N> v0 = vec<N>(glm::dvec3(corners[0]));
  const Vec<N> normal = cross(vec<N>(glm::dvec3(corners[1])) - v0, vec<N>(glm::dvec3(corners[2])) - v0);
  return {normal, dot(normal, from_line<N>(line, corners[0])), dot(normal, vec<N>(line.direction))};
}

/// The line meets a sphere at s = (middle -+ sqrt(discriminant)) / length2.
template <class N>
struct SphereTerms {
  Vec<N> center;  ///< seen from the line's point
  N length2, middle, discriminant;
};

/// The discriminant by Lagrange's identity, r^2 d.d - |m x d|^2: its sign is that of radius minus distance, and far
/// less cancels than in (m.d)^2 - d.d (m.m - r^2).
template <class N>
SphereTerms<N> sphere_terms(const Line& line, const glm::vec3& center, float radius) {
  const Vec<N> d = vec<N>(line.direction), m = from_line<N>(line, center), moment = cross(m, d);
  const N length2 = dot(d, d), r = N(static_cast<double>(radius));
  return {m, length2, dot(m, d), r * r * length2 - dot(moment, moment)};
}

}  // namespace plumbline
