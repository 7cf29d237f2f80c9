// SPDX-License-Identifier: MIT
// Changes to records of transforms, to primitives, and to single numbers.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tracer/broken_trees_edit.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

bool any(std::uint32_t) { return true; }
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kDenormal = 0x1p-140f;

glm::vec4& record(TreeEditor& editor, std::uint32_t n, std::uint32_t i) {
  return editor.image.texels[transform_texel(editor.image, n, i)];
}
std::uint32_t any_transform(TreeEditor& editor) { return editor.choose(editor.image.transform_count, any); }

/// A stored primitive that does (not) end its cluster.
std::uint32_t choose_primitive(TreeEditor& editor, bool ends) {
  return editor.choose(editor.image.primitive_count,
                       [&](std::uint32_t k) { return (stored_primitive(editor.image, k).label < 0.0f) == ends; });
}
glm::vec4& primitive_texel(TreeEditor& editor, std::uint32_t k, std::size_t i) {
  return editor.image.texels[primitive_texels(editor.image, k)[i]];
}
std::size_t primitive_place(const TreeEditor& editor, std::uint32_t k) { return primitive_texels(editor.image, k)[0]; }

}  // namespace

std::size_t break_leaf_place(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  record(editor, n, 8).x += 1.0f;
  return transform_texel(editor.image, n, 8);
}

std::size_t swap_leaf_places(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  std::swap(record(editor, n, 8).y, record(editor, n, 8).w);
  return transform_texel(editor.image, n, 8);
}

std::size_t break_parent(TreeEditor& editor) {
  const GeometryImage& image = editor.image;
  const std::uint32_t n =
      editor.choose(image.transform_count, [&](std::uint32_t i) { return record_texel(image, i, 3).w > 0.0f; });
  record(editor, n, 3).w = 0.0f;
  return transform_texel(image, n, 3);
}

std::size_t break_depth(TreeEditor& editor) {
  const GeometryImage& image = editor.image;
  const std::uint32_t n =
      editor.choose(image.transform_count, [&](std::uint32_t i) { return record_texel(image, i, 7).y > 0.0f; });
  record(editor, n, 7).z += 1.0f;
  return transform_texel(image, n, 7);
}

std::size_t break_region(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  record(editor, n, 4).w += 1.0f;
  return transform_texel(editor.image, n, 4);
}

std::size_t break_primitive_range(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  record(editor, n, 7).y += 1.0f;
  return transform_texel(editor.image, n, 7);
}

std::size_t scale_inverse(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  glm::vec4& row = record(editor, n, 1);
  for (int i = 0; i < 3; ++i) row[i] *= 1.0f + 0x1p-18f;
  return transform_texel(editor.image, n, 1);
}

std::size_t transpose_inverse(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < i; ++k)
      std::swap(record(editor, n, static_cast<std::uint32_t>(i))[k],
                record(editor, n, static_cast<std::uint32_t>(k))[i]);
  return transform_texel(editor.image, n, 0);
}

std::size_t move_transform(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  record(editor, n, 1).w += 0x1p-19f * editor.image.radius;
  return transform_texel(editor.image, n, 1);
}

std::size_t nudge_inverse(TreeEditor& editor) {
  const std::uint32_t n = any_transform(editor);
  float& entry = record(editor, n, 2).z;  // the third axis is scaled alone, so the entry stands in one product
  entry = std::nextafter(entry, 0.0f);
  return transform_texel(editor.image, n, 2);
}

std::size_t unend_cluster(TreeEditor& editor) {
  const std::uint32_t k = choose_primitive(editor, true);
  float& label = primitive_texel(editor, k, 0).w;
  label = -label;
  return primitive_place(editor, k);
}

std::size_t end_cluster(TreeEditor& editor) {
  const std::uint32_t k = choose_primitive(editor, false);
  float& label = primitive_texel(editor, k, 0).w;
  label = -label;
  return primitive_place(editor, k);
}

std::size_t break_label(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count, any);
  primitive_texel(editor, k, 0).w += 0.5f;
  return primitive_place(editor, k);
}

std::size_t break_word_low(TreeEditor& editor) {
  const auto nodes = editor.nodes(3);
  const EditNode node = editor.choose(nodes, [](const EditNode&) { return true; });
  float& word = editor.texel(node.unit).w;
  word = std::bit_cast<float>(std::bit_cast<std::uint32_t>(word) | 1u << editor.image.payload_bits);
  return editor.place(node.unit);
}

std::size_t break_word_high(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), [](const EditNode&) { return true; });
  float& word = editor.texel(node.unit).w;
  word = std::bit_cast<float>(std::bit_cast<std::uint32_t>(word) & ~0x20000000u);
  return editor.place(node.unit);
}

std::size_t make_centre_nan(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), [](const EditNode&) { return true; });
  editor.texel(node.unit).z = std::numeric_limits<float>::quiet_NaN();
  return editor.place(node.unit);
}

std::size_t make_corner_infinite(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count, any);
  primitive_texel(editor, k, 2).y = kInfinity;
  return primitive_texels(editor.image, k)[2];
}

std::size_t make_radius_denormal(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), [](const EditNode& n) { return n.is_leaf; });
  editor.texel(node.unit).w = kDenormal;
  return editor.place(node.unit);
}

std::size_t make_sphere_denormal(TreeEditor& editor) {
  const auto is_sphere = [&](std::uint32_t k) { return !stored_primitive(editor.image, k).is_triangle; };
  const std::uint32_t k = editor.choose(editor.image.primitive_count, is_sphere);  // not the ground
  primitive_texel(editor, k, 1).x = kDenormal;
  return primitive_texels(editor.image, k)[1];
}

std::size_t write_behind(TreeEditor& editor) {
  editor.image.texels.back().y = 1.0f;
  return editor.image.texels.size() - 1;
}

std::size_t write_unused(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count, any);
  primitive_texel(editor, k, 2).w = 1.0f;
  return primitive_texels(editor.image, k)[2];
}

std::size_t move_light(TreeEditor& editor) {
  const std::uint32_t l = editor.choose(editor.image.light_count, any);
  float& x = editor.image.texels[light_texel(editor.image, l, 0)].x;
  x = std::nextafter(x, kInfinity);
  return light_texel(editor.image, l, 0);
}

std::size_t exchange_lights(TreeEditor& editor) {
  GeometryImage& image = editor.image;
  const std::uint32_t l = editor.choose(image.light_count - 1, any);
  for (std::uint32_t i = 0; i < kLightTexels; ++i)
    std::swap(image.texels[light_texel(image, l, i)], image.texels[light_texel(image, l + 1, i)]);
  return light_texel(image, l, 0);
}

std::size_t move_corner(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count, any);
  const StoredPrimitive p = stored_primitive(editor.image, k);
  // Inwards, so that no bound is left.
  glm::vec4& corner = primitive_texel(editor, k, 1);
  const glm::vec3 moved = glm::vec3(corner) + (p.a - p.b) / 1024.0f;
  corner = glm::vec4(moved, corner.w);
  return primitive_place(editor, k);
}

std::size_t exchange_labels(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count - 1, any);
  float &a = primitive_texel(editor, k, 0).w, &b = primitive_texel(editor, k + 1, 0).w;
  const float label = std::fabs(a);
  a = std::copysign(b, a), b = std::copysign(label, b);
  return primitive_place(editor, k);
}

std::size_t turn_triangle(TreeEditor& editor) {
  const std::uint32_t k = editor.choose(editor.image.primitive_count, any);
  const StoredPrimitive p = stored_primitive(editor.image, k);
  glm::vec4 &b = primitive_texel(editor, k, 1), &c = primitive_texel(editor, k, 2);
  b = glm::vec4(p.c, b.w), c = glm::vec4(p.b, c.w);
  return primitive_place(editor, k);
}

std::size_t repeat_primitive(TreeEditor& editor) {
  // Of one cluster, so that what holds the one holds the other.
  const std::uint32_t k = choose_primitive(editor, false);
  const float sign = primitive_texel(editor, k + 1, 0).w;
  for (std::size_t i = 0; i < 3; ++i) primitive_texel(editor, k + 1, i) = primitive_texel(editor, k, i);
  float& label = primitive_texel(editor, k + 1, 0).w;
  label = std::copysign(label, sign);
  --editor.image.triangle_count;
  return kAttribute;
}

}  // namespace plumbline
