// SPDX-License-Identifier: GPL-3.0-or-later
// Independent comparison (design section 7): do two engines take their samples from the same distribution? Both are
// asked for batches of frames; every test is one on symmetric differences (differences.h, sign_flips.h), so frames are
// the unit of independence and pixels may depend on each other.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/picture_engine.h"

namespace plumbline {

/// False alarms are budgeted at one in all nights of a year, over at most this many comparisons a night.
inline constexpr int kMostComparisons = 256;
inline constexpr double kCaseLevel = 1.0 / 365.0 / kMostComparisons;

/// `batches` renderings of `frames` frames each, from frame 0 on.
std::vector<PictureMoments> take_batches(PictureEngine& engine, std::uint32_t batches, std::uint32_t frames,
                                         const std::function<void(double)>& progress = {});

/// A way in which a picture may be wrong, made by rendering it so: what it is compared along.
struct Direction {
  std::string name;                ///< "light radius"
  std::string unit;                ///< of what is fitted: "%", "pixels"
  double scale = 1.0;              ///< units in one step of `change`
  std::vector<glm::dvec3> change;  ///< of the mean picture, in one step
  std::vector<glm::dvec3> weight;  ///< of each pixel, from other samples than `change`
};

struct CompareOptions {
  double level = kCaseLevel;         ///< family-wise, over all tests of the comparison
  std::vector<glm::dvec3> rounding;  ///< how far a pixel's means may differ by rounding; empty: not at all
  bool pixels_independent = true;    ///< promised by both engines: dependence of neighbours is then an error
  int tile = 8;                      ///< pixels
  std::uint64_t seed = 0;            ///< of the random signs
  std::vector<Direction> directions;
  std::uint64_t most_flips = 0;  ///< 0: as many as the level needs
};

/// Tests of one kind, corrected by Bonferroni for their number.
struct TestFamily {
  std::string name;         ///< "pixels"
  std::string sees;         ///< what failure it is there for
  std::uint64_t tests = 0;  ///< 0: it could not be asked
  double level = 0.0;       ///< of all its tests together
  double p = 1.0;           ///< the smallest times their number
  std::string worst;        ///< where, and what was found there
  std::string would_see;    ///< with probability 0.99; empty where that is not a number
  bool alarm() const { return tests > 0 && !(p > level); }
};

/// How far the tested engine is from the truth along a direction.
struct Fit {
  std::string name, unit;
  double value = 0.0;       ///< units; 0: nothing is wrong
  double interval = 0.0;    ///< half the width of the 99 % interval
  double detectable = 0.0;  ///< units, with probability 0.99 at the level of the family
};

struct PictureComparison {
  int width = 0, height = 0;
  std::uint32_t batches = 0, frames = 0;         ///< frames of each batch
  glm::dvec3 mean_tested{0.0}, mean_truth{0.0};  ///< of the whole picture
  double whole_student_p = 1.0;                  ///< Student's, of the whole picture's brightness: uniform
  double whole_detectable = 0.0;                 ///< bias of the whole picture's mean, as a share of it
  std::vector<glm::dvec3> tested, truth;         ///< mean pictures over all batches, linear colour
  std::vector<float> z;          ///< of each pixel's brightness; 0 where there is no noise and no difference
  std::vector<double> p_values;  ///< of the pixels that have noise enough
  std::vector<TestFamily> families;
  std::vector<Fit> fits;
  bool alarm() const;
  double p() const;             ///< of the whole comparison: alarm if it is at most the level
  std::string verdict() const;  ///< one line: the families that raise alarms, or that none does
  double level = 0.0;
};

/// Both have the same number of batches, at least 8, of the same size.
PictureComparison compare_pictures(const std::vector<PictureMoments>& tested, const std::vector<PictureMoments>& truth,
                                   const CompareOptions& options);

}  // namespace plumbline
