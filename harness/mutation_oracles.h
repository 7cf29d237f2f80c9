// SPDX-License-Identifier: GPL-3.0-or-later
// Who can tell that a shader is a mutant: small questions whose answers are known without the shader, from exact
// arithmetic, the reference, C++, or a program in which the mutated file does not stand.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/active_lines.h"
#include "harness/mutants.h"
#include "tracer/gl_context.h"

namespace plumbline {

struct MutationOracle {
  std::string name;                   ///< "hits.compact_sphere_octant"
  std::vector<ActiveLines> programs;  ///< what it runs
  /// What is wrong, in one sentence; empty where nothing is seen. Programs are compiled anew each time, with the
  /// patches of the context that the oracle was made with. Throws EnvironmentError where the driver refuses one.
  std::function<std::string(const Mutant&)> ask;
  bool sees(const Mutant& mutant) const;
};

/// Rays held against the arbiter and Embree, and against programs that do not contain the mutated file.
std::vector<MutationOracle> walk_oracles(GlContext& context);
/// The same of rays that shaders have made, walked for the renderer.
std::vector<MutationOracle> ray_walk_oracles(GlContext& context);
/// Single files: exact and elementary arithmetic, random numbers, sums of samples.
std::vector<MutationOracle> arithmetic_oracles(GlContext& context);
/// Exact scaling, and the triangle test alone.
std::vector<MutationOracle> geometry_oracles(GlContext& context);
/// What is around the walks: another dialect, the pixels of a pass, counts.
std::vector<MutationOracle> pass_oracles(GlContext& context);
/// Ties, rays that end at a surface, and walks without an end.
std::vector<MutationOracle> tie_oracles(GlContext& context);
/// Shading at the borders of its cases, with numbers that are exact.
std::vector<MutationOracle> edge_oracles(GlContext& context);
/// Small pictures, followed by the reference sample by sample.
std::vector<MutationOracle> picture_oracles(GlContext& context);

}  // namespace plumbline
