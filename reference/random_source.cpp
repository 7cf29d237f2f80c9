// SPDX-License-Identifier: GPL-3.0-or-later
// Philox, and how a draw becomes its counter.
#include "reference/random_source.h"

#include "scenes/error.h"

namespace plumbline {

namespace {

/// No pixel has this column: the counter of a frame's time.
constexpr std::uint32_t kNoPixel = 0xffffffffu;
constexpr std::uint32_t kRayShift = 26;  ///< rays have 6 bits, dimensions 26

double number_of(std::uint32_t word) { return static_cast<double>(word >> 8) * 0x1p-24; }

/// The first dimension of the group: 0 and 1 are the place in the pixel, then each purpose has three.
std::uint32_t group_of(std::uint32_t dimension) { return dimension < 2 ? 0 : dimension - (dimension - 2) % 3; }

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = 0xD2511F53ull * counter[0], b = 0xCD9E8D57ull * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

PhiloxSource::PhiloxSource(std::uint64_t seed)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {}

void PhiloxSource::fill(const Draw& first, std::span<double> numbers) const {
  PLUMBLINE_ASSERT(first.ray < 64 && first.dimension + numbers.size() < (1u << kRayShift));
  std::array<std::uint32_t, 4> words{};
  std::uint32_t group = kNoPixel;
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t dimension = first.dimension + i;
    if (group_of(dimension) != group) {
      group = group_of(dimension);
      words = philox({first.x, first.y, first.frame, (first.ray << kRayShift) | group}, key_);
    }
    numbers[i] = number_of(words[dimension - group]);
  }
}

double PhiloxSource::time(std::uint32_t frame) const {
  return number_of(philox({kNoPixel, kNoPixel, frame, 0}, key_)[0]);
}

}  // namespace plumbline
