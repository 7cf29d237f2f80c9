// SPDX-License-Identifier: MIT
#include "tracer/image_structure.h"

#include <cmath>
#include <limits>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tracer/image_view.h"

namespace plumbline {
namespace {

/// The cell that a link of layout `paper` leads to; kNone outside of the image.
std::uint32_t link_cell(const GeometryImage& image, float x, float y) {
  const double column = std::floor((x - std::floor(static_cast<double>(x))) * image.width);
  const double row = std::floor(static_cast<double>(y) * image.height);
  if (!(column >= 0.0 && column < image.width && row >= 0.0 && row < image.height)) return kNone;
  return static_cast<std::uint32_t>(row / 2.0) * static_cast<std::uint32_t>(image.width) +
         static_cast<std::uint32_t>(column);
}

/// The clusters that hold a primitive, by their first stored primitive, ascending.
std::vector<std::uint32_t> clusters_of(const GeometryImage& image, std::uint32_t primitive) {
  std::vector<std::uint32_t> clusters;
  std::uint32_t first = 0;
  for (std::uint32_t k = 0; k < image.primitive_count; ++k) {
    const std::uint64_t unit = primitive_unit(image, k);
    if (unit >= unit_count(image)) break;
    const float label = texel_at(image, unit).w;
    if (primitive_of_label(label) == primitive && (clusters.empty() || clusters.back() != first))
      clusters.push_back(first);
    if (label < 0.0f) first = k + 1;
  }
  return clusters;
}

template <typename Want>
std::vector<std::uint32_t> leaves(const GeometryImage& image, const RegionCopy& copy, const Want& want) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t cell = copy.begin; cell < copy.end; cell += node_units(image)) {
    const NodeCell node = node_cell(image, cell);
    if (node.is_leaf && want(node)) found.push_back(cell);
  }
  return found;
}

}  // namespace

std::optional<RegionCopy> region_copy(const GeometryImage& image, std::uint32_t space, std::uint32_t copy) {
  std::uint64_t start = 0, size = image.copy_size;
  if (space != kNone) {
    if (space >= image.transform_count) return std::nullopt;
    const auto first = whole_number(record_texel(image, space, 4).w);
    const auto count = whole_number(record_texel(image, space, 5).w);
    if (!first || !count) return std::nullopt;
    start = *first, size = *count;
  }
  const std::uint64_t begin = start + copy * size;
  if (size == 0 || copy >= image.copy_count || begin + size > unit_count(image)) return std::nullopt;
  return RegionCopy{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(begin + size)};
}

NodeCell node_cell(const GeometryImage& image, std::uint32_t cell) {
  NodeCell node;
  const std::uint32_t units = node_units(image);
  if (cell >= unit_count(image)) return node;
  if (is_compact(image)) {
    const std::uint32_t word = std::bit_cast<std::uint32_t>(texel_at(image, cell).w);
    const std::uint32_t payload = word & ((1u << image.payload_bits) - 1u);
    node.is_end = word == kEndWord;
    node.is_leaf = !node.is_end && word >> 31 != 0;
    if (node.is_end) return node;
    node.out = cell + (node.is_leaf ? units : payload);
    if (!node.is_leaf) {
      node.in = cell + units;
    } else if (payload < image.primitive_count) {
      node.cluster = payload;
    } else if (payload - image.primitive_count < image.transform_count) {
      node.transform = payload - image.primitive_count;
    }
    return node;
  }
  const glm::vec4& links = texel_at(image, cell, 1);
  const std::uint32_t target = link_cell(image, links.x, links.y);
  if (links.z >= 0.0f) node.out = link_cell(image, links.z, links.w);
  const double kind = std::floor(static_cast<double>(links.x));
  if (kind == 0.0) {
    node.in = target;
  } else if ((kind == kLinkTriangle || kind == kLinkSphere) && target != kNone && target >= image.primitive_start) {
    node.is_leaf = true;
    node.cluster = (target - image.primitive_start) / std::max(image.primitive_stride, 1u);
  } else if (kind == kLinkTransform && target != kNone && target >= image.transform_start) {
    node.is_leaf = true;
    const std::uint32_t n = (target - image.transform_start) / record_units(image);
    if (n < image.transform_count) node.transform = n;
  }
  return node;
}

std::vector<std::uint32_t> chain_to(const GeometryImage& image, const RegionCopy& copy, std::uint32_t leaf) {
  std::vector<std::uint32_t> chain;
  const std::uint32_t units = node_units(image);
  for (std::uint32_t cell = copy.begin; cell < leaf;) {
    const NodeCell node = node_cell(image, cell);
    // The last of a chain leads out of it, to an end or to what stands behind its parents: all that follows up to there
    // is below it.
    const std::uint32_t end = node.is_leaf || node.is_end ? cell + units : std::min(node.out, copy.end);
    if (end > leaf) chain.push_back(cell);
    cell = end > leaf || end <= cell ? cell + units : end;
  }
  chain.push_back(leaf);
  return chain;
}

std::vector<std::uint32_t> leaves_of_primitive(const GeometryImage& image, const RegionCopy& copy,
                                               std::uint32_t primitive) {
  const std::vector<std::uint32_t> clusters = clusters_of(image, primitive);
  return leaves(image, copy, [&](const NodeCell& node) {
    return node.cluster != kNone && std::binary_search(clusters.begin(), clusters.end(), node.cluster);
  });
}

std::vector<std::uint32_t> leaves_of_transform(const GeometryImage& image, const RegionCopy& copy, std::uint32_t n) {
  return leaves(image, copy, [&](const NodeCell& node) { return node.transform == n; });
}

std::optional<std::vector<std::uint32_t>> transforms_to(const GeometryImage& image, std::uint32_t instance) {
  std::vector<std::uint32_t> path;
  for (std::uint32_t node = instance; node != kNone;) {
    // Parents have lower numbers, so that the way ends.
    if (node >= image.transform_count || (!path.empty() && node >= path.back())) return std::nullopt;
    path.push_back(node);
    const auto outer = whole_number(record_texel(image, node, 3).w);
    if (!outer) return std::nullopt;
    node = *outer - 1u;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

double scale_to_world(const GeometryImage& image, const std::vector<std::uint32_t>& path) {
  // Entries are rounded by u = 2^-24, so that of a matrix that stretches by s the products of columns are off by at
  // most 2 sqrt(3) u s^2, for each transform on the way.
  glm::dmat3 transposed(1.0);
  for (const std::uint32_t node : path) {
    glm::dmat3 out;
    for (int i = 0; i < 3; ++i) out[i] = glm::dvec3(record_texel(image, node, static_cast<std::uint32_t>(3 + i)));
    transposed = out * transposed;
  }
  const glm::dmat3 gram = transposed * glm::transpose(transposed);
  const double s2 = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
  const double allowed = 4.0 * 0x1p-24 * static_cast<double>(path.size()) * s2;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(gram[i][k] - (i == k ? s2 : 0.0)) <= allowed)) return std::numeric_limits<double>::quiet_NaN();
  return std::ldexp(std::sqrt(s2), -image.scale_exponent);
}

bool inverse_fits(const GeometryImage& image, std::uint32_t n) {
  for (int row = 0; row < 3; ++row) {
    const glm::dvec3 back(record_texel(image, n, static_cast<std::uint32_t>(row)));
    for (int column = 0; column < 3; ++column) {
      double sum = row == column ? -1.0 : 0.0, size = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double term =
            back[k] * static_cast<double>(record_texel(image, n, static_cast<std::uint32_t>(3 + k))[column]);
        sum += term;
        size += std::abs(term);
      }
      if (!(std::abs(sum) <= 0x1p-22 * size)) return false;
    }
  }
  return true;
}

}  // namespace plumbline
