// SPDX-License-Identifier: MIT
// What a sphere tree is built over: references to primitives, each with the balls whose hull contains it. Long
// triangles may stand in several references, each for a part.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/scene.h"
#include "tracer/miniball.h"

namespace plumbline {

/// An axis-aligned box; empty unless something was added.
struct Box {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};
  void add(const Box& other) {
    lower = glm::min(lower, other.lower);
    upper = glm::max(upper, other.upper);
  }
  /// The squared diagonal, the cost measure of the build. In double: extents of legal floats squared overflow a float.
  double diagonal2() const {
    const glm::dvec3 size = glm::dvec3(upper) - glm::dvec3(lower);
    return glm::dot(size, size);
  }
};

struct Reference {
  Box box;  ///< around the balls, rounded outwards
  std::uint32_t primitive = 0;
  std::uint32_t first_ball = 0, ball_count = 0;  ///< into References::balls
};

struct References {
  std::vector<Reference> list;
  /// A triangle's corners as points; a sphere itself; the corners of a part of a triangle, each with a radius that
  /// covers what rounding did to it. The convex hull of a reference's balls contains what the reference stands for.
  std::vector<FloatBall> balls;
};

/// References to all primitives of positive extent: triangles whose area is not exactly zero, and spheres. With
/// split_long above 0, triangles whose longest edge exceeds split_long times the scene's radius are cut into parts no
/// longer than that, the longest first, as far as the number of parts allows. The parts of a triangle cover it,
/// exactly. Throws InputError where a coordinate is not finite or so large that a box or a ball around it has no float.
References collect_references(const Scene& scene, float split_long);

/// The references that splitting may add: as many as there are primitives, but always this many.
inline constexpr std::size_t kMinExtraParts = 1u << 16;

/// True where the triangle's corners lie exactly on one line: it is never hit (SEMANTICS 2.2).
bool has_no_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

}  // namespace plumbline
