// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/model_bias.h"

#include <algorithm>
#include <cmath>

#include "harness/compare_pictures.h"
#include "harness/differences.h"
#include "harness/independent.h"
#include "harness/picture_report.h"
#include "reports/format.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr int kTile = 8;  ///< side, pixels

double brightness(const glm::dvec3& color) { return (color.x + color.y + color.z) / 3.0; }

}  // namespace

ModelBias measure_model_bias(const Scene& scene, const std::vector<std::string>& effects, const ModelBiasDepth& depth,
                             std::uint64_t seed, const std::function<void(double)>& progress) {
  const auto batches_of = [&](Effects::Model model, const char* purpose, double from) {
    const PictureSettings settings{depth.width, depth.height, effects_of(scene, effects, model),
                                   mix64(seed ^ name_hash(purpose)), 0.0};
    return take_batches(*make_reference_engine(scene, settings), depth.batches, depth.frames, [&](double share) {
      if (progress) progress(from + 0.5 * share);
    });
  };
  const auto paper = batches_of(Effects::Model::paper, "paper", 0.0),
             physical = batches_of(Effects::Model::physical, "physical", 0.5);
  ModelBias bias;
  bias.width = depth.width, bias.height = depth.height;
  bias.paper = pixel_means(paper), bias.physical = pixel_means(physical);
  const std::size_t pixels = paper.front().mean.size();
  const auto n = static_cast<double>(depth.batches);
  std::vector<double> whole(depth.batches, 0.0);
  double light = 0.0, squares = 0.0;
  std::vector<std::vector<double>> d(pixels, std::vector<double>(depth.batches));
  for (std::size_t i = 0; i < pixels; ++i) {
    double sum = 0.0, sum_squares = 0.0;
    for (std::size_t b = 0; b < depth.batches; ++b) {
      const double off = brightness(paper[b].mean[i]) - brightness(physical[b].mean[i]);
      d[i][b] = off;
      whole[b] += off / static_cast<double>(pixels);
      light += brightness(physical[b].mean[i]) / (n * static_cast<double>(pixels));
      sum += off;
      sum_squares += off * off;
    }
    // (sum^2 - sum of squares) / (n (n - 1)) is the square of the mean without the noise's share.
    squares += (sum * sum - sum_squares) / (n * (n - 1.0)) / static_cast<double>(pixels);
  }
  if (!(light > 0.0)) return bias;
  const DifferenceTest test = test_differences(whole);
  bias.mean = test.mean / light;
  bias.mean_interval = interval_of(test, 0.99) / light;
  bias.root_mean_square = std::sqrt(std::max(0.0, squares)) / light;
  std::vector<double> p_values;
  for (int top = 0; top < depth.height; top += kTile)
    for (int left = 0; left < depth.width; left += kTile) {
      std::vector<double> tile(depth.batches, 0.0);
      double count = 0.0;
      for (int y = top; y < std::min(top + kTile, depth.height); ++y)
        for (int x = left; x < std::min(left + kTile, depth.width); ++x, ++count)
          for (std::size_t b = 0; b < depth.batches; ++b)
            tile[b] += d[static_cast<std::size_t>(y * depth.width + x)][b];
      for (double& sum : tile) sum /= count;
      const DifferenceTest found = test_differences(tile);
      p_values.push_back(found.student_p);
      if (std::fabs(found.mean) / light > std::fabs(bias.greatest_tile)) bias.greatest_tile = found.mean / light;
    }
  bias.tiles = p_values.size();
  for (const double p : p_values) bias.differing_tiles += p * static_cast<double>(bias.tiles) <= 0.01;
  return bias;
}

void record_model_bias(const ModelBias& bias, const std::filesystem::path& folder, const std::string& stem,
                       CaseRecord& record) {
  record.figures.push_back({"model bias of the mean", "%", 100.0 * bias.mean, 100.0 * (bias.mean - bias.mean_interval),
                            100.0 * (bias.mean + bias.mean_interval), 2});
  record.figures.push_back({"model bias, root mean square", "%", 100.0 * bias.root_mean_square});
  record.figures.push_back({"model bias, greatest of 8 x 8 pixels", "%", 100.0 * bias.greatest_tile});
  record.message = "the paper's density changes the mean by " + value_text(100.0 * bias.mean) + " % +- " +
                   value_text(100.0 * bias.mean_interval) + " %, and " + grouped(bias.differing_tiles) + " of " +
                   counted(bias.tiles, "tile") + " beyond noise; the greatest by " +
                   value_text(100.0 * bias.greatest_tile) + " % of the mean brightness";
  record_pair({bias.paper, bias.physical, bias.width, bias.height, "Paper", "Physical",
               "Mean of the reference's samples under this model."},
              folder, stem, record);
}

}  // namespace plumbline
