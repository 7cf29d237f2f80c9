// SPDX-License-Identifier: MIT
// See picture.h.
#include "reports/picture.h"

#include <algorithm>
#include <cmath>

#include "reports/files.h"
#include "reports/summary.h"
#include "scenes/error.h"
#include "scenes/image_file.h"
#include "scenes/scene.h"

namespace plumbline {
namespace {

constexpr int kScaleColors = 17;  // the page interpolates between them

Picture blank(std::size_t items, int width, int height) {
  PLUMBLINE_ASSERT(width > 0 && height > 0 &&
                   items == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.pixels.resize(items, kNoValue);
  return picture;
}

/// Position in the order of display; unknown verdicts are as grave as can be.
std::size_t gravity(std::string_view verdict) {
  const auto& infos = verdict_infos();
  return static_cast<std::size_t>(
      std::find_if(infos.begin(), infos.end(), [&](const VerdictInfo& info) { return info.name == verdict; }) -
      infos.begin());
}

}  // namespace

Picture paint_colors(std::span<const glm::dvec3> colors, int width, int height) {
  Picture picture = blank(colors.size(), width, height);
  picture.values = {"linear colour", {"R", "G", "B"}, {}, {}};
  std::uint64_t without = 0, brighter = 0;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const glm::dvec3& color = colors[i];
    for (int c = 0; c < 3; ++c) picture.values.values.push_back(static_cast<float>(color[c]));
    if (std::isnan(color.x + color.y + color.z)) {
      ++without;
      continue;
    }
    brighter += color.x > 1.0 || color.y > 1.0 || color.z > 1.0;
    for (int c = 0; c < 3; ++c)
      picture.pixels[i][static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::lround(255.0f * to_srgb(static_cast<float>(std::clamp(color[c], 0.0, 1.0)))));
  }
  if (brighter) picture.legend.push_back({"brighter than shown", "#ffffff", brighter});
  if (without) picture.legend.push_back({"no value", hex_color(kNoValue), without});
  return picture;
}

Picture paint_values(std::span<const float> values, int width, int height, const std::string& unit, ValueRange range) {
  Picture picture = blank(values.size(), width, height);
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  std::uint64_t without = 0;
  for (const float value : values) {
    if (!std::isfinite(value)) {
      ++without;
      continue;
    }
    least = std::min(least, static_cast<double>(value));
    greatest = std::max(greatest, static_cast<double>(value));
  }
  if (without == values.size()) least = greatest = 0.0;
  const double low = std::isnan(range.low) ? least : range.low, high = std::isnan(range.high) ? greatest : range.high;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i]))
      picture.pixels[i] = value_color(high > low ? (static_cast<double>(values[i]) - low) / (high - low) : 0.0);
  picture.scale = {low, high, unit, {}};
  picture.values = {unit, {""}, {}, {values.begin(), values.end()}};
  for (int i = 0; i < kScaleColors; ++i)
    picture.scale.colors.push_back(hex_color(value_color(i / (kScaleColors - 1.0))));
  if (without) picture.legend.push_back({"no value", hex_color(kNoValue), without});
  return picture;
}

Picture paint_signed(std::span<const float> values, int width, int height, const std::string& unit, double limit) {
  PLUMBLINE_ASSERT(limit > 0.0);
  Picture picture = blank(values.size(), width, height);
  std::uint64_t without = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) ++without;
    picture.pixels[i] = signed_color(static_cast<double>(values[i]) / limit);
  }
  picture.scale = {-limit, limit, unit, {}};
  picture.values = {unit, {""}, {}, {values.begin(), values.end()}};
  for (int i = 0; i < kScaleColors; ++i)
    picture.scale.colors.push_back(hex_color(signed_color(2.0 * i / (kScaleColors - 1.0) - 1.0)));
  if (without) picture.legend.push_back({"no value", hex_color(kNoValue), without});
  return picture;
}

Picture paint_primitives(std::span<const std::uint32_t> primitives, std::span<const float> brightness, int width,
                         int height) {
  Picture picture = blank(primitives.size(), width, height);
  PLUMBLINE_ASSERT(brightness.empty() || brightness.size() == primitives.size());
  std::uint64_t misses = 0;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (primitives[i] == kNone) {
      ++misses;
      continue;
    }
    const Rgb color = primitive_color(primitives[i]);
    picture.pixels[i] =
        brightness.empty() ? color : shaded(color, 0.15f + 0.85f * std::clamp(brightness[i], 0.0f, 1.0f));
  }
  if (misses) picture.legend.push_back({"miss", hex_color(kNoValue), misses});
  return picture;
}

Picture paint_verdicts(std::span<const std::uint8_t> verdicts, std::span<const std::string> names,
                       std::span<const float> brightness, int width, int height, int grow) {
  Picture picture = blank(verdicts.size(), width, height);
  PLUMBLINE_ASSERT((brightness.empty() || brightness.size() == verdicts.size()) && grow >= 0);
  const std::size_t agree = gravity("agree");
  std::vector<std::uint64_t> counts(names.size(), 0);
  std::vector<std::size_t> shown(verdicts.size(), agree), gravities;
  std::vector<Rgb> colors;
  for (const std::string& name : names) {
    gravities.push_back(gravity(name));
    colors.push_back(verdict_color(name));
  }
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    PLUMBLINE_ASSERT(verdicts[i] < names.size());
    ++counts[verdicts[i]];
    const float light = brightness.empty() ? 1.0f : 0.25f + 0.75f * std::clamp(brightness[i], 0.0f, 1.0f);
    picture.pixels[i] = shaded(verdict_color("agree"), light);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint8_t verdict = verdicts[static_cast<std::size_t>(y) * width + x];
      if (gravities[verdict] == agree) continue;
      for (int dy = -grow; dy <= grow; ++dy) {
        for (int dx = -grow; dx <= grow; ++dx) {
          const int px = x + dx, py = y + dy;
          if (px < 0 || py < 0 || px >= width || py >= height || dx * dx + dy * dy > grow * grow) continue;
          const std::size_t at = static_cast<std::size_t>(py) * width + px;
          if (gravities[verdict] < shown[at]) continue;
          shown[at] = gravities[verdict];
          picture.pixels[at] = colors[verdict];
        }
      }
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (counts[i]) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return gravities[a] < gravities[b]; });
  picture.values = {"", {""}, {names.begin(), names.end()}, {verdicts.begin(), verdicts.end()}};
  for (const std::size_t i : order) picture.legend.push_back({names[i], hex_color(colors[i]), counts[i]});
  return picture;
}

std::string picture_file_name(std::string stem) {
  std::replace_if(
      stem.begin(), stem.end(),
      [](char c) {
        return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
                 c == '-');
      },
      '_');
  return stem;
}

PictureRecord save_picture(const Picture& picture, const std::filesystem::path& folder, const std::string& stem,
                           const std::string& title, const std::string& caption) {
  PLUMBLINE_ASSERT(!picture.pixels.empty());
  PictureRecord record;
  record.path = "pictures/" + picture_file_name(stem) + ".png";
  record.title = title;
  record.caption = caption;
  record.width = picture.width;
  record.height = picture.height;
  record.scale = picture.scale;
  record.legend = picture.legend;
  make_folder(folder / "pictures");
  const std::span<const std::uint8_t> bytes{picture.pixels.front().data(), picture.pixels.size() * 3};
  static_assert(sizeof(Rgb) == 3);
  write_png(folder / record.path, picture.width, picture.height, bytes);
  if (!picture.values.values.empty() && picture.pixels.size() <= kMostValuePixels) {
    record.values = "pictures/" + picture_file_name(stem) + ".values.js";
    write_text(folder / record.values, values_script(picture.values, record.path, picture.width, picture.height));
  }
  return record;
}

}  // namespace plumbline
