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
  std::uint32_t levels = 7;       ///< 1, 2, 4, ... samples
  std::uint32_t replicates = 32;  ///< of each level, of different frames
  std::uint32_t truth_frames = 4096;
};

struct Convergence {
  /// N, and the mean square error over pixels and channels as a share of a sample's mean variance: 1/N is expected.
  std::vector<double> samples, error;
  std::vector<double> error_of_reference;  ///< of a reference with as many samples
  double slope = 0.0;                      ///< of log error over log N; expected: -1
  double interval = 0.0;                   ///< half the width of its 99 % interval, by jackknife over the replicates
  double p = 1.0;                          ///< that the errors of both engines grow apart with N as they do
};

/// The error that the long reference has itself is subtracted: E |mean_N - truth|^2 = variance/N + variance/M + bias^2.
/// `p` needs no distribution: replicate by replicate the trend of N times the error is set against that of `reference`
/// (differences.h). `truth` and `reference` have seeds of their own.
Convergence measure_convergence(PictureEngine& tested, PictureEngine& reference, PictureEngine& truth,
                                const ConvergenceDepth& depth, const std::function<void(double)>& progress = {});

/// Adds figures and the plot; fails where p is at most kCaseLevel.
void record_convergence(const Convergence& convergence, const std::filesystem::path& folder, const std::string& stem,
                        CaseRecord& record);

}  // namespace plumbline
