// SPDX-License-Identifier: MIT
#include "tracer/random_numbers.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kRays = 63;               // of a sample (SEMANTICS 6.1)
constexpr std::uint32_t kBlocksBeforeLights = 3;  // the place in the pixel, the lens, the normal
constexpr std::uint32_t kNoiseWidth = 4096;       // of the texture, at most
constexpr std::uint64_t kMostTexels = 1u << 26;   // of a layer: 1 GB
constexpr std::uint64_t kManyTexels = 1u << 24;   // of several layers
constexpr std::uint64_t kNoiseStream = name_hash("image of noise"), kTimeStream = name_hash("time of a frame");

glm::uvec4 mix_words(glm::uvec4 v) {
  v = v * 1664525u + 1013904223u;
  for (int round = 0; round < 3; ++round) {
    if (round > 0) v ^= v >> 16u;
    v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z;
  }
  return v;
}

glm::uvec2 words_of(std::uint64_t seed) {
  return {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)};
}

std::uint32_t width_of(std::uint32_t texels) { return std::min(texels, kNoiseWidth); }

}  // namespace

double frame_time_number(std::uint64_t seed, std::uint32_t frame) {
  return static_cast<double>(Random(seed, kTimeStream, frame).bits() >> 40) * 0x1p-24;
}

glm::vec4 hashed_block(std::uint64_t seed, std::uint32_t pixel, std::uint32_t frame, std::uint32_t ray,
                       std::uint32_t block) {
  const glm::uvec4 key = mix_words(glm::uvec4(words_of(seed), ray, block));
  return glm::vec4(mix_words(key + glm::uvec4(pixel, frame, 0u, 0u)) >> 8u) * 0x1p-24f;
}

glm::ivec4 random_uniform(std::uint64_t seed, std::uint32_t texels, std::uint32_t first_frame) {
  return glm::ivec4(glm::uvec4(words_of(seed), texels, first_frame));
}

void fill_noise_layer(std::uint64_t seed, std::uint32_t frame, std::span<glm::vec4> texels) {
  Random random(seed, kNoiseStream, frame);
  const auto upper = [](std::uint64_t bits) { return static_cast<float>(bits >> 40) * 0x1p-24f; };
  for (glm::vec4& texel : texels) {
    const std::uint64_t a = random.bits(), b = random.bits();
    texel = {upper(a), upper(a << 24), upper(b), upper(b << 24)};
  }
}

NoiseImage::NoiseImage(GlContext& context, std::uint64_t seed, int width, int height, std::uint32_t lights)
    : context_(&context), seed_(seed) {
  const std::uint64_t needed = std::max(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height),
                                        std::uint64_t{kRays} * (kBlocksBeforeLights + lights));
  const std::uint64_t most =
      std::min(kMostTexels, std::uint64_t{kNoiseWidth} * static_cast<std::uint64_t>(context.max_texture_size()));
  if (needed > most)
    throw InputError("a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels with " +
                     std::to_string(lights) +
                     " lights needs more noise than a texture holds; take random numbers "
                     "`hash`");
  texels_ = static_cast<std::uint32_t>(std::bit_ceil(needed));
}

std::uint32_t NoiseImage::most_frames() const {
  const auto rows = static_cast<std::uint64_t>(context_->max_texture_size());
  const std::uint64_t most = std::min(kManyTexels, rows * width_of(texels_)) / texels_;
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(most, 1));
}

void NoiseImage::go_to(std::uint32_t first, std::uint32_t count) {
  PLUMBLINE_ASSERT(count >= 1 && count <= most_frames());
  if (first == first_ && count == count_) return;
  const int width = static_cast<int>(width_of(texels_)), rows = static_cast<int>(texels_) / width;
  if (count > allocated_) {
    texture_ = {};
    texture_ = GlTexture(*context_, GL_RGBA32F, GL_RGBA, GL_FLOAT, width, rows * static_cast<int>(count));
    allocated_ = count;
  }
  // A few megabytes at a time.
  const std::uint32_t at_once = std::clamp(kNoiseWidth * 256 / texels_, 1u, count);
  std::vector<glm::vec4> texels(std::size_t{texels_} * at_once);
  for (std::uint32_t done = 0; done < count; done += at_once) {
    const std::uint32_t layers = std::min(at_once, count - done);
    for (std::uint32_t k = 0; k < layers; ++k)
      fill_noise_layer(seed_, first + done + k, std::span(texels).subspan(std::size_t{texels_} * k, texels_));
    texture_.update_rows(static_cast<int>(done) * rows, width, std::span(texels).first(std::size_t{layers} * texels_));
  }
  first_ = first, count_ = count;
}

}  // namespace plumbline
