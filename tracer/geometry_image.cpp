// SPDX-License-Identifier: MIT
// The bake's common part: the choice of units, padded bounds, and primitives as texels. Each layout has a file of its
// own.
#include "tracer/geometry_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "scenes/error.h"
#include "tracer/bake.h"

namespace plumbline {
namespace {

constexpr int kMinWidth = 16;
constexpr int kExtremeExponent = 20;  // radii in [2^-20, 2^20] are walked as they are

glm::vec3 scaled(const glm::vec3& v, int exponent) {
  return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

/// The exponent that brings the scene's radius into [0.5, 1) where it is extreme.
int choose_scale(double radius) {
  if (radius == 0.0) return 0;
  if (radius >= std::ldexp(1.0, -kExtremeExponent) && radius <= std::ldexp(1.0, kExtremeExponent)) return 0;
  int exponent = 0;
  std::frexp(radius, &exponent);
  return -exponent;
}

}  // namespace

double longest_edge(const Scene& scene, std::uint32_t primitive) {
  if (!scene.is_triangle(primitive)) return 0.0;
  const auto corners = scene.corners(primitive);
  double longest2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 edge = glm::dvec3(corners[(i + 1) % 3]) - glm::dvec3(corners[i]);
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  return std::sqrt(longest2) * (1.0 + 0x1p-50);
}

double transform_pad(const Transform& transform, const glm::dvec3& center, double extent) {
  const TransformD forward = to_double(transform);
  const TransformD back = inverse(forward);
  double norm2 = 0.0;  // of |L| |L^-1|, Frobenius
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      double entry = 0.0;
      for (int k = 0; k < 3; ++k) entry += std::abs(forward.linear[k][row]) * std::abs(back.linear[column][k]);
      norm2 += entry * entry;
    }
  }
  return kPadTransform * std::sqrt(norm2) * (4.0 * extent + glm::length(center - forward.translation));
}

namespace {

/// The nodes of a sphere tree of a space of radius `extent` (image units), appended to the region; `first` is the
/// number of the tree's first reference among all.
void append_tree(const Scene& scene, const SphereTree& tree, int exponent, double extent, std::uint32_t first,
                 BakeRegion& region) {
  const auto base = static_cast<std::uint32_t>(region.nodes.size());
  if (tree.nodes.empty()) return;
  region.roots.push_back(base);
  region.nodes.resize(base + tree.nodes.size());
  std::vector<double> longest(tree.nodes.size(), 0.0);
  // Children stand behind their parents, so a backward pass sees them first.
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    const TreeNode& node = tree.nodes[n];
    for (std::uint32_t i = 0; i < node.reference_count; ++i) {
      longest[n] = std::max(longest[n], longest_edge(scene, tree.references[node.first_reference + i]));
    }
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      PLUMBLINE_ASSERT(node.first_child + i > n);
      longest[n] = std::max(longest[n], longest[node.first_child + i]);
    }
    const double pad = kPadEdge * std::ldexp(longest[n], exponent) + kPadRadius * extent;
    const double radius = std::ldexp(static_cast<double>(node.radius), exponent) + pad;
    BakeNode& out = region.nodes[base + n];
    out.center = scaled(node.center, exponent);
    out.radius2 = radius * radius * (1.0 + 0x1p-50);
    const glm::vec3 lower = scaled(node.lower, exponent), upper = scaled(node.upper, exponent);
    for (int axis = 0; axis < 3; ++axis) {
      out.lower[axis] = round_down(lower[axis] - pad);
      out.upper[axis] = round_up(upper[axis] + pad);
    }
    out.order = glm::dvec3(node.center);
    out.first_child = base + node.first_child, out.child_count = node.child_count;
    out.payload = first + node.first_reference;
  }
}

void append_group(const GroupTree& group, int exponent, std::uint32_t primitive_count, BakeRegion& region) {
  if (group.nodes.empty()) return;
  const auto base = static_cast<std::uint32_t>(region.nodes.size());
  region.roots.push_back(base);
  for (std::uint32_t i = 0; i < group.nodes.size(); ++i) {
    BakeNode node = bake_group_node(group, i, exponent);
    node.first_child += base;
    if (node.is_leaf()) node.payload += primitive_count;
    region.nodes.push_back(node);
  }
}

void append_primitives(const Scene& scene, const SphereTree& tree, int exponent, std::vector<PrimitiveTexels>& texels) {
  const std::size_t first = texels.size();
  for (const std::uint32_t primitive : tree.references) {
    const float label = static_cast<float>(primitive + 1);
    if (scene.is_triangle(primitive)) {
      const auto corners = scene.corners(primitive);
      texels.push_back({glm::vec4(scaled(corners[0], exponent), label),
                        glm::vec4(scaled(corners[1], exponent), kKindTriangle),
                        glm::vec4(scaled(corners[2], exponent), 0.0f)});
    } else {
      const Sphere& sphere = scene.sphere(primitive);
      texels.push_back({glm::vec4(scaled(sphere.center, exponent), label),
                        glm::vec4(std::ldexp(sphere.radius, exponent), 0.0f, 0.0f, kKindSphere), glm::vec4(0.0f)});
    }
  }
  for (const TreeNode& node : tree.nodes) {
    if (node.reference_count == 0) continue;
    float& label = texels[first + node.first_reference + node.reference_count - 1][0].w;
    label = -label;
  }
}

void count_primitives(const Scene& scene, const SceneTree& tree, GeometryImage& image) {
  std::vector<bool> seen(scene.primitive_count(), false);
  const auto count = [&](const SphereTree& one) {
    for (const std::uint32_t primitive : one.references) {
      if (seen[primitive]) continue;
      seen[primitive] = true;
      ++(scene.is_triangle(primitive) ? image.triangle_count : image.sphere_count);
    }
    image.primitive_count += static_cast<std::uint32_t>(one.references.size());
  };
  count(tree.world);
  image.world_primitives = image.primitive_count;
  for (const SphereTree& part : tree.parts) count(part);
  image.transform_count = static_cast<std::uint32_t>(scene.nodes.size());
  image.light_count = static_cast<std::uint32_t>(scene.lights.size());
}

/// A ball as four floats that contain it; the centre moves when it is rounded, and the radius covers that too.
glm::vec4 float_ball(const Ball& ball, int exponent) {
  const glm::vec3 center(std::ldexp(ball.center.x, exponent), std::ldexp(ball.center.y, exponent),
                         std::ldexp(ball.center.z, exponent));
  const double moved = glm::length(glm::dvec3(center)) * 0x1p-24;
  return {center, round_up((std::ldexp(ball.radius, exponent) + moved) * (1.0 + 0x1p-50))};
}

/// Which region each space has: the world, then parts, then groups in the order of their nodes.
struct Numbering {
  std::vector<std::uint32_t> first_primitive;  ///< of the world's tree and of each part's
  std::vector<std::uint32_t> behind;           ///< of each scene node: the region that it leads to
};

BakeInput collect(const Scene& scene, const SceneTree& tree, const GeometryImage& image, Numbering& numbering) {
  BakeInput input;
  const bool has_nodes = !scene.nodes.empty();
  const int world = image.scale_exponent;
  BakeRegion region;
  append_tree(scene, tree.world, world, has_nodes ? std::ldexp(tree.groups[0].extent, world) : image.radius, 0, region);
  append_group(tree.groups[0], world, image.primitive_count, region);
  input.regions.push_back(std::move(region));
  append_primitives(scene, tree.world, world, input.primitives);
  numbering.first_primitive.push_back(0);
  for (std::size_t p = 0; p < tree.parts.size(); ++p) {
    const int exponent = choose_scale(tree.part_balls[p].radius);
    const auto first = static_cast<std::uint32_t>(input.primitives.size());
    region = {};
    append_tree(scene, tree.parts[p], exponent, float_ball(tree.part_balls[p], exponent).w, first, region);
    input.regions.push_back(std::move(region));
    append_primitives(scene, tree.parts[p], exponent, input.primitives);
    numbering.first_primitive.push_back(first);
  }
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].part != kNone) {
      numbering.behind.push_back(1 + scene.nodes[n].part);
      continue;
    }
    numbering.behind.push_back(static_cast<std::uint32_t>(input.regions.size()));
    if (tree.groups[n + 1].nodes.empty()) continue;  // shows nothing: never entered
    region = {};
    append_group(tree.groups[n + 1], inner_exponent(scene, tree, n), image.primitive_count, region);
    input.regions.push_back(std::move(region));
  }
  return input;
}

/// Steps of the longest walk: every node of every region is visited once for each way in.
std::uint32_t longest_walk(const BakeInput& input, const Numbering& numbering, const GeometryImage& image) {
  const std::uint64_t end = image.options.layout == Layout::compact ? 1 : 0;
  std::vector<std::uint64_t> steps(input.regions.size(), 0);
  // A region's transforms lead to parts, or to groups that stand behind it: those of nodes with higher numbers.
  const auto count = [&](std::size_t r) {
    const BakeRegion& region = input.regions[r];
    steps[r] = std::max<std::uint64_t>(region.nodes.size() + end, 1);
    for (const BakeNode& node : region.nodes)
      if (node.is_leaf() && node.payload >= image.primitive_count)
        steps[r] += steps[numbering.behind[node.payload - image.primitive_count]];
    steps[r] = std::min<std::uint64_t>(steps[r], std::numeric_limits<std::int32_t>::max());
  };
  const std::size_t parts = numbering.first_primitive.size() - 1;
  for (std::size_t r = 1; r <= parts; ++r) count(r);
  for (std::size_t r = input.regions.size(); r-- > parts + 1;) count(r);
  count(0);
  return static_cast<std::uint32_t>(steps[0]);
}

void write_transforms(const Scene& scene, const SceneTree& tree, const BakeOutput& output, const Numbering& numbering,
                      GeometryImage& image) {
  std::uint32_t largest = image.primitive_count;
  for (const RegionPlace& place : output.regions)
    largest = std::max(largest, place.start + place.copy_size * image.copy_count);
  if (image.transform_count > 0 && std::max(largest, image.transform_count) >= kMaxExactFloat)
    throw InputError("the geometry image of " + image.scene_name +
                     " places transforms beyond what its records can number (2^24 cells); use links `threaded`");
  std::vector<std::uint32_t> depth(scene.nodes.size(), 1);
  const auto number = [](std::uint32_t value) { return static_cast<float>(value); };
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.parent != kNone) depth[n] = depth[node.parent] + 1;
    if (tree.leaf[n] == kNone) continue;  // shows nothing: never entered
    const RegionPlace& behind = output.regions[numbering.behind[n]];
    MovingTexels moving =
        moving_texels(scene, tree, n, {number(node.parent + 1), number(behind.start), number(behind.copy_size)});
    for (std::uint32_t i = 0; i < moving.size(); ++i) image.texels[transform_texel(image, n, i)] = moving[i];
    glm::vec4 primitives(0.0f, 0.0f, number(depth[n]), 0.0f);
    if (node.part != kNone) {
      primitives.x = number(numbering.first_primitive[node.part + 1]);
      primitives.y = number(static_cast<std::uint32_t>(tree.parts[node.part].references.size()));
    }
    image.texels[transform_texel(image, n, 7)] = primitives;
    for (std::uint32_t i = 0; i < 8; ++i)
      image.texels[transform_texel(image, n, 8 + i / 4)][static_cast<int>(i % 4)] = number(output.leaves[n][i]);
  }
}

void write_lights(const Scene& scene, GeometryImage& image) {
  for (std::uint32_t l = 0; l < scene.lights.size(); ++l) {
    const auto texels = light_texels(scene.lights[l]);
    for (std::uint32_t i = 0; i < kLightTexels; ++i) image.texels[light_texel(image, l, i)] = texels[i];
  }
}

}  // namespace

std::array<glm::vec4, kLightTexels> light_texels(const Light& light) {
  return {glm::vec4(light.position, light.radius), light.has_color ? glm::vec4(light.color, 1.0f) : glm::vec4(0.0f)};
}

float round_up(double x) {
  const float f = static_cast<float>(x);
  return f < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}
float round_down(double x) { return -round_up(-x); }

std::vector<std::uint32_t> children_of(const BakeNode& node) {
  std::vector<std::uint32_t> children(node.child_count);
  for (std::uint32_t i = 0; i < node.child_count; ++i) children[i] = node.first_child + i;
  return children;
}

std::vector<std::uint32_t> ordered(const BakeRegion& region, std::vector<std::uint32_t> nodes, unsigned octant,
                                   bool sorted) {
  if (!sorted) return nodes;
  const glm::dvec3 diagonal((octant & 1u) != 0 ? -1.0 : 1.0, (octant & 2u) != 0 ? -1.0 : 1.0,
                            (octant & 4u) != 0 ? -1.0 : 1.0);
  std::stable_sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
    return glm::dot(region.nodes[a].order, diagonal) < glm::dot(region.nodes[b].order, diagonal);
  });
  return nodes;
}

BakeNode bake_group_node(const GroupTree& group, std::uint32_t number, int exponent) {
  const GroupNode& node = group.nodes[number];
  BakeNode out;
  out.center = glm::vec3(std::ldexp(node.center.x, exponent), std::ldexp(node.center.y, exponent),
                         std::ldexp(node.center.z, exponent));
  // The centre's rounding is made up for in the radius.
  const double moved = glm::length(glm::dvec3(out.center)) * 0x1p-24;
  const double radius = std::ldexp(node.radius + kPadRadius * group.extent, exponent) + moved;
  out.radius2 = radius * radius * (1.0 + 0x1p-50);
  for (int axis = 0; axis < 3; ++axis) {
    out.lower[axis] = round_down(out.center[axis] - radius);
    out.upper[axis] = round_up(out.center[axis] + radius);
  }
  out.order = node.rest_center;
  out.first_child = node.first_child, out.child_count = node.child_count;
  out.payload = node.is_leaf() ? group.leaves[node.first_leaf] : 0;
  return out;
}

int world_exponent(const Scene& scene, const SceneTree& tree) {
  return choose_scale(scene.nodes.empty() ? tree.world_ball.radius : tree.groups[0].extent);
}

int inner_exponent(const Scene& scene, const SceneTree& tree, std::uint32_t node) {
  const std::uint32_t part = scene.nodes[node].part;
  return choose_scale(part != kNone ? tree.part_balls[part].radius : tree.groups[node + 1].extent);
}

MovingTexels moving_texels(const Scene& scene, const SceneTree& tree, std::uint32_t n, const glm::vec3& fixed) {
  const Node& node = scene.nodes[n];
  const int outer = node.parent == kNone ? world_exponent(scene, tree) : inner_exponent(scene, tree, node.parent);
  const int inner = inner_exponent(scene, tree, n);
  const TransformD forward = to_double(node.transform);
  const TransformD back = inverse(forward);
  MovingTexels texels;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      texels[static_cast<std::size_t>(row)][column] =
          static_cast<float>(std::ldexp(back.linear[column][row], inner - outer));
      texels[static_cast<std::size_t>(3 + row)][column] =
          static_cast<float>(std::ldexp(forward.linear[column][row], outer - inner));
    }
    texels[static_cast<std::size_t>(row)].w = static_cast<float>(std::ldexp(forward.translation[row], outer));
    texels[static_cast<std::size_t>(3 + row)].w = fixed[row];
  }
  const Ball& ball = node.part != kNone ? tree.part_balls[node.part] : tree.groups[n + 1].content;
  texels[6] = float_ball(ball, inner);
  return texels;
}

void set_image_ball(const Scene& scene, const SceneTree& tree, GeometryImage& image) {
  const Ball& ball = scene.nodes.empty() ? tree.world_ball : tree.groups[0].content;
  image.scale_exponent = world_exponent(scene, tree);
  const glm::vec4 rounded = float_ball(ball, image.scale_exponent);
  image.center = glm::vec3(rounded), image.radius = rounded.w;
}

std::size_t transform_texel(const GeometryImage& image, std::uint32_t n, std::uint32_t i) {
  if (image.options.layout == Layout::compact)
    return std::size_t{image.transform_start} + std::size_t{kTransformTexels} * n + i;
  const std::size_t cell = std::size_t{image.transform_start} + std::size_t{kTransformTexels / 2} * n + i / 2;
  const std::size_t width = static_cast<std::size_t>(image.width);
  return cell / width * 2 * width + cell % width + (i % 2) * width;
}

std::size_t light_texel(const GeometryImage& image, std::uint32_t l, std::uint32_t i) {
  const bool is_compact = image.options.layout == Layout::compact;
  const std::size_t start = std::size_t{image.transform_start} +
                            std::size_t{is_compact ? kTransformTexels : kTransformTexels / 2} * image.transform_count;
  if (is_compact) return start + std::size_t{kLightTexels} * l + i;
  const std::size_t cell = start + l, width = static_cast<std::size_t>(image.width);
  return cell / width * 2 * width + cell % width + i * width;
}

void allocate_texels(std::uint64_t texels, GeometryImage& image) {
  std::uint64_t width = image.options.width, height = image.options.width;
  while (width * height < texels) (height > width ? width : height) *= 2;
  if (height > kMaxImageWidth) {
    throw InputError("the geometry image of " + image.scene_name + " needs " + std::to_string(texels) +
                     " texels, more than a texture of 16384 x 16384 holds; use links `threaded`, layout `compact`, or "
                     "a smaller scene");
  }
  image.width = static_cast<int>(width), image.height = static_cast<int>(height);
  image.texels.assign(width * height, glm::vec4(0.0f));
}

GeometryImage bake(const Scene& scene, const SceneTree& tree, const BakeOptions& options) {
  if (options.width < kMinWidth || options.width > kMaxImageWidth ||
      !std::has_single_bit(static_cast<unsigned>(options.width))) {
    throw InputError("the image's width is " + std::to_string(options.width) +
                     ", but must be a power of two from 16 to 16384");
  }
  if (scene.primitive_count() > kMaxPrimitives) {
    throw InputError("the scene " + scene.name + " has " + std::to_string(scene.primitive_count()) +
                     " primitives, more than the 16777214 that the geometry image can number; split it");
  }
  GeometryImage image;
  set_image_ball(scene, tree, image);
  if (!(image.radius <= std::numeric_limits<float>::max())) {
    throw InputError("the scene " + scene.name + " has coordinates that are not finite; mend them before baking");
  }
  image.options = options;
  image.options.tree = tree.world.options;
  image.scene_name = scene.name;
  count_primitives(scene, tree, image);
  image.primitive_stride = primitive_stride(options.layout, image.triangle_count > 0 || image.sphere_count == 0);
  image.copy_count = options.links == Links::octant ? 8 : 1;

  Numbering numbering;
  const BakeInput input = collect(scene, tree, image, numbering);
  image.cell_count = longest_walk(input, numbering, image);
  const BakeOutput output = options.layout == Layout::compact ? bake_compact(input, image) : bake_paper(input, image);
  write_transforms(scene, tree, output, numbering, image);
  write_lights(scene, image);
  return image;
}

GeometryImage bake(const Scene& scene, const BakeOptions& options) {
  return bake(scene, build_scene_tree(scene, options.tree, options.transform_list == TransformList::root), options);
}

std::uint32_t primitive_stride(Layout layout, bool has_triangles) {
  return (layout == Layout::compact ? 2u : 1u) + (has_triangles ? 1u : 0u);
}

const char* name_of(Layout layout) { return layout == Layout::paper ? "paper" : "compact"; }
const char* name_of(Bounds bounds) { return bounds == Bounds::sphere ? "sphere" : "aabb"; }
const char* name_of(Links links) { return links == Links::threaded ? "threaded" : "octant"; }
const char* name_of(TransformOut out) { return out == TransformOut::inverse ? "inverse" : "restore"; }
const char* name_of(TransformList list) { return list == TransformList::root ? "root" : "tree"; }

}  // namespace plumbline
