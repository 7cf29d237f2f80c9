// SPDX-License-Identifier: MIT
// Figures over all nodes of an image: its shape, what it must cost, how tight it is, and where its memory goes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tracer/inspect.h"

namespace plumbline {

/// What a texel is there for.
enum class TexelKind : std::uint8_t {
  node,       ///< a bounding volume of the first copy of a region (compact: its link is in the same texel)
  link,       ///< layout `paper`: the texel below, in and out link
  copy,       ///< either of these in the other copies, one for each octant
  end,        ///< the end of a copy; layout `paper`: the cell of an empty region
  primitive,  ///< points, labels and radii
  transform,  ///< records
  light,
  unused,  ///< fills up: cells in part and the image up to a power of two
};
inline constexpr std::size_t kTexelKinds = 8;
const char* name_of(TexelKind kind);

/// The kind of every texel, row by row.
std::vector<TexelKind> texel_kinds(const GeometryImage& image, const InspectedImage& inspected);
/// How many there are of each; their sum is the size of the image.
std::array<std::uint64_t, kTexelKinds> count_kinds(std::span<const TexelKind> kinds);

/// Of a few numbers or many.
struct Summary {
  std::uint64_t count = 0;
  double mean = 0.0, min = 0.0, median = 0.0, p99 = 0.0, max = 0.0;  ///< of ranks: the value at floor(q (count - 1))
};
Summary summarize_values(std::vector<double> values);

/// What a random line through the ball of a space meets there, if nothing stops it. A root is visited by every line
/// that enters the space, any other node by those that hit its parent, an end (compact) by all. Behind a transform's
/// leaf roots and end are visited by all that hit the leaf, the rest by those that meet the image of what stands there.
/// That is exact in the mean where these images lie within the leaf; volumes that reach beyond it count in full, so
/// that on scenes of many stretched instances it tells up to a fifth too much.
struct LineCost {
  double visits = 0.0;      ///< nodes, ends, and all that is behind transforms
  double at_once = 0.0;     ///< of these, roots and ends: visited by whatever enters the space
  double primitives = 0.0;  ///< tested
  double transforms = 0.0;  ///< entered
};

struct RegionFigures {
  std::size_t nodes = 0, leaves = 0, transforms = 0;  ///< leaves that lead into one are in both
  std::size_t primitives = 0;                         ///< stored
  std::uint32_t depth = 0;
  std::uint64_t texels = 0;  ///< of all its copies and of its primitives
  LineCost cost;             ///< for one line that enters it
};

struct TreeFigures {
  std::size_t nodes = 0, leaves = 0, transforms = 0, primitives = 0;
  std::uint32_t depth = 0;
  std::vector<std::uint64_t> depths;      ///< [d]: leaves at depth d in their region
  std::vector<std::uint64_t> nodes_at;    ///< [d]: nodes at depth d in their region
  std::vector<std::uint64_t> widths;      ///< [k]: inner nodes with k children
  std::vector<std::uint64_t> leaf_sizes;  ///< [n]: leaves with n primitives (transforms left out)
  LineCost cost;                          ///< of a line through the image's ball
  Summary slack;                          ///< of nodes that have one
  Summary overlap;                        ///< of nodes that have one
  double overlap_met = 0.0;               ///< the mean weighted by chance: the overlap at a node that a line hits
  std::vector<RegionFigures> regions;     ///< as InspectedImage::regions
};
TreeFigures figures_of(const GeometryImage& image, const InspectedImage& inspected);

}  // namespace plumbline
