// SPDX-License-Identifier: MIT
// The build from end to end, and what can be said of a finished tree.
#include "tracer/sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "scenes/error.h"
#include "tracer/tree_references.h"
#include "tracer/tree_select.h"
#include "tracer/tree_split.h"

namespace plumbline {

SphereTree build_sphere_tree(const Scene& scene, const TreeOptions& options, int threads) {
  if (options.leaf_size < 1 || options.leaf_size > 8)
    throw InputError("leaf size " + std::to_string(options.leaf_size) + " is out of range: give 1 to 8");
  if (options.width != 0 && options.width < 2)
    throw InputError("tree width " + std::to_string(options.width) + " is out of range: give 0 (any) or 2 and more");
  if (!(options.split_long >= 0.0f && std::isfinite(options.split_long)))
    throw InputError("split_long is out of range: give 0 (none) or a share of the scene's radius");
  if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  References references = collect_references(scene, options.split_long);
  std::vector<BinaryNode> nodes = split_references(references, threads);
  if (!nodes.empty()) fit_balls(nodes, references, threads);
  return select_nodes(nodes, references, options);
}

TreeCost expected_cost(const SphereTree& tree) {
  TreeCost cost;
  if (tree.nodes.empty()) return cost;
  cost.sphere_tests = 1.0;
  for (const TreeNode& node : tree.nodes) {
    const double ratio = static_cast<double>(node.radius) / tree.nodes[0].radius;
    cost.sphere_tests += ratio * ratio * node.child_count;
    if (node.is_leaf()) cost.leaves += ratio * ratio;
    cost.primitive_tests += ratio * ratio * node.reference_count;
  }
  return cost;
}

TreeStats tree_stats(const SphereTree& tree) {
  TreeStats stats;
  stats.nodes = tree.nodes.size();
  stats.references = tree.references.size();
  const auto count_in = [](std::vector<std::size_t>& histogram, std::size_t value) {
    if (histogram.size() <= value) histogram.resize(value + 1, 0);
    ++histogram[value];
  };
  std::vector<int> depth(tree.nodes.size(), 1);  // children stand behind their parents
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const TreeNode& node = tree.nodes[i];
    stats.depth = std::max(stats.depth, depth[i]);
    for (std::uint32_t k = 0; k < node.child_count; ++k) depth[node.first_child + k] = depth[i] + 1;
    if (node.is_leaf()) ++stats.leaves;
    count_in(node.is_leaf() ? stats.leaf_sizes : stats.widths,
             node.is_leaf() ? node.reference_count : node.child_count);
  }
  return stats;
}

}  // namespace plumbline
