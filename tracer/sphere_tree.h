// SPDX-License-Identifier: MIT
// The bounding volume hierarchy on the CPU: a tree of any width whose nodes carry a ball and a box around all that lies
// below them. It is built here and baked into a geometry image (geometry_image.h); nothing here knows of texels.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

struct TreeOptions {
  int leaf_size = 4;        ///< primitives per leaf at most, 1 to 8
  int width = 0;            ///< children per node at most, 2 or more; 0: as many as the cost model likes
  float split_long = 0.0f;  ///< triangles whose longest edge exceeds this share of the scene's radius are split before
                            ///< the build (the references, not the triangles); 0: none
};

/// One node. A leaf has no children. Bounds hold everything below, as exact sets, rounded outwards to float.
struct TreeNode {
  glm::vec3 center{0.0f};
  float radius = 0.0f;                 ///< of a ball that contains all primitives below
  glm::vec3 lower{0.0f}, upper{0.0f};  ///< of a box that contains all primitives below
  std::uint32_t first_child = 0;       ///< into SphereTree::nodes; children are contiguous
  std::uint32_t child_count = 0;
  std::uint32_t first_reference = 0;  ///< into SphereTree::references; leaves only
  std::uint32_t reference_count = 0;
  bool is_leaf() const { return child_count == 0; }
};

struct SphereTree {
  /// nodes[0] is the root; empty for an empty scene.
  std::vector<TreeNode> nodes;
  /// Primitive numbers in leaf order; a split triangle stands in several leaves.
  std::vector<std::uint32_t> references;
  TreeOptions options;
};

/// Builds the tree of all primitives of positive extent. Time O(n log n).
/// Throws InputError for options out of range.
SphereTree build_sphere_tree(const Scene& scene, const TreeOptions& options = {});

/// The expected number of spheres and primitives that a random line through the root's ball meets (the sum of squared
/// radius ratios): the cost that the builder minimises.
struct TreeCost {
  double sphere_tests = 0.0;
  double primitive_tests = 0.0;
};
TreeCost expected_cost(const SphereTree& tree);

}  // namespace plumbline
