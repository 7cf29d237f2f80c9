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

  void write() {
    cells_per_node_ = image_.options.bounds == Bounds::aabb ? 2 : 1;
    const std::uint64_t nodes = std::max<std::size_t>(input_.nodes.size(), 1);
    image_.cell_count = static_cast<std::uint32_t>(nodes);
    const std::uint64_t copy_size = nodes * cells_per_node_;
    const std::uint64_t node_cells = image_.copy_count * copy_size;
    const std::uint64_t start = node_cells + node_cells % 2;
    allocate_texels(2 * (start + std::uint64_t{image_.primitive_stride} * image_.primitive_count), image_);
    image_.copy_size = static_cast<std::uint32_t>(copy_size);
    image_.primitive_start = static_cast<std::uint32_t>(start);
    for (unsigned copy = 0; copy < image_.copy_count; ++copy) {
      if (input_.nodes.empty()) {
        write_cell(next_, glm::vec4(0.0f), glm::vec4(end_link(), end_link()));
        next_ += cells_per_node_;
      } else {
        write_node(0, copy, end_link());
      }
    }
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
  }

 private:
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

  /// Cells of a subtree: what the out link of its last chain reaches is known before it is written.
  std::uint32_t subtree_cells(std::uint32_t n) {
    if (subtree_.empty()) {
      subtree_.assign(input_.nodes.size(), cells_per_node_);
      for (std::uint32_t i = static_cast<std::uint32_t>(subtree_.size()); i-- > 0;) {
        const TreeNode& node = input_.tree.nodes[i];
        for (std::uint32_t c = 0; c < node.child_count; ++c) subtree_[i] += subtree_[node.first_child + c];
      }
    }
    return subtree_[n];
  }

  void write_node(std::uint32_t n, unsigned copy, glm::vec2 out) {
    const TreeNode& node = input_.tree.nodes[n];
    const std::uint32_t cell = next_;
    next_ += cells_per_node_;
    glm::vec2 in = link(next_, 0);
    if (node.is_leaf()) {
      const bool triangle = input_.primitives[node.first_reference][1].w == kKindTriangle;
      in = link(image_.primitive_start + image_.primitive_stride * node.first_reference,
                triangle ? kLinkTriangle : kLinkSphere);
    }
    const PaddedNode& padded = input_.nodes[n];
    if (image_.options.bounds == Bounds::aabb) {
      write_cell(cell, glm::vec4(padded.lower, 0.0f), glm::vec4(in, out));
      write_cell(cell + 1, glm::vec4(padded.upper, 0.0f), glm::vec4(0.0f));
    } else {
      write_cell(cell, glm::vec4(padded.center, round_up(padded.radius2)), glm::vec4(in, out));
    }
    const auto children = ordered_children(input_.tree, n, copy, image_.options.links == Links::octant);
    for (std::size_t i = 0; i < children.size(); ++i) {
      const bool last = i + 1 == children.size();
      write_node(children[i], copy, last ? out : link(next_ + subtree_cells(children[i]), 0));
    }
  }

  const BakeInput& input_;
  GeometryImage& image_;
  std::uint32_t next_ = 0;
  std::uint32_t cells_per_node_ = 1;
  std::vector<std::uint32_t> subtree_;
};

}  // namespace

void bake_paper(const BakeInput& input, GeometryImage& image) { PaperWriter(input, image).write(); }

}  // namespace plumbline
