// SPDX-License-Identifier: MIT
// Builds the sphere tree: median splits of the primitives' boxes, and a ball around each node's box.
#include "tracer/sphere_tree.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "scenes/error.h"
#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

struct Box {
  glm::vec3 lower{std::numeric_limits<float>::infinity()}, upper{-std::numeric_limits<float>::infinity()};
  void add(const Box& other) { lower = glm::min(lower, other.lower), upper = glm::max(upper, other.upper); }
  glm::dvec3 middle() const { return 0.5 * (glm::dvec3(lower) + glm::dvec3(upper)); }
};

Box primitive_box(const Scene& scene, std::uint32_t primitive) {
  Box box;
  if (scene.is_triangle(primitive)) {
    for (const glm::vec3& corner : scene.corners(primitive)) box.add({corner, corner});
    return box;
  }
  const Sphere& sphere = scene.sphere(primitive);
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = sum_down(sphere.center[axis], -sphere.radius);
    box.upper[axis] = sum_up(sphere.center[axis], sphere.radius);
  }
  return box;
}

void build_node(const std::vector<Box>& boxes, std::size_t first, std::size_t last, std::size_t node,
                SphereTree& tree) {
  Box box;
  for (std::size_t i = first; i < last; ++i) box.add(boxes[tree.references[i]]);
  tree.nodes[node].lower = box.lower, tree.nodes[node].upper = box.upper;
  tree.nodes[node].center = glm::vec3(box.middle());
  const glm::dvec3 center(tree.nodes[node].center);
  const double distance = glm::length(glm::max(glm::dvec3(box.upper) - center, center - glm::dvec3(box.lower)));
  tree.nodes[node].radius = sum_up(distance * (1.0 + 0x1p-50));  // over the rounding of length()

  if (last - first <= static_cast<std::size_t>(tree.options.leaf_size)) {
    tree.nodes[node].first_reference = static_cast<std::uint32_t>(first);
    tree.nodes[node].reference_count = static_cast<std::uint32_t>(last - first);
    return;
  }
  const glm::dvec3 size = glm::dvec3(box.upper) - glm::dvec3(box.lower);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = first + (last - first) / 2;
  std::sort(tree.references.begin() + first, tree.references.begin() + last, [&](std::uint32_t a, std::uint32_t b) {
    const double ma = boxes[a].middle()[axis], mb = boxes[b].middle()[axis];
    return ma != mb ? ma < mb : a < b;
  });
  const std::size_t child = tree.nodes.size();
  tree.nodes.resize(child + 2);
  tree.nodes[node].first_child = static_cast<std::uint32_t>(child);
  tree.nodes[node].child_count = 2;
  build_node(boxes, first, middle, child, tree);
  build_node(boxes, middle, last, child + 1, tree);
}

}  // namespace

SphereTree build_sphere_tree(const Scene& scene, const TreeOptions& options) {
  if (options.leaf_size < 1 || options.leaf_size > 8) throw InputError("leaf size must be 1 to 8");
  if (options.width != 0 && options.width < 2) throw InputError("tree width must be 0 or at least 2");
  if (!(options.split_long >= 0.0f)) throw InputError("split_long must be 0 or more");
  SphereTree tree;
  tree.options = options;
  std::vector<Box> boxes(scene.primitive_count());
  tree.references.resize(boxes.size());
  std::iota(tree.references.begin(), tree.references.end(), 0u);
  for (const std::uint32_t p : tree.references) boxes[p] = primitive_box(scene, p);
  if (boxes.empty()) return tree;
  tree.nodes.resize(1);
  build_node(boxes, 0, boxes.size(), 0, tree);
  return tree;
}

TreeCost expected_cost(const SphereTree& tree) {
  TreeCost cost;
  if (tree.nodes.empty()) return cost;
  cost.sphere_tests = 1.0;
  for (const TreeNode& node : tree.nodes) {
    const double ratio = static_cast<double>(node.radius) / tree.nodes[0].radius;
    cost.sphere_tests += ratio * ratio * node.child_count;
    cost.primitive_tests += ratio * ratio * node.reference_count;
  }
  return cost;
}

}  // namespace plumbline
