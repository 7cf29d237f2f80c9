// SPDX-License-Identifier: MIT
// See color.h.
#include "reports/color.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scenes/image_file.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

double to_linear(std::uint8_t code) { return static_cast<double>(from_srgb(static_cast<float>(code) / 255.0f)); }

std::uint8_t to_code(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * to_srgb(static_cast<float>(std::clamp(linear, 0.0, 1.0)))));
}

/// OKLab to linear sRGB, which lies outside of [0, 1] where sRGB cannot show the colour.
std::array<double, 3> linear_of(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3.0);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3.0);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3.0);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

Rgb oklch(double lightness, double chroma, double hue_degrees) {
  const double hue = hue_degrees * 3.141592653589793 / 180.0;
  const auto at = [&](double c) { return linear_of(lightness, c * std::cos(hue), c * std::sin(hue)); };
  const auto shown = [](const std::array<double, 3>& rgb) {
    return std::all_of(rgb.begin(), rgb.end(), [](double v) { return v >= 0.0 && v <= 1.0; });
  };
  double low = 0.0, high = chroma;
  if (shown(at(high))) low = high;
  for (int i = 0; i < 20 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (shown(at(middle)) ? low : high) = middle;
  }
  const auto rgb = at(low);
  return {to_code(rgb[0]), to_code(rgb[1]), to_code(rgb[2])};
}

double lightness_of(Rgb color) {
  const double r = to_linear(color[0]), g = to_linear(color[1]), b = to_linear(color[2]);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

Rgb value_color(double share) {
  if (std::isnan(share)) return kNoValue;
  const double v = std::clamp(share, 0.0, 1.0);
  return oklch(0.24 + 0.72 * v, 0.13 + 0.05 * v, 305.0 - 198.0 * v);
}

Rgb signed_color(double share) {
  if (std::isnan(share)) return kNoValue;
  const double size = std::min(1.0, std::fabs(share));
  return oklch(0.96 - 0.42 * size, 0.17 * size, share < 0.0 ? 255.0 : 45.0);
}

Rgb primitive_color(std::uint32_t primitive) {
  const std::uint64_t bits = mix64(primitive + 0x9e3779b97f4a7c15ull);
  const auto part = [&](int shift) { return static_cast<double>((bits >> shift) & 0xffffu) / 65536.0; };
  return oklch(0.62 + 0.24 * part(0), 0.09 + 0.07 * part(16), 360.0 * part(32));
}

Rgb verdict_color(std::string_view verdict) {
  // After Okabe and Ito (2008) and Tol (2021): told apart in the three common kinds of colour blindness, and by
  // lightness.
  if (verdict == "agree") return {176, 186, 197};
  if (verdict == "tie") return {86, 180, 233};
  if (verdict == "grazing") return {230, 159, 0};
  if (verdict == "reference_wrong") return {0, 158, 115};
  if (verdict == "undefined") return {122, 128, 140};
  if (verdict == "leak") return {204, 68, 153};
  if (verdict == "tracer_wrong") return {213, 62, 0};
  if (verdict == "capped") return {106, 61, 194};
  return {140, 140, 140};
}

Rgb texel_color(std::string_view kind) {
  if (kind == "nodes") return {11, 118, 196};
  if (kind == "links") return {86, 180, 233};
  if (kind == "copies") return {125, 143, 209};
  if (kind == "ends") return {213, 94, 0};
  if (kind == "primitives") return {230, 159, 0};
  if (kind == "transforms") return {0, 158, 115};
  if (kind == "lights") return {240, 228, 66};
  if (kind == "unused") return {185, 194, 205};
  return {136, 136, 136};
}

Rgb shaded(Rgb color, float brightness) {
  Rgb out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = to_code(to_linear(color[i]) * static_cast<double>(brightness));
  return out;
}

std::string hex_color(Rgb color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
  return text;
}

}  // namespace plumbline
