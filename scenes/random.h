// SPDX-License-Identifier: MIT
// Random numbers that repeat bit for bit on every machine: each is a function of (seed, stream, index), so any part of
// a run can be generated alone, in any order, by any number of threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>

namespace plumbline {

/// SplitMix64's finaliser (Steele, Lea and Flood 2014): a bijection of 64 bits in which every input bit reaches every
/// output bit.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// FNV-1a: a stable number for a name, so that streams can be named.
constexpr std::uint64_t name_hash(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

/// A short sequence of random numbers belonging to one item (a ray, a primitive): SplitMix64 started at a hash of its
/// name.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
      : state_(mix64(mix64(mix64(seed + kStep) ^ stream) + kStep * (index + 1))) {}

  std::uint64_t bits() { return mix64(state_ += kStep); }
  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in [0, n), n > 0; the bias is below n / 2^64.
  std::uint32_t below(std::uint32_t n) {
    const std::uint64_t x = bits(), low = (x & 0xffffffffu) * n, high = (x >> 32) * n;  // x * n in two halves
    return static_cast<std::uint32_t>((high + (low >> 32)) >> 32);
  }
  /// Uniform on the unit sphere (Marsaglia 1972: from a point of the unit disc, without trigonometry).
  glm::dvec3 direction() {
    for (;;) {
      const double x = uniform(-1.0, 1.0), y = uniform(-1.0, 1.0), s = x * x + y * y;
      if (!(s < 1.0)) continue;
      const double r = 2.0 * std::sqrt(1.0 - s);
      return {r * x, r * y, 1.0 - 2.0 * s};
    }
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;
  std::uint64_t state_;
};

}  // namespace plumbline
