// SPDX-License-Identifier: MIT
// The changes that break an image in one place each. Only broken_trees.cpp needs them.
#pragma once

#include <functional>
#include <utility>

#include "scenes/random.h"
#include "tracer/geometry_image.h"

namespace plumbline {

/// What a change returns where it concerns an attribute of the image.
inline constexpr std::size_t kAttribute = static_cast<std::size_t>(-1);

/// A node of one copy of a region, as the changes need it.
struct EditNode {
  std::uint32_t unit = 0;   ///< where it stands
  std::uint32_t index = 0;  ///< number within its copy
  std::uint32_t end = 0;    ///< number of the node behind all that stands below
  std::uint32_t parent = kNone, payload = kNone;
  bool is_leaf = false;
};

/// A copy of an image of which changes choose places.
class TreeEditor {
 public:
  TreeEditor(GeometryImage& image_in, const Scene& scene_in, Random& random)
      : image(image_in), scene(scene_in), random_(random) {}

  /// The nodes of a copy of the world's region, or of the region behind a scene node.
  std::vector<EditNode> nodes(std::uint32_t copy = 0, std::uint32_t space = kNone) const;
  /// One of the items that satisfy a condition. There is one.
  EditNode choose(const std::vector<EditNode>& from, const std::function<bool(const EditNode&)>& condition);
  std::uint32_t choose(std::uint32_t count, const std::function<bool(std::uint32_t)>& condition);
  /// Two nodes that satisfy a condition together: the first among those that have such a second.
  std::pair<EditNode, EditNode> choose_pair(const std::vector<EditNode>& from,
                                            const std::function<bool(const EditNode&, const EditNode&)>& condition);

  glm::vec4& texel(std::uint64_t unit, int row = 0);
  std::size_t place(std::uint64_t unit) const;
  /// The words of a node's links. In layout `compact`, of its only way out.
  void set_out(const EditNode& node, std::uint32_t target_index);
  void set_payload(const EditNode& node, std::uint32_t payload);

  GeometryImage& image;
  const Scene& scene;  ///< of which the image is

 private:
  Random& random_;
};

// Each makes the change that its entry in broken_trees.cpp describes, and returns the texel whose cell is to be named.
std::size_t break_cap(TreeEditor& editor);
std::size_t break_primitive_start(TreeEditor& editor);
std::size_t break_image_ball(TreeEditor& editor);
std::size_t break_scale(TreeEditor& editor);

std::size_t break_out_past_parent(TreeEditor& editor);
std::size_t break_out_by_half(TreeEditor& editor);
std::size_t break_link_centre(TreeEditor& editor);
std::size_t break_link_kind(TreeEditor& editor);
std::size_t swap_out_links(TreeEditor& editor);
std::size_t skip_node(TreeEditor& editor);
std::size_t break_leaf_payload(TreeEditor& editor);
std::size_t run_on(TreeEditor& editor);
std::size_t end_early(TreeEditor& editor);
std::size_t lead_to_itself(TreeEditor& editor);
std::size_t lead_to_root(TreeEditor& editor);
std::size_t nest_in_itself(TreeEditor& editor);
std::size_t remove_end(TreeEditor& editor);
std::size_t remove_space_end(TreeEditor& editor);
std::size_t leave_out_transform(TreeEditor& editor);
std::size_t repeat_cluster(TreeEditor& editor);
std::size_t swap_leaves(TreeEditor& editor);
std::size_t swap_siblings(TreeEditor& editor);
std::size_t shorten_out(TreeEditor& editor);

std::size_t shrink_leaf(TreeEditor& editor);
std::size_t shrink_inner(TreeEditor& editor);
std::size_t shrink_shared_leaf(TreeEditor& editor);
std::size_t shrink_transform_leaf(TreeEditor& editor);
std::size_t move_node(TreeEditor& editor);
std::size_t enlarge_node(TreeEditor& editor);
std::size_t tighten_node(TreeEditor& editor);
std::size_t halve_record_ball(TreeEditor& editor);

std::size_t break_leaf_place(TreeEditor& editor);
std::size_t swap_leaf_places(TreeEditor& editor);
std::size_t break_parent(TreeEditor& editor);
std::size_t break_depth(TreeEditor& editor);
std::size_t break_region(TreeEditor& editor);
std::size_t break_primitive_range(TreeEditor& editor);
std::size_t scale_inverse(TreeEditor& editor);
std::size_t transpose_inverse(TreeEditor& editor);
std::size_t move_transform(TreeEditor& editor);
std::size_t nudge_inverse(TreeEditor& editor);

std::size_t unend_cluster(TreeEditor& editor);
std::size_t end_cluster(TreeEditor& editor);
std::size_t break_label(TreeEditor& editor);
std::size_t break_word_low(TreeEditor& editor);
std::size_t break_word_high(TreeEditor& editor);
std::size_t make_centre_nan(TreeEditor& editor);
std::size_t make_corner_infinite(TreeEditor& editor);
std::size_t make_radius_denormal(TreeEditor& editor);
std::size_t make_sphere_denormal(TreeEditor& editor);
std::size_t write_behind(TreeEditor& editor);
std::size_t write_unused(TreeEditor& editor);
std::size_t move_corner(TreeEditor& editor);
std::size_t move_light(TreeEditor& editor);
std::size_t exchange_lights(TreeEditor& editor);
std::size_t exchange_labels(TreeEditor& editor);
std::size_t turn_triangle(TreeEditor& editor);
std::size_t repeat_primitive(TreeEditor& editor);

}  // namespace plumbline
