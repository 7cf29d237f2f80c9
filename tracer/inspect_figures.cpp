// SPDX-License-Identifier: MIT
#include "tracer/inspect_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace plumbline {
namespace {

void count_at(std::vector<std::uint64_t>& histogram, std::size_t at) {
  if (histogram.size() <= at) histogram.resize(at + 1, 0);
  ++histogram[at];
}

class KindMap {
 public:
  KindMap(const GeometryImage& image, const InspectedImage& inspected) : image_(image), inspected_(inspected) {
    kinds_.assign(image.texels.size(), TexelKind::unused);
  }

  std::vector<TexelKind> fill() {
    for (const InspectedRegion& region : inspected_.regions)
      for (std::uint32_t c = 0; c < image_.copy_count; ++c) fill_copy(region, c);
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k)
      for (const std::size_t texel : primitive_texels(image_, k)) set(texel, TexelKind::primitive);
    for (std::uint32_t n = 0; n < image_.transform_count; ++n)
      for (std::uint32_t i = 0; i < kTransformTexels; ++i) set(transform_texel(image_, n, i), TexelKind::transform);
    for (std::uint32_t l = 0; l < image_.light_count; ++l)
      for (std::uint32_t i = 0; i < kLightTexels; ++i) set(light_texel(image_, l, i), TexelKind::light);
    return std::move(kinds_);
  }

 private:
  void set(std::size_t texel, TexelKind kind) {
    if (texel < kinds_.size()) kinds_[texel] = kind;
  }
  void fill_copy(const InspectedRegion& region, std::uint32_t c) {
    const std::uint64_t begin = std::uint64_t{region.start} + std::uint64_t{c} * region.copy_size;
    const std::uint32_t units = node_units(image_);
    for (std::uint32_t i = 0; i < region.node_count * units; ++i) {
      set(unit_texel(image_, begin + i), c == 0 ? TexelKind::node : TexelKind::copy);
      // Links stand below the first cell of a node; below the second nothing does.
      if (!is_compact(image_) && i % units == 0)
        set(unit_texel(image_, begin + i, 1), c == 0 ? TexelKind::link : TexelKind::copy);
    }
    if (is_compact(image_)) {
      set(begin + region.copy_size - 1, TexelKind::end);
    } else if (region.node_count == 0) {
      set(unit_texel(image_, begin), TexelKind::end), set(unit_texel(image_, begin, 1), TexelKind::end);
    }
  }

  const GeometryImage& image_;
  const InspectedImage& inspected_;
  std::vector<TexelKind> kinds_;
};

/// The surface of the unit sphere's image under a linear map, over the sphere's own: the mean of |cofactor(M) n| over
/// all n, here over points spread evenly on a spiral. Within 1 % where axes are stretched up to tenfold.
double surface_stretch(const glm::dmat3& linear) {
  constexpr int kPoints = 400;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                            glm::cross(linear[0], linear[1]));
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kPoints, r = std::sqrt(1.0 - z * z);
    sum += glm::length(cofactor * glm::dvec3(r * std::cos(golden * i), r * std::sin(golden * i), z));
  }
  return sum / kPoints;
}

/// That a random line through the ball of the region around a transform meets the ball of the space behind it: by
/// surfaces, more than 1 where that ball is the larger, so that its product with the chance of a node is the node's.
double chance_behind(const GeometryImage& image, const InspectedRegion& around, const InspectedRegion& behind,
                     const InspectedNode& leaf) {
  glm::dmat3 rows;
  for (int i = 0; i < 3; ++i)
    rows[i] = glm::dvec3(glm::vec3(record_texel(image, leaf.transform, static_cast<std::uint32_t>(3 + i))));
  const double share = behind.radius / around.radius;
  return surface_stretch(glm::transpose(rows)) * share * share;
}

/// Costs of a region's own nodes, and of those behind its transforms that are known already.
LineCost line_cost(const GeometryImage& image, const InspectedImage& inspected, std::uint32_t r,
                   const std::vector<RegionFigures>& figures) {
  const InspectedRegion& region = inspected.regions[r];
  LineCost cost;
  if (is_compact(image) || region.node_count == 0) cost.at_once = 1.0;
  for (std::uint32_t i = region.first_node; i < region.first_node + region.node_count; ++i) {
    const InspectedNode& node = inspected.nodes[i];
    if (node.parent == kNone)
      cost.at_once += 1.0;
    else
      cost.visits += inspected.nodes[node.parent].chance;
    if (!node.is_leaf) continue;
    cost.primitives += node.chance * node.primitives;
    if (node.transform == kNone) continue;
    cost.transforms += node.chance;
    const std::uint32_t behind = inspected.behind[node.transform];
    if (behind == kNone) continue;
    const LineCost& inner = figures[behind].cost;
    const double meets = chance_behind(image, region, inspected.regions[behind], node);
    cost.visits += node.chance * inner.at_once + meets * (inner.visits - inner.at_once);
    cost.primitives += meets * inner.primitives;
    cost.transforms += meets * inner.transforms;
  }
  cost.visits += cost.at_once;
  return cost;
}

}  // namespace

const char* name_of(TexelKind kind) {
  switch (kind) {
    case TexelKind::node:
      return "nodes";
    case TexelKind::link:
      return "links";
    case TexelKind::copy:
      return "copies";
    case TexelKind::end:
      return "ends";
    case TexelKind::primitive:
      return "primitives";
    case TexelKind::transform:
      return "transforms";
    case TexelKind::light:
      return "lights";
    case TexelKind::unused:
      return "unused";
  }
  return "";
}

std::vector<TexelKind> texel_kinds(const GeometryImage& image, const InspectedImage& inspected) {
  return KindMap(image, inspected).fill();
}

std::array<std::uint64_t, kTexelKinds> count_kinds(std::span<const TexelKind> kinds) {
  std::array<std::uint64_t, kTexelKinds> counts{};
  for (const TexelKind kind : kinds) ++counts[static_cast<std::size_t>(kind)];
  return counts;
}

Summary summarize_values(std::vector<double> values) {
  Summary s;
  s.count = values.size();
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  for (const double value : values) s.mean += value;
  s.mean /= static_cast<double>(values.size());
  const auto rank = [&](std::size_t parts, std::size_t of) { return values[(values.size() - 1) * parts / of]; };
  s.min = values.front(), s.median = rank(1, 2), s.p99 = rank(99, 100), s.max = values.back();
  return s;
}

TreeFigures figures_of(const GeometryImage& image, const InspectedImage& inspected) {
  TreeFigures all;
  all.regions.resize(inspected.regions.size());
  std::vector<double> slack, overlap;
  double met = 0.0, chances = 0.0;
  for (const InspectedNode& node : inspected.nodes) {
    RegionFigures& region = all.regions[node.region];
    ++region.nodes;
    region.depth = std::max(region.depth, node.depth);
    count_at(all.nodes_at, node.depth);
    if (node.is_leaf) {
      ++region.leaves;
      region.transforms += node.transform != kNone;
      region.primitives += node.primitives;
      count_at(all.depths, node.depth);
      if (node.cluster != kNone) count_at(all.leaf_sizes, node.primitives);
    } else {
      count_at(all.widths, node.children);
    }
    if (node.slack > 0.0) slack.push_back(node.slack);
    if (std::isnan(node.overlap)) continue;
    overlap.push_back(node.overlap);
    met += node.chance * node.overlap, chances += node.chance;
  }
  const std::uint64_t unit = is_compact(image) ? 1 : 2;
  for (std::size_t r = 0; r < all.regions.size(); ++r) {
    RegionFigures& region = all.regions[r];
    region.texels = unit * (std::uint64_t{image.copy_count} * inspected.regions[r].copy_size +
                            std::uint64_t{image.primitive_stride} * region.primitives);
    all.nodes += region.nodes, all.leaves += region.leaves, all.transforms += region.transforms;
    all.primitives += region.primitives;
    all.depth = std::max(all.depth, region.depth);
  }
  for (const std::uint32_t r : inspected.inner_first) all.regions[r].cost = line_cost(image, inspected, r, all.regions);
  if (!all.regions.empty()) all.cost = all.regions[0].cost;
  all.slack = summarize_values(std::move(slack));
  all.overlap = summarize_values(std::move(overlap));
  all.overlap_met = chances > 0.0 ? met / chances : 0.0;
  return all;
}

}  // namespace plumbline
