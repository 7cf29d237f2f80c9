// SPDX-License-Identifier: GPL-3.0-or-later
// Convergence: the mean square error of N samples against a long reference falls as 1/N. A bias, or samples that depend
// on each other, bend the line.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/picture_engine.h"
#include "reports/record.h"

namespace plumbline {

struct ConvergenceDepth {
  std::uint32_t levels = 7;      ///< 1, 2, 4, ... samples
  std::uint32_t replicates = 8;  ///< of each level, of different frames
  std::uint32_t truth_frames = 2048;
};

struct Convergence {
  std::vector<double> samples, error;  ///< N, and the mean square error over pixels and channels
  std::vector<double> deviation;       ///< of the logarithm of each error
  double slope = 0.0;                  ///< of log error over log N; expected: -1
  double interval = 0.0;               ///< half the width of its 99 % interval
  double p = 1.0;                      ///< that a right engine's slope is at least as far from -1
};

/// The error that the long reference has itself is subtracted: E |mean_N - truth|^2 = variance/N + variance/M + bias^2.
Convergence measure_convergence(PictureEngine& tested, PictureEngine& truth, const ConvergenceDepth& depth,
                                const std::function<void(double)>& progress = {});

/// Least squares, weighted by the errors' own deviations (`freedom` degrees of freedom stand behind these).
void fit_slope(Convergence& convergence, double freedom);

/// Adds figures and the plot; fails where p is at most kCaseLevel.
void record_convergence(const Convergence& convergence, const std::filesystem::path& folder, const std::string& stem,
                        CaseRecord& record);

}  // namespace plumbline
