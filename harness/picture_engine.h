// SPDX-License-Identifier: GPL-3.0-or-later
// A source of samples of pictures, whoever takes them: what the statistics ask of the production tracer and of the
// reference alike.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "reference/renderer.h"

namespace plumbline {

/// Means and variances of a picture's pixels over some of its frames, row by row from the top, linear colour.
struct PictureMoments {
  int width = 0, height = 0;
  std::uint32_t frames = 0;          ///< samples of each pixel
  std::vector<glm::dvec3> mean;      ///< width * height
  std::vector<glm::dvec3> variance;  ///< of one sample, unbiased; empty for one frame
};

/// Mean of each pixel over batches of the same size and number of frames.
std::vector<glm::dvec3> pixel_means(const std::vector<PictureMoments>& batches);

/// Scene, size, effects, seed and time are fixed when it is made. Frames are numbered for ever: asking for the same
/// ones again gives the same moments, disjoint ones have samples independent of each other.
class PictureEngine {
 public:
  virtual ~PictureEngine() = default;
  /// As reports show it: "reference", "tracer, hash".
  virtual const std::string& name() const = 0;
  /// Frames first_frame ... first_frame + frames - 1, frames > 0.
  virtual PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) = 0;
};

/// What is fixed when an engine is made.
struct PictureSettings {
  int width = 0, height = 0;  ///< pixels; 0: the scene camera's
  Effects effects;            ///< instead of the scene's
  std::uint64_t seed = 0;     ///< of the engine's own random numbers
  double time = 0.0;          ///< of the picture, seconds
};

/// Makes an engine for a scene. It may keep the scene or copy it: the scene outlives the engine.
using MakePictureEngine = std::function<std::unique_ptr<PictureEngine>(const Scene&, const PictureSettings&)>;

/// The reference renderer as an engine; the frames of `settings` are not read. `numbers`: null for the renderer's own,
/// else they must outlive the engine. Throws as ReferenceRenderer does.
std::unique_ptr<PictureEngine> reference_engine(const Scene& scene, const ReferenceSettings& settings,
                                                const RandomSource* numbers = nullptr);
/// The same in the form that factories take.
std::unique_ptr<PictureEngine> make_reference_engine(const Scene& scene, const PictureSettings& settings);

}  // namespace plumbline
