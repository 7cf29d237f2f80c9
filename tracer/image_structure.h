// SPDX-License-Identifier: MIT
// What stands below what in a geometry image, as its texels tell, whatever they hold. Cells are texels in layout
// `compact`.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/geometry_image.h"

namespace plumbline {

/// One copy of a region: cells [begin, end).
struct RegionCopy {
  std::uint32_t begin = 0, end = 0;
};

/// A copy of the region behind a scene's node (kNone: the world's). Nothing where the node's record leads to none.
std::optional<RegionCopy> region_copy(const GeometryImage& image, std::uint32_t space, std::uint32_t copy);

/// What a cell says as a node. Where links lead: a cell, or kNone: an end, or nowhere.
struct NodeCell {
  bool is_end = false;  ///< no node but the end of a region (compact)
  bool is_leaf = false;
  std::uint32_t cluster = kNone;    ///< of a leaf: its first stored primitive
  std::uint32_t transform = kNone;  ///< of a leaf: the scene's node that it leads into
  std::uint32_t in = kNone;         ///< an inner node's first child
  std::uint32_t out = kNone;        ///< where the walk goes on behind all that stands below
};
NodeCell node_cell(const GeometryImage& image, std::uint32_t cell);

/// The cells above a leaf in its copy, from a root down, and the leaf itself.
std::vector<std::uint32_t> chain_to(const GeometryImage& image, const RegionCopy& copy, std::uint32_t leaf);

/// The leaves of a copy whose cluster holds the primitive; those that lead into a transform.
std::vector<std::uint32_t> leaves_of_primitive(const GeometryImage& image, const RegionCopy& copy,
                                               std::uint32_t primitive);
std::vector<std::uint32_t> leaves_of_transform(const GeometryImage& image, const RegionCopy& copy, std::uint32_t node);

/// Scene nodes from the outermost to `instance`, as the records tell. Nothing where they tell no way to the world.
std::optional<std::vector<std::uint32_t>> transforms_to(const GeometryImage& image, std::uint32_t instance);

/// World units of a unit of the space into which these transforms lead, the outermost first; NaN where that depends on
/// the direction.
double scale_to_world(const GeometryImage& image, const std::vector<std::uint32_t>& path);

/// Whether the matrices of a record are each other's inverses. Their entries were rounded to 2^-24 of themselves, so
/// that an entry of the product is off by at most 2^-23 of the sum of its terms' sizes; twice that is allowed.
bool inverse_fits(const GeometryImage& image, std::uint32_t n);

}  // namespace plumbline
