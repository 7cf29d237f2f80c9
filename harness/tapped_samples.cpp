// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/tapped_samples.h"

#include <algorithm>

#include "scenes/error.h"
#include "tracer/random_numbers.h"

namespace plumbline {

void SampleTap::rays(const TappedBatch&, std::uint32_t ray, std::uint32_t light, std::span<const Ray> rays,
                     std::span<const Hit> hits) {
  PLUMBLINE_ASSERT(ray < open_.paths.size());
  TappedRays& into = light == kNone ? open_.paths[ray] : open_.shadows[{ray, light}];
  into.rays.assign(rays.begin(), rays.end());
  into.hits.assign(hits.begin(), hits.end());
}

void SampleTap::numbers(const TappedBatch&, std::uint32_t ray, std::uint32_t first,
                        std::span<const glm::vec4> numbers) {
  open_.numbers[{ray, first}].assign(numbers.begin(), numbers.end());
}

void SampleTap::samples(const TappedBatch& batch, std::span<const glm::vec4> colors) {
  open_.batch = batch;
  open_.colors.assign(colors.begin(), colors.end());
  batches.push_back(std::move(open_));
  open_ = {};
}

void ItemNumbers::fill(const Draw& first, std::span<double> numbers) const {
  PLUMBLINE_ASSERT(numbers.size() <= 3);
  const auto found = samples_->numbers.find({first.ray, first.dimension});
  const glm::vec4 drawn = found == samples_->numbers.end() ? glm::vec4(0.0f) : found->second[item_];
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = drawn[static_cast<int>(i)];
}

double ItemNumbers::time(std::uint32_t frame) const { return frame_time_number(seed_, frame); }

}  // namespace plumbline
