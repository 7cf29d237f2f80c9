// SPDX-License-Identifier: MIT
// The build from end to end, and what can be said of a finished tree.
#include "tracer/sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "scenes/error.h"
#include "tracer/tree_references.h"
#include "tracer/tree_reinsert.h"
#include "tracer/tree_select.h"
#include "tracer/tree_split.h"

namespace plumbline {
namespace {

/// Nodes that reinsertion may look at: some two seconds' work. Scenes of up to 10^5 primitives take less.
constexpr std::size_t kReinsertVisits = std::size_t{1} << 24;
/// What kSplitBest tries beside 0, the smallest first: where it splits nothing, the others do not either.
constexpr float kSplitTrials[] = {0.03125f, 0.0625f};
/// Splitting must save at least this share of the cost, for it takes memory.
constexpr double kSplitSaving = 0.02;
/// kSplitBest means 0 for larger scenes: several builds would take too long, and their triangles are seldom long.
constexpr std::uint32_t kMaxSplitSearch = 300'000;

SphereTree build_from(References references, const TreeOptions& options, int threads) {
  std::vector<BinaryNode> nodes = split_references(references, threads);
  reinsert_subtrees(nodes, references, kReinsertVisits);
  fit_balls(nodes, references, threads);
  return select_nodes(nodes, references, options);
}

}  // namespace

SphereTree build_sphere_tree(const Scene& scene, const TreeOptions& options, int threads) {
  if (options.leaf_size < 1 || options.leaf_size > kMaxLeafSize)
    throw InputError("leaf size " + std::to_string(options.leaf_size) + " is out of range: give 1 to " +
                     std::to_string(kMaxLeafSize));
  if (options.width != 0 && options.width < 2)
    throw InputError("tree width " + std::to_string(options.width) + " is out of range: give 0 (any) or 2 and more");
  const bool search = options.split_long == kSplitBest;
  if (!search && !(options.split_long >= 0.0f && std::isfinite(options.split_long)))
    throw InputError("split_long is out of range: give a share of the scene's radius, 0 (none) or -1 (the best)");
  if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  TreeOptions used = options;
  if (search) used.split_long = 0.0f;
  References references = collect_references(scene, used.split_long);
  const std::size_t unsplit = references.list.size();
  SphereTree best = build_from(std::move(references), used, threads);
  if (!search || scene.primitive_count() > kMaxSplitSearch) return best;
  double least = (1.0 - kSplitSaving) * expected_cost(best).total();
  for (const float trial : kSplitTrials) {
    used.split_long = trial;
    references = collect_references(scene, trial);
    if (references.list.size() == unsplit) break;
    SphereTree tree = build_from(std::move(references), used, threads);
    const double cost = expected_cost(tree).total();
    if (!(cost < least)) continue;
    best = std::move(tree);
    least = cost;
  }
  return best;
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
