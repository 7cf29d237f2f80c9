// SPDX-License-Identifier: GPL-3.0-or-later
// The bound against all signs counted out, its level on ugly distributions, and its power against a simulation.
#include "harness/differences.h"

#include <boost/math/distributions/normal.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "scenes/random.h"

using namespace plumbline;

namespace {

/// P(|S| >= x) over all signs of these sizes.
double counted_tail(const std::vector<double>& sizes, double x) {
  double squares = 0.0;
  for (const double size : sizes) squares += size * size;
  const double reached = x * std::sqrt(squares) * (1.0 - 1e-12);
  std::uint64_t hits = 0;
  const std::uint64_t all = std::uint64_t{1} << sizes.size();
  for (std::uint64_t signs = 0; signs < all; ++signs) {
    double sum = 0.0;
    for (std::size_t i = 0; i < sizes.size(); ++i) sum += (signs >> i & 1) != 0 ? sizes[i] : -sizes[i];
    hits += std::fabs(sum) >= reached;
  }
  return static_cast<double>(hits) / static_cast<double>(all);
}

double normal_number(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(2.0 * std::numbers::pi * random.uniform());
}

}  // namespace

TEST_CASE("The tail bound holds for signs counted out, also where it is nearly reached", "[statistics]") {
  const std::vector<std::vector<double>> all_sizes{{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
                                                   {1, 1},
                                                   {1, 0, 0},
                                                   {100, 1, 1, 1, 1, 1},
                                                   {8, 7, 6, 5, 4, 3, 2, 1}};
  for (const std::vector<double>& sizes : all_sizes)
    for (double x = 0.0; x <= 4.0; x += 0.125) CHECK(counted_tail(sizes, x) <= tail_bound(x));
  // Two equal sizes reach sqrt 2 half of the time, which is where the constant comes from.
  CHECK(counted_tail({1, 1}, std::numbers::sqrt2) == 0.5);
  CHECK(tail_bound(std::numbers::sqrt2 + 1e-9) == Approx(0.5).epsilon(1e-6));
  // The constant is 3.18, not larger: far out the bound is that multiple of the normal tail.
  CHECK(tail_bound(5.0) < 3.2 * 2.0 * 2.8665e-7);
  CHECK(tail_bound(threshold_of(1e-7)) == Approx(1e-7).epsilon(1e-9));
}

TEST_CASE("What cannot be told apart has p = 1, what differs without noise the least p, NaN none", "[statistics]") {
  const std::vector<double> none(64, 0.0), constant(64, 1e-3), rounding(64, 1e-7);
  CHECK(test_differences(none).p == 1.0);
  CHECK(test_differences(constant).p < 1e-13);
  CHECK(test_differences(rounding).p < 1e-13);
  CHECK(test_differences(rounding, 1.1e-7).p == 1.0);
  CHECK(test_differences(rounding, 0.9e-7).p < 1e-13);
  std::vector<double> once(64, 0.0);  // one rare event
  once[7] = 3.0;
  CHECK(test_differences(once).p == 1.0);
  once[9] = std::numeric_limits<double>::quiet_NaN();
  CHECK(test_differences(once).p == 0.0);
  CHECK(test_differences(constant, std::numeric_limits<double>::quiet_NaN()).p == 0.0);
}

TEST_CASE("Rounding that is allowed widens the question, not more", "[statistics]") {
  // A mean of 1 with deviation 1/4: far from 0, at home within 1.
  std::vector<double> differences;
  Random random(5, 0, 0);
  for (int i = 0; i < 64; ++i) differences.push_back(1.0 + 0.25 * normal_number(random));
  CHECK(test_differences(differences).p < 1e-9);
  CHECK(test_differences(differences, 0.5).p < 1e-9);
  CHECK(test_differences(differences, 1.0).p > 0.01);
  CHECK(test_differences(differences, 2.0).p == 1.0);
}

TEST_CASE("Alarms on distributions far from normal stay below their level", "[statistics]") {
  // Sums of a rare event of probability 1/200, of which a batch of 8 has mostly none: Student's test has no claim here.
  std::uint64_t alarms = 0;
  constexpr int kRuns = 20000;
  for (int run = 0; run < kRuns; ++run) {
    Random random(11, 0, static_cast<std::uint64_t>(run));
    std::vector<double> differences(32);
    for (double& d : differences)
      for (int i = 0; i < 8; ++i)
        d += (random.uniform() < 0.005 ? 40.0 : 0.0) - (random.uniform() < 0.005 ? 40.0 : 0.0);
    alarms += test_differences(differences).p <= 0.05;
  }
  // 4.5 deviations of a binomial count above its level; the bound being one, the true rate is lower.
  CHECK(static_cast<double>(alarms) <= 0.05 * kRuns + 4.5 * std::sqrt(0.05 * 0.95 * kRuns));
  CHECK(alarms > 0);  // the test does see such things
}

TEST_CASE("A shift of the detectable size is seen as often as is said, and Student's p is uniform", "[statistics]") {
  constexpr std::size_t kCount = 64;
  constexpr int kRuns = 4000;
  for (const double level : {1e-3, 1e-7}) {
    const double shift = detectable_mean(2.0, kCount, level, 0.9);
    int seen = 0;
    double sum_p = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      Random random(17, 1, static_cast<std::uint64_t>(run));
      std::vector<double> differences(kCount);
      for (double& d : differences) d = 2.0 * normal_number(random);
      sum_p += test_differences(differences).student_p;
      for (double& d : differences) d += shift;
      seen += test_differences(differences).p <= level;
    }
    CHECK(std::fabs(seen - 0.9 * kRuns) < 4.5 * std::sqrt(0.9 * 0.1 * kRuns));
    CHECK(std::fabs(sum_p / kRuns - 0.5) < 4.5 / std::sqrt(12.0 * kRuns));
  }
  CHECK(std::isinf(detectable_mean(1.0, 16, 1e-9)));  // S is at most 4
  CHECK(detectable_mean(0.0, 64, 1e-7) == 0.0);
}
