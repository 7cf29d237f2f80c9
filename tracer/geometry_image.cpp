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

float round_down(double x) { return -round_up(-x); }

std::vector<PaddedNode> pad_nodes(const Scene& scene, const SphereTree& tree, const GeometryImage& image) {
  const int exponent = image.scale_exponent;
  std::vector<double> longest(tree.nodes.size(), 0.0);
  std::vector<PaddedNode> padded(tree.nodes.size());
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
    const double pad = kPadEdge * std::ldexp(longest[n], exponent) + kPadRadius * image.radius;
    const double radius = std::ldexp(static_cast<double>(node.radius), exponent) + pad;
    PaddedNode& out = padded[n];
    out.center = scaled(node.center, exponent);
    out.radius2 = radius * radius * (1.0 + 0x1p-50);
    const glm::vec3 lower = scaled(node.lower, exponent), upper = scaled(node.upper, exponent);
    for (int axis = 0; axis < 3; ++axis) {
      out.lower[axis] = round_down(lower[axis] - pad);
      out.upper[axis] = round_up(upper[axis] + pad);
    }
  }
  return padded;
}

std::vector<PrimitiveTexels> primitive_texels(const Scene& scene, const SphereTree& tree, int exponent) {
  std::vector<PrimitiveTexels> texels(tree.references.size());
  for (std::size_t k = 0; k < texels.size(); ++k) {
    const std::uint32_t primitive = tree.references[k];
    const float label = static_cast<float>(primitive + 1);
    if (scene.is_triangle(primitive)) {
      const auto corners = scene.corners(primitive);
      texels[k] = {glm::vec4(scaled(corners[0], exponent), label),
                   glm::vec4(scaled(corners[1], exponent), kKindTriangle),
                   glm::vec4(scaled(corners[2], exponent), 0.0f)};
    } else {
      const Sphere& sphere = scene.sphere(primitive);
      texels[k] = {glm::vec4(scaled(sphere.center, exponent), label),
                   glm::vec4(std::ldexp(sphere.radius, exponent), 0.0f, 0.0f, kKindSphere), glm::vec4(0.0f)};
    }
  }
  for (const TreeNode& node : tree.nodes) {
    if (node.reference_count == 0) continue;
    float& label = texels[node.first_reference + node.reference_count - 1][0].w;
    label = -label;
  }
  return texels;
}

void count_primitives(const Scene& scene, const SphereTree& tree, GeometryImage& image) {
  std::vector<bool> seen(scene.primitive_count(), false);
  for (const std::uint32_t primitive : tree.references) {
    if (seen[primitive]) continue;
    seen[primitive] = true;
    ++(scene.is_triangle(primitive) ? image.triangle_count : image.sphere_count);
  }
  image.primitive_count = static_cast<std::uint32_t>(tree.references.size());
}

}  // namespace

float round_up(double x) {
  const float f = static_cast<float>(x);
  return f < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

std::vector<std::uint32_t> ordered_children(const SphereTree& tree, std::uint32_t node, unsigned octant, bool sorted) {
  const TreeNode& parent = tree.nodes[node];
  std::vector<std::uint32_t> children(parent.child_count);
  for (std::uint32_t i = 0; i < parent.child_count; ++i) children[i] = parent.first_child + i;
  if (!sorted) return children;
  const glm::dvec3 diagonal((octant & 1u) != 0 ? -1.0 : 1.0, (octant & 2u) != 0 ? -1.0 : 1.0,
                            (octant & 4u) != 0 ? -1.0 : 1.0);
  std::stable_sort(children.begin(), children.end(), [&](std::uint32_t a, std::uint32_t b) {
    return glm::dot(glm::dvec3(tree.nodes[a].center), diagonal) < glm::dot(glm::dvec3(tree.nodes[b].center), diagonal);
  });
  return children;
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

GeometryImage bake(const Scene& scene, const SphereTree& tree, const BakeOptions& options) {
  if (options.width < kMinWidth || options.width > kMaxImageWidth ||
      !std::has_single_bit(static_cast<unsigned>(options.width))) {
    throw InputError("the image's width is " + std::to_string(options.width) +
                     ", but must be a power of two from 16 to 16384");
  }
  if (scene.primitive_count() > kMaxPrimitives) {
    throw InputError("the scene " + scene.name + " has " + std::to_string(scene.primitive_count()) +
                     " primitives, more than the 16777214 that the geometry image can number; split it");
  }
  const Ball ball = bounding_ball(scene);
  if (!(ball.radius <= std::numeric_limits<double>::max())) {
    throw InputError("the scene " + scene.name + " has coordinates that are not finite; mend them before baking");
  }
  GeometryImage image;
  image.options = options;
  image.options.tree = tree.options;
  image.scene_name = scene.name;
  image.scale_exponent = choose_scale(ball.radius);
  image.center =
      glm::vec3(std::ldexp(ball.center.x, image.scale_exponent), std::ldexp(ball.center.y, image.scale_exponent),
                std::ldexp(ball.center.z, image.scale_exponent));
  // The centre moved when it was rounded to float; the radius covers that too.
  const double moved = glm::length(glm::dvec3(image.center)) * 0x1p-24;
  image.radius = round_up((std::ldexp(ball.radius, image.scale_exponent) + moved) * (1.0 + 0x1p-50));
  count_primitives(scene, tree, image);
  image.primitive_stride = primitive_stride(options.layout, image.triangle_count > 0 || image.sphere_count == 0);
  image.copy_count = options.links == Links::octant ? 8 : 1;

  const BakeInput input{tree, pad_nodes(scene, tree, image), primitive_texels(scene, tree, image.scale_exponent)};
  if (options.layout == Layout::compact) {
    bake_compact(input, image);
  } else {
    bake_paper(input, image);
  }
  return image;
}

GeometryImage bake(const Scene& scene, const BakeOptions& options) {
  return bake(scene, build_sphere_tree(scene, options.tree), options);
}

std::uint32_t primitive_stride(Layout layout, bool has_triangles) {
  return (layout == Layout::compact ? 2u : 1u) + (has_triangles ? 1u : 0u);
}

const char* name_of(Layout layout) { return layout == Layout::paper ? "paper" : "compact"; }
const char* name_of(Bounds bounds) { return bounds == Bounds::sphere ? "sphere" : "aabb"; }
const char* name_of(Links links) { return links == Links::threaded ? "threaded" : "octant"; }

}  // namespace plumbline
