// SPDX-License-Identifier: MIT
// What both layouts bake from: nodes with padded bounds in the image's units, primitives and transforms as texels.
#pragma once

#include <array>
#include <vector>

#include "tracer/geometry_image.h"

namespace plumbline {

// Why bounds are padded. Culling must not change an answer: where the shader's arithmetic accepts primitive p at
// parameter t, every node above p must pass the shader's node test while best >= t. Let u = 2^-24, R the scene's
// radius, L the longest edge of p, and D = 3.3 R: no point of the scene is farther from a walking origin whose ray
// meets it (near rays start within 2 R of the centre, far ones are moved to 2.05 R before the point next to it).
//
//   (1) Triangles: what is accepted. Let X be the point of p that the computed weights stand for.
//       Across the ray: a projected corner is off by u (2 |p.xy| + 5 sqrt(2) |p.z|) <= 7.4 u D (a subtraction, a shear
//       factor of 2 u, a product, a subtraction), and the weights miss the ray among the projected corners as they are
//       in float by e. Along the ray: t d.z is off by 10 u D (four roundings in T, two in det, four after it), the
//       ray's length by sqrt(3) of that. So |P(t) - X| <= e + 25 u D. With M the farthest projected corner:
//         |det| >= kEdgeOn M^2: each edge function is off by d <= 2 u M^2; the exact ones balance the corners, so
//         e = |sum of d_i corner_i| / |det| <= 6 u M^3 / |det| <= 6 * 2^8 u M = 2^-13.4 M. The weights are not
//         negative, so the ray is within e of the projected triangle and M <= 1.001 of its longest edge, which the
//         shear stretches by at most sqrt(3): e <= 2^-12.6 L. Below that the edge functions are exact but for 4 u of
//         themselves: e <= 4 u M.
//         Products flushed to zero add at most 2^-123 to an edge function, 2^-23 of kLeastDet: e grows by 2^-21 M.
//       Spheres: the foot of the perpendicular is off by 3 u D across and 9 u D along the ray, the half chord by 6 u r,
//       t by u D: P(t) lies within 20 u D of the sphere.
//   (2) Nodes: what is culled. m = c - o is off by u D, s = clamp(dot(m, dn), 0, best) by 9 u D in length, s d and f =
//   m
//       - s d by u D each: |f| <= (distance from c to the segment [0, best]) + 12 u D, and dot(f, f) adds 1.5 u R to
//       its root. The distance from c to the segment is at most |P(t) - c| <= radius + |P(t) - X|.
//
// (3) Transforms: the ray that enters node T of a space of radius R is off, per component, by 5 u |L^-1| |o - T| in its
//     origin (a subtraction, a matrix entry, a product, two sums) and by 4 u |L^-1| |d| in its direction. Carried back
//     to the outer space, with k the norm of |L| |L^-1|: at most k u (5 |o - T| + 4 * 3.3 R) at any point that the ray
//     may hit, and |o - T| <= 3.3 R + |c - T|, c being the middle of what lies behind the transform. So the ball of T's
//     leaf is padded by 2^-20 k (4 R + |c - T|), and like all nodes of that space by 2^-17 R. R is taken as the next
//     power of two, lest every padding change whenever something moves.
//
// For (1) and (2) together 2^-12.6 L + (25 + 12) u D + 1.5 u R <= 2^-12 L + 2^-17 R. The boxes of `aabb` are padded
// alike on each side; the slabs are off by u D for each difference and 2 u of each quotient, less than the spheres'
// test is.
inline constexpr double kPadEdge = 0x1p-12;
inline constexpr double kPadRadius = 0x1p-17;
inline constexpr double kPadTransform = 0x1p-20;

/// The padding of a transform's leaf in a space of radius `extent`, by (3).
double transform_pad(const Transform& transform, const glm::dvec3& center, double extent);

/// The longest edge of a triangle, rounded up; 0 for a sphere.
double longest_edge(const Scene& scene, std::uint32_t primitive);

/// A node of any of the trees, in image units of its space.
struct BakeNode {
  glm::vec3 center{0.0f};
  double radius2 = 0.0;  ///< squared, padded
  glm::vec3 lower{0.0f}, upper{0.0f};
  glm::dvec3 order{0.0};  ///< children stand front to back by this
  std::uint32_t first_child = 0, child_count = 0;
  std::uint32_t payload = 0;  ///< of a leaf: the first primitive of its cluster, or primitive_count + scene node
  bool is_leaf() const { return child_count == 0; }
};

/// What is walked in one space: trees side by side.
struct BakeRegion {
  std::vector<BakeNode> nodes;
  std::vector<std::uint32_t> roots;
};

/// Where a region went: texels (compact) or cells (paper).
struct RegionPlace {
  std::uint32_t start = 0, copy_size = 0;
};

/// One primitive as the format's P0, P1, P2.
using PrimitiveTexels = std::array<glm::vec4, 3>;

/// A node's leaf in each copy of the tree that it stands in.
using LeafPlaces = std::array<std::uint32_t, 8>;

struct BakeInput {
  std::vector<BakeRegion> regions;  ///< the world first, then parts, then groups
  std::vector<PrimitiveTexels> primitives;
};
struct BakeOutput {
  std::vector<RegionPlace> regions;
  std::vector<LeafPlaces> leaves;  ///< of each scene node; 0 where it shows nothing
};

/// The children of a node, or the roots, in the order in which a ray of this octant should meet them (bit a set:
/// direction component a is negative); as they stand where `sorted` is false.
std::vector<std::uint32_t> ordered(const BakeRegion& region, std::vector<std::uint32_t> nodes, unsigned octant,
                                   bool sorted);
std::vector<std::uint32_t> children_of(const BakeNode& node);

/// The smallest float that is not below x; the largest that is not above.
float round_up(double x);
float round_down(double x);

/// Fill image.texels with regions and primitives, and the fields that describe the layout, from options, counts and
/// scale that are set already.
BakeOutput bake_compact(const BakeInput& input, GeometryImage& image);
BakeOutput bake_paper(const BakeInput& input, GeometryImage& image);

/// The texels of a node: its bounds, and in layout `compact` its word, whose payload and leaf bit are given.
std::array<glm::vec4, 2> compact_node(const BakeNode& node, std::uint32_t payload, const GeometryImage& image);
std::array<glm::vec4, 2> paper_node(const BakeNode& node, Bounds bounds);  ///< tops of its one or two cells

/// Sets width and height to the smallest powers of two, at least options.width each, that hold `texels`, and allocates
/// them. Throws InputError beyond 16384 x 16384.
void allocate_texels(std::uint64_t texels, GeometryImage& image);

// Of the parts that a bake and an update have in common (geometry_image.cpp, geometry_image_update.cpp).

/// A group's node in image units.
BakeNode bake_group_node(const GroupTree& group, std::uint32_t node, int exponent);
/// The exponents of the spaces: the world, behind a node.
int world_exponent(const Scene& scene, const SceneTree& tree);
int inner_exponent(const Scene& scene, const SceneTree& tree, std::uint32_t node);
/// The first texels of a node's record, which depend on where the node stands: matrices and ball.
using MovingTexels = std::array<glm::vec4, 7>;
MovingTexels moving_texels(const Scene& scene, const SceneTree& tree, std::uint32_t node, const glm::vec3& fixed);
/// Sets the image's own ball.
void set_image_ball(const Scene& scene, const SceneTree& tree, GeometryImage& image);

}  // namespace plumbline
