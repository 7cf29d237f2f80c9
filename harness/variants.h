// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of bake and shader that must not change an answer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tracer/geometry_image.h"
#include "tracer/scene_tree.h"

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

/// The trees that a scene's variants are baked from. Many share one; each is built when it is first asked for.
class VariantTrees {
 public:
  /// `standard`: of the default options. Both must outlive this.
  VariantTrees(const Scene& scene, const SceneTree& standard);
  const SceneTree& of(const BakeOptions& options);

 private:
  struct Built {
    TreeOptions options;
    bool list = false;
    std::unique_ptr<const SceneTree> tree;
  };
  const Scene& scene_;
  const SceneTree& standard_;
  std::vector<Built> built_;
};

}  // namespace plumbline
