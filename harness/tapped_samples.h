// SPDX-License-Identifier: GPL-3.0-or-later
// All that the renderer's taps tell of the samples of one batch, kept until they are compared; and the random numbers
// of one of them for the reference.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "reference/random_source.h"
#include "tracer/renderer.h"

namespace plumbline {

/// Rays of one kind, one for each item; those that are not there have a direction of zero.
struct TappedRays {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  bool has(std::size_t item) const { return !rays.empty() && rays[item].direction != glm::vec3(0.0f); }
};

struct TappedSamples {
  using Key = std::pair<std::uint32_t, std::uint32_t>;
  TappedBatch batch;
  std::array<TappedRays, 64> paths;               ///< by number (SEMANTICS 6.1)
  std::map<Key, TappedRays> shadows;              ///< by number of the ray that hit, and light; hits tell the kind
  std::map<Key, std::vector<glm::vec4>> numbers;  ///< by ray and first dimension
  std::vector<glm::vec4> colors;                  ///< in w: walks that found no end
};

/// Keeps batches, in their order.
class SampleTap final : public RenderTap {
 public:
  std::vector<TappedSamples> batches;

  void rays(const TappedBatch& batch, std::uint32_t ray, std::uint32_t light, std::span<const Ray> rays,
            std::span<const Hit> hits) override;
  void numbers(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first,
               std::span<const glm::vec4> numbers) override;
  void samples(const TappedBatch& batch, std::span<const glm::vec4> colors) override;

 private:
  TappedSamples open_;
};

/// The numbers that the tracer has drawn for one item.
class ItemNumbers final : public RandomSource {
 public:
  /// `seed`: of the renderer, for the times of frames.
  ItemNumbers(const TappedSamples& samples, std::size_t item, std::uint64_t seed)
      : samples_(&samples), item_(item), seed_(seed) {}
  void fill(const Draw& first, std::span<double> numbers) const override;
  double time(std::uint32_t frame) const override;

 private:
  const TappedSamples* samples_;
  std::size_t item_;
  std::uint64_t seed_;
};

}  // namespace plumbline
