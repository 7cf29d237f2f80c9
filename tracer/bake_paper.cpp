// SPDX-License-Identifier: MIT
// The layout `paper` (the paper, section 4): cells two texels high, links as texture coordinates.
#include <algorithm>

#include "scenes/error.h"
#include "tracer/bake.h"

namespace plumbline {
namespace {

class PaperWriter {
 public:
  PaperWriter(const BakeInput& input, GeometryImage& image) : input_(input), image_(image) {}

  BakeOutput write() {
    cells_per_node_ = image_.options.bounds == Bounds::aabb ? 2 : 1;
    std::uint64_t cells = 0;
    for (const BakeRegion& region : input_.regions) cells += image_.copy_count * region_cells(region);
    const std::uint64_t start = cells + cells % 2;
    const std::uint64_t transforms = start + std::uint64_t{image_.primitive_stride} * image_.primitive_count;
    allocate_texels(2 * (transforms + std::uint64_t{kTransformTexels / 2} * image_.transform_count +
                         std::uint64_t{kLightTexels / 2} * image_.light_count),
                    image_);
    image_.primitive_start = static_cast<std::uint32_t>(start);
    image_.transform_start = static_cast<std::uint32_t>(transforms);
    output_.leaves.resize(image_.transform_count);
    for (const BakeRegion& region : input_.regions) write_region(region);
    image_.copy_size = output_.regions[0].copy_size;
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k) {
      const PrimitiveTexels& p = input_.primitives[k];
      const std::uint32_t cell = image_.primitive_start + k * image_.primitive_stride;
      if (image_.primitive_stride == 1) {
        write_cell(cell, p[0], p[1]);
      } else {
        write_cell(cell, p[0], p[2]);
        write_cell(cell + 1, p[1], glm::vec4(0.0f));
      }
    }
    return std::move(output_);
  }

 private:
  /// Cells of one copy; an empty region has one cell whose both links end.
  std::uint64_t region_cells(const BakeRegion& region) const {
    return std::max<std::size_t>(region.nodes.size(), 1) * cells_per_node_;
  }

  glm::vec2 link(std::uint32_t cell, int kind) const {
    const std::uint32_t width = static_cast<std::uint32_t>(image_.width);
    const float x = (static_cast<float>(cell % width) + 0.5f) / static_cast<float>(image_.width);
    const float y = (2.0f * static_cast<float>(cell / width) + 0.5f) / static_cast<float>(image_.height);
    return {x + static_cast<float>(kind), y};
  }
  glm::vec2 end_link() const { return link(0, kLinkEnd); }

  void write_cell(std::uint32_t cell, const glm::vec4& top, const glm::vec4& below) {
    const std::size_t width = static_cast<std::size_t>(image_.width);
    const std::size_t at = cell / width * 2 * width + cell % width;
    image_.texels[at] = top;
    image_.texels[at + width] = below;
  }

  void write_region(const BakeRegion& region) {
    output_.regions.push_back({next_, static_cast<std::uint32_t>(region_cells(region))});
    // Cells of subtrees: what the out link of a chain's last node reaches is known before it is written.
    subtree_.assign(region.nodes.size(), cells_per_node_);
    for (std::size_t i = subtree_.size(); i-- > 0;)
      for (const std::uint32_t child : children_of(region.nodes[i])) subtree_[i] += subtree_[child];
    const bool sorted = image_.options.links == Links::octant;
    for (unsigned copy = 0; copy < image_.copy_count; ++copy) {
      if (region.nodes.empty()) {
        write_cell(next_, glm::vec4(0.0f), glm::vec4(end_link(), end_link()));
        next_ += cells_per_node_;
      }
      write_chain(region, region.roots, copy, sorted, end_link());
    }
  }

  /// Nodes side by side; `out` is where the last of them leads on.
  void write_chain(const BakeRegion& region, const std::vector<std::uint32_t>& chain, unsigned copy, bool sorted,
                   glm::vec2 out) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const bool last = i + 1 == chain.size();
      write_node(region, chain[i], copy, sorted, last ? out : link(next_ + subtree_[chain[i]], 0));
    }
  }

  void write_node(const BakeRegion& region, std::uint32_t n, unsigned copy, bool sorted, glm::vec2 out) {
    const BakeNode& node = region.nodes[n];
    const std::uint32_t cell = next_;
    next_ += cells_per_node_;
    glm::vec2 in = link(next_, 0);
    if (node.is_leaf() && node.payload >= image_.primitive_count) {
      const std::uint32_t number = node.payload - image_.primitive_count;
      output_.leaves[number][copy] = cell;
      in = link(image_.transform_start + kTransformTexels / 2 * number, kLinkTransform);
    } else if (node.is_leaf()) {
      const bool triangle = input_.primitives[node.payload][1].w == kKindTriangle;
      in =
          link(image_.primitive_start + image_.primitive_stride * node.payload, triangle ? kLinkTriangle : kLinkSphere);
    }
    const auto tops = paper_node(node, image_.options.bounds);
    write_cell(cell, tops[0], glm::vec4(in, out));
    if (cells_per_node_ == 2) write_cell(cell + 1, tops[1], glm::vec4(0.0f));
    write_chain(region, ordered(region, children_of(node), copy, sorted), copy, sorted, out);
  }

  const BakeInput& input_;
  GeometryImage& image_;
  BakeOutput output_;
  std::uint32_t next_ = 0;
  std::uint32_t cells_per_node_ = 1;
  std::vector<std::uint32_t> subtree_;
};

}  // namespace

std::array<glm::vec4, 2> paper_node(const BakeNode& node, Bounds bounds) {
  if (bounds == Bounds::aabb) return {glm::vec4(node.lower, 0.0f), glm::vec4(node.upper, 0.0f)};
  return {glm::vec4(node.center, round_up(node.radius2)), glm::vec4(0.0f)};
}

BakeOutput bake_paper(const BakeInput& input, GeometryImage& image) { return PaperWriter(input, image).write(); }

}  // namespace plumbline
