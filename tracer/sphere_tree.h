// SPDX-License-Identifier: MIT
// The bounding volume hierarchy on the CPU: a tree of any width whose nodes carry a ball and a box around all that lies
// below them. It is built here and baked into a geometry image (geometry_image.h); nothing here knows of texels.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

/// TreeOptions::split_long: build with several values and keep the tree that the cost model likes best.
inline constexpr float kSplitBest = -1.0f;

struct TreeOptions {
  int leaf_size = 8;  ///< primitives per leaf at most, 1 to kMaxLeafSize; few leaves are as large as they may be
  int width = 0;      ///< children per node at most, 2 or more; 0: as many as the cost model likes
  /// Triangles whose longest edge exceeds this share of the scene's radius are split before the build (the references,
  /// not the triangles); 0: none. Splitting never changes an answer, see tree_references.cpp. SphereTree::options tells
  /// what kSplitBest has chosen.
  float split_long = kSplitBest;
  bool operator==(const TreeOptions&) const = default;
};

/// One node. A leaf has no children. Bounds hold everything below, as exact sets, rounded outwards to float; of a split
/// triangle they hold the parts that stand below, and the parts cover the triangle.
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
  /// Primitive numbers in leaf order; a split triangle stands in several leaves, at most once in each.
  std::vector<std::uint32_t> references;
  TreeOptions options;
};

/// Builds the tree of all primitives of positive extent (a sphere of radius above 0, a triangle whose area is not
/// exactly 0). Time O(n log n). `threads` 0: one per core; their number does not change the tree, bit for bit. Throws
/// InputError for options out of range, and for coordinates that are not finite or whose bounds have no float.
SphereTree build_sphere_tree(const Scene& scene, const TreeOptions& options = {}, int threads = 0);

/// The cost model, in units of one sphere test. A random line that meets a ball of radius R meets one of radius r
/// inside it with probability r^2 / R^2, so a tree costs the sum over
///   all nodes but the root: (radius of the parent)^2 * kStepCost, for they are tested when the parent is hit, and
///   all leaves: radius^2 * (kLeafCost + n * kPrimitiveCost), for entering it and testing its n primitives.
/// Measured with the production shader on ten scenes, the optimum is flat: any kLeafCost from 0.5 to 4 with any
/// kPrimitiveCost from 0.5 to 2 is within 2 % of the best. Of the options, by the mean of twelve scenes, not splitting
/// takes 1.18 times as long (1.5 to 1.9 times where triangles are long and thin, nothing elsewhere), leaves of up to 1,
/// 2 and 4 take 1.18, 1.05 and 1.015 times as long, and a width of 2 takes 1.02 times as long.
inline constexpr double kStepCost = 1.0;
inline constexpr double kLeafCost = 1.0;
inline constexpr double kPrimitiveCost = 1.0;
/// Bounds on TreeOptions. Wider nodes are never built: the cost model has no use for them.
inline constexpr int kMaxTreeWidth = 16;
inline constexpr int kMaxLeafSize = 8;

/// The expected number of things that a random line through the root's ball meets: what the builder minimises.
struct TreeCost {
  double sphere_tests = 0.0;  ///< the root's own test included
  double leaves = 0.0;        ///< leaves whose sphere is hit
  double primitive_tests = 0.0;
  double total() const { return kStepCost * sphere_tests + kLeafCost * leaves + kPrimitiveCost * primitive_tests; }
};
TreeCost expected_cost(const SphereTree& tree);

/// The tree's shape in numbers.
struct TreeStats {
  std::size_t nodes = 0, leaves = 0, references = 0;
  int depth = 0;                        ///< nodes on the longest way from the root to a leaf; 0: empty
  std::vector<std::size_t> widths;      ///< widths[k]: inner nodes with k children
  std::vector<std::size_t> leaf_sizes;  ///< leaf_sizes[n]: leaves with n references
};
TreeStats tree_stats(const SphereTree& tree);

}  // namespace plumbline
