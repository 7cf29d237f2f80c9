// SPDX-License-Identifier: MIT
// What both layouts bake from: the tree's nodes with padded bounds in the image's units, and its primitives as texels.
#pragma once

#include <array>
#include <vector>

#include "tracer/geometry_image.h"

namespace plumbline {

// Why bounds are padded. Culling must not change an answer: where the shader's arithmetic accepts primitive p at
// parameter t, every node above p must pass the shader's node test while best >= t. Let u = 2^-24, R the scene's
// radius, D = 3.5 R >= the distance of a walking origin (ray_prepare.glsl: at most 2.3 R from the centre) to any point
// of the scene, L the longest edge of p.
//
//   (1) Accepting. Let X be the point of p that the computed weights stand for. A projected corner (x, y) is off by
//       9.2 u D (a subtraction, a shear factor of 2 u, a product, a subtraction, twice), z by 4 u D in the end, so
//       |P(t) - X| <= e + 20 u D, where e is how far the weights miss the ray among the projected corners as they are
//       in float:
//         fast path (|det| >= 2^-8 M^2, M the farthest corner): each edge function is off by 2 u M^2, a weight by at
//         most 8 u M^2 / |det|, the three together by e <= 12 * 2^8 u M <= 2^-12.4 M, and M <= 1.001 of the longest
//         projected edge; slow path: e <= 2^-12 of the longest projected edge, tested.
//       The shear stretches by at most sqrt(3): e <= sqrt(3) 2^-12 (1 + 2^-9) L < 2^-11 L.
//       Spheres: the foot of the perpendicular is off by 3 u D across and 9 u D along the ray, the half chord by 6 u r,
//       t by u D: P(t) lies within 20 u D of the sphere.
//   (2) Culling. m = c - o is off by u D, s = clamp(dot(m, dn), 0, best) by 9 u D in length, f = m - s d by another 2 u
//   D:
//       |f| <= (distance from c to the segment [0, best]) + 12 u D, and dot(f, f) adds 1.5 u D to its root.
//       The distance from c to the segment is at most |P(t) - c| <= radius + |P(t) - X|.
//
// Together: 2^-11 L + (20 + 14) u D = 2^-11 L + 119 u R, rounded up to 2^-11 L + 2^-17 R. The boxes of `aabb` are
// padded alike on each side; their test (bounds.glsl) errs by 12 u D as well. (kEdgeOn and kEdgeOnReach of
// shader_words.h are the 2^-8 and 2^-12 above.)
inline constexpr double kPadEdge = 0x1p-11;
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
