// SPDX-License-Identifier: MIT
// Changes to attributes, links and bounds; how places are chosen.
#include "tracer/broken_trees_edit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scenes/error.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

bool is_inner(const EditNode& node) { return !node.is_leaf; }
bool is_leaf(const EditNode& node) { return node.is_leaf; }
/// Above primitives, not a transform.
bool holds_primitives(const GeometryImage& image, const EditNode& node) {
  return node.is_leaf && node.payload < image.primitive_count;
}

glm::vec2 link_to(const GeometryImage& image, std::uint32_t cell, int kind) {
  const auto width = static_cast<std::uint32_t>(image.width);
  return {(static_cast<float>(cell % width) + 0.5f) / static_cast<float>(image.width) + static_cast<float>(kind),
          (2.0f * static_cast<float>(cell / width) + 0.5f) / static_cast<float>(image.height)};
}

void multiply_radius2(TreeEditor& editor, const EditNode& node, float factor) {
  glm::vec4& top = editor.texel(node.unit);
  if (!is_compact(editor.image)) {
    top.w *= factor;
    return;
  }
  const std::uint32_t mask = (1u << editor.image.payload_bits) - 1u, word = std::bit_cast<std::uint32_t>(top.w);
  const auto scaled = std::bit_cast<std::uint32_t>(std::fabs(top.w) * factor);
  top.w = std::bit_cast<float>((word & (0x80000000u | mask)) | (scaled & ~mask));
}

/// Halves the squared radius, or moves a side of the box in by a third.
std::size_t shrink(TreeEditor& editor, const EditNode& node) {
  if (has_boxes(editor.image)) {
    glm::vec4 &lower = editor.texel(node.unit), &upper = editor.texel(node.unit + 1);
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (upper[i] - lower[i] > upper[axis] - lower[axis]) axis = i;
    lower[axis] += (upper[axis] - lower[axis]) / 3.0f;
  } else {
    multiply_radius2(editor, node, 0.5f);
  }
  return editor.place(node.unit);
}

/// Whether something that a node of the scene shows would stand outside of its leaf, if that shrank. What is stretched
/// along one axis need not fill the sphere around it, so that some leaves may shrink without harm.
bool loses_content(TreeEditor& editor, const EditNode& node) {
  PLUMBLINE_ASSERT(editor.image.scale_exponent == 0);
  const std::vector<glm::vec4> before = editor.image.texels;
  shrink(editor, node);
  const Volume volume = volume_at(editor.image, node.unit);
  editor.image.texels = before;
  const auto is_outside = [&](const glm::dvec3& p) {
    constexpr double kClearly = 1.0 + 0x1p-10;
    if (!volume.is_box)
      return glm::length(p - glm::dvec3(volume.center)) > kClearly * std::sqrt(static_cast<double>(volume.radius2));
    const glm::dvec3 lower(volume.lower), upper(volume.upper), middle = 0.5 * (lower + upper);
    return glm::any(glm::greaterThan(glm::abs(p - middle), kClearly * 0.5 * (upper - lower)));
  };
  const Scene& scene = editor.scene;
  const std::uint32_t shown = node.payload - editor.image.primitive_count;
  for (const std::uint32_t instance : instances_of(scene)) {
    const std::vector<std::uint32_t> chain = chain_of(scene, instance);
    if (std::find(chain.begin(), chain.end(), shown) == chain.end()) continue;
    const TransformD out = to_world(scene, instance);
    const auto taken_out = [&](const glm::dvec3& p) { return out.linear * p + out.translation; };
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      if (!scene.is_placed(instance, p)) continue;
      if (scene.is_triangle(p)) {
        for (const glm::vec3& corner : scene.corners(p))
          if (is_outside(taken_out(glm::dvec3(corner)))) return true;
      } else {
        for (int side = 0; side < 6; ++side) {
          glm::dvec3 pole(scene.sphere(p).center);
          pole[side / 2] += (side % 2 == 0 ? 1.0 : -1.0) * static_cast<double>(scene.sphere(p).radius);
          if (is_outside(taken_out(pole))) return true;
        }
      }
    }
  }
  return false;
}

bool is_far_from_its_brothers(const EditNode& node) { return node.end > node.index + 2; }

}  // namespace

std::vector<EditNode> TreeEditor::nodes(std::uint32_t copy, std::uint32_t space) const {
  std::uint32_t start = 0, size = image.copy_size;
  if (space != kNone) {
    start = static_cast<std::uint32_t>(record_texel(image, space, 4).w);
    size = static_cast<std::uint32_t>(record_texel(image, space, 5).w);
  }
  Recorder ignored(image);
  const CopyView view = read_copy(image, start + copy * size, size, ignored);
  PLUMBLINE_ASSERT(ignored.count() == 0);
  const std::vector<std::uint32_t> parents = parents_of(view);
  std::vector<EditNode> nodes;
  for (std::uint32_t i = 0; i < view.nodes.size(); ++i) {
    const NodeView& node = view.nodes[i];
    nodes.push_back({view.start + i * node_units(image), i, node.end, parents[i], node.payload, node.is_leaf});
  }
  return nodes;
}

EditNode TreeEditor::choose(const std::vector<EditNode>& from, const std::function<bool(const EditNode&)>& condition) {
  return from[choose(static_cast<std::uint32_t>(from.size()), [&](std::uint32_t i) { return condition(from[i]); })];
}

std::uint32_t TreeEditor::choose(std::uint32_t count, const std::function<bool(std::uint32_t)>& condition) {
  std::vector<std::uint32_t> fit;
  for (std::uint32_t i = 0; i < count; ++i)
    if (condition(i)) fit.push_back(i);
  PLUMBLINE_ASSERT(!fit.empty());
  return fit[random_.below(static_cast<std::uint32_t>(fit.size()))];
}

std::pair<EditNode, EditNode> TreeEditor::choose_pair(
    const std::vector<EditNode>& from, const std::function<bool(const EditNode&, const EditNode&)>& condition) {
  const EditNode first = choose(from, [&](const EditNode& a) {
    return std::any_of(from.begin(), from.end(), [&](const EditNode& b) { return condition(a, b); });
  });
  return {first, choose(from, [&](const EditNode& b) { return condition(first, b); })};
}

glm::vec4& TreeEditor::texel(std::uint64_t unit, int row) { return image.texels[unit_texel(image, unit, row)]; }
std::size_t TreeEditor::place(std::uint64_t unit) const { return unit_texel(image, unit); }

void TreeEditor::set_out(const EditNode& node, std::uint32_t target) {
  if (is_compact(image)) return set_payload(node, (target - node.index) * node_units(image));
  const glm::vec2 link = link_to(image, node.unit + (target - node.index) * node_units(image), 0);
  texel(node.unit, 1).z = link.x, texel(node.unit, 1).w = link.y;
}

void TreeEditor::set_payload(const EditNode& node, std::uint32_t payload) {
  if (is_compact(image)) {
    float& word = texel(node.unit).w;
    const std::uint32_t mask = (1u << image.payload_bits) - 1u;
    word = std::bit_cast<float>((std::bit_cast<std::uint32_t>(word) & ~mask) | payload);
    return;
  }
  const bool is_transform = payload >= image.primitive_count;
  const int kind = is_transform                                   ? kLinkTransform
                   : stored_primitive(image, payload).is_triangle ? kLinkTriangle
                                                                  : kLinkSphere;
  const std::uint32_t cell = is_transform
                                 ? image.transform_start + record_units(image) * (payload - image.primitive_count)
                                 : image.primitive_start + image.primitive_stride * payload;
  const glm::vec2 link = link_to(image, cell, kind);
  texel(node.unit, 1).x = link.x, texel(node.unit, 1).y = link.y;
}

// Attributes.

std::size_t break_cap(TreeEditor& editor) {
  --editor.image.cell_count;
  return kAttribute;
}
std::size_t break_primitive_start(TreeEditor& editor) {
  ++editor.image.primitive_start;
  return kAttribute;
}
std::size_t break_image_ball(TreeEditor& editor) {
  editor.image.radius *= 0.9f;
  return kAttribute;
}
std::size_t break_scale(TreeEditor& editor) {
  ++editor.image.scale_exponent;
  return kAttribute;
}

// Links.

std::size_t break_out_past_parent(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const auto count = static_cast<std::uint32_t>(nodes.size());
  const EditNode node = editor.choose(nodes, [&](const EditNode& n) {
    return is_inner(n) && n.parent != kNone && nodes[n.parent].end == n.end && n.end + 1 < count;
  });
  editor.set_out(node, node.end + 1);
  return editor.place(node.unit);
}

std::size_t break_out_by_half(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), is_inner);
  editor.set_payload(node, (node.end - node.index) * node_units(editor.image) - 1);
  return editor.place(node.unit);
}

std::size_t break_link_centre(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), is_inner);
  editor.texel(node.unit, 1).z += 0.25f / static_cast<float>(editor.image.width);
  return editor.place(node.unit);
}

std::size_t break_link_kind(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(3), is_leaf);
  editor.texel(node.unit, 1).x += static_cast<float>(kLinkSphere - kLinkTriangle);
  return editor.place(node.unit);
}

std::size_t swap_out_links(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const auto [node, other] = editor.choose_pair(nodes, [&](const EditNode& a, const EditNode& b) {
    return is_inner(a) && is_leaf(b) && b.index > a.end && b.end < nodes.size();
  });
  editor.set_out(node, other.end);
  editor.set_out(other, node.end);
  return editor.place(other.unit);
}

std::size_t skip_node(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const EditNode node =
      editor.choose(nodes, [&](const EditNode& n) { return is_inner(n) && is_leaf(nodes[n.index + 1]); });
  const glm::vec2 link = link_to(editor.image, node.unit + 2 * node_units(editor.image), 0);
  editor.texel(node.unit, 1).x = link.x, editor.texel(node.unit, 1).y = link.y;
  return editor.place(nodes[node.index + 1].unit);
}

std::size_t break_leaf_payload(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), is_leaf);
  editor.set_payload(node, editor.image.primitive_count + editor.image.transform_count);
  return editor.place(node.unit);
}

std::size_t run_on(TreeEditor& editor) {
  const auto nodes = editor.nodes(2);
  editor.set_out(nodes.back(), nodes.back().index + 1);
  return editor.place(nodes.back().unit);
}

std::size_t end_early(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const EditNode node = editor.choose(nodes, [&](const EditNode& n) { return is_leaf(n) && n.end + 2 < nodes.size(); });
  if (is_compact(editor.image)) {
    editor.texel(node.unit) = end_texel(editor.image);
  } else {
    const glm::vec4 end = end_texel(editor.image);
    editor.texel(node.unit, 1).z = end.z, editor.texel(node.unit, 1).w = end.w;
  }
  return editor.place(node.unit);
}

std::size_t lead_to_itself(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), is_inner);
  editor.set_payload(node, 0);
  return editor.place(node.unit);
}

std::size_t lead_to_root(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), [](const EditNode& n) { return is_leaf(n) && n.index > 3; });
  const glm::vec2 link = link_to(editor.image, 0, 0);
  editor.texel(node.unit, 1).z = link.x, editor.texel(node.unit, 1).w = link.y;
  return editor.place(node.unit);
}

std::size_t nest_in_itself(TreeEditor& editor) {
  // A nested node that is made to lead to the region in which it stands.
  const GeometryImage& image = editor.image;
  const std::uint32_t n =
      editor.choose(image.transform_count, [&](std::uint32_t i) { return record_texel(image, i, 3).w > 0.0f; });
  const auto parent = static_cast<std::uint32_t>(record_texel(image, n, 3).w) - 1;
  for (const std::uint32_t i : {4u, 5u})
    editor.image.texels[transform_texel(image, n, i)].w = record_texel(image, parent, i).w;
  return transform_texel(image, n, 4);
}

std::size_t remove_end(TreeEditor& editor) {
  const auto nodes = editor.nodes(1);
  const std::uint32_t unit = nodes.back().unit + node_units(editor.image);
  editor.texel(unit) = glm::vec4(0.0f);
  return editor.place(unit);
}

std::size_t remove_space_end(TreeEditor& editor) {
  const std::uint32_t n = editor.choose(editor.image.transform_count, [](std::uint32_t) { return true; });
  const auto nodes = editor.nodes(0, n);
  const std::uint32_t unit = nodes.back().unit + node_units(editor.image);
  editor.texel(unit) = glm::vec4(0.0f);
  return editor.place(unit);
}

std::size_t leave_out_transform(TreeEditor& editor) {
  GeometryImage& image = editor.image;
  const auto nodes = editor.nodes();
  const auto is_transform = [&](const EditNode& n) { return is_leaf(n) && n.payload >= image.primitive_count; };
  const auto [node, other] = editor.choose_pair(nodes, [&](const EditNode& a, const EditNode& b) {
    return is_transform(a) && is_transform(b) && a.index != b.index;
  });
  editor.set_payload(node, other.payload);
  return transform_texel(image, node.payload - image.primitive_count, 0);
}

std::size_t repeat_cluster(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const auto [first, second] = editor.choose_pair(nodes, [&](const EditNode& a, const EditNode& b) {
    return is_leaf(a) && a.index + 20 < nodes.size() && is_leaf(b) && b.index > a.index;
  });
  editor.set_payload(second, first.payload);
  return editor.place(second.unit);
}

std::size_t swap_leaves(TreeEditor& editor) {
  const auto nodes = editor.nodes(5);
  const auto [first, second] = editor.choose_pair(nodes, [&](const EditNode& a, const EditNode& b) {
    return is_leaf(a) && a.index + 20 < nodes.size() && is_leaf(b) && b.index > a.index && b.parent != a.parent;
  });
  editor.set_payload(first, second.payload), editor.set_payload(second, first.payload);
  return editor.place(first.unit);
}

std::size_t swap_siblings(TreeEditor& editor) {
  const auto nodes = editor.nodes(6);
  const EditNode first = editor.choose(nodes, [&](const EditNode& n) {
    return is_leaf(n) && n.end < nodes.size() && nodes[n.end].is_leaf && nodes[n.end].parent == n.parent;
  });
  const EditNode second = nodes[first.end];
  std::swap(editor.texel(first.unit), editor.texel(second.unit));
  editor.set_payload(first, second.payload), editor.set_payload(second, first.payload);
  return editor.place(first.unit);
}

std::size_t shorten_out(TreeEditor& editor) {
  const auto nodes = editor.nodes();
  const EditNode node =
      editor.choose(nodes, [&](const EditNode& n) { return is_inner(n) && nodes[n.index + 1].end < n.end; });
  editor.set_out(node, nodes[node.index + 1].end);
  return editor.place(node.unit);
}

// Bounds.

std::size_t shrink_leaf(TreeEditor& editor) {
  return shrink(editor,
                editor.choose(editor.nodes(), [&](const EditNode& n) { return holds_primitives(editor.image, n); }));
}

std::size_t shrink_inner(TreeEditor& editor) {
  return shrink(editor, editor.choose(editor.nodes(),
                                      [](const EditNode& n) { return is_inner(n) && is_far_from_its_brothers(n); }));
}

std::size_t shrink_shared_leaf(TreeEditor& editor) {
  // Leaves that hold nothing but parts of one triangle, so that no whole primitive tells of them.
  return shrink(editor, editor.choose(editor.nodes(), [&](const EditNode& n) {
    return is_leaf(n) && stored_primitive(editor.image, n.payload).label < 0.0f;
  }));
}

std::size_t shrink_transform_leaf(TreeEditor& editor) {
  return shrink(editor, editor.choose(editor.nodes(), [&](const EditNode& n) {
    return is_leaf(n) && n.payload >= editor.image.primitive_count && loses_content(editor, n);
  }));
}

std::size_t move_node(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(4), is_leaf);
  glm::vec4& top = editor.texel(node.unit);
  top.y += std::sqrt(std::fabs(top.w));
  return editor.place(node.unit);
}

std::size_t enlarge_node(TreeEditor& editor) {
  const unsigned copy = editor.image.copy_count > 1 ? 7 : 0;
  const EditNode node = editor.choose(editor.nodes(copy), [](const EditNode& n) { return n.index > 0; });
  if (has_boxes(editor.image)) {
    glm::vec4 &lower = editor.texel(node.unit), &upper = editor.texel(node.unit + 1);
    upper.z += upper.z - lower.z;
  } else {
    multiply_radius2(editor, node, 4.0f);
  }
  return editor.place(node.unit);
}

std::size_t tighten_node(TreeEditor& editor) {
  const EditNode node = editor.choose(editor.nodes(), is_leaf);
  glm::vec4& top = editor.texel(node.unit);
  double reach2 = 0.0;
  float lowest = std::numeric_limits<float>::infinity();
  for (std::uint32_t k = node.payload;; ++k) {
    const StoredPrimitive p = stored_primitive(editor.image, k);
    for (const glm::vec3& corner : {p.a, p.is_triangle ? p.b : p.a, p.is_triangle ? p.c : p.a}) {
      const glm::dvec3 d = glm::dvec3(corner) - glm::dvec3(glm::vec3(top));
      reach2 = std::max(reach2, glm::dot(d, d));
      lowest = std::min(lowest, corner.x - p.radius);
    }
    if (p.label < 0.0f) break;
  }
  if (has_boxes(editor.image))
    top.x = std::nextafter(lowest, -std::numeric_limits<float>::infinity());
  else
    top.w = std::nextafter(static_cast<float>(reach2), std::numeric_limits<float>::infinity());
  return editor.place(node.unit);
}

std::size_t halve_record_ball(TreeEditor& editor) {
  // A group's: several records that lead to one part would contradict one another as well.
  GeometryImage& image = editor.image;
  const std::uint32_t n =
      editor.choose(image.transform_count, [&](std::uint32_t i) { return record_texel(image, i, 7).y == 0.0f; });
  image.texels[transform_texel(image, n, 6)].w *= 0.5f;
  return transform_texel(image, n, 6);
}

}  // namespace plumbline
