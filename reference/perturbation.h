// SPDX-License-Identifier: GPL-3.0-or-later
// From three random numbers to the place in a cube, disc or ball that an effect perturbs with (SEMANTICS 7.4).
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace plumbline {

/// Uniform in the cube of half-side 1.
inline glm::dvec3 in_cube(const glm::dvec3& u) { return 2.0 * u - 1.0; }

/// Uniform on the disc of radius 1 in x and y; u.z is not used.
inline glm::dvec3 on_disc(const glm::dvec3& u) {
  const double radius = std::sqrt(u.x), angle = 2.0 * std::numbers::pi * u.y;
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

/// Uniform in the ball of radius 1: height and angle are uniform on its surface (Archimedes), the cube of the distance
/// is uniform.
inline glm::dvec3 in_ball(const glm::dvec3& u) {
  const double z = 1.0 - 2.0 * u.x, s = 2.0 * std::sqrt(u.x * (1.0 - u.x)), angle = 2.0 * std::numbers::pi * u.y;
  return std::cbrt(u.z) * glm::dvec3(s * std::cos(angle), s * std::sin(angle), z);
}

}  // namespace plumbline
