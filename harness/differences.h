// SPDX-License-Identifier: GPL-3.0-or-later
// A test that needs no normal distribution. Two sources are asked for batches of the same size, batch b of one is set
// against batch b of the other, and d_b is the difference of some figure of the two (a pixel's mean, a tile's, a sum
// with given weights, a variance). If both draw from the same distribution, d_b and -d_b are equally likely, whatever
// that distribution is; given the sizes |d_b|, their signs are fair coins. Then
//
//     S = sum d_b / sqrt(sum d_b^2)
//
// is a sum of fair coins with weights whose squares add up to 1, and for every such sum and every x
//
//     P(S >= x) <= c P(N(0, 1) >= x),   c = 1 / (4 P(N(0, 1) >= sqrt 2)) = 3.178...
//
// (Bentkus and Dzindzalieta 2015, "A tight Gaussian bound for weighted sums of Rademacher random variables"). So the
// p-values of alarms are upper bounds that hold for few samples, rare events and any dependence between pixels. What
// it costs: S is at most sqrt(n) for n batches, and a factor of 3.2 in level, which is 0.2 standard deviations at the
// levels of a run. Where a figure's two distributions are equal only in their mean (sums over pixels of a source whose
// pixels are not independent) the difference is symmetric as far as both are normal, as sums over many pixels are.
#pragma once

#include <cstddef>
#include <span>

namespace plumbline {

/// At least the probability of |S| >= x under symmetric differences. In [0, 1]; 0 for NaN.
double tail_bound(double x);
/// The x at which tail_bound is `level`, in (0, 1).
double threshold_of(double level);

struct DifferenceTest {
  std::size_t count = 0;   ///< of differences
  double mean = 0.0;       ///< of the differences
  double deviation = 0.0;  ///< of one difference, by the unbiased variance
  double statistic = 0.0;  ///< S, with its sign, once what rounding may explain is taken from the mean
  double p = 1.0;          ///< upper bound, of both sides
  double z = 0.0;          ///< Student's t of the same, as the normal quantile of its p: for maps and plots
  double student_p = 1.0;  ///< of both sides; uniform as far as the batches' means are normal
};

/// Tests that the mean difference is at most `rounding` away from 0: the p-value is the greatest over all means in that
/// interval. A difference that is not finite has p = 0. At least two differences.
DifferenceTest test_differences(std::span<const double> differences, double rounding = 0.0);

/// The mean difference that test_differences calls an alarm at `level` (p <= level) with this probability, if `count`
/// differences are normal with this deviation; by the noncentral t distribution. Infinite where so few differences
/// cannot reach the level.
double detectable_mean(double deviation, std::size_t count, double level, double probability = 0.99);

/// Half the width of the mean's confidence interval, by Student.
double interval_of(const DifferenceTest& test, double confidence);

/// A p-value of both sides as the size of a normal deviate.
double deviate_of(double p);

}  // namespace plumbline
