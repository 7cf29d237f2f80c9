// SPDX-License-Identifier: MIT
// The layout `compact`: depth-first copies of the tree, one texel per node, the way out in the low bits of the squared
// radius.
#include <algorithm>
#include <bit>

#include "scenes/error.h"
#include "tracer/bake.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kLeafBit = 0x80000000u;

/// A positive float of at least `radius2` whose low bits are the payload.
std::uint32_t sphere_word(double radius2, std::uint32_t payload, int payload_bits) {
  const std::uint32_t mask = (1u << payload_bits) - 1u;
  const std::uint32_t wanted = std::bit_cast<std::uint32_t>(round_up(radius2));
  const std::uint32_t word = (wanted & ~mask) | payload;
  return word >= wanted ? word : word + mask + 1u;
}

class CompactWriter {
 public:
  CompactWriter(const BakeInput& input, GeometryImage& image) : input_(input), image_(image) {}

  void write() {
    const std::uint32_t texels_per_node = image_.options.bounds == Bounds::aabb ? 2 : 1;
    const std::uint64_t nodes = input_.nodes.size();
    image_.cell_count = static_cast<std::uint32_t>(nodes + 1);
    image_.payload_bits = std::bit_width(std::max<std::uint64_t>(nodes * texels_per_node, image_.primitive_count));
    if (image_.payload_bits > kMaxPayloadBits) {
      throw InputError("the tree of " + image_.scene_name +
                       " has more nodes or primitives than 23 bits can number; use the layout `paper`");
    }
    const std::uint64_t copy_size = nodes * texels_per_node + 1;
    const std::uint64_t start = image_.copy_count * copy_size;
    allocate_texels(start + std::uint64_t{image_.primitive_stride} * image_.primitive_count, image_);
    image_.copy_size = static_cast<std::uint32_t>(copy_size);
    image_.primitive_start = static_cast<std::uint32_t>(start);
    for (unsigned copy = 0; copy < image_.copy_count; ++copy) {
      if (nodes > 0) write_node(0, copy);
      image_.texels[next_++] = glm::vec4(0.0f, 0.0f, 0.0f, std::bit_cast<float>(kEndWord));
    }
    for (const PrimitiveTexels& primitive : input_.primitives) {
      for (std::uint32_t i = 0; i < image_.primitive_stride; ++i) image_.texels[next_++] = primitive[i];
    }
  }

 private:
  void write_node(std::uint32_t n, unsigned copy) {
    const TreeNode& node = input_.tree.nodes[n];
    const std::size_t at = next_;
    next_ += image_.options.bounds == Bounds::aabb ? 2 : 1;
    for (const std::uint32_t child : ordered_children(input_.tree, n, copy, image_.options.links == Links::octant))
      write_node(child, copy);
    const std::uint32_t payload = node.is_leaf() ? node.first_reference : static_cast<std::uint32_t>(next_ - at);
    const std::uint32_t leaf_bit = node.is_leaf() ? kLeafBit : 0u;
    const PaddedNode& padded = input_.nodes[n];
    if (image_.options.bounds == Bounds::aabb) {
      image_.texels[at] = glm::vec4(padded.lower, std::bit_cast<float>(kWordBase | payload | leaf_bit));
      image_.texels[at + 1] = glm::vec4(padded.upper, 0.0f);
    } else {
      const std::uint32_t word = sphere_word(padded.radius2, payload, image_.payload_bits);
      image_.texels[at] = glm::vec4(padded.center, std::bit_cast<float>(word | leaf_bit));
    }
  }

  const BakeInput& input_;
  GeometryImage& image_;
  std::size_t next_ = 0;
};

}  // namespace

void bake_compact(const BakeInput& input, GeometryImage& image) { CompactWriter(input, image).write(); }

}  // namespace plumbline
