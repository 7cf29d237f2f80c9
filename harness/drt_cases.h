// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `drt.*` of an engine under test: independent comparison with the reference, convergence; and those that
// ask nobody but the reference: model bias.
#pragma once

#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "harness/independent.h"
#include "harness/picture_engine.h"

namespace plumbline {

/// What is asked: makes the engine under test for a case. The reference's pictures are the truth.
using EngineUnderTest = std::function<MakePictureEngine(CaseContext&)>;

struct DrtOptions {
  std::string name;  ///< of the engine in case names: empty, or "texture" for drt.independent.texture.dof...
  bool pixels_independent = true;  ///< what its random numbers promise (SEMANTICS 7.1)
  double rounding = 0x1p-16;       ///< of its colours, as a share of them
  std::uint32_t single_frames = 12, pair_frames = 3, all_frames = 4;  ///< of each of the 64 batches
};

/// `drt.independent.<effect>.<scene>.<model>` for each effect alone, on the scene that shows it best;
/// `drt.pairs.<effect>_<effect>.<scene>` for all ten pairs and `drt.all.<scene>.<model>` on sphereflake 3, Figure 1,
/// textured blocks in transforms and a Cornell box; `drt.convergence.<effect>.<scene>`.
std::vector<Case> independent_cases(const EngineUnderTest& engine, const DrtOptions& options = {});

/// `drt.model_bias.<effect>.<scene>`: how far `paper` is from `physical`, by the reference.
std::vector<Case> model_bias_cases();

}  // namespace plumbline
