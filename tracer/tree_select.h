// SPDX-License-Identifier: MIT
// The second stage of the build: which nodes of the binary tree are kept, and where its leaves are.
#pragma once

#include <vector>

#include "tracer/sphere_tree.h"
#include "tracer/tree_split.h"

namespace plumbline {

/// The cheapest tree under the cost model of sphere_tree.h that can be had from `nodes` by leaving nodes out (their
/// children move up) and by ending at nodes of up to options.leaf_size references, no node having more than
/// options.width children.
SphereTree select_nodes(const std::vector<BinaryNode>& nodes, const References& references, const TreeOptions& options);

}  // namespace plumbline
