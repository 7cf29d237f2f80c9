// SPDX-License-Identifier: MIT
// What rays do in an image: random lines to ask with, and what the production traversal did, node by node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/ray.h"
#include "tracer/inspect.h"
#include "tracer/probe.h"

namespace plumbline {

/// Rays along random lines through the image's ball, world space: every line is as likely as every other (isotropic and
/// uniform), which is what LineCost (inspect_figures.h) counts for. Each starts before the ball, within what the
/// traversal takes as near.
std::vector<Ray> random_lines(const GeometryImage& image, std::size_t count, std::uint64_t seed);

/// What walks have cost at a node, all copies and all instances of its region together.
struct NodeLoad {
  std::uint64_t visits = 0, hits = 0;
  std::uint64_t primitive_tests = 0;  ///< of a leaf: its hits times its primitives
  /// In the units of the cost model (sphere_tree.h): visits, leaves entered and primitives tested.
  double cost = 0.0;
};

/// Of each node. `visits`: of each unit, as VisitProbe counts them.
std::vector<NodeLoad> node_loads(const InspectedImage& inspected, std::span<const NodeVisits> visits);

/// Where a hit lies in the trees.
class HitPlaces {
 public:
  HitPlaces(const GeometryImage& image, const InspectedImage& inspected);
  /// Nodes passed from the root of the world down to the leaf that was hit, through all transforms; 0 for a miss. Of a
  /// triangle that stands in several leaves: the first of them.
  std::uint32_t depth(const Hit& hit) const;
  /// The overlap of siblings (InspectedNode::overlap), summed over these nodes; 0 for a miss.
  double overlap(const Hit& hit) const;

 private:
  struct Place {
    std::uint32_t depth = 0;
    double overlap = 0.0;
  };
  Place place(const Hit& hit) const;

  std::vector<Place> primitives_;     ///< by number in the scene; within the region
  std::vector<Place> entrances_;      ///< of the leaf that leads into each transform; within its region
  std::vector<std::uint32_t> outer_;  ///< of each transform: the one around it; kNone: the world
};

}  // namespace plumbline
