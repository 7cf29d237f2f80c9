// SPDX-License-Identifier: MIT
// How triangles hang together: which share an edge or a corner, and which surfaces are closed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

/// Corners are the same where their positions are the same numbers, bit for bit, +0 and -0 alike, in one space: those
/// of different parts never are. Edge i of a triangle runs from its corner i to corner (i + 1) % 3; edge 3 * t + i of
/// all is the "side" of triangle t on an edge.
struct Topology {
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> corner;  ///< the vertex of corner 3 * t + i

  std::uint32_t edge_count = 0;
  std::vector<std::uint32_t> edge;        ///< the edge of side 3 * t + i; kNone where both ends are one vertex
  std::vector<std::uint32_t> edge_start;  ///< edge_count + 1 offsets into edge_sides
  std::vector<std::uint32_t> edge_sides;  ///< sides, edge by edge, ascending

  std::uint32_t component_count = 0;
  std::vector<std::uint32_t> component;            ///< of each triangle; a component hangs together by edges
  std::vector<std::uint8_t> component_closed;      ///< 1 where every edge of the component has exactly two sides
  std::vector<std::uint8_t> component_orientable;  ///< 1 where closed, and its triangles can be turned to face one way
  std::vector<std::uint8_t>
      turned;  ///< 1 where a triangle of an orientable component faces the other way than its first

  /// The sides that share the edge of side 3 * t + i, itself among them: one on a border, two inside a surface, more
  /// where surfaces meet. Empty for an edge without length.
  std::span<const std::uint32_t> sides(std::uint32_t triangle, int i) const {
    const std::uint32_t e = edge[3 * triangle + static_cast<std::uint32_t>(i)];
    if (e == kNone) return {};
    return std::span(edge_sides).subspan(edge_start[e], edge_start[e + 1] - edge_start[e]);
  }
  /// Whether a triangle belongs to a closed surface; false for numbers of spheres.
  bool is_closed(std::uint32_t triangle) const {
    return triangle < component.size() && component_closed[component[triangle]] != 0;
  }
  /// Whether two triangles have a vertex in common; false for numbers of spheres.
  bool share_a_corner(std::uint32_t a, std::uint32_t b) const;
  /// Whether two triangles have an edge in common; false for numbers of spheres.
  bool share_an_edge(std::uint32_t a, std::uint32_t b) const;
};

/// Time and memory are linear in the number of triangles.
Topology make_topology(const Scene& scene);

}  // namespace plumbline
