// SPDX-License-Identifier: MIT
// The smallest ball around a set of balls. Points are balls of radius 0, so that triangle corners and whole spheres are
// refitted by one function.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace plumbline {

/// A ball in the scene's own 32 bits.
struct FloatBall {
  glm::vec3 center{0.0f};
  float radius = 0.0f;  ///< 0: a point
};

/// The balls that hold the smallest enclosing ball in place: at most four in three dimensions.
struct BallSupport {
  std::array<std::uint32_t, 4> ball{};  ///< indices into the span that was given
  int count = 0;
};

/// The centre of the smallest ball around `balls` (not empty), to about 1e-7 of its radius or better: farthest-point
/// pivoting (Gaertner 1999) with the basis found among all subsets of at most five balls, which is right for balls as
/// well as for points (Fischer and Gaertner 2003: the problem is of LP type, although Welzl's recursion fails for
/// balls). `support` says where to start (count 0: anywhere) and where it ended. Starting from the supports of two sets
/// that make up this one saves most passes.
glm::dvec3 smallest_ball_center(std::span<const FloatBall> balls, std::span<const std::uint32_t> start,
                                BallSupport& support);

/// A float radius with which a ball around `center` contains all `balls`, exactly: the least possible or the float
/// after it. Infinity where no float is large enough.
float enclosing_radius(std::span<const FloatBall> balls, const glm::vec3& center);

}  // namespace plumbline
