// SPDX-License-Identifier: MIT
// Polygons of any shape become triangles. The only file that names GLU is triangulate.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace plumbline {

/// Corners of a polygon at most: beyond it the time is no longer bounded.
inline constexpr std::size_t kMaxPolygonCorners = 16384;

/// A corner that the polygon did not have: where its edges cross.
struct BlendedCorner {
  glm::vec3 position{0.0f};
  std::array<std::uint32_t, 4> source{};  ///< corners of the polygon, or blended corners made before this one
  std::array<float, 4> weight{};          ///< of each source; they add up to 1
};

/// Indices below n mean the polygon's corners, n + i means blended[i].
struct Triangulation {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< wound like the polygon
  std::vector<BlendedCorner> blended;                   ///< empty for a polygon that does not cross itself
  bool too_complex = false;  ///< refused: more than kMaxPolygonCorners corners, or hundreds and edges that cross
};

/// Triangles that cover the polygon, concave or not. A polygon that crosses itself covers all that it winds around. One
/// without area gives no triangles. Corners need not lie in one plane exactly: the polygon is cut as seen along its
/// mean normal.
Triangulation triangulate(std::span<const glm::vec3> corners);

/// Whether a triangle has an area that is not zero, decided exactly for the floats as given.
bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

}  // namespace plumbline
