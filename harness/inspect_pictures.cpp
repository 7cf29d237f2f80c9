// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/inspect_pictures.h"

#include <algorithm>
#include <array>
#include <limits>

#include "reports/picture.h"

namespace plumbline {
namespace {

constexpr int kMostSide = 1024;     ///< of the picture of a large image, in pixels
constexpr int kZoomedWidth = 2048;  ///< of that of a small one
constexpr int kLeastRows = 8;

/// Rows up to the last that holds something, whole blocks of them.
int used_rows(const GeometryImage& image, std::span<const TexelKind> kinds, int block) {
  const auto last = std::find_if(kinds.rbegin(), kinds.rend(), [](TexelKind k) { return k != TexelKind::unused; });
  const int rows = static_cast<int>((kinds.rend() - last + image.width - 1) / image.width);
  return std::min(image.height, (std::max(rows, kLeastRows) + block - 1) / block * block);
}

/// The kind that most texels of a block have; of kinds that as many have, the first.
TexelKind kind_of_block(std::span<const TexelKind> kinds, int width, int x, int y, int side) {
  std::array<int, kTexelKinds> counts{};
  for (int dy = 0; dy < side; ++dy)
    for (int dx = 0; dx < side; ++dx)
      ++counts[static_cast<std::size_t>(kinds[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width) +
                                              static_cast<std::size_t>(x + dx)])];
  return static_cast<TexelKind>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

}  // namespace

void paint_image(const InspectTask& task, std::span<const TexelKind> kinds, std::vector<PictureRecord>& pictures) {
  const GeometryImage& image = *task.image;
  // Sides are powers of two, and so are blocks.
  int block = 1;
  while (image.width / block > kMostSide || image.height / block > kMostSide) block *= 2;
  block = std::min({block, image.width, image.height});
  const int shown = used_rows(image, kinds, block);
  const int columns = image.width / block, rows = shown / block;
  const int zoom = std::max(1, kZoomedWidth / std::max(columns, rows));
  std::array<Rgb, kTexelKinds> colors;
  Picture picture;
  const auto counts = count_kinds(kinds);
  for (std::size_t k = 0; k < kTexelKinds; ++k) {
    const char* name = name_of(static_cast<TexelKind>(k));
    colors[k] = texel_color(name);
    if (counts[k] > 0) picture.legend.push_back({name, hex_color(colors[k]), counts[k]});
  }
  picture.width = columns * zoom, picture.height = rows * zoom;
  picture.pixels.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const auto kind = static_cast<std::size_t>(kind_of_block(kinds, image.width, x * block, y * block, block));
      for (int py = y * zoom; py < (y + 1) * zoom; ++py)
        for (int px = x * zoom; px < (x + 1) * zoom; ++px) {
          // From 4 pixels on, a darker line between texels.
          const bool is_line = zoom >= 4 && (py == y * zoom || px == x * zoom);
          picture.pixels[static_cast<std::size_t>(py) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(px)] = is_line ? shaded(colors[kind], 0.7f) : colors[kind];
        }
    }
  const std::string left_out =
      shown < image.height ? " Rows from " + std::to_string(shown) + " on hold nothing and are left out." : "";
  const std::string scale = block > 1
                                ? "Each pixel stands for " + std::to_string(block) + " x " + std::to_string(block) +
                                      " texels, in the colour of what most of them are."
                                : "Each texel is " + std::to_string(zoom) + " x " + std::to_string(zoom) + " pixels.";
  pictures.push_back(save_picture(picture, task.out, task.stem + ".image", "The geometry image",
                                  "Texels by what they are. " + scale + left_out));
}

void paint_rays(const InspectTask& task, const InspectedImage& inspected, std::span<const Ray> rays,
                std::span<const Hit> hits, std::vector<PictureRecord>& pictures) {
  const HitPlaces places(*task.image, inspected);
  const float none = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> steps, tests, depth, overlap;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const bool is_hit = hit.kind == HitKind::hit;
    steps.push_back(static_cast<float>(hit.steps)), tests.push_back(static_cast<float>(hit.primitive_tests));
    depth.push_back(is_hit ? static_cast<float>(places.depth(hit)) : none);
    overlap.push_back(is_hit ? static_cast<float>(places.overlap(hit)) : none);
  }
  const auto add = [&](const std::vector<float>& values, const char* unit, const char* stem, const char* title,
                       const char* caption) {
    pictures.push_back(save_picture(paint_values(values, task.camera.width, task.camera.height, unit), task.out,
                                    task.stem + "." + stem, title, caption));
  };
  add(steps, "cells", "steps", "Steps per pixel", "Cells of the geometry image that the ray visited.");
  add(tests, "tests", "tests", "Primitive tests per pixel", "Primitives that the ray was tested against.");
  add(depth, "nodes", "depth", "Depth of the hit",
      "Nodes from the root of the world down to the leaf that was hit, through all transforms.");
  add(overlap, "parent volumes", "overlap", "Overlap above the hit",
      "What children share, over their parent's volume, summed over the nodes above the leaf that was hit.");
}

}  // namespace plumbline
