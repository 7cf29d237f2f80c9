// SPDX-License-Identifier: GPL-3.0-or-later
// Are the p-values of many pixels together spread as they should be? Each pixel's p-value by Student's test is uniform
// only if its batches are normal, and pixels may depend on each other (a frame has one time, a noise texture is
// shared), so no table says how far their distribution may be from uniform. The signs say it: if both sources are the
// same, the differences of a whole batch, all pixels together, are as likely with the opposite sign. So the
// Kolmogorov-Smirnov and Anderson-Darling distances are computed again under random signs of the batches, and the share
// of flips at which they are at least as large is an exact p-value, whatever the distribution and dependence.
#pragma once

#include <cstdint>
#include <vector>

namespace plumbline {

struct SpreadTest {
  std::size_t values = 0;        ///< pixels
  double kolmogorov = 0.0;       ///< sqrt(values) times the greatest distance of the distributions
  double anderson = 0.0;         ///< the weighted mean square of the distance, which sees the tails
  double p = 1.0;                ///< of both together: twice the smaller
  std::uint64_t flips = 0;       ///< that it took
  std::vector<double> p_values;  ///< Student's, of each pixel
};

/// `differences[b][i]` is that of batch b and pixel i; at least 8 batches. Flips until both distances have been reached
/// 20 times (Besag and Clifford 1991), or `most` times: the least p is 2 / (most + 1).
SpreadTest test_spread(const std::vector<std::vector<float>>& differences, std::uint64_t seed, std::uint64_t most);

}  // namespace plumbline
