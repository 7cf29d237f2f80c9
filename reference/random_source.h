// SPDX-License-Identifier: GPL-3.0-or-later
// Where the reference renderer's random numbers come from: its own generator, or numbers given by whoever compares its
// samples with another's.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace plumbline {

/// What a random number is a function of (SEMANTICS 7.1 and 7.3).
struct Draw {
  std::uint32_t x = 0, y = 0;  ///< pixel
  std::uint32_t frame = 0;
  std::uint32_t ray = 1;  ///< 1 to 63
  std::uint32_t dimension = 0;
};

/// Numbers k / 2^24 in [0, 1). Asked by many threads at once.
class RandomSource {
 public:
  virtual ~RandomSource() = default;
  /// The numbers of dimensions first.dimension, first.dimension + 1, ...
  virtual void fill(const Draw& first, std::span<double> numbers) const = 0;
  /// The number w of a frame's time.
  virtual double time(std::uint32_t frame) const = 0;
};

/// Philox4x32-10 (Salmon, Moraes, Dror and Shaw 2011): a bijection of the counter for each key.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// The renderer's own: Philox with the seed for a key and the draw for a counter. Each group of dimensions that belongs
/// to one purpose (SEMANTICS 7.3) has a counter of its own.
class PhiloxSource final : public RandomSource {
 public:
  explicit PhiloxSource(std::uint64_t seed);
  void fill(const Draw& first, std::span<double> numbers) const override;
  double time(std::uint32_t frame) const override;

 private:
  std::array<std::uint32_t, 2> key_;
};

}  // namespace plumbline
