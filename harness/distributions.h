// SPDX-License-Identifier: GPL-3.0-or-later
// Classical tests of numbers against a distribution: independent numbers, with p-values from the statistics' known
// distributions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace plumbline {

/// Numbers that should be independent and uniform in [0, 1].
struct UniformTest {
  std::size_t count = 0;
  double kolmogorov = 0.0;    ///< the greatest distance D of the distributions
  double kolmogorov_p = 1.0;  ///< within 2 % down to 1e-12, from 8 numbers on
  double anderson = 0.0;      ///< A^2: sees the tails
  double anderson_p = 1.0;
};

/// Not empty; a number outside of [0, 1], or none, makes both p 0.
UniformTest test_uniform(std::vector<double> numbers);

/// P(sqrt(n) D >= x) for n numbers: Stephens' modification of Kolmogorov's limit.
double kolmogorov_tail(double d, std::size_t n);
/// P(A^2 >= z) for many numbers (Marsaglia and Marsaglia 2004), exact to 2e-6 above 1e-4; below that an exponential
/// with the rate of the largest term of its series.
double anderson_tail(double z);

/// Pearson's statistic of counts against expected ones, which sum up to the same; each expected count at least 5.
/// Returns P(chi^2 >= found) with counts.size() - 1 degrees of freedom; 0 where a count is impossible.
double chi_square_p(std::span<const std::uint64_t> counts, std::span<const double> expected);

/// p-value of the correlation of two sequences of equal length, at least 8, independent under the null: Student's test
/// of their product-moment correlation of ranks would need no normality; here the numbers are bounded and many.
double correlation_p(std::span<const double> a, std::span<const double> b);

}  // namespace plumbline
