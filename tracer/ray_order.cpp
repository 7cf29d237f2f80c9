// SPDX-License-Identifier: MIT
#include "tracer/ray_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "scenes/error.h"
#include "tracer/halves.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

// The pixels that llvmpipe walks together: 4 wide, 2 high, in blocks of 4 x 4.
constexpr std::uint32_t kBlock = 4, kGroup = 8;

/// Above this mean squared distance between neighbours (LinePlace), sorting pays for itself.
constexpr double kSortAbove = 0.05;

/// A ray as a point in six dimensions: rays that meet the same nodes are near one another.
struct LinePlace {
  glm::vec3 direction{0.0f};  ///< of unit length
  glm::vec3 point{0.0f};      ///< the line's point next to the scene's centre, in radii from it
};

LinePlace line_place(const Ray& ray, const Ball& ball) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
  const glm::dvec3 o = (glm::dvec3(ray.origin) - ball.center) / ball.radius;
  return {glm::vec3(d), glm::vec3(o - glm::dot(o, d) * d)};
}

float distance2(const LinePlace& a, const LinePlace& b) {
  const glm::vec3 d = a.direction - b.direction, p = a.point - b.point;
  return glm::dot(d, d) + glm::dot(p, p);
}

/// x in [0, 1] as an integer of `bits` bits; what is outside, or no number, goes to an end.
std::uint32_t quantised(float x, unsigned bits) {
  const float scaled = x * static_cast<float>(1u << bits);
  const float most = static_cast<float>((1u << bits) - 1u);
  return scaled > 0.0f ? static_cast<std::uint32_t>(std::min(scaled, most)) : 0u;
}

/// Moves bit i of a number below 32 to bit 6 i.
std::uint32_t spread_by_6(std::uint32_t x) {
  return (x & 1u) | (x & 2u) << 5 | (x & 4u) << 10 | (x & 8u) << 15 | (x & 16u) << 20;
}

/// Octant of the direction, then direction and point interleaved bit by bit: 3 + 12 + 15 bits.
std::uint32_t sort_key(const LinePlace& place) {
  std::uint32_t octant = 0, code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    octant |= place.direction[axis] < 0.0f ? 1u << axis : 0u;
    code |= spread_by_6(quantised(place.point[axis] * 0.5f + 0.5f, 5)) << (2 - axis);
    code |= spread_by_6(quantised(std::abs(place.direction[axis]), 4)) << (5 - axis);
  }
  return octant << 27 | code;
}

/// The numbers 0 .. n - 1 in ascending order of their keys, of 30 bits; equal keys stay in order.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& keys) {
  constexpr unsigned kDigit = 10, kDigits = 3;
  std::vector<std::uint32_t> order(keys.size()), next(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  for (unsigned digit = 0; digit < kDigits; ++digit) {
    const unsigned shift = digit * kDigit;
    std::array<std::uint32_t, 1u << kDigit> begin{};
    for (const std::uint32_t key : keys) ++begin[key >> shift & ((1u << kDigit) - 1u)];
    std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), 0u);
    for (const std::uint32_t i : order) next[begin[keys[i] >> shift & ((1u << kDigit) - 1u)]++] = i;
    order.swap(next);
  }
  return order;
}

/// The pixel of the k-th ray where each eight in a row share a group.
std::uint32_t group_pixel(std::uint32_t k) {
  constexpr std::uint32_t kBlocksPerRow = kBatchWidth / kBlock;
  const std::uint32_t lane = k % kGroup, half = k / kGroup % 2, block = k / (2 * kGroup);
  const std::uint32_t x = block % kBlocksPerRow * kBlock + lane % kBlock;
  const std::uint32_t y = block / kBlocksPerRow * kBlock + half * 2 + lane / kBlock;
  return y * kBatchWidth + x;
}

}  // namespace

RayOrder choose_ray_order(std::span<const Ray> rays, const Ball& ball) {
  constexpr std::size_t kSamples = 128;
  if (rays.size() < 2 * kGroup || !(ball.radius > 0.0)) return RayOrder::groups;
  const auto mean_distance2 = [&](std::initializer_list<std::size_t> offsets) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t s = 0; s < kSamples; ++s) {
      const std::size_t i = s * rays.size() / kSamples;
      for (const std::size_t offset : offsets) {
        if (i + offset >= rays.size() || !is_defined(rays[i]) || !is_defined(rays[i + offset])) continue;
        sum += distance2(line_place(rays[i], ball), line_place(rays[i + offset], ball));
        ++count;
      }
    }
    return count > 0 ? sum / static_cast<double>(count) : 4.0;
  };
  const double picture = mean_distance2({2, kBatchWidth}), groups = mean_distance2({2, 5});
  if (!(std::min(picture, groups) <= kSortAbove)) return RayOrder::sorted;
  return picture < groups ? RayOrder::picture : RayOrder::groups;
}

RayPlaces place_rays(std::span<const Ray> rays, RayOrder order, const Ball& ball) {
  const std::uint32_t count = static_cast<std::uint32_t>(rays.size());
  PLUMBLINE_ASSERT(count <= kBatchWidth * kBatchHeight);
  RayPlaces places;
  places.pixel.resize(count);
  if (order == RayOrder::picture) {
    std::iota(places.pixel.begin(), places.pixel.end(), 0u);
    places.rows = static_cast<int>((count + kBatchWidth - 1) / kBatchWidth);
    return places;
  }
  if (order == RayOrder::sorted) {
    std::vector<std::uint32_t> keys(count);
    in_halves(count, [&](int, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) keys[i] = sort_key(line_place(rays[i], ball));
    });
    const std::vector<std::uint32_t> ascending = sorted_by(keys);
    for (std::uint32_t k = 0; k < count; ++k) places.pixel[ascending[k]] = group_pixel(k);
  } else {
    for (std::uint32_t k = 0; k < count; ++k) places.pixel[k] = group_pixel(k);
  }
  constexpr std::uint32_t kRaysPerBlockRow = kBatchWidth * kBlock;
  places.rows = static_cast<int>((count + kRaysPerBlockRow - 1) / kRaysPerBlockRow * kBlock);
  return places;
}

}  // namespace plumbline
