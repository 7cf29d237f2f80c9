// SPDX-License-Identifier: MIT
// All trees of a scene: over the geometry of the world and of each part, and over the nodes that stand in each space.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scenes/scene.h"
#include "tracer/sphere_tree.h"

namespace plumbline {

/// A node of a tree over scene nodes. A leaf stands for one node of the scene; spheres are refitted when nodes move.
struct GroupNode {
  glm::dvec3 center{0.0};
  double radius = 0.0;            ///< around everything below, in the space of the group
  std::uint32_t first_child = 0;  ///< into GroupTree::nodes; children are contiguous and stand after their parent
  std::uint32_t child_count = 0;  ///< 0: a leaf
  std::uint32_t parent = kNone;
  std::uint32_t node = kNone;  ///< of the scene; leaves only
  bool is_leaf() const { return child_count == 0; }
};

/// The tree over the nodes of one space, built for their rest transforms; empty where the space holds none.
struct GroupTree {
  std::vector<GroupNode> nodes;  ///< nodes[0] is the root
};

struct SceneTree {
  SphereTree world;                 ///< of the primitives in world space
  std::vector<SphereTree> parts;    ///< as Scene::parts
  std::vector<GroupTree> groups;    ///< groups[0]: the nodes of the world; groups[n + 1]: those below node n
  std::vector<std::uint32_t> leaf;  ///< of each scene node: its leaf in the group of the space it stands in
};

/// Builds all trees. `list` root makes each group one node with a leaf for every scene node. Throws as
/// build_sphere_tree does.
SceneTree build_scene_tree(const Scene& scene, const TreeOptions& options = {}, bool list_at_root = false,
                           int threads = 0);

}  // namespace plumbline
