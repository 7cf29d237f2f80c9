// SPDX-License-Identifier: MIT
// A geometry image taken apart: its trees node by node, as its texels tell, and what each node is worth. Figures over
// all nodes are in inspect_figures.h, what rays do there is in inspect_rays.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/geometry_image.h"
#include "tracer/image_view.h"

namespace plumbline {

/// A node of the first copy of a region.
struct InspectedNode {
  std::uint32_t region = 0;      ///< into InspectedImage::regions
  std::uint32_t number = 0;      ///< within its copy, in the order of the image
  std::uint32_t unit = 0;        ///< where it stands: texel (compact) or cell (paper)
  std::uint32_t parent = kNone;  ///< into InspectedImage::nodes; kNone: a root of its region
  std::uint32_t end = 0;         ///< likewise: below node i stand those from i + 1 to before `end`
  std::uint32_t depth = 1;       ///< nodes from the root of its region down to it, both counted
  std::uint32_t children = 0;
  bool is_leaf = false;
  std::uint32_t cluster = kNone;    ///< of a leaf: its first stored primitive; kNone where it leads into a transform
  std::uint32_t transform = kNone;  ///< of a leaf: the scene's node that it leads into
  std::uint32_t primitives = 0;     ///< stored below it, those behind transforms not counted
  Volume volume;                    ///< in the units of its region's space
  double radius = 0.0;              ///< of its ball; of a box: half the diagonal
  /// That a random line through the ball of its region's space meets it: the share of their surfaces (Crofton), r^2 /
  /// R^2 of a ball, at most 1. So counts the cost model of sphere_tree.h.
  double chance = 0.0;
  /// What its children share, over its own volume (overlap.h); NaN: it has fewer than two, or no volume.
  double overlap = 0.0;
  double slack = 0.0;  ///< its radius over that of the smallest ball around what stands below; 0: not known (verify.h)
};

/// What is walked in one space: it stands in the image once, however often it is shown.
struct InspectedRegion {
  std::uint32_t start = 0, copy_size = 0;  ///< units
  std::uint32_t first_node = 0, node_count = 0;
  std::vector<std::uint32_t> from;  ///< nodes of the scene whose records lead here; empty: the world
  glm::dvec3 center{0.0};  ///< of the ball that random lines of its space pass through; it holds all volumes there
  double radius = 0.0;
  /// For each copy but the first: of each node here the unit of its twin there, kNone where there is none.
  std::vector<std::vector<std::uint32_t>> twins;
};

struct InspectedImage {
  std::vector<InspectedRegion> regions;    ///< the world first
  std::vector<InspectedNode> nodes;        ///< region by region, depth first
  std::vector<std::uint32_t> behind;       ///< of each record: the region that it leads to; kNone: none
  std::vector<std::uint32_t> entrance;     ///< of each record: the node that leads into it; kNone: none
  std::vector<std::uint32_t> inner_first;  ///< regions such that those behind a region's transforms stand before it;
                                           ///< empty where broken transforms lead in circles
  /// What breaks the format, in sentences, at most 8 of `fault_count`; then slack is not measured, and all else is said
  /// as far as it can be. `plumbline verify` tells all.
  std::vector<std::string> faults;
  std::uint64_t fault_count = 0;
};

/// Takes an image apart, whatever it holds. `threads` 0: one per core. Throws InputError where sizes and counts do not
/// fit one another.
InspectedImage inspect_image(const GeometryImage& image, int threads = 0);

}  // namespace plumbline
