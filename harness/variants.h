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

/// All variants, the default left out.
std::vector<Variant> all_variants();

/// "compact_sphere_octant": what the shader is compiled for.
std::string variant_name(const BakeOptions& options);

}  // namespace plumbline
