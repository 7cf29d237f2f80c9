// SPDX-License-Identifier: MIT
// All trees of a scene: over the geometry of the world and of each part, and over the nodes that stand in each space.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/scene.h"
#include "tracer/sphere_tree.h"

namespace plumbline {

/// Nesting of transforms: taking a ray out again costs the square of it.
inline constexpr std::uint32_t kMaxDepth = 64;

/// A node of a tree over scene nodes. Its ball is refitted when they move; its place in the tree stays.
struct GroupNode {
  glm::dvec3 center{0.0};
  double radius = 0.0;                ///< around all that a ray may hit below, rounding included, in the group's space
  Ball content;                       ///< around all that stands below, without padding
  glm::dvec3 lower{0.0}, upper{0.0};  ///< of a box around the contents of the leaves below
  glm::dvec3 rest_center{0.0};        ///< `center` when the nodes stand at rest: children are ordered by it
  std::uint32_t first_child = 0;      ///< into GroupTree::nodes; children are contiguous and stand after their parent
  std::uint32_t child_count = 0;      ///< 0: a leaf
  std::uint32_t parent = kNone;
  std::uint32_t first_leaf = 0, leaf_count = 0;  ///< into GroupTree::leaves: the scene nodes below
  bool is_leaf() const { return child_count == 0; }
};

/// The tree over the nodes of one space, built for their rest transforms; empty where the space holds none that show
/// anything.
struct GroupTree {
  std::vector<GroupNode> nodes;       ///< nodes[0] is the root
  std::vector<std::uint32_t> leaves;  ///< scene nodes in the order of the tree; leaf i of the tree stands for leaves[i]
  Ball content;         ///< around all that stands in the space (the world's geometry too), without padding
  double extent = 0.0;  ///< the content's radius rounded up to a power of two: what padding is measured by
};

struct SceneTree {
  SphereTree world;               ///< of the primitives in world space
  Ball world_ball;                ///< around them
  std::vector<SphereTree> parts;  ///< as Scene::parts; references are numbers of the scene's primitives
  std::vector<Ball> part_balls;   ///< around them, in their own spaces
  std::vector<Ball> part_reach;   ///< where a ray that has entered them may hit something, padding included
  std::vector<GroupTree> groups;  ///< groups[0]: the nodes of the world; groups[n + 1]: those below node n
  std::vector<std::uint32_t>
      leaf;  ///< of each scene node: its leaf in the group that it stands in; kNone: shows nothing
};

/// Builds all trees. With `list_at_root` each group is one node above a leaf for every scene node, as in the paper.
/// Throws as build_sphere_tree does, and InputError for transforms that nest deeper than kMaxDepth or carry geometry
/// out of what a float holds.
SceneTree build_scene_tree(const Scene& scene, const TreeOptions& options = {}, bool list_at_root = false,
                           int threads = 0);

/// Fits all balls of all groups to the nodes' transforms, as build_scene_tree does.
void refit_all_groups(const Scene& scene, SceneTree& tree);

/// The group in which a scene node stands.
std::uint32_t group_of(const Scene& scene, std::uint32_t node);

/// A node of a group whose ball refit_groups may have changed.
struct GroupPlace {
  std::uint32_t group = 0, node = 0;
};

/// Refits the balls above the nodes `moved`, in their own groups and in all that these stand in. Returns them, without
/// repetition. Sets `rescaled` where a group's `extent` changed, so that everything in it must be padded anew.
std::vector<GroupPlace> refit_groups(const Scene& scene, std::span<const std::uint32_t> moved, SceneTree& tree,
                                     bool& rescaled);

}  // namespace plumbline
