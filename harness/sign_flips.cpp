// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/sign_flips.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>

#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::size_t kBins = 1024;        ///< of |S| / sqrt(n) in [0, 1]
constexpr std::uint64_t kEnough = 20;      ///< times that a distance is reached
constexpr std::uint64_t kAtOnce = 64;      ///< flips
constexpr std::uint64_t kSignStream = 41;  ///< of the random signs

struct Distances {
  double kolmogorov = 0.0, anderson = 0.0;
};

class Spread {
 public:
  explicit Spread(const std::vector<std::vector<float>>& differences)
      : differences_(differences), scale_(differences.front().size()) {
    const auto n = static_cast<double>(differences.size());
    // (|S| / sqrt n)^2 of normal differences has the beta distribution with 1/2 and (n - 1) / 2.
    for (std::size_t bin = 0; bin <= kBins; ++bin) {
      const double s = static_cast<double>(bin) / static_cast<double>(kBins);
      expected_[bin] = boost::math::ibeta(0.5, 0.5 * (n - 1.0), s * s);
    }
    for (std::size_t i = 0; i < scale_.size(); ++i) {
      double squares = 0.0;
      for (const auto& batch : differences) squares += static_cast<double>(batch[i]) * static_cast<double>(batch[i]);
      scale_[i] = squares > 0.0 ? static_cast<float>(1.0 / std::sqrt(n * squares)) : 0.0f;
    }
  }

  /// The sizes |S| / sqrt(n) of all pixels under these signs.
  std::vector<float> sizes(const std::vector<float>& signs) const {
    std::vector<float> sums(scale_.size(), 0.0f);
    for (std::size_t b = 0; b < differences_.size(); ++b) {
      const float sign = signs[b];
      const float* from = differences_[b].data();
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += sign * from[i];
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = std::fabs(sums[i]) * scale_[i];
    return sums;
  }

  Distances distances(const std::vector<float>& sizes) const {
    std::vector<std::uint32_t> counts(kBins, 0);
    for (const float size : sizes)
      ++counts[std::min(static_cast<std::size_t>(size * static_cast<float>(kBins)), kBins - 1)];
    const auto m = static_cast<double>(sizes.size());
    Distances result;
    double below = 0.0;
    for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
      below += counts[bin];
      const double f = expected_[bin + 1], away = below / m - f;
      result.kolmogorov = std::max(result.kolmogorov, std::fabs(away));
      if (f > 0.0 && f < 1.0)
        result.anderson += m * away * away / (f * (1.0 - f)) * 0.5 * (expected_[bin + 2] - expected_[bin]);
    }
    result.kolmogorov *= std::sqrt(m);
    return result;
  }

  double p_value(float size) const {
    const double s = std::min(1.0, static_cast<double>(size));
    return boost::math::ibetac(0.5, 0.5 * (static_cast<double>(differences_.size()) - 1.0), s * s);
  }

 private:
  const std::vector<std::vector<float>>& differences_;
  std::vector<float> scale_;
  std::array<double, kBins + 1> expected_{};
};

/// How often a distance was reached, and after how many flips for the kEnough-th time.
struct Reached {
  std::uint64_t times = 0, flips = 0;
  void count(bool reached, std::uint64_t flip) {
    if (times == kEnough) return;
    flips = flip;
    times += reached;
  }
  double p() const {
    if (times == kEnough) return static_cast<double>(times) / static_cast<double>(flips);
    return static_cast<double>(times + 1) / static_cast<double>(flips + 1);
  }
};

std::vector<float> random_signs(std::size_t count, std::uint64_t seed, std::uint64_t flip) {
  Random random(seed, kSignStream, flip);
  std::vector<float> signs;
  std::uint64_t bits = 0;
  for (std::size_t b = 0; b < count; ++b, bits >>= 1) {
    if (b % 64 == 0) bits = random.bits();
    signs.push_back((bits & 1) != 0 ? 1.0f : -1.0f);
  }
  return signs;
}

}  // namespace

SpreadTest test_spread(const std::vector<std::vector<float>>& differences, std::uint64_t seed, std::uint64_t most) {
  PLUMBLINE_ASSERT(differences.size() >= 8);
  SpreadTest test;
  test.values = differences.front().size();
  if (test.values == 0) return test;
  const Spread spread(differences);
  const std::vector<float> sizes = spread.sizes(std::vector<float>(differences.size(), 1.0f));
  for (const float size : sizes) test.p_values.push_back(spread.p_value(size));
  const Distances found = spread.distances(sizes);
  test.kolmogorov = found.kolmogorov;
  test.anderson = found.anderson;

  Reached kolmogorov, anderson;
  std::vector<Distances> flipped(kAtOnce);
  while (test.flips < most && (kolmogorov.times < kEnough || anderson.times < kEnough)) {
    const std::uint64_t count = std::min(kAtOnce, most - test.flips);
    tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t i) {
      flipped[i] = spread.distances(spread.sizes(random_signs(differences.size(), seed, test.flips + i)));
    });
    for (std::uint64_t i = 0; i < count; ++i) {
      kolmogorov.count(flipped[i].kolmogorov >= found.kolmogorov, test.flips + i + 1);
      anderson.count(flipped[i].anderson >= found.anderson, test.flips + i + 1);
    }
    test.flips += count;
  }
  test.p = std::min(1.0, 2.0 * std::min(kolmogorov.p(), anderson.p()));
  return test;
}

}  // namespace plumbline
