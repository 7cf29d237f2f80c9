// SPDX-License-Identifier: GPL-3.0-or-later
// The independent comparison from end to end: which pictures are asked for, how many samples, and what comes of them.
#pragma once

#include <string>
#include <vector>

#include "harness/compare_pictures.h"
#include "harness/picture_engine.h"

namespace plumbline {

struct Depth {
  int width = 64, height = 48;             ///< pixels
  std::uint32_t batches = 64, frames = 8;  ///< frames of each batch
  double rounding = 0x1p-16;               ///< of the engines' colours, as a share of them
  bool pixels_independent = true;          ///< as CompareOptions
  std::uint64_t most_flips = 0;            ///< as CompareOptions
};

/// "aa", "soft_shadow", "dof", "glossy", "motion_blur".
const std::vector<std::string>& effect_names();
/// All effects off but these, with the scene's own depth and glossiness. Throws InputError for an unknown name.
Effects effects_of(const Scene& scene, const std::vector<std::string>& names, Effects::Model model);

/// The scene with all that effects need and it lacks: a radius for its lights (a twentieth of their distance from what
/// the camera looks at), an aperture (a hundredth of the focus), a glossiness of 0.05, and, where it has no
/// transforms, a movement of all of it by a tenth of its radius while the shutter is open. A scene without lights gets
/// the default one.
Scene with_effects(Scene scene);

/// The scene of a case, with_effects: what load_scene takes, or "mirrors": a sphereflake of mirrors, whose light comes
/// by many bounces.
Scene drt_scene(const std::string& spec);

/// Renders with both makers, with seeds made of `seed`, and compares; the directions are the small changes that the
/// picture can show; together they take about as many samples as one of the engines.
PictureComparison compare_engines(const Scene& scene, const Effects& effects, const Depth& depth, std::uint64_t seed,
                                  const MakePictureEngine& tested, const MakePictureEngine& truth,
                                  const std::function<void(double)>& progress = {});

}  // namespace plumbline
