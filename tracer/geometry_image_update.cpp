// SPDX-License-Identifier: MIT
// Moving nodes in a finished image: their own records and the spheres above them are written anew, nothing below.
#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "scenes/error.h"
#include "tracer/bake.h"

namespace plumbline {
namespace {

/// Writes texels and remembers those whose bits changed.
class Updater {
 public:
  Updater(const Scene& scene, const SceneTree& tree, GeometryImage& image) : scene_(scene), tree_(tree), image_(image) {
    node_texels_ = image.options.bounds == Bounds::aabb ? 2 : 1;
  }

  void update_record(std::uint32_t n) {
    glm::vec3 fixed;
    for (std::uint32_t row = 0; row < 3; ++row)
      fixed[static_cast<int>(row)] = image_.texels[transform_texel(image_, n, 3 + row)].w;
    const MovingTexels moving = moving_texels(scene_, tree_, n, fixed);
    for (std::uint32_t i = 0; i < moving.size(); ++i) put(transform_texel(image_, n, i), moving[i]);
  }

  /// The bounds of a group's node, in every copy.
  void update_bounds(const GroupPlace& place) {
    const GroupTree& group = tree_.groups[place.group];
    const int exponent = place.group == 0 ? image_.scale_exponent : inner_exponent(scene_, tree_, place.group - 1);
    const BakeNode node = bake_group_node(group, place.node, exponent);
    const bool compact = image_.options.layout == Layout::compact;
    for (unsigned copy = 0; copy < image_.copy_count; ++copy) {
      const std::uint32_t at = place_of(place, copy);
      std::array<glm::vec4, 2> texels;
      if (compact) {
        // The payload is the tree's, which stays.
        const std::uint32_t word = std::bit_cast<std::uint32_t>(image_.texels[at].w);
        texels = compact_node(node, word & ((1u << image_.payload_bits) - 1u), image_);
      } else {
        texels = paper_node(node, image_.options.bounds);
      }
      for (std::uint32_t i = 0; i < node_texels_; ++i) put(compact ? at + i : top_texel(at + i), texels[i]);
    }
  }

  std::vector<TexelRange> ranges() {
    std::sort(changed_.begin(), changed_.end());
    std::vector<TexelRange> ranges;
    for (const std::uint32_t texel : changed_) {
      if (!ranges.empty() && ranges.back().first + ranges.back().count == texel)
        ++ranges.back().count;
      else
        ranges.push_back({texel, 1});
    }
    return ranges;
  }

 private:
  void put(std::size_t at, const glm::vec4& texel) {
    if (std::memcmp(&image_.texels[at], &texel, sizeof texel) == 0) return;
    image_.texels[at] = texel;
    changed_.push_back(static_cast<std::uint32_t>(at));
  }

  std::size_t top_texel(std::size_t cell) const {
    const std::size_t width = static_cast<std::size_t>(image_.width);
    return cell / width * 2 * width + cell % width;
  }

  /// Where a group's node stands in a copy: a leaf as its scene node's record says, an inner node before the first leaf
  /// of its own in this copy's order.
  std::uint32_t place_of(const GroupPlace& place, unsigned copy) const {
    const GroupTree& group = tree_.groups[place.group];
    std::uint32_t n = place.node, above = 0;
    while (!group.nodes[n].is_leaf()) {
      n = first_child(group, n, copy);
      above += node_texels_;
    }
    const std::uint32_t scene_node = group.leaves[group.nodes[n].first_leaf];
    const float leaf = image_.texels[transform_texel(image_, scene_node, 8 + copy / 4)][static_cast<int>(copy % 4)];
    return static_cast<std::uint32_t>(leaf) - above;
  }

  std::uint32_t first_child(const GroupTree& group, std::uint32_t n, unsigned copy) const {
    const GroupNode& node = group.nodes[n];
    if (image_.options.links == Links::threaded) return node.first_child;
    const glm::dvec3 diagonal((copy & 1u) != 0 ? -1.0 : 1.0, (copy & 2u) != 0 ? -1.0 : 1.0,
                              (copy & 4u) != 0 ? -1.0 : 1.0);
    std::uint32_t first = node.first_child;
    for (std::uint32_t c = first + 1; c < node.first_child + node.child_count; ++c)
      if (glm::dot(group.nodes[c].rest_center, diagonal) < glm::dot(group.nodes[first].rest_center, diagonal))
        first = c;
    return first;
  }

  const Scene& scene_;
  const SceneTree& tree_;
  GeometryImage& image_;
  std::uint32_t node_texels_ = 1;
  std::vector<std::uint32_t> changed_;
};

}  // namespace

std::vector<TexelRange> update_transforms(const Scene& scene, std::span<const std::uint32_t> moved, SceneTree& tree,
                                          GeometryImage& image) {
  PLUMBLINE_ASSERT(image.transform_count == scene.nodes.size() && tree.leaf.size() == scene.nodes.size());
  for (const std::uint32_t n : moved) {
    PLUMBLINE_ASSERT(n < scene.nodes.size());
    if (const std::string error = transform_error(scene.nodes[n].transform); !error.empty())
      throw InputError("scene " + scene.name + ": the transform of node " + scene.nodes[n].name + " " + error);
  }
  bool rescaled = false;
  const std::vector<GroupPlace> places = refit_groups(scene, moved, tree, rescaled);
  Updater updater(scene, tree, image);
  if (rescaled) {
    // A space has outgrown the power of two that its paddings are measured by: all of them change.
    refit_all_groups(scene, tree);
    const GeometryImage anew = bake(scene, tree, image.options);
    PLUMBLINE_ASSERT(anew.texels.size() == image.texels.size());
    std::vector<TexelRange> ranges;
    for (std::uint32_t i = 0; i < anew.texels.size(); ++i) {
      if (std::memcmp(&anew.texels[i], &image.texels[i], sizeof(glm::vec4)) == 0) continue;
      if (!ranges.empty() && ranges.back().first + ranges.back().count == i)
        ++ranges.back().count;
      else
        ranges.push_back({i, 1});
    }
    const BakeOptions options = image.options;
    image = anew;
    image.options = options;
    return ranges;
  }
  set_image_ball(scene, tree, image);
  std::set<std::uint32_t> records(moved.begin(), moved.end());
  for (const GroupPlace& place : places) {
    updater.update_bounds(place);
    if (place.group > 0) records.insert(place.group - 1);  // the ball of what stands behind that node
  }
  for (const std::uint32_t n : records)
    if (tree.leaf[n] != kNone) updater.update_record(n);
  return updater.ranges();
}

}  // namespace plumbline
