// SPDX-License-Identifier: GPL-3.0-or-later
// The reference renderer: means and variances of all pixels, by SEMANTICS 6 and 7. Written from that page and the paper
// alone; it shares nothing with the production tracer but the scenes.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "reference/sample.h"
#include "scenes/rendered_picture.h"

namespace plumbline {

struct ReferenceSettings {
  int width = 0, height = 0;  ///< pixels; 0: the scene camera's
  std::uint32_t frames = 1;   ///< samples of each pixel, at least 1
  std::uint32_t first_frame = 0;
  std::uint64_t seed = 0;               ///< of the renderer's own numbers
  double time = 0.0;                    ///< of the picture, seconds
  std::optional<Effects> effects = {};  ///< instead of the scene's
};

/// Called with the share that is done, by one thread at a time; false ends the rendering.
using ReferenceProgress = std::function<bool(double share)>;

class ReferenceRenderer {
 public:
  /// Copies the scene. Throws InputError for a camera that sees nothing, for a lens that reaches the plane of what is
  /// sharp, and for sizes or counts out of range.
  ReferenceRenderer(const Scene& scene, const ReferenceSettings& settings);
  ~ReferenceRenderer();

  /// Whether the scene had no light, and is lit by default_light.
  bool lit_by_default() const;
  const ReferenceSettings& settings() const;  ///< with the size and the effects that are meant
  /// Other frames of the same picture. Throws InputError for a count of 0.
  void set_frames(std::uint32_t first, std::uint32_t count);

  /// The picture, on all cores. It depends on the settings alone, not on the number of threads. `numbers`: null for the
  /// renderer's own. Nothing where `progress` ended it.
  std::optional<RenderedPicture> render(const ReferenceProgress& progress = {}, const RandomSource* numbers = nullptr);

  /// The colour of one sample and, where it is asked for, its record.
  glm::dvec3 sample(std::uint32_t x, std::uint32_t y, std::uint32_t frame, SampleRecord* record = nullptr,
                    const RandomSource* numbers = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
