// SPDX-License-Identifier: GPL-3.0-or-later
// The arbiter's own tree of boxes, independent of both tracers: it may name too many candidates, never too few.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "reference/line.h"

namespace plumbline {

struct Box {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};
};

/// Both children's boxes stand in the node. A child of count 0 is a node, else a run of BoxTree::order.
struct BoxNode {
  std::array<Box, 2> box{};
  std::array<std::uint32_t, 2> first{};  ///< of nodes, or of order
  std::array<std::uint32_t, 2> count{};
};

struct BoxTree {
  std::vector<BoxNode> nodes;  ///< nodes[0] is the root; some slots are unused; empty where a single leaf holds all
  std::vector<std::uint32_t> order;  ///< numbers of the boxes given to the build
  Box bounds;
};

/// Surface area heuristic over 16 bins, on all cores (TBB); the same tree on any number of them.
BoxTree build_box_tree(const std::vector<Box>& boxes);

/// The line prepared for slab tests: every box that holds a point within `reach` of the line's part first <= s <= last
/// is met.
///
/// In each axis the slab's s is ((bound -+ pad) - p) / d, computed with three roundings. For the box without its pad
/// that is off by at most 4 u |s|, which moves the bound by 4 u (|bound| + |p| + pad). A pad of reach plus four times
/// that covers it, and the pad's own roundings, and what `point` lacks of p, at most u |p|. A line that is itself off
/// by some error has a pad that is wider by twice what that moves it within the bounds. A zero component makes the
/// slab's s infinite on the side where the line is, or NaN where it touches the padded face; comparisons are written so
/// that NaN does not exclude.
struct SlabLine {
  glm::dvec3 before{0.0}, behind{0.0};  ///< the line's point plus, minus the pad
  glm::dvec3 inverse{0.0};
  double first = 0.0, last = 0.0;

  SlabLine(const Line& line, const Box& bounds, double reach, double first_s, double last_s);

  /// The s at which the line enters the box; infinity where it misses.
  double enter(const Box& box) const {
    double s_enter = first, s_leave = last;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.lower[axis] - before[axis]) * inverse[axis],
                   b = (box.upper[axis] - behind[axis]) * inverse[axis];
      const double near = inverse[axis] < 0.0 ? b : a, far = inverse[axis] < 0.0 ? a : b;
      s_enter = near > s_enter ? near : s_enter;
      s_leave = far < s_leave ? far : s_leave;
    }
    return s_enter > s_leave ? std::numeric_limits<double>::infinity() : s_enter;
  }
};

/// Calls visit(first, count) for each run of `order` whose box `slabs` meets, near boxes first; visit may lower
/// slabs.last.
template <class Visit>
void walk(const BoxTree& tree, SlabLine& slabs, Visit&& visit) {
  if (tree.nodes.empty()) {
    if (!tree.order.empty()) visit(std::uint32_t{0}, static_cast<std::uint32_t>(tree.order.size()));
    return;
  }
  struct Entry {
    double s;
    std::uint32_t first, count;
  };
  // Deep enough: a path takes one entry per level, and build_box_tree keeps within kMaxDepth.
  std::array<Entry, 96> stack;
  std::size_t size = 0;
  stack[size++] = {slabs.first, 0, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.s > slabs.last) continue;
    if (entry.count > 0) {
      visit(entry.first, entry.count);
      continue;
    }
    const BoxNode& node = tree.nodes[entry.first];
    const double s0 = slabs.enter(node.box[0]), s1 = slabs.enter(node.box[1]);
    const int near = s1 < s0 ? 1 : 0;
    const double s_near = near ? s1 : s0, s_far = near ? s0 : s1;
    constexpr double kMissed = std::numeric_limits<double>::infinity();
    if (s_far < kMissed) stack[size++] = {s_far, node.first[1 - near], node.count[1 - near]};
    if (s_near < kMissed) stack[size++] = {s_near, node.first[near], node.count[near]};
  }
}

}  // namespace plumbline
