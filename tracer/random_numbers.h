#pragma once
#include "scenes/random.h"
#include "tracer/gl_objects.h"
namespace plumbline {
struct NoiseImage {
  NoiseImage(GlContext&, std::uint64_t, int, int, std::uint32_t) {}
  std::uint32_t texels() const { return 0; }
  void bind(int) {}
  void go_to(std::uint32_t, std::uint32_t) {}
};
inline glm::ivec4 random_uniform(std::uint64_t seed, std::uint32_t texels, std::uint32_t first) {
  return {static_cast<int>(seed), static_cast<int>(seed >> 32), static_cast<int>(texels), static_cast<int>(first)};
}
inline double frame_time_number(std::uint64_t seed, std::uint32_t frame) {
  return std::floor(Random(seed, name_hash("time"), frame).uniform() * 16777216.0) / 16777216.0;
}
}
