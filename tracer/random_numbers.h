// SPDX-License-Identifier: MIT
// Where the renderer's random numbers come from (SEMANTICS 7): what shaders/random.glsl is given, the same hash in C++,
// and the paper's image of noise. All numbers are k / 2^24.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "tracer/gl_objects.h"

namespace plumbline {

/// The number that tells the time of a frame (SEMANTICS 7.3), in [0, 1).
double frame_time_number(std::uint64_t seed, std::uint32_t frame);

/// The four numbers that random_block() of shaders/random.glsl computes where RANDOM_HASH is defined, bit by bit.
glm::vec4 hashed_block(std::uint64_t seed, std::uint32_t pixel, std::uint32_t frame, std::uint32_t ray,
                       std::uint32_t block);

/// u_random of shaders/random.glsl. `texels` and `first_frame` are those of a NoiseImage, 0 without one.
glm::ivec4 random_uniform(std::uint64_t seed, std::uint32_t texels, std::uint32_t first_frame);

/// Makes the layer of noise of a frame.
void fill_noise_layer(std::uint64_t seed, std::uint32_t frame, std::span<glm::vec4> texels);

/// The image of noise: a layer for each frame of a batch, renewed with the batch.
class NoiseImage {
 public:
  /// For pictures of this size with so many lights. Throws InputError for a picture whose noise no texture holds.
  NoiseImage(GlContext& context, std::uint64_t seed, int width, int height, std::uint32_t lights);

  /// Texels of a layer: a power of two, at least the pixels of the picture and the blocks that a pixel may draw.
  std::uint32_t texels() const { return texels_; }
  /// Layers that the image can hold, at least 1.
  std::uint32_t most_frames() const;
  /// Makes the layers of frames first to first + count - 1; count is at most most_frames().
  void go_to(std::uint32_t first, std::uint32_t count);
  std::uint32_t first_frame() const { return first_; }  ///< of the layers at hand
  bool is_made() const { return count_ > 0; }           ///< false before the first go_to
  void bind(int unit) const { texture_.bind(unit); }

 private:
  GlContext* context_;
  std::uint64_t seed_;
  std::uint32_t texels_, first_ = 0, count_ = 0, allocated_ = 0;
  GlTexture texture_;
};

}  // namespace plumbline
