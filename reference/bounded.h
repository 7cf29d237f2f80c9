// SPDX-License-Identifier: GPL-3.0-or-later
// Floating-point numbers that carry a bound of their error (Wilkinson's running error analysis): what exact arithmetic
// is spared by. No rounding mode is touched.
#pragma once

#include <cmath>
#include <limits>

namespace plumbline {

/// The true number lies within `error` of `value`. An overflow or an invalid operation makes the error infinite or NaN,
/// and every question about such a number is answered with "not known".
///
/// Each operation adds the rounding of its own result (half an ulp, at most u |value|) to what it inherits. The bound's
/// own arithmetic rounds too: a handful of operations on non-negative numbers, each off by a factor of at most 1 + u,
/// so a factor of 1 + 16 u covers them. Underflow is not accounted for: see Line for why there is none.
template <class T>
struct Bounded {
  T value = 0, error = 0;

  Bounded() = default;
  explicit Bounded(double exact) : value(exact) {}
  Bounded(T v, T e) : value(v), error(e * (1 + 16 * kUnit)) {}

  static constexpr T kUnit = std::numeric_limits<T>::epsilon() / 2;

  /// The sign where it is certain, 0 where it is not known.
  int sign() const { return value > error ? 1 : value < -error ? -1 : 0; }

  friend Bounded operator+(const Bounded& a, const Bounded& b) {
    const T v = a.value + b.value;
    return {v, a.error + b.error + kUnit * std::fabs(v)};
  }
  friend Bounded operator-(const Bounded& a, const Bounded& b) {
    const T v = a.value - b.value;
    return {v, a.error + b.error + kUnit * std::fabs(v)};
  }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    const T v = a.value * b.value;
    return {v, std::fabs(a.value) * b.error + (std::fabs(b.value) + b.error) * a.error + kUnit * std::fabs(v)};
  }
  friend Bounded operator/(const Bounded& a, const Bounded& b) {
    // |A/B - a/b| <= (|A - a| + |a/b| |B - b|) / |B|.
    const T v = a.value / b.value, least = std::fabs(b.value) - b.error;
    if (!(least > 0)) return {v, std::numeric_limits<T>::infinity()};
    return {v, (a.error + std::fabs(v) * (1 + kUnit) * b.error) / least * (1 + kUnit) + kUnit * std::fabs(v)};
  }
  /// Times a power of two: exact.
  friend Bounded scaled(const Bounded& a, T power_of_two) {
    Bounded result;
    result.value = a.value * power_of_two, result.error = a.error * power_of_two;
    return result;
  }
  /// Of a number known not to be negative.
  friend Bounded sqrt(const Bounded& a) {
    if (!(a.value > a.error)) return {0, std::sqrt(std::fmax(a.value, T(0)) + a.error)};
    const T v = std::sqrt(a.value);  // |sqrt(A) - sqrt(a)| = |A - a| / (sqrt(A) + sqrt(a))
    return {v, a.error / v + kUnit * v};
  }
};

/// What t is computed in, and everything else that is to be good to a double.
using BoundedT = Bounded<long double>;

/// Whether the two are certainly in this order.
template <class T>
bool certainly_less(const Bounded<T>& a, const Bounded<T>& b) {
  return (b - a).sign() > 0;
}

}  // namespace plumbline
