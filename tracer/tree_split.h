// SPDX-License-Identifier: MIT
// The first stage of the build: a binary tree over references, by splits that keep boxes short, with a ball around each
// node.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tracer/tree_references.h"

namespace plumbline {

/// One node of the binary tree. Nodes stand in depth-first order: the first child is the next node, and a node over n
/// references is followed by the 2n - 2 nodes below it.
struct BinaryNode {
  Box box;
  glm::vec3 center{0.0f};
  float radius = 0.0f;                 ///< of a ball around everything below
  std::uint32_t first = 0, count = 0;  ///< range of References::list
  std::uint32_t second_child = 0;      ///< 0: a single reference
};

/// From this depth on nodes are halved by count, so that no scene makes a tree deeper than this and log2 of its size.
inline constexpr int kMaxSplitDepth = 64;

/// Orders `references.list` and returns the binary tree over it down to single references, boxes filled in. Splits
/// minimise the sum of count times squared diagonal of the box: for spheres a better guide than the box's surface,
/// since a ball's radius follows the diagonal. The result does not depend on the number of threads.
std::vector<BinaryNode> split_references(References& references, int threads);

/// Gives every node the smallest ball around the balls of its references, its centre rounded to float and its radius
/// rounded upwards after that. Throws InputError where a radius has no float.
void fit_balls(std::vector<BinaryNode>& nodes, const References& references, int threads);

/// Nodes whose subtrees are to be worked on apart, so that work is shared evenly: the same for any number of threads.
std::vector<std::uint32_t> task_roots(const std::vector<BinaryNode>& nodes);

/// Calls work(0) to work(count - 1), each once, on this many threads. The first exception is thrown on.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace plumbline
