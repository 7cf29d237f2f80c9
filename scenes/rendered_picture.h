// SPDX-License-Identifier: MIT
// A picture as a renderer hands it out, whoever rendered it, and what every renderer asks of a request (SEMANTICS 6).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

/// Row by row from the top. All but mean and variance is that of one sharp ray a pixel (SEMANTICS 6.9).
struct RenderedPicture {
  int width = 0, height = 0;
  std::uint32_t frames = 0;                        ///< samples of each pixel
  std::vector<glm::dvec3> mean;                    ///< linear colour
  std::vector<glm::dvec3> variance;                ///< of one sample, unbiased; empty for one frame
  std::vector<double> depth;                       ///< infinite where nothing is hit
  std::vector<glm::dvec3> normal;                  ///< N; zero where nothing is hit
  std::vector<std::uint32_t> primitive, instance;  ///< kNone for none
  std::vector<std::uint32_t> steps;  ///< nodes that the ray's walk visited; empty where the engine has none
};

/// Sets a size of 0 x 0 to the camera's. Throws InputError for a size, a number of frames or a time that no picture
/// has.
void complete_picture_request(const Camera& camera, int& width, int& height, std::uint32_t first_frame,
                              std::uint32_t frames, double time);

/// Throws InputError for a lens that reaches the plane of what is sharp (SEMANTICS 6.2).
void require_lens_before_focus(const Camera& camera);

}  // namespace plumbline
