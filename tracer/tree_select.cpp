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

/// forest[k - 1]: the least cost of a node's subtree as k kept nodes, their own spheres' tests not counted.
struct Forests {
  std::array<double, kMaxForest> forest;
  int size = 0;
};

/// How a node's cheapest trees are had.
struct Choice {
  std::uint64_t first_part = 0;  ///< 4 bits for each k of 2 or more: how many of the k come from the first child
  std::uint8_t children = 0;     ///< as a kept node: how many children; 0: a leaf
};

int first_part(const Choice& choice, int k) { return static_cast<int>(choice.first_part >> (4 * (k - 2)) & 15u); }

Choice choose(const BinaryNode& node, const Forests* first, const Forests* second, const TreeOptions& options,
              int width, Forests& result) {
  Choice choice;
  const double radius2 = static_cast<double>(node.radius) * node.radius;
  double best = std::numeric_limits<double>::infinity();
  if (node.count <= static_cast<std::uint32_t>(options.leaf_size))
    best = radius2 * (kLeafCost + node.count * kPrimitiveCost);
  result.size = 1;
  if (first) {
    result.size = std::min(width, first->size + second->size);
    for (int k = 2; k <= result.size; ++k) {
      double least = std::numeric_limits<double>::infinity();
      int from_first = 0;
      for (int i = std::max(1, k - second->size); i <= std::min(k - 1, first->size); ++i) {
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
      node.reference_count = from.count;
      for (std::uint32_t i = 0; i < from.count; ++i)
        tree.references.push_back(references.list[from.first + i].primitive);
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
  std::vector<Forests> waiting;
  for (std::size_t at = nodes.size(); at-- > 0;) {
    Forests result;
    if (nodes[at].second_child == 0) {
      choices[at] = choose(nodes[at], nullptr, nullptr, options, width, result);
    } else {
      PLUMBLINE_ASSERT(waiting.size() >= 2);
      const Forests first = waiting.back(), second = waiting[waiting.size() - 2];
      waiting.resize(waiting.size() - 2);
      choices[at] = choose(nodes[at], &first, &second, options, width, result);
    }
    waiting.push_back(result);
  }
  tree.nodes.resize(1);
  tree.references.reserve(references.list.size());
  Emitter{nodes, references, choices, tree}.emit(0, 0);
  return tree;
}

}  // namespace plumbline
