// SPDX-License-Identifier: GPL-3.0-or-later
// The paired comparison (design section 7): the reference follows each of the tracer's samples, with the numbers that
// the tracer drew, step by step along the tapped rays. Each step agrees within its bound (paired_bounds.h), or it is
// the first event that differs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "harness/session.h"
#include "harness/tapped_samples.h"
#include "reference/path_steps.h"

namespace plumbline {

/// The links of a sample's chain.
enum class PairedStep : std::uint8_t { primary, hit, shadow, reflected, refracted, color };
inline constexpr std::size_t kPairedSteps = 6;
const char* name_of(PairedStep step);

enum class SampleVerdict : std::uint8_t {
  agree,  ///< every step within its bound
  apart,  ///< hangs on a tie, on a grazing ray, or on a choice that 32 bits do not settle
  differ,
};

/// What became of one sample.
struct PairedSample {
  std::uint32_t x = 0, y = 0, frame = 0;
  SampleVerdict verdict = SampleVerdict::agree;
  double error_in_bounds = 0.0;    ///< of the colour: largest of the channels
  double largest = 0.0;            ///< error over bound of all its steps
  glm::dvec3 told{0.0}, own{0.0};  ///< colour of the tracer; of the reference with the same numbers
  double end_to_end = 0.0;         ///< largest difference to the reference's own sample of the same numbers
  std::uint32_t ray = 0;           ///< where it differs, or why it stands apart: number of the ray
  PairedStep step = PairedStep::color;
  std::string event{};   ///< one sentence
  std::string replay{};  ///< explains the ray of the event
};

struct PairedTally {
  std::uint64_t samples = 0, apart = 0, differ = 0;
  std::uint64_t rays = 0, shadow_rays = 0;
  std::uint64_t above_tenth = 0;               ///< agreeing samples whose colour uses more than 10 % of its bound
  std::array<double, kPairedSteps> largest{};  ///< of each kind of step that agreed, error over bound
  std::array<std::uint64_t, kVerdictCount> verdicts{};  ///< of all rays
  std::vector<double> end_to_end;                       ///< of each sample that agrees
  std::vector<PairedSample> kept;                       ///< the first samples that differ, then some that stand apart
  std::vector<glm::dvec3> tracer, reference;            ///< by pixel: sums of PairedSample::told and own
  std::vector<float> error_in_bounds;                   ///< by pixel: the largest of its samples; the picture's size
  std::vector<std::uint8_t> verdict;                    ///< by pixel: the gravest SampleVerdict
};

/// Compares all samples of a batch. `prepared` is the stage's scene as the tracer saw it (lights, camera, effects,
/// time).
void compare_samples(Session& session, const Stage& stage, const PreparedScene& prepared, const TappedSamples& samples,
                     std::uint64_t seed, PairedTally& tally);

}  // namespace plumbline
