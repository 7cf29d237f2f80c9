// SPDX-License-Identifier: MIT
// Reading a geometry image as geometry_image.h describes it, whatever its texels hold. Where things stand is counted in
// units: texels (compact) or cells (paper).
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "tracer/geometry_image.h"

namespace plumbline {

inline bool is_compact(const GeometryImage& image) { return image.options.layout == Layout::compact; }
inline bool has_boxes(const GeometryImage& image) { return image.options.bounds == Bounds::aabb; }
/// Units of a node, and of a transform's record.
inline std::uint32_t node_units(const GeometryImage& image) { return has_boxes(image) ? 2 : 1; }
inline std::uint32_t record_units(const GeometryImage& image) {
  return is_compact(image) ? kTransformTexels : kTransformTexels / 2;
}
inline std::uint32_t light_units(const GeometryImage& image) {
  return is_compact(image) ? kLightTexels : kLightTexels / 2;
}
inline std::uint64_t unit_count(const GeometryImage& image) {
  return is_compact(image) ? image.texels.size() : image.texels.size() / 2;
}

/// The texel of a unit; of a cell row 0 is the upper one.
inline std::size_t unit_texel(const GeometryImage& image, std::uint64_t unit, int row = 0) {
  if (is_compact(image)) return unit;
  const std::uint64_t width = static_cast<std::uint64_t>(image.width);
  return (unit / width * 2 + static_cast<std::uint64_t>(row)) * width + unit % width;
}
inline const glm::vec4& texel_at(const GeometryImage& image, std::uint64_t unit, int row = 0) {
  return image.texels[unit_texel(image, unit, row)];
}

/// The end texel of a copy (compact), or the links of an empty region (paper).
inline glm::vec4 end_texel(const GeometryImage& image) {
  if (is_compact(image)) return {0.0f, 0.0f, 0.0f, std::bit_cast<float>(kEndWord)};
  const float x = 0.5f / static_cast<float>(image.width) + kLinkEnd, y = 0.5f / static_cast<float>(image.height);
  return {x, y, x, y};
}

/// The first unit of a stored primitive.
inline std::uint64_t primitive_unit(const GeometryImage& image, std::uint32_t k) {
  return image.primitive_start + std::uint64_t{image.primitive_stride} * k;
}
/// The texels of its P0, P1, P2; the last is its P1 again where the image has no triangles.
inline std::array<std::size_t, 3> primitive_texels(const GeometryImage& image, std::uint32_t k) {
  const std::uint64_t unit = primitive_unit(image, k);
  if (is_compact(image)) return {unit, unit + 1, unit + (image.primitive_stride == 3 ? 2 : 1)};
  const std::size_t below = unit_texel(image, unit, 1);
  return {unit_texel(image, unit), image.primitive_stride == 2 ? unit_texel(image, unit + 1) : below, below};
}

struct StoredPrimitive {
  glm::vec3 a{0.0f}, b{0.0f}, c{0.0f};  ///< corners; a sphere's centre is a
  float radius = 0.0f;                  ///< of a sphere
  float label = 0.0f;
  bool is_triangle = false;
};
inline StoredPrimitive stored_primitive(const GeometryImage& image, std::uint32_t k) {
  const auto at = primitive_texels(image, k);
  const glm::vec4 &p0 = image.texels[at[0]], &p1 = image.texels[at[1]], &p2 = image.texels[at[2]];
  StoredPrimitive primitive;
  primitive.a = glm::vec3(p0);
  primitive.label = p0.w;
  primitive.is_triangle = p1.w == kKindTriangle;
  if (primitive.is_triangle)
    primitive.b = glm::vec3(p1), primitive.c = glm::vec3(p2);
  else
    primitive.radius = p1.x;
  return primitive;
}

/// The primitive's number in the scene; nothing where the label is none.
inline std::optional<std::uint32_t> primitive_of_label(float label) {
  const float size = std::fabs(label);
  if (!(size >= 1.0f && size <= static_cast<float>(kMaxPrimitives)) || size != std::floor(size)) return std::nullopt;
  return static_cast<std::uint32_t>(size) - 1;
}

/// A record's number: a whole one that is exact as a float.
inline std::optional<std::uint32_t> whole_number(float value) {
  if (!(value >= 0.0f && value < static_cast<float>(kMaxExactFloat)) || value != std::floor(value) ||
      std::signbit(value))
    return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

inline const glm::vec4& record_texel(const GeometryImage& image, std::uint32_t n, std::uint32_t i) {
  return image.texels[transform_texel(image, n, i)];
}

/// A node's bounding volume.
struct Volume {
  bool is_box = false;
  glm::vec3 center{0.0f};              ///< of a ball
  float radius2 = 0.0f;                ///< squared
  glm::vec3 lower{0.0f}, upper{0.0f};  ///< of a box
};
inline Volume volume_at(const GeometryImage& image, std::uint64_t unit) {
  const glm::vec4& top = texel_at(image, unit);
  Volume volume;
  volume.is_box = has_boxes(image);
  if (volume.is_box) {
    volume.lower = glm::vec3(top);
    volume.upper = glm::vec3(texel_at(image, unit + 1));
  } else {
    volume.center = glm::vec3(top);
    volume.radius2 = is_compact(image) ? std::fabs(top.w) : top.w;
  }
  return volume;
}

inline bool same_bits(const glm::vec4& a, const glm::vec4& b) {
  return std::bit_cast<std::array<std::uint32_t, 4>>(a) == std::bit_cast<std::array<std::uint32_t, 4>>(b);
}
inline bool is_zero_bits(const glm::vec4& a) { return same_bits(a, glm::vec4(0.0f)); }

}  // namespace plumbline
