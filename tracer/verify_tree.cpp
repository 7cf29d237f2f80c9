// SPDX-License-Identifier: MIT
// The image against the trees on the CPU: each copy of each region is the depth-first walk of its trees, children front
// to back for the copy's octant.
#include <algorithm>
#include <optional>

#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// A region's trees as one: the primitives' and the group's, either of which may be missing.
class RegionTrees {
 public:
  RegionTrees(const SphereTree* tree, std::uint32_t first_primitive, const GroupTree* group,
              std::uint32_t primitive_count)
      : tree_(tree), group_(group), first_primitive_(first_primitive), primitive_count_(primitive_count) {
    split_ = tree_ != nullptr ? static_cast<std::uint32_t>(tree_->nodes.size()) : 0;
    count_ = split_ + (group_ != nullptr ? static_cast<std::uint32_t>(group_->nodes.size()) : 0);
    size_.assign(count_, 1);
    for (std::uint32_t n = count_; n-- > 0;)  // children stand behind their parents
      for (std::uint32_t c = 0; c < child_count(n); ++c) size_[n] += size_[first_child(n) + c];
  }

  std::uint32_t count() const { return count_; }
  /// Nodes of the subtree.
  std::uint32_t size(std::uint32_t n) const { return size_[n]; }
  std::vector<std::uint32_t> roots() const {
    std::vector<std::uint32_t> roots;
    if (split_ > 0) roots.push_back(0);
    if (count_ > split_) roots.push_back(split_);
    return roots;
  }
  bool is_leaf(std::uint32_t n) const { return child_count(n) == 0; }
  std::uint32_t payload(std::uint32_t n) const {
    if (n < split_) return first_primitive_ + tree_->nodes[n].first_reference;
    return primitive_count_ + group_->leaves[group_->nodes[n - split_].first_leaf];
  }
  /// Front to back for directions of an octant; where that is nothing, as they stand.
  std::vector<std::uint32_t> children(std::uint32_t n, std::optional<unsigned> octant) const {
    std::vector<std::uint32_t> list(child_count(n));
    for (std::uint32_t c = 0; c < list.size(); ++c) list[c] = first_child(n) + c;
    if (!octant) return list;
    const glm::dvec3 along((*octant & 1u) != 0 ? -1.0 : 1.0, (*octant & 2u) != 0 ? -1.0 : 1.0,
                           (*octant & 4u) != 0 ? -1.0 : 1.0);
    std::stable_sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
      return glm::dot(place(a), along) < glm::dot(place(b), along);
    });
    return list;
  }

 private:
  std::uint32_t child_count(std::uint32_t n) const {
    return n < split_ ? tree_->nodes[n].child_count : group_->nodes[n - split_].child_count;
  }
  std::uint32_t first_child(std::uint32_t n) const {
    return n < split_ ? tree_->nodes[n].first_child : split_ + group_->nodes[n - split_].first_child;
  }
  glm::dvec3 place(std::uint32_t n) const {
    return n < split_ ? glm::dvec3(tree_->nodes[n].center) : group_->nodes[n - split_].rest_center;
  }

  const SphereTree* tree_;
  const GroupTree* group_;
  const std::uint32_t first_primitive_, primitive_count_;
  std::uint32_t split_ = 0, count_ = 0;  ///< nodes of the group follow those of the tree
  std::vector<std::uint32_t> size_;
};

void check_copy(const Examination& e, const RegionTrees& trees, const CopyView& copy, std::optional<unsigned> octant,
                Recorder& recorder) {
  const auto find = [&](std::uint32_t i, const std::string& message) {
    recorder.add(Rule::thread, copy.nodes.empty() ? unit_texel(e.image, copy.start) : node_texel(e, copy, i), i,
                 "node " + std::to_string(i) + ": " + message);
  };
  if (copy.nodes.size() != trees.count())
    return find(0, "the copy holds " + std::to_string(copy.nodes.size()) + " nodes, its trees " +
                       std::to_string(trees.count()));
  std::vector<std::uint32_t> waiting = trees.roots();
  std::reverse(waiting.begin(), waiting.end());
  for (std::uint32_t i = 0; i < copy.nodes.size(); ++i) {
    const std::uint32_t n = waiting.back();
    waiting.pop_back();
    const NodeView& node = copy.nodes[i];
    if (trees.is_leaf(n)) {
      if (!node.is_leaf || node.payload != trees.payload(n))
        find(i, "the tree has a leaf here that leads to " + std::to_string(trees.payload(n)));
      continue;
    }
    if (node.is_leaf)
      find(i, "the tree has an inner node here");
    else if (node.end != i + trees.size(n))
      find(i, "the way out leads to node " + std::to_string(node.end) + ", in the tree to node " +
                  std::to_string(i + trees.size(n)));
    const std::vector<std::uint32_t> children = trees.children(n, octant);
    waiting.insert(waiting.end(), children.rbegin(), children.rend());
  }
}

}  // namespace

void check_tree(Examination& e) {
  const SceneTree& tree = *e.tree;
  const Scene& scene = *e.scene;
  if (tree.groups.size() != scene.nodes.size() + 1 || tree.parts.size() != scene.parts.size() ||
      e.image.transform_count != scene.nodes.size()) {
    leave_undecided(e, {Rule::thread});  // check_scene has said so
    return;
  }
  // Where each part's primitives start: they are stored in the order of their trees.
  std::vector<std::uint32_t> first{0};
  first.push_back(static_cast<std::uint32_t>(tree.world.references.size()));
  for (const SphereTree& part : tree.parts)
    first.push_back(first.back() + static_cast<std::uint32_t>(part.references.size()));
  for (const RegionView& region : e.regions) {
    const SphereTree* primitives = nullptr;
    const GroupTree* group = nullptr;
    std::uint32_t first_primitive = 0;
    if (region.from.empty() && &region != e.regions.data()) continue;  // reported: nothing leads there
    if (region.from.empty()) {
      primitives = &tree.world, group = &tree.groups[0];
    } else if (const std::uint32_t part = scene.nodes[region.from[0]].part; part != kNone) {
      primitives = &tree.parts[part], first_primitive = first[part + 1];
    } else {
      group = &tree.groups[region.from[0] + 1];
    }
    const RegionTrees trees(primitives, first_primitive, group, e.image.primitive_count);
    std::vector<Recorder> found(region.copies.size(), Recorder(e.image));
    parallel_for(region.copies.size(), trees.count() > 5000 ? e.threads : 1, [&](std::size_t c) {
      const bool is_sorted = e.image.options.links == Links::octant;
      check_copy(e, trees, region.copies[c], is_sorted ? std::optional(static_cast<unsigned>(c)) : std::nullopt,
                 found[c]);
    });
    for (Recorder& one : found) e.recorder.merge(std::move(one));
  }
}

}  // namespace plumbline
