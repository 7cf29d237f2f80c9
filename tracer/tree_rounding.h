// SPDX-License-Identifier: MIT
// Rounding outwards to float, and signs of sums without error: what the sphere tree's exact containment rests on.
#pragma once

#include <cmath>
#include <limits>
#include <span>

namespace plumbline {

/// a + b and what rounding took from it: sum + error is the exact value (Knuth's TwoSum; any order of magnitudes).
struct ExactSum {
  double sum, error;
};
inline ExactSum exact_sum(double a, double b) {
  const double s = a + b, z = s - a;
  return {s, (a - (s - z)) + (b - z)};
}

/// The least float that is >= a + b, exactly; infinity where there is none. a and b are finite.
inline float sum_up(double a, double b = 0.0) {
  const auto [sum, error] = exact_sum(a, b);
  const float f = static_cast<float>(sum);
  const bool below = f < sum || (f == sum && error > 0.0);
  return below ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// The greatest float that is <= a + b, exactly; minus infinity where there is none.
inline float sum_down(double a, double b = 0.0) { return -sum_up(-a, -b); }

/// The sign (-1, 0, 1) of the exact sum of `terms`, at most 16 of them, each a product of two floats: Shewchuk 1997's
/// Grow-Expansion. Such products are multiples of 2^-298 below 2^257, so nothing over- or underflows.
inline int exact_sign(std::span<const double> terms) {
  double expansion[16];  // non-overlapping, ascending: the sign of the last that is not zero is the sign of all
  int size = 0;
  for (double term : terms) {
    int kept = 0;
    for (int i = 0; i < size; ++i) {
      const auto [sum, error] = exact_sum(expansion[i], term);
      term = sum;
      if (error != 0.0) expansion[kept++] = error;
    }
    if (term != 0.0) expansion[kept++] = term;
    size = kept;
  }
  if (size == 0) return 0;
  return expansion[size - 1] > 0.0 ? 1 : -1;
}

}  // namespace plumbline
