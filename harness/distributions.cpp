// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/distributions.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>

#include "scenes/error.h"

namespace plumbline {

double kolmogorov_tail(double d, std::size_t n) {
  const double root = std::sqrt(static_cast<double>(n));
  const double x = d * (root + 0.12 + 0.11 / root);  // Stephens 1970
  if (std::isnan(x)) return 0.0;
  if (x < 0.2) return 1.0;
  double tail = 0.0;
  if (x < 1.0) {  // the other series of the same function, which converges here
    double below = 0.0;
    for (int k = 1; k < 40; k += 2) below += std::exp(-k * k * std::numbers::pi * std::numbers::pi / (8.0 * x * x));
    tail = 1.0 - std::sqrt(2.0 * std::numbers::pi) / x * below;
  } else {
    for (int k = 1; k < 40; ++k) tail += (k % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * x * x);
  }
  return std::clamp(tail, 0.0, 1.0);
}

double anderson_tail(double z) {
  if (std::isnan(z)) return 0.0;
  if (z <= 0.0) return 1.0;
  const auto polynomial = [z](std::initializer_list<double> coefficients) {
    double sum = 0.0;
    for (auto c = std::rbegin(coefficients); c != std::rend(coefficients); ++c) sum = sum * z + *c;
    return sum;
  };
  const auto upper = [&polynomial] {
    return std::exp(-std::exp(polynomial({1.0776, -2.30695, 0.43424, -0.082433, 0.008056, -0.0003146})));
  };
  if (z < 2.0)
    return 1.0 - std::exp(-1.2337141 / z) / std::sqrt(z) *
                     polynomial({2.00012, 0.247105, -0.0649821, 0.0347962, -0.0116720, 0.00168691});
  // A^2 is a sum of chi^2 / (j (j + 1)): far out the first term, of weight 1/2, rules, and the tail is
  // const e^-z / sqrt z. The fit is not meant for z above 8, where it is 1e-4.
  constexpr double kJoin = 8.0;
  if (z <= kJoin) return 1.0 - upper();
  return anderson_tail(kJoin) * std::exp(kJoin - z) * std::sqrt(kJoin / z);
}

UniformTest test_uniform(std::vector<double> numbers) {
  PLUMBLINE_ASSERT(!numbers.empty());
  UniformTest test;
  test.count = numbers.size();
  if (!std::all_of(numbers.begin(), numbers.end(), [](double u) { return u >= 0.0 && u <= 1.0; })) {
    test.kolmogorov_p = test.anderson_p = 0.0;
    return test;
  }
  std::sort(numbers.begin(), numbers.end());
  const auto n = static_cast<double>(numbers.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto rank = static_cast<double>(i);
    test.kolmogorov = std::max({test.kolmogorov, numbers[i] - rank / n, (rank + 1.0) / n - numbers[i]});
    // A number that is exactly 0 or 1 (k / 2^24, p-values of nothing) stands for its neighbourhood.
    const double low = std::max(numbers[i], 0x1p-26), high = std::max(1.0 - numbers[numbers.size() - 1 - i], 0x1p-26);
    sum += (2.0 * rank + 1.0) / n * (std::log(low) + std::log(high));
  }
  test.anderson = -n - sum;
  test.kolmogorov_p = kolmogorov_tail(test.kolmogorov, numbers.size());
  test.anderson_p = anderson_tail(test.anderson);
  return test;
}

double chi_square_p(std::span<const std::uint64_t> counts, std::span<const double> expected) {
  PLUMBLINE_ASSERT(counts.size() == expected.size() && counts.size() >= 2);
  double sum = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    PLUMBLINE_ASSERT(expected[i] >= 5.0);
    const double away = static_cast<double>(counts[i]) - expected[i];
    sum += away * away / expected[i];
  }
  const boost::math::chi_squared distribution(static_cast<double>(counts.size() - 1));
  return boost::math::cdf(boost::math::complement(distribution, sum));
}

double correlation_p(std::span<const double> a, std::span<const double> b) {
  PLUMBLINE_ASSERT(a.size() == b.size() && a.size() >= 8);
  const auto n = static_cast<double>(a.size());
  double mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  if (!std::isfinite(ab)) return 0.0;
  if (!(aa > 0.0 && bb > 0.0)) return 1.0;  // a constant is independent of everything
  // Fisher's transformation is normal with variance 1 / (n - 3).
  const double r = std::clamp(ab / std::sqrt(aa * bb), -1.0 + 1e-15, 1.0 - 1e-15);
  const double z = std::atanh(r) * std::sqrt(n - 3.0);
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::fabs(z)));
}

}  // namespace plumbline
