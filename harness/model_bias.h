// SPDX-License-Identifier: GPL-3.0-or-later
// Model bias: how far the picture by the paper's densities is from that by the physical ones. It is what the paper's
// scheme costs, not an error of any renderer.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "reports/record.h"
#include "scenes/scene.h"

namespace plumbline {

struct ModelBiasDepth {
  int width = 192, height = 128;
  std::uint32_t batches = 16, frames = 8;
};

struct ModelBias {
  int width = 0, height = 0;
  std::vector<glm::dvec3> paper, physical;  ///< mean of each pixel
  double mean = 0.0;                        ///< of the whole picture's difference, as a share of its brightness
  double mean_interval = 0.0;               ///< half the width of its 99 % interval
  double root_mean_square = 0.0;            ///< over the pixels, as a share of the mean brightness, noise subtracted
  double greatest_tile = 0.0;               ///< of the means of 8 x 8 pixels, by size, as a share of the same
  std::size_t differing_tiles = 0;          ///< whose difference is beyond noise, at 1 % over all of them
  std::size_t tiles = 0;
};

ModelBias measure_model_bias(const Scene& scene, const std::vector<std::string>& effects, const ModelBiasDepth& depth,
                             std::uint64_t seed, const std::function<void(double)>& progress = {});

void record_model_bias(const ModelBias& bias, const std::filesystem::path& folder, const std::string& stem,
                       CaseRecord& record);

}  // namespace plumbline
