// SPDX-License-Identifier: GPL-3.0-or-later
// A picture whose every pixel is known in closed form, gathered to the points of a profile, and the tests that hold a
// renderer's means and variances to it. Derivations stand in closed_forms.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "harness/compare_pictures.h"

namespace plumbline {

/// What one sample of a pixel is, as a random number: the same in all three channels. A variance of 0 says that every
/// sample is `mean`.
struct SampleMoments {
  double mean = 0.0, variance = 0.0;
  double third = 0.0;      ///< third moment about the mean
  bool two_valued = true;  ///< samples are 0 or 1, nothing between

  static SampleMoments sure(double value) { return {value, 0.0, 0.0, value == 0.0 || value == 1.0}; }
  /// 1 with probability p, in [0, 1]; what rounding puts outside is taken as sure.
  static SampleMoments chance(double p);
  /// From E c, E c^2, E c^3.
  static SampleMoments from_raw(const std::array<double, 3>& raw);
};

/// Whose pixels belong together: pixels of one point have the same place on the profile's axis, nearly or exactly.
inline constexpr std::uint32_t kNoPoint = 0xffffffffu;

struct Profile {
  int width = 0, height = 0;
  std::vector<SampleMoments> pixels;    ///< row by row
  std::vector<std::uint32_t> point_of;  ///< for each pixel its point, or kNoPoint
  std::vector<double> place;            ///< for each point, ascending: where it stands on the plot's axis
  std::vector<double> slope;  ///< for each pixel: d mean / d ln s, s the size that the effect has; may be empty
  /// Motion blur: all samples of a frame share one time. Then the pixels of a point are alike, the frame is the unit of
  /// independence, and pixel i is 1 where the frame's number w is in [from, to).
  struct Interval {
    double from = 0.0, to = 0.0;
  };
  std::vector<Interval> exposed;  ///< for each point; empty: pixels and frames are independent
};

struct PointResult {
  double place = 0.0, expected = 0.0, measured = 0.0;
  double standard_error = 0.0;  ///< of the measured mean, from the exact variance
  double z = 0.0;               ///< deviation in standard errors, its skewness taken out; about normal
  double samples = 0.0;
};

struct ProfileResult {
  std::vector<PointResult> points;  ///< those that were judged: points with few events are joined with a neighbour
  double chi_square = 0.0, degrees = 0.0;
  double common_z = 0.0;  ///< of the sum of all deviations
  double p_worst = 1.0, p_chi_square = 1.0,
         p_common = 1.0;                            ///< p_worst: of the worst point, corrected for their number
  double p = 1.0;                                   ///< of the whole profile: three times the least of these, at most 1
  std::uint64_t sure_pixels = 0, wrong_pixels = 0;  ///< without variance; of these, or by their variance, not as exact
  double detectable_point = 0.0;  ///< bias of the mean of the best-measured point that is seen with probability 0.99
  double detectable_size = 0.0;   ///< relative error of the effect's size that is; 0 where it is not known
  bool passed(double level) const { return wrong_pixels == 0 && p >= level; }
};

/// What rounding may add to a colour of size 1: some 60 operations of 2^-24 (SEMANTICS 6.9 asks 2^-22 of the mean
/// itself).
inline constexpr double kColorRounding = 0x1p-18;

/// Holds a picture to its profile. `independent_pixels`: false for the noise `texture` (SEMANTICS 7.1), where only
/// tests that need no independence between pixels are made.
ProfileResult judge_profile(const Profile& profile, const PictureMoments& picture, bool independent_pixels = true);

}  // namespace plumbline
