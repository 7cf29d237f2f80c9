// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/differences.h"

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// P(N(0, 1) >= x).
double normal_tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

/// P(|T| >= t), T of Student's distribution.
double student_tail(double t, double freedom) {
  if (t == kInfinity) return 0.0;
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), t));
}

}  // namespace

double tail_bound(double x) {
  if (std::isnan(x)) return 0.0;
  static const double factor = 1.0 / (4.0 * normal_tail(std::numbers::sqrt2));
  return std::min(1.0, 2.0 * factor * normal_tail(x));
}

double threshold_of(double level) {
  PLUMBLINE_ASSERT(level > 0.0 && level < 1.0);
  double low = 0.0, high = 40.0;  // the bound falls
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (tail_bound(middle) > level ? low : high) = middle;
  }
  return high;
}

DifferenceTest test_differences(std::span<const double> differences, double rounding) {
  PLUMBLINE_ASSERT(differences.size() >= 2);
  DifferenceTest test;
  test.count = differences.size();
  const auto n = static_cast<double>(differences.size());
  for (const double d : differences) test.mean += d / n;
  if (!std::isfinite(test.mean) || std::isnan(rounding)) {
    test.p = test.student_p = 0.0;
    test.statistic = test.z = test.deviation = kInfinity;
    return test;
  }
  double squares = 0.0;  // about the mean
  for (const double d : differences) squares += (d - test.mean) * (d - test.mean);
  test.deviation = std::sqrt(squares / (n - 1.0));
  // |S| and |t| fall with the distance from the mean that is asked, so the nearest one that rounding allows is worst.
  const double excess = test.mean - std::clamp(test.mean, -rounding, rounding);
  if (excess == 0.0) return test;
  test.statistic = n * excess / std::sqrt(squares + n * excess * excess);
  test.p = tail_bound(std::fabs(test.statistic));
  const double t = squares > 0.0 ? std::fabs(excess) * std::sqrt(n) / test.deviation : kInfinity;
  test.student_p = student_tail(t, n - 1.0);
  test.z = std::copysign(deviate_of(test.student_p), excess);
  return test;
}

double detectable_mean(double deviation, std::size_t count, double level, double probability) {
  const auto n = static_cast<double>(count);
  const double x = threshold_of(level);
  if (!(x * x < n)) return kInfinity;
  if (!(deviation > 0.0)) return 0.0;
  const double t = x * std::sqrt((n - 1.0) / (n - x * x));  // S = x where Student's t is this
  // Only the side of the shift counts: the other is less likely than the level.
  const auto alarm = [&](double shift) {
    return boost::math::cdf(boost::math::complement(boost::math::non_central_t(n - 1.0, shift), t));
  };
  double low = 0.0, high = t + 1.0;
  while (alarm(high) < probability) high *= 1.5;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (alarm(middle) < probability ? low : high) = middle;
  }
  return high * deviation / std::sqrt(n);
}

double interval_of(const DifferenceTest& test, double confidence) {
  const auto n = static_cast<double>(test.count);
  const double quantile = boost::math::quantile(boost::math::students_t(n - 1.0), 0.5 + 0.5 * confidence);
  return quantile * test.deviation / std::sqrt(n);
}

double deviate_of(double p) {
  // Beyond 38 deviations a double knows no smaller probability.
  if (!(p > 1e-300)) return 38.0;
  if (p >= 1.0) return 0.0;
  return boost::math::quantile(boost::math::complement(boost::math::normal(), 0.5 * p));
}

}  // namespace plumbline
