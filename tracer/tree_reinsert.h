// SPDX-License-Identifier: MIT
// Between the stages of the build: what greedy splits got wrong is put right by moving subtrees to better places.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/tree_split.h"

namespace plumbline {

/// No binary tree is deeper than this, whatever the scene: functions may recurse over it.
inline constexpr int kMaxBinaryDepth = 128;

/// Takes subtrees out and puts them back where the sum of squared diagonals over all inner nodes falls most (Bittner,
/// Hapala and Havran 2013), the largest first, pass after pass while that pays. Reorders `references.list` and `nodes`,
/// which stay in depth-first order. `max_visits` bounds the work, counted in nodes looked at, and so the same on every
/// machine.
void reinsert_subtrees(std::vector<BinaryNode>& nodes, References& references, std::size_t max_visits);

}  // namespace plumbline
