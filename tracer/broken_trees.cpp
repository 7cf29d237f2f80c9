// SPDX-License-Identifier: MIT
// The scenes of the library, and the faults by name. What they change is in broken_trees_edit.h.
#include "tracer/broken_trees.h"

#include <cmath>
#include <string>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "tracer/broken_trees_edit.h"

namespace plumbline {
namespace {

using Finder = TreeFault::Finder;
using Change = std::size_t (*)(TreeEditor&);

struct Entry {
  TreeFault fault;
  Change change;
};

constexpr Layout kCompact = Layout::compact, kPaper = Layout::paper;
constexpr Bounds kSphere = Bounds::sphere, kBox = Bounds::aabb;
constexpr Links kThreaded = Links::threaded, kOctant = Links::octant;

const Entry kEntries[] = {
    // Attributes.
    {{"attribute.cap_too_low", "the longest walk is said to be one node shorter", "metadata", Finder::image,
      "triangles", kCompact, kSphere, kThreaded},
     break_cap},
    {{"attribute.primitives_elsewhere", "primitives are said to start one texel later", "metadata", Finder::image,
      "spheres", kPaper, kSphere, kThreaded},
     break_primitive_start},
    {{"attribute.ball_too_small", "the scene's ball loses a tenth of its radius", "ball", Finder::image, "triangles",
      kPaper, kBox, kThreaded},
     break_image_ball},
    // Links.
    {{"link.past_the_parent", "a way out leads past the node to which the way out of the node around it leads",
      "link_target", Finder::image, "triangles", kCompact, kSphere, kThreaded},
     break_out_past_parent},
    {{"link.past_the_parent.paper", "a way out leads past the node to which the way out of the node around it leads",
      "link_target", Finder::image, "triangles", kPaper, kSphere, kOctant},
     break_out_past_parent},
    {{"link.half_a_node", "a way out leads into the middle of a node of two texels", "link_target", Finder::image,
      "triangles", kCompact, kBox, kThreaded},
     break_out_by_half},
    {{"link.off_centre", "a way out lands a quarter of a texel beside the centre of its cell", "link_target",
      Finder::image, "spheres", kPaper, kSphere, kThreaded},
     break_link_centre},
    {{"link.wrong_kind", "a leaf's way in says that its triangles are spheres", "link_target", Finder::image,
      "triangles", kPaper, kBox, kOctant},
     break_link_kind},
    {{"link.swapped", "the ways out of two nodes are exchanged", "cycle", Finder::image, "spheres", kPaper, kSphere,
      kThreaded},
     swap_out_links},
    {{"link.skips_a_node", "a way in leads to the second node instead of the first", "unreached", Finder::image,
      "triangles", kPaper, kSphere, kThreaded},
     skip_node},
    {{"link.no_such_transform", "a leaf leads to a transform behind the last", "link_target", Finder::image, "nested",
      kCompact, kBox, kThreaded},
     break_leaf_payload},
    {{"chain.runs_on", "the last way out leads behind the copy instead of ending", "chain_end", Finder::image,
      "triangles", kPaper, kSphere, kOctant},
     run_on},
    {{"chain.ends_early.leaf", "a leaf in the middle of the copy ends the walk", "chain_end", Finder::image, "spheres",
      kPaper, kBox, kThreaded},
     end_early},
    {{"chain.ends_early.compact", "a leaf in the middle of the copy becomes an end", "chain_end", Finder::image,
      "triangles", kCompact, kSphere, kThreaded},
     end_early},
    {{"circle.to_itself", "a way out leads to its own node", "cycle", Finder::image, "triangles", kCompact, kSphere,
      kThreaded},
     lead_to_itself},
    {{"circle.to_the_root", "a leaf's way out leads back to the root", "cycle", Finder::image, "triangles", kPaper,
      kSphere, kThreaded},
     lead_to_root},
    {{"circle.of_spaces", "a transform leads into the space in which it stands", "cycle", Finder::image, "nested",
      kPaper, kSphere, kThreaded},
     nest_in_itself},
    {{"end.missing", "the end of a copy is overwritten", "no_end", Finder::image, "triangles", kCompact, kBox, kOctant},
     remove_end},
    {{"end.missing.space", "the end of a transform's region is overwritten", "no_end", Finder::image, "nested",
      kCompact, kSphere, kThreaded},
     remove_space_end},
    {{"unreached.transform", "two leaves lead to one transform, so that another is left out", "unreached",
      Finder::image, "nested", kPaper, kBox, kOctant},
     leave_out_transform},
    {{"twice.cluster", "a leaf leads to the primitives of another", "visited_twice", Finder::image, "triangles",
      kCompact, kSphere, kThreaded},
     repeat_cluster},
    {{"twice.cluster.paper", "a leaf leads to the primitives of another", "visited_twice", Finder::image, "spheres",
      kPaper, kBox, kThreaded},
     repeat_cluster},
    {{"copies.sphere", "one copy's sphere is doubled", "copies", Finder::image, "triangles", kCompact, kSphere,
      kOctant},
     enlarge_node},
    {{"copies.leaves", "two leaves of one copy exchange what they lead to", "copies", Finder::image, "triangles",
      kPaper, kSphere, kOctant},
     swap_leaves},
    {{"order.back_to_front", "in one copy two neighbouring leaves stand in the other order, bounds and all", "thread",
      Finder::tree, "triangles", kPaper, kSphere, kOctant},
     swap_siblings},
    {{"order.shorter_way_out", "a way out leads to a node below instead of past it", "thread", Finder::tree,
      "triangles", kCompact, kSphere, kThreaded},
     shorten_out},
    // Bounds.
    {{"sphere_too_small.leaf", "a leaf's sphere loses half of its squared radius", "containment", Finder::image,
      "triangles", kCompact, kSphere, kThreaded},
     shrink_leaf},
    {{"sphere_too_small.inner", "an inner node's sphere loses half of its squared radius", "containment", Finder::image,
      "spheres", kPaper, kSphere, kThreaded},
     shrink_inner},
    {{"sphere_moved", "a sphere moves by its radius", "containment", Finder::image, "triangles", kPaper, kSphere,
      kOctant},
     move_node},
    {{"box_too_small", "a side of a box moves in by a third", "containment", Finder::image, "triangles", kCompact, kBox,
      kThreaded},
     shrink_inner},
    {{"sphere_too_small.part", "a leaf above parts of split triangles loses half of its squared radius", "containment",
      Finder::image, "split", kCompact, kSphere, kThreaded},
     shrink_shared_leaf},
    {{"box_too_small.part", "the box of a leaf above parts of split triangles loses a third", "containment",
      Finder::image, "split", kPaper, kBox, kThreaded},
     shrink_shared_leaf},
    {{"sphere_too_small.transform", "the leaf of a transform loses half of its squared radius", "containment",
      Finder::image, "nested", kPaper, kSphere, kThreaded},
     shrink_transform_leaf},
    {{"box_too_small.transform", "the box of a transform's leaf loses a third", "containment", Finder::image, "nested",
      kCompact, kBox, kOctant},
     shrink_transform_leaf},
    {{"padding.sphere", "a sphere is the tightest around its primitives", "padding", Finder::image, "triangles", kPaper,
      kSphere, kThreaded},
     tighten_node},
    {{"padding.box", "a box is the tightest around its primitives", "padding", Finder::image, "spheres", kCompact, kBox,
      kThreaded},
     tighten_node},
    {{"ball_too_small.transform", "the ball behind a transform is halved", "ball", Finder::image, "nested", kCompact,
      kSphere, kOctant},
     halve_record_ball},
    // Transforms.
    {{"transform.way_out_place", "a way out leads behind another node than the transform's leaf", "transform_balance",
      Finder::image, "nested", kCompact, kSphere, kThreaded},
     break_leaf_place},
    {{"transform.way_out_octant", "the ways out of two copies are exchanged", "transform_balance", Finder::image,
      "nested", kPaper, kSphere, kOctant},
     swap_leaf_places},
    {{"transform.way_out_space", "a nested transform's way out leads to the world", "transform_balance", Finder::image,
      "nested", kPaper, kBox, kThreaded},
     break_parent},
    {{"transform.depth", "a transform is said to be one deeper than it is", "record", Finder::image, "nested", kCompact,
      kSphere, kThreaded},
     break_depth},
    {{"transform.region", "a transform leads one unit past its region's start", "record", Finder::image, "nested",
      kPaper, kSphere, kThreaded},
     break_region},
    {{"transform.primitives", "a transform is said to hold one primitive more", "record", Finder::image, "nested",
      kCompact, kBox, kOctant},
     break_primitive_range},
    {{"transform.inverse_scaled", "an inverse's row is off by 2^-18 of itself", "inverse", Finder::image, "nested",
      kCompact, kSphere, kThreaded},
     scale_inverse},
    {{"transform.inverse_transposed", "an inverse is transposed", "inverse", Finder::image, "nested", kPaper, kSphere,
      kThreaded},
     transpose_inverse},
    // Primitives and texels.
    {{"label.no_end", "the label that ends a cluster loses its sign", "label", Finder::image, "triangles", kCompact,
      kSphere, kThreaded},
     unend_cluster},
    {{"label.early_end", "a label in the middle of a cluster gets a sign", "label", Finder::image, "spheres", kPaper,
      kSphere, kThreaded},
     end_cluster},
    {{"label.no_number", "a label is not whole", "label", Finder::image, "triangles", kPaper, kBox, kThreaded},
     break_label},
    {{"word.bit", "a word has a bit beside payload and leaf", "word", Finder::image, "triangles", kCompact, kBox,
      kOctant},
     break_word_low},
    {{"word.exponent", "a word lacks a bit of what makes it a normal float", "word", Finder::image, "spheres", kCompact,
      kBox, kThreaded},
     break_word_high},
    {{"nan.centre", "a sphere's centre is NaN", "texel_nan", Finder::image, "triangles", kCompact, kSphere, kThreaded},
     make_centre_nan},
    {{"nan.corner", "a corner is infinite", "texel_nan", Finder::image, "triangles", kPaper, kBox, kThreaded},
     make_corner_infinite},
    {{"denormal.radius", "a node's squared radius is denormal", "texel_denormal", Finder::image, "spheres", kPaper,
      kSphere, kThreaded},
     make_radius_denormal},
    {{"denormal.primitive", "a sphere's radius is denormal", "texel_denormal", Finder::image, "spheres", kCompact, kBox,
      kThreaded},
     make_sphere_denormal},
    {{"unused.behind", "a texel behind the last that is used is not zero", "texel_unused", Finder::image, "triangles",
      kCompact, kSphere, kThreaded},
     write_behind},
    {{"unused.component", "a component that means nothing is not zero", "texel_unused", Finder::image, "triangles",
      kPaper, kSphere, kThreaded},
     write_unused},
    // What the image alone cannot tell.
    {{"scene.corner", "a corner moves inwards by a thousandth of its edge", "primitive_bits", Finder::scene,
      "triangles", kCompact, kSphere, kThreaded},
     move_corner},
    {{"scene.labels_exchanged", "two primitives exchange their labels", "primitive_bits", Finder::rays, "triangles",
      kCompact, kSphere, kThreaded},
     exchange_labels},
    {{"scene.corners_turned", "a triangle's corners are in the other order", "primitive_bits", Finder::rays,
      "triangles", kPaper, kBox, kOctant},
     turn_triangle},
    {{"scene.repeated", "a triangle stands in the place of its neighbour, and is counted so", "primitive_missing",
      Finder::rays, "triangles", kCompact, kBox, kThreaded},
     repeat_primitive},
    {{"scene.repeated.paper", "a triangle stands in the place of its neighbour, and is counted so", "primitive_missing",
      Finder::rays, "triangles", kPaper, kSphere, kThreaded},
     repeat_primitive},
    {{"scene.scale", "the image is said to be scaled by 2", "metadata", Finder::rays, "triangles", kCompact, kSphere,
      kThreaded},
     break_scale},
    {{"scene.translation", "a transform moves by 2^-19 of the scene", "matrix_bits", Finder::rays, "nested", kPaper,
      kBox, kThreaded},
     move_transform},
    {{"scene.inverse_ulp", "an entry of an inverse is the next float", "matrix_bits", Finder::scene, "nested", kCompact,
      kSphere, kThreaded},
     nudge_inverse},
    {{"scene.light", "a light moves to the next float", "light_bits", Finder::scene, "spheres", kCompact, kSphere,
      kThreaded},
     move_light},
    {{"scene.lights_exchanged", "two lights exchange their places", "light_bits", Finder::scene, "spheres", kPaper,
      kBox, kThreaded},
     exchange_lights},
    // What changes no answer.
    {{"harmless.larger_sphere",
      "a sphere is doubled: it holds what it held, and rays that enter it go on to its children", "", Finder::nobody,
      "triangles", kCompact, kSphere, kThreaded},
     enlarge_node},
    {{"harmless.larger_box", "a box grows", "", Finder::nobody, "spheres", kPaper, kBox, kThreaded}, enlarge_node},
};

Scene nested_scene() {
  Scene scene = generate_scene("tetra", 2);
  scene.name = "nested";
  const auto add_part = [&](const Scene& from, const char* name) {
    Part part;
    part.name = name;
    part.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
    part.first_sphere = static_cast<std::uint32_t>(scene.spheres.size());
    part.triangle_count = static_cast<std::uint32_t>(from.triangles.size());
    part.sphere_count = static_cast<std::uint32_t>(from.spheres.size());
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), from.positions.begin(), from.positions.end());
    for (Triangle triangle : from.triangles) {
      for (std::uint32_t& p : triangle.position) p += base;
      triangle.normal = triangle.texcoord = {kNone, kNone, kNone};
      triangle.material = 0;
      scene.triangles.push_back(triangle);
    }
    for (const Sphere& sphere : from.spheres) scene.spheres.push_back({sphere.center, sphere.radius, 0});
    scene.parts.push_back(part);
  };
  add_part(generate_scene("icosphere", 1), "ball");
  add_part(generate_scene("sphereflake", 1), "flake");
  const auto add_node = [&](std::uint32_t parent, std::uint32_t part, const glm::vec3& at, float scale) {
    Node node;
    node.name = "n" + std::to_string(scene.nodes.size());
    node.parent = parent, node.part = part;
    const float c = 0.8f * scale, s = 0.6f * scale;  // turned about z, sheared a little
    node.transform.linear = glm::mat3(c, s, 0.0f, -s, c, 0.0f, 0.1f * scale, 0.0f, 1.25f * scale);
    node.transform.translation = at;
    node.rest = node.transform;
    scene.nodes.push_back(node);
    return static_cast<std::uint32_t>(scene.nodes.size() - 1);
  };
  add_node(kNone, 0, {2.5f, 0.0f, 0.25f}, 0.5f);
  add_node(kNone, 1, {0.0f, 2.75f, 0.0f}, 0.75f);
  const std::uint32_t group = add_node(kNone, kNone, {-2.5f, -1.0f, 0.5f}, 0.6f);
  add_node(group, 0, {1.0f, 1.5f, 0.0f}, 0.5f);
  add_node(group, 1, {-1.0f, 0.5f, 1.5f}, 0.4f);
  const std::uint32_t inner = add_node(group, kNone, {0.5f, -1.5f, -1.0f}, 0.7f);
  add_node(inner, 0, {1.0f, 0.0f, 0.0f}, 0.6f);
  add_node(inner, 1, {-1.0f, 0.25f, 0.0f}, -0.5f);
  add_node(kNone, 0, {0.0f, -3.0f, -1.0f}, 0.4f);
  return scene;
}

/// Long triangles, crossing one another.
Scene split_scene() {
  Scene scene;
  scene.name = "split";
  scene.materials.resize(1);
  Random random(1, name_hash("broken trees"), 0);
  const auto point = [&] {
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0);
    return glm::vec3(x, y, z);
  };
  for (std::uint32_t i = 0; i < 40; ++i) {
    for (int corner = 0; corner < 3; ++corner) scene.positions.push_back(point());
    Triangle triangle;
    triangle.position = {3 * i, 3 * i + 1, 3 * i + 2};
    scene.triangles.push_back(triangle);
  }
  return scene;
}

}  // namespace

std::span<const TreeFault> tree_faults() {
  static const std::vector<TreeFault> faults = [] {
    std::vector<TreeFault> list;
    for (const Entry& entry : kEntries) list.push_back(entry.fault);
    return list;
  }();
  return faults;
}

BrokenTree sound_tree(std::string_view name, const BakeOptions& options) {
  BrokenTree result;
  if (name == "nested")
    result.scene = nested_scene();
  else if (name == "split")
    result.scene = split_scene();
  else
    result.scene = name == "spheres" ? generate_scene("sphereflake", 2) : generate_scene("creature");
  result.tree = build_scene_tree(result.scene, options.tree, options.transform_list == TransformList::root);
  result.sound = bake(result.scene, result.tree, options);
  result.broken = result.sound;
  return result;
}

BrokenTree break_tree(const TreeFault& fault, std::uint64_t seed) {
  for (const Entry& entry : kEntries) {
    if (entry.fault.name != fault.name) continue;
    BakeOptions options;
    options.layout = fault.layout, options.bounds = fault.bounds, options.links = fault.links;
    options.width = 16;
    options.tree.split_long = fault.scene == "split" ? 0.3f : 0.0f;
    BrokenTree result = sound_tree(fault.scene, options);
    Random random(seed, name_hash(fault.name), 0);
    TreeEditor editor(result.broken, result.scene, random);
    const std::size_t texel = entry.change(editor);
    if (texel == kAttribute) return result;
    const std::size_t width = static_cast<std::size_t>(result.broken.width);
    result.x = static_cast<int>(texel % width), result.y = static_cast<int>(texel / width);
    if (fault.layout == Layout::paper) result.y &= ~1;
    return result;
  }
  throw InputError("there is no fault " + std::string(fault.name));
}

}  // namespace plumbline
