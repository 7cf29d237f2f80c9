// SPDX-License-Identifier: MIT
// Neighbouring floats.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace plumbline {

/// The float `count` places after x in the order of all finite floats (before it, where count is negative), -0 and +0
/// being one place. Stops at the largest finite ones. x must be finite.
inline float step_ulps(float x, std::int64_t count) {
  constexpr std::int64_t kLargest = 0x7f7fffff;
  const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(x) & 0x7fffffffu);
  const std::int64_t place = std::clamp((std::signbit(x) ? -bits : bits) + count, -kLargest, kLargest);
  const float size = std::bit_cast<float>(static_cast<std::uint32_t>(place < 0 ? -place : place));
  return place < 0 ? -size : size;
}

/// The distance from |x| to the next larger float.
inline double ulp(float x) {
  const float size = std::abs(x);
  return static_cast<double>(step_ulps(size, 1)) - static_cast<double>(size);
}

/// The unit in the last place of a point's largest coordinate: what moving it by one place means.
inline double ulp(const glm::vec3& p) { return ulp(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)})); }

}  // namespace plumbline
