// SPDX-License-Identifier: GPL-3.0-or-later
// The polynomials that decide what a line meets, written once for every kind of number: exact ones, and floating-point
// ones that carry their error bound.
#pragma once

#include <array>

#include "reference/bounded.h"
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
// Always inline: with several kinds of lines the compiler would call them, numbers in memory, an eighth slower.
template <class N>
[[gnu::always_inline]] inline N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class N>
[[gnu::always_inline]] inline Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A line as numbers of one kind (see Line). Exact lines in an instance's space are multiplied by `scale`, lest they
/// have to divide.
template <class N>
struct LineOf {
  using Number = N;
  Vec<N> point, rest, direction;
  N scale;
  bool has_rest = false, has_scale = false;

  const Vec<N>& heading() const { return direction; }
  /// A point of the line's space as seen from the line's point, times `scale`.
  Vec<N> see(const glm::vec3& v) const {
    const Vec<N> a = (has_scale ? vec<N>(glm::dvec3(v)) * scale : vec<N>(glm::dvec3(v))) - point;
    return has_rest ? a - rest : a;
  }
  /// A length of the line's space, times `scale`.
  N length(double x) const { return has_scale ? N(N(x) * scale) : N(x); }
};

/// The same of a line that has no errors. Numbers are made where they are used, so that the compiler sees zeros.
template <class T>
struct WorldLineOf {
  using Number = Bounded<T>;
  const Line& line;

  Vec<Number> heading() const { return vec<Number>(line.direction); }
  Vec<Number> see(const glm::vec3& v) const {
    const Vec<Number> a = vec<Number>(glm::dvec3(v)) - vec<Number>(line.point);
    return line.shift == 0.0 ? a : a - vec<Number>(line.rest);
  }
  Number length(double x) const { return Number(x); }
};

/// A line with the errors that it has.
template <class T>
LineOf<Bounded<T>> bounded_line(const Line& line) {
  const auto known_to = [](const glm::dvec3& v, double error) {
    using B = Bounded<T>;
    const T e = static_cast<T>(error);
    return Vec<B>{B(static_cast<T>(v.x), e), B(static_cast<T>(v.y), e), B(static_cast<T>(v.z), e)};
  };
  return {known_to(line.point, line.point_error),
          known_to(line.rest, 0.0),
          known_to(line.direction, line.direction_error),
          Bounded<T>(1.0),
          true,
          false};
}

/// d . (a x b) of the segment's ends a and b: on which side the line passes the segment, as six times a volume, times
/// the square of the line's scale.
template <class L, class N = typename L::Number>
N edge_moment(const L& line, const glm::vec3& from, const glm::vec3& to) {
  const Vec<N> edge = vec<N>(glm::dvec3(to)) - vec<N>(glm::dvec3(from));
  return dot(cross(line.heading(), line.see(from)), edge);
}

/// The line meets a triangle's plane at s = numerator / determinant.
template <class N>
struct PlaneTerms {
  Vec<N> normal;             ///< (v1 - v0) x (v2 - v0), without the line's scale
  N numerator, determinant;  ///< times the line's scale
};

template <class L, class N = typename L::Number>
PlaneTerms<N> plane_terms(const L& line, const std::array<glm::vec3, 3>& corners) {
  const Vec<N> v0 = vec<N>(glm::dvec3(corners[0]));
  const Vec<N> normal = cross(vec<N>(glm::dvec3(corners[1])) - v0, vec<N>(glm::dvec3(corners[2])) - v0);
  return {normal, dot(normal, line.see(corners[0])), dot(normal, line.heading())};
}

/// The line meets a sphere at s = (middle -+ sqrt(discriminant)) / length2. All lengths are times the line's scale.
template <class N>
struct SphereTerms {
  Vec<N> center;  ///< seen from the line's point
  N length2, middle, discriminant;
};

/// The discriminant by Lagrange's identity, r^2 d.d - |m x d|^2: its sign is that of radius minus distance, and far
/// less cancels than in (m.d)^2 - d.d (m.m - r^2).
template <class L, class N = typename L::Number>
SphereTerms<N> sphere_terms(const L& line, const glm::vec3& center, float radius) {
  const Vec<N> d = line.heading(), m = line.see(center), moment = cross(m, d);
  const N length2 = dot(d, d), r = line.length(static_cast<double>(radius));
  return {m, length2, dot(m, d), r * r * length2 - dot(moment, moment)};
}

}  // namespace plumbline
