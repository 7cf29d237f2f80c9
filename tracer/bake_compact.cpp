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

  BakeOutput write() {
    node_texels_ = image_.options.bounds == Bounds::aabb ? 2 : 1;
    std::uint64_t texels = 0, longest = 0;
    for (const BakeRegion& region : input_.regions) {
      longest = std::max<std::uint64_t>(longest, region.nodes.size() * node_texels_);
      texels += image_.copy_count * (region.nodes.size() * node_texels_ + 1);
    }
    const std::uint64_t payloads = std::uint64_t{image_.primitive_count} + image_.transform_count;
    image_.payload_bits = static_cast<int>(std::bit_width(std::max(longest, payloads)));
    if (image_.payload_bits > kMaxPayloadBits) {
      throw InputError("the tree of " + image_.scene_name +
                       " has more nodes or primitives than 23 bits can number; use the layout `paper`");
    }
    const std::uint64_t transforms = texels + std::uint64_t{image_.primitive_stride} * image_.primitive_count;
    allocate_texels(transforms + std::uint64_t{kTransformTexels} * image_.transform_count +
                        std::uint64_t{kLightTexels} * image_.light_count,
                    image_);
    image_.primitive_start = static_cast<std::uint32_t>(texels);
    image_.transform_start = static_cast<std::uint32_t>(transforms);
    output_.leaves.resize(image_.transform_count);
    for (const BakeRegion& region : input_.regions) write_region(region);
    image_.copy_size = output_.regions[0].copy_size;
    for (const PrimitiveTexels& primitive : input_.primitives) {
      for (std::uint32_t i = 0; i < image_.primitive_stride; ++i) image_.texels[next_++] = primitive[i];
    }
    return std::move(output_);
  }

 private:
  void write_region(const BakeRegion& region) {
    const auto size = static_cast<std::uint32_t>(region.nodes.size() * node_texels_ + 1);
    output_.regions.push_back({static_cast<std::uint32_t>(next_), size});
    const bool sorted = image_.options.links == Links::octant;
    for (unsigned copy = 0; copy < image_.copy_count; ++copy) {
      for (const std::uint32_t root : region.roots) write_node(region, root, copy, sorted);
      image_.texels[next_++] = glm::vec4(0.0f, 0.0f, 0.0f, std::bit_cast<float>(kEndWord));
    }
  }

  void write_node(const BakeRegion& region, std::uint32_t n, unsigned copy, bool sorted) {
    const BakeNode& node = region.nodes[n];
    const std::size_t at = next_;
    next_ += node_texels_;
    for (const std::uint32_t child : ordered(region, children_of(node), copy, sorted))
      write_node(region, child, copy, sorted);
    if (node.is_leaf() && node.payload >= image_.primitive_count)
      output_.leaves[node.payload - image_.primitive_count][copy] = static_cast<std::uint32_t>(at);
    const std::uint32_t payload = node.is_leaf() ? node.payload : static_cast<std::uint32_t>(next_ - at);
    const auto texels = compact_node(node, payload, image_);
    for (std::uint32_t i = 0; i < node_texels_; ++i) image_.texels[at + i] = texels[i];
  }

  const BakeInput& input_;
  GeometryImage& image_;
  BakeOutput output_;
  std::size_t next_ = 0;
  std::uint32_t node_texels_ = 1;
};

}  // namespace

std::array<glm::vec4, 2> compact_node(const BakeNode& node, std::uint32_t payload, const GeometryImage& image) {
  const std::uint32_t leaf_bit = node.is_leaf() ? kLeafBit : 0u;
  if (image.options.bounds == Bounds::aabb) {
    return {glm::vec4(node.lower, std::bit_cast<float>(kWordBase | payload | leaf_bit)), glm::vec4(node.upper, 0.0f)};
  }
  const std::uint32_t word = sphere_word(node.radius2, payload, image.payload_bits);
  return {glm::vec4(node.center, std::bit_cast<float>(word | leaf_bit)), glm::vec4(0.0f)};
}

BakeOutput bake_compact(const BakeInput& input, GeometryImage& image) { return CompactWriter(input, image).write(); }

}  // namespace plumbline
