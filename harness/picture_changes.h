// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures that are wrong on purpose, in one named way: of the scene, of the effects, or of the random numbers. Small
// changes are the directions along which comparisons look; those of picture_faults.h must be found.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/compare_pictures.h"
#include "harness/picture_engine.h"

namespace plumbline {

struct PictureChange {
  std::string name;                            ///< "light radius"
  std::string what;                            ///< one sentence
  std::string unit;                            ///< of the change, "%"; faults: empty
  double size = 0.0;                           ///< units that it changes
  std::function<void(Scene&, Effects&)> edit;  ///< empty: both stay as they are
  /// Instead of own.fill: own are the engine's own numbers. Empty: those.
  std::function<void(const RandomSource& own, const Draw&, std::span<double>)> fill;
  std::function<double(double)> time;                 ///< what becomes of the number of a frame's time; empty: the same
  std::function<std::uint32_t(std::uint32_t)> frame;  ///< whose numbers a frame takes; empty: its own
  bool eight_bits = false;                            ///< frames are averaged in 8 bits
};

/// The reference renderer with the change made.
std::unique_ptr<PictureEngine> changed_engine(const PictureChange& change, const Scene& scene,
                                              const PictureSettings& settings);

/// The small changes that can be seen in this picture: those of parameters whose effects are switched on.
std::vector<PictureChange> small_changes(const Scene& scene, const Effects& effects);

/// The directions of these changes, by the reference renderer. `frames` of its samples go into each, in two halves with
/// different numbers: one for the weights, one for the change, so that its noise does not make the fit too small. A
/// change that the picture does not show is left out.
std::vector<Direction> directions_of(const std::vector<PictureChange>& changes, const Scene& scene,
                                     const PictureSettings& settings, std::uint32_t frames);

/// Radii of all lights times `by`; all glossiness times `by`.
void scale_lights(Scene& scene, float by);
void scale_glossy(Scene& scene, Effects& effects, float by);
/// The place in the pixel moved by so many pixels.
PictureChange pixel_shift(const std::string& name, double x, double y);

}  // namespace plumbline
