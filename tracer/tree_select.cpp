// SPDX-License-Identifier: MIT
// Dynamic programming over (node, nearest kept ancestor), with the ancestor's part taken out of the state: it enters
// the cost only as the product of its squared radius and the number of spheres that stand directly below it. So it is
// enough to know, for each node and each number k, the least cost of what lies below if exactly k kept nodes stand for
// it (as in Ylitie, Karras and Laine 2017), and the width of the tree becomes a bound on k.
#include "tracer/tree_select.h"

#include <algorithm>
#include <array>

#include "scenes/error.h"

namespace plumbline {
namespace {

/// Spheres that may stand for one node: also the largest width that is ever used. 4 bits hold a number below it.
constexpr int kMaxForest = kMaxTreeWidth;
static_assert(kMaxForest <= 16);

/// What is known of a node's subtree while its parent is waited for.
struct Below {
  /// forest[k - 1]: the least cost as k kept nodes, the tests of their own spheres not counted.
  std::array<double, kMaxForest> forest;
  int forests = 0;
  /// The distinct primitives, ascending; primitive_count is above kMaxLeafSize where there are too many for any leaf.
  /// Parts of one split triangle count once: where splitting did not pay, a leaf makes the triangle whole again.
  std::array<std::uint32_t, kMaxLeafSize> primitives;
  int primitive_count = 0;
};

void merge_primitives(const Below& first, const Below& second, Below& result) {
  result.primitive_count = kMaxLeafSize + 1;
  if (first.primitive_count > kMaxLeafSize || second.primitive_count > kMaxLeafSize) return;
  std::array<std::uint32_t, 2 * kMaxLeafSize> both;
  const auto end =
      std::set_union(first.primitives.begin(), first.primitives.begin() + first.primitive_count,
                     second.primitives.begin(), second.primitives.begin() + second.primitive_count, both.begin());
  if (end - both.begin() > kMaxLeafSize) return;
  result.primitive_count = static_cast<int>(end - both.begin());
  std::copy(both.begin(), end, result.primitives.begin());
}

/// How a node's cheapest trees are had.
struct Choice {
  std::uint64_t first_part = 0;  ///< 4 bits for each k of 2 or more: how many of the k come from the first child
  std::uint8_t children = 0;     ///< as a kept node: how many children; 0: a leaf
};

int first_part(const Choice& choice, int k) { return static_cast<int>(choice.first_part >> (4 * (k - 2)) & 15u); }

/// The choice for `node` from what is known of its children, `first` and `second` (null: a single reference), and what
/// is then known of it; `result.primitives` is already there.
Choice choose(const BinaryNode& node, const Below* first, const Below* second, const TreeOptions& options, int width,
              Below& result) {
  Choice choice;
  const double radius2 = static_cast<double>(node.radius) * node.radius;
  double best = std::numeric_limits<double>::infinity();
  if (result.primitive_count <= options.leaf_size)
    best = radius2 * (kLeafCost + result.primitive_count * kPrimitiveCost);
  result.forests = 1;
  if (first) {
    result.forests = std::min(width, first->forests + second->forests);
    for (int k = 2; k <= result.forests; ++k) {
      double least = std::numeric_limits<double>::infinity();
      int from_first = 0;
      for (int i = std::max(1, k - second->forests); i <= std::min(k - 1, first->forests); ++i) {
        const double cost = first->forest[i - 1] + second->forest[k - i - 1];
        if (cost < least) least = cost, from_first = i;
      }
      result.forest[k - 1] = least;
      choice.first_part |= static_cast<std::uint64_t>(from_first) << (4 * (k - 2));
      const double kept = least + k * radius2 * kStepCost;
      if (kept < best) best = kept, choice.children = static_cast<std::uint8_t>(k);
    }
  }
  result.forest[0] = best;
  return choice;
}

struct Emitter {
  const std::vector<BinaryNode>& nodes;
  const References& references;
  const std::vector<Choice>& choices;
  SphereTree& tree;

  /// The k nodes that stand for `at`, in the binary tree's order.
  void collect(std::uint32_t at, int k, std::vector<std::uint32_t>& kept) const {
    if (k == 1) {
      kept.push_back(at);
      return;
    }
    const int from_first = first_part(choices[at], k);
    collect(at + 1, from_first, kept);
    collect(nodes[at].second_child, k - from_first, kept);
  }

  void emit(std::uint32_t at, std::uint32_t to) const {
    const BinaryNode& from = nodes[at];
    TreeNode node;
    node.center = from.center, node.radius = from.radius;
    node.lower = from.box.lower, node.upper = from.box.upper;
    std::vector<std::uint32_t> kept;
    if (choices[at].children == 0) {
      node.first_reference = static_cast<std::uint32_t>(tree.references.size());
      for (std::uint32_t i = 0; i < from.count; ++i) {
        const std::uint32_t primitive = references.list[from.first + i].primitive;
        const auto begin = tree.references.begin() + node.first_reference;
        if (std::find(begin, tree.references.end(), primitive) == tree.references.end())
          tree.references.push_back(primitive);
      }
      node.reference_count = static_cast<std::uint32_t>(tree.references.size()) - node.first_reference;
    } else {
      const int k = choices[at].children, from_first = first_part(choices[at], k);
      collect(at + 1, from_first, kept);
      collect(from.second_child, k - from_first, kept);
      node.first_child = static_cast<std::uint32_t>(tree.nodes.size());
      node.child_count = static_cast<std::uint32_t>(kept.size());
      tree.nodes.resize(tree.nodes.size() + kept.size());
    }
    tree.nodes[to] = node;
    for (std::uint32_t i = 0; i < kept.size(); ++i) emit(kept[i], node.first_child + i);
  }
};

}  // namespace

SphereTree select_nodes(const std::vector<BinaryNode>& nodes, const References& references,
                        const TreeOptions& options) {
  SphereTree tree;
  tree.options = options;
  if (nodes.empty()) return tree;
  const int width = options.width == 0 ? kMaxForest : std::min(options.width, kMaxForest);
  std::vector<Choice> choices(nodes.size());
  // Backwards through a depth-first order the two children of a node are the last two that are still waiting.
  std::vector<Below> waiting;
  for (std::size_t at = nodes.size(); at-- > 0;) {
    Below result;
    if (nodes[at].second_child == 0) {
      result.primitives[0] = references.list[nodes[at].first].primitive;
      result.primitive_count = 1;
      choices[at] = choose(nodes[at], nullptr, nullptr, options, width, result);
    } else {
      PLUMBLINE_ASSERT(waiting.size() >= 2);
      const Below &first = waiting.back(), &second = waiting[waiting.size() - 2];
      merge_primitives(first, second, result);
      choices[at] = choose(nodes[at], &first, &second, options, width, result);
      waiting.resize(waiting.size() - 2);
    }
    waiting.push_back(result);
  }
  tree.nodes.resize(1);
  tree.references.reserve(references.list.size());
  Emitter{nodes, references, choices, tree}.emit(0, 0);
  return tree;
}

}  // namespace plumbline
