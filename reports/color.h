// SPDX-License-Identifier: MIT
// The colours of pictures: a scale for values, one colour per primitive, one per verdict.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace plumbline {

/// sRGB, 8 bits each.
using Rgb = std::array<std::uint8_t, 3>;

/// OKLab lightness, chroma and hue (Ottosson 2020), chroma lowered to what sRGB can show.
Rgb oklch(double lightness, double chroma, double hue_degrees);
/// OKLab lightness of a colour: 0 black, 1 white.
double lightness_of(Rgb color);

/// Dark violet at 0 through blue and green to pale yellow at 1: lightness rises evenly, so equal steps look equal, in
/// grey and to the colour-blind too. Arguments are clamped; NaN gives kNoValue.
Rgb value_color(double share);
/// Blue at -1 through near white at 0 to orange at 1: what differs, and which way. Arguments are clamped; NaN gives
/// kNoValue.
Rgb signed_color(double share);
/// A colour that tells a primitive from its neighbours: the number is hashed.
Rgb primitive_color(std::uint32_t primitive);
/// The colour of a verdict, as in the page's legend (assets/report.css names the same); unknown names are grey.
Rgb verdict_color(std::string_view verdict);
/// The colour of a kind of texel of a geometry image: "nodes", "links", "copies", ...; unknown names are grey.
Rgb texel_color(std::string_view kind);
inline constexpr Rgb kNoValue{58, 64, 74};

/// The colour at a brightness in [0, 1], scaled in linear light.
Rgb shaded(Rgb color, float brightness);
std::string hex_color(Rgb color);  ///< "#56b4e9"

}  // namespace plumbline
