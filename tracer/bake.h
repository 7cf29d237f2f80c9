// SPDX-License-Identifier: MIT
// What both layouts bake from: the tree's nodes with padded bounds in the image's units, and its primitives as texels.
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
// Together 2^-12.6 L + (25 + 12) u D + 1.5 u R <= 2^-12 L + 2^-17 R. The boxes of `aabb` are padded alike on each side;
// the slabs are off by u D for each difference and 2 u of each quotient, less than the spheres' test is.
inline constexpr double kPadEdge = 0x1p-12;
inline constexpr double kPadRadius = 0x1p-17;

struct PaddedNode {
  glm::vec3 center{0.0f};
  double radius2 = 0.0;  ///< squared, padded
  glm::vec3 lower{0.0f}, upper{0.0f};
};

/// One primitive as the format's P0, P1, P2.
using PrimitiveTexels = std::array<glm::vec4, 3>;

struct BakeInput {
  const SphereTree& tree;
  std::vector<PaddedNode> nodes;            ///< as tree.nodes
  std::vector<PrimitiveTexels> primitives;  ///< as tree.references
};

/// The children of a node in the order in which a ray of this octant should meet them (bit a set: direction component a
/// is negative). Octant 0 of links `threaded` takes the tree's own order instead: pass `sorted` false.
std::vector<std::uint32_t> ordered_children(const SphereTree& tree, std::uint32_t node, unsigned octant, bool sorted);

/// The smallest float that is not below x.
float round_up(double x);

/// Fill image.texels and the fields that describe the layout, from options, counts and scale that are set already.
void bake_compact(const BakeInput& input, GeometryImage& image);
void bake_paper(const BakeInput& input, GeometryImage& image);

/// Sets width and height to the smallest powers of two, at least options.width each, that hold `texels`, and allocates
/// them. Throws InputError beyond 16384 x 16384.
void allocate_texels(std::uint64_t texels, GeometryImage& image);

}  // namespace plumbline
