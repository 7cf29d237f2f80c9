// SPDX-License-Identifier: MIT
// Pictures from what is known of each pixel: values, primitives, verdicts. The legend is kept as data beside the
// pixels; the page draws it as text, which stays sharp, follows the theme and is read aloud.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "reports/color.h"
#include "reports/pixel_values.h"
#include "reports/record.h"

namespace plumbline {

/// Row 0 at the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< width * height, row by row
  ColorScale scale;
  std::vector<LegendEntry> legend;
  PixelValues values;  ///< those that the colours stand for; empty where they are not kept
};

struct ValueRange {
  double low = std::numeric_limits<double>::quiet_NaN();   ///< NaN: the least finite value
  double high = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the greatest finite value
};

/// Each of these takes width * height items, row by row.

/// Linear colour as it is seen: sRGB of [0, 1]. What is brighter than 1 in a channel is shown as 1, which the legend
/// counts; what is no number in one is kNoValue.
Picture paint_colors(std::span<const glm::dvec3> colors, int width, int height);

/// Values by colour; a pixel that is not finite has none and is shown in kNoValue.
Picture paint_values(std::span<const float> values, int width, int height, const std::string& unit,
                     ValueRange range = {});

/// Values of either sign by colour, from -limit to limit > 0: blue below zero, orange above.
Picture paint_signed(std::span<const float> values, int width, int height, const std::string& unit, double limit);

/// Primitive numbers (kNone: a miss) by colour. `brightness` in [0, 1] (|cosine| between ray and normal, say) makes the
/// shape seen; empty: flat.
Picture paint_primitives(std::span<const std::uint32_t> primitives, std::span<const float> brightness, int width,
                         int height);

/// Verdicts by colour: pixel i has verdict names[verdicts[i]]. What does not agree is grown to a disc of radius `grow`
/// pixels, grave verdicts over harmless ones, so that one lost pixel of 512 x 512 is seen; the legend counts pixels
/// before that. Agreeing pixels are grey, by `brightness` where it is given, so that one sees where on the scene the
/// others lie.
Picture paint_verdicts(std::span<const std::uint8_t> verdicts, std::span<const std::string> names,
                       std::span<const float> brightness, int width, int height, int grow = 2);

/// `stem` with every character that is no good in a file name replaced by '_'.
std::string picture_file_name(std::string stem);

/// Writes folder/pictures/STEM.png (characters of `stem` that are no good in a file name become '_') and returns its
/// record, complete but for `explain`. Values of up to kMostValuePixels pixels go to STEM.values.js beside it. Throws
/// EnvironmentError where the disk refuses.
PictureRecord save_picture(const Picture& picture, const std::filesystem::path& folder, const std::string& stem,
                           const std::string& title, const std::string& caption);

}  // namespace plumbline
