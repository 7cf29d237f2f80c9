// SPDX-License-Identifier: MIT
// Reinsertion: a branch-and-bound search for the best place of each subtree.
#include "tracer/tree_reinsert.h"

#include <algorithm>

#include "scenes/error.h"

namespace plumbline {
namespace {

/// A pass that lowers the sum by less than this share is the last.
constexpr double kWorthwhile = 0.002;
/// Nodes looked at for one place. A few dozen do in ordinary scenes; where everything lies within everything else, as
/// in a nest of concentric spheres, bounds exclude nothing and each search would look at the whole tree.
constexpr std::size_t kMaxVisitsPerPlace = 1000;

struct LinkedNode {
  Box box;
  double cost = 0.0;  ///< squared diagonal of the box
  std::uint32_t parent = kNone;
  std::uint32_t child[2] = {kNone, kNone};
  std::uint32_t reference = kNone;  ///< of those without children
  int height = 0;                   ///< 0: no children
};

Box joined(const Box& a, const Box& b) {
  Box box = a;
  box.add(b);
  return box;
}

bool same_box(const Box& a, const Box& b) { return a.lower == b.lower && a.upper == b.upper; }

class Optimizer {
 public:
  explicit Optimizer(const std::vector<BinaryNode>& nodes) : nodes_(nodes.size()) {
    for (std::uint32_t i = static_cast<std::uint32_t>(nodes.size()); i-- > 0;) {
      LinkedNode& node = nodes_[i];
      node.box = nodes[i].box;
      node.cost = node.box.diagonal2();
      if (nodes[i].second_child == 0) {
        node.reference = nodes[i].first;
        continue;
      }
      node.child[0] = i + 1, node.child[1] = nodes[i].second_child;
      for (const std::uint32_t child : node.child) {
        nodes_[child].parent = i;
        node.height = std::max(node.height, nodes_[child].height + 1);
      }
    }
  }

  /// Tries all subtrees, the largest first, until `max_visits` nodes in all have been looked at.
  void pass(std::size_t max_visits) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 1; i < nodes_.size(); ++i)
      if (nodes_[i].parent != 0) order.push_back(i);
    std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      return nodes_[a].cost != nodes_[b].cost ? nodes_[a].cost > nodes_[b].cost : a < b;
    });
    for (const std::uint32_t node : order) {
      if (visits_ >= max_visits) return;
      if (nodes_[node].parent == 0) continue;  // since this pass began
      const std::uint32_t place = best_place(node);
      if (place != kNone) move(node, place);
    }
  }

  std::size_t visits() const { return visits_; }

  double cost() const {
    double sum = 0.0;
    for (const LinkedNode& node : nodes_)
      if (node.height > 0) sum += node.cost;
    return sum;
  }

  void write(std::vector<BinaryNode>& nodes, References& references) const {
    std::vector<Reference> list;
    list.reserve(references.list.size());
    nodes.clear();
    nodes.reserve(nodes_.size());
    write_below(0, references.list, nodes, list);
    references.list = std::move(list);
  }

 private:
  std::uint32_t sibling(std::uint32_t node) const {
    const LinkedNode& parent = nodes_[nodes_[node].parent];
    return parent.child[parent.child[0] == node ? 1 : 0];
  }

  int depth(std::uint32_t node) const {
    int depth = 0;
    for (; nodes_[node].parent != kNone; node = nodes_[node].parent) ++depth;
    return depth;
  }

  /// The node to be paired with `node` so that the sum of costs falls most; kNone where it stands best.
  ///
  /// Taking `node` out removes its parent, a gain of the parent's cost, and shrinks the ancestors above up to the first
  /// that holds its new place as well. Putting it beside `place` adds a parent around both, and grows all between.
  std::uint32_t best_place(std::uint32_t node) {
    best_gain_ = 0.0, best_place_ = kNone;
    stop_at_ = visits_ + kMaxVisitsPerPlace;
    const std::uint32_t parent = nodes_[node].parent;
    double freed = nodes_[parent].cost;
    Box left = nodes_[sibling(node)].box;  // what remains below `below` without the node
    search(node, sibling(node), freed);
    for (std::uint32_t below = parent, pivot = nodes_[parent].parent; pivot != kNone && visits_ < stop_at_;
         below = pivot, pivot = nodes_[pivot].parent) {
      search(node, sibling(below), freed);
      left.add(nodes_[sibling(below)].box);
      freed += nodes_[pivot].cost - left.diagonal2();
      // beside all of the pivot that remains, under a parent as large as the pivot was
      if (pivot != 0 && freed - nodes_[pivot].cost > best_gain_ && fits(node, pivot))
        best_gain_ = freed - nodes_[pivot].cost, best_place_ = pivot;
    }
    return best_place_;
  }

  bool fits(std::uint32_t node, std::uint32_t place) const {
    return depth(place) + 1 + std::max(nodes_[node].height, nodes_[place].height) < kMaxBinaryDepth;
  }

  /// Looks at `root` and all below it, the most promising first. `freed`: the gain before anything is added or grown.
  void search(std::uint32_t node, std::uint32_t root, double freed) {
    const double least_added = nodes_[node].cost;  // a parent of `node` and anything is no smaller
    queue_.assign(1, {freed, root});
    while (!queue_.empty() && visits_ < stop_at_) {
      ++visits_;
      std::pop_heap(queue_.begin(), queue_.end());
      const auto [gain, place] = queue_.back();
      queue_.pop_back();
      if (gain - least_added <= best_gain_) return;
      const LinkedNode& at = nodes_[place];
      const double added = joined(at.box, nodes_[node].box).diagonal2();
      if (gain - added > best_gain_ && place != sibling(node) && fits(node, place))
        best_gain_ = gain - added, best_place_ = place;
      const double gain_below = gain - (added - at.cost);
      if (at.height == 0 || gain_below - least_added <= best_gain_) continue;
      for (const std::uint32_t child : at.child) {
        queue_.emplace_back(gain_below, child);
        std::push_heap(queue_.begin(), queue_.end());
      }
    }
  }

  /// Takes `node` out and pairs it with `place`; its parent, free after the first, is the new parent of both.
  void move(std::uint32_t node, std::uint32_t place) {
    const std::uint32_t parent = nodes_[node].parent, other = sibling(node), above = nodes_[parent].parent;
    replace_child(above, parent, other);
    refresh(above);
    replace_child(nodes_[place].parent, place, parent);
    nodes_[parent].child[0] = place, nodes_[parent].child[1] = node;
    nodes_[place].parent = nodes_[node].parent = parent;
    refresh(parent);
  }

  void replace_child(std::uint32_t parent, std::uint32_t child, std::uint32_t by) {
    nodes_[parent].child[nodes_[parent].child[0] == child ? 0 : 1] = by;
    nodes_[by].parent = parent;
  }

  /// Corrects boxes and heights from `node` up to where nothing changes.
  void refresh(std::uint32_t node) {
    for (bool first = true; node != kNone; node = nodes_[node].parent, first = false) {
      LinkedNode& at = nodes_[node];
      const LinkedNode &a = nodes_[at.child[0]], &b = nodes_[at.child[1]];
      const Box box = joined(a.box, b.box);
      const int height = 1 + std::max(a.height, b.height);
      if (!first && height == at.height && same_box(box, at.box)) return;
      at.box = box, at.cost = box.diagonal2(), at.height = height;
    }
  }

  std::uint32_t write_below(std::uint32_t from, const std::vector<Reference>& list, std::vector<BinaryNode>& nodes,
                            std::vector<Reference>& ordered) const {
    const std::uint32_t at = static_cast<std::uint32_t>(nodes.size());
    BinaryNode node;
    node.box = nodes_[from].box;
    node.first = static_cast<std::uint32_t>(ordered.size());
    nodes.push_back(node);
    if (nodes_[from].height == 0) {
      ordered.push_back(list[nodes_[from].reference]);
    } else {
      write_below(nodes_[from].child[0], list, nodes, ordered);
      nodes[at].second_child = write_below(nodes_[from].child[1], list, nodes, ordered);
    }
    nodes[at].count = static_cast<std::uint32_t>(ordered.size()) - node.first;
    return at;
  }

  std::vector<LinkedNode> nodes_;
  std::vector<std::pair<double, std::uint32_t>> queue_;  ///< a heap, kept so that its memory is
  std::size_t visits_ = 0, stop_at_ = 0;
  double best_gain_ = 0.0;
  std::uint32_t best_place_ = kNone;
};

}  // namespace

void reinsert_subtrees(std::vector<BinaryNode>& nodes, References& references, std::size_t max_visits) {
  if (nodes.size() < 5) return;  // two references or fewer: nothing to move
  Optimizer optimizer(nodes);
  nodes = {};  // its memory; written anew below
  double cost = optimizer.cost();
  while (optimizer.visits() < max_visits) {
    optimizer.pass(max_visits);
    const double lower = optimizer.cost();
    if (!(lower < (1.0 - kWorthwhile) * cost)) break;
    cost = lower;
  }
  optimizer.write(nodes, references);
}

}  // namespace plumbline
