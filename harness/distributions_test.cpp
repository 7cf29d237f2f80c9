// SPDX-License-Identifier: GPL-3.0-or-later
// Published quantiles, levels by simulation, and what each test sees.
#include "harness/distributions.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "scenes/random.h"

using namespace plumbline;

namespace {

std::vector<double> uniform_numbers_of(std::uint64_t seed, std::size_t count) {
  Random random(seed, 3, 0);
  std::vector<double> numbers(count);
  for (double& u : numbers) u = random.uniform();
  return numbers;
}

}  // namespace

TEST_CASE("Tails of Kolmogorov and of Anderson and Darling have their published quantiles", "[statistics]") {
  constexpr std::size_t kMany = 100'000'000;
  const double root = std::sqrt(static_cast<double>(kMany));
  CHECK(kolmogorov_tail(1.3581 / root, kMany) == Approx(0.05).epsilon(1e-3));
  CHECK(kolmogorov_tail(1.6276 / root, kMany) == Approx(0.01).epsilon(1e-3));
  CHECK(kolmogorov_tail(0.5 / root, kMany) == Approx(0.9639452).epsilon(1e-5));
  // Both series are the same function where one hands over to the other.
  CHECK(kolmogorov_tail((1.0 - 1e-9) / root, kMany) ==
        Approx(kolmogorov_tail((1.0 + 1e-9) / root, kMany)).epsilon(1e-6));
  CHECK(anderson_tail(1.93296) == Approx(0.10).epsilon(2e-3));
  CHECK(anderson_tail(2.49237) == Approx(0.05).epsilon(2e-3));
  CHECK(anderson_tail(3.8781) == Approx(0.01).epsilon(2e-3));
  double before = 1.0;
  for (double z = 0.1; z < 40.0; z += 0.1) {
    CHECK(anderson_tail(z) < before + 1e-12);
    before = anderson_tail(z);
  }
  CHECK(before < 1e-15);
}

TEST_CASE("Uniform numbers pass as often as is said, others do not", "[statistics]") {
  std::vector<double> kolmogorov, anderson, chi, correlation;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const std::vector<double> u = uniform_numbers_of(seed, 256), v = uniform_numbers_of(seed + 1000, 256);
    const UniformTest test = test_uniform(u);
    kolmogorov.push_back(test.kolmogorov_p);
    anderson.push_back(test.anderson_p);
    std::vector<std::uint64_t> counts(16, 0);
    for (const double x : u) ++counts[static_cast<std::size_t>(16.0 * x)];
    chi.push_back(chi_square_p(counts, std::vector<double>(16, 16.0)));
    correlation.push_back(correlation_p(u, v));
  }
  for (const auto* p_values : {&kolmogorov, &anderson, &chi, &correlation})
    CHECK(test_uniform(*p_values).kolmogorov_p > 1e-4);

  std::vector<double> u = uniform_numbers_of(7, 65536);
  std::vector<double> squeezed = u, curved = u;
  for (double& x : squeezed) x = 0.5 + 0.98 * (x - 0.5);
  for (double& x : curved) x = std::pow(x, 1.03);
  CHECK(test_uniform(u).anderson_p > 1e-3);
  CHECK(test_uniform(squeezed).anderson_p < 1e-12);
  CHECK(test_uniform(curved).kolmogorov_p < 1e-3);
  CHECK(correlation_p(u, curved) < 1e-300);
  u[5] = std::numeric_limits<double>::quiet_NaN();
  CHECK(test_uniform(u).kolmogorov_p == 0.0);
  CHECK(correlation_p(u, curved) == 0.0);
  CHECK(test_uniform({0.5, 1.5}).anderson_p == 0.0);
}
