// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of bake and shader that must not change an answer.
#pragma once

#include <string>
#include <vector>

#include "tracer/geometry_image.h"

namespace plumbline {

struct Variant {
  std::string name;  ///< "paper_sphere_threaded", "leaf_1", ...: part of case names
  std::string what;  ///< one sentence: how it differs from the default
  BakeOptions options;
};

/// All variants, the default left out. `placed`: of scenes with transforms too. Leaving transforms by their inverses is
/// none of them: it may change answers, within bounds.
std::vector<Variant> all_variants(bool placed = false);

/// "compact_sphere_octant": what the shader is compiled for.
std::string variant_name(const BakeOptions& options);

}  // namespace plumbline
