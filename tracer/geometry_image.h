// SPDX-License-Identifier: MIT
// The geometry image: a sphere tree and its primitives baked into one RGBA32F texture that a shader walks without a
// stack. This header is the only place where the format is written down; its constants reach the GLSL from here.
//
// Units. World coordinates times 2^scale_exponent, an exact power of two that is 1 unless the scene's radius lies
// outside [2^-20, 2^20]. All bounds are padded, so that no primitive is lost that the shader's own arithmetic accepts
// (bake.h).
//
// Primitives stand after the nodes, cluster by cluster (a cluster is what one leaf holds), each in `primitive_stride`
// units:
//
//   triangle   P0 = corner 0, label     P1 = corner 1, kind 0     P2 = corner 2, 0
//   sphere     P0 = centre, label       P1 = radius, 0, 0, kind 1
//   label      the primitive's number + 1, exact as float; negative on the last primitive of its cluster
//
// Regions. What is walked in one space is a region: the world's (its own geometry, then the tree over the nodes that
// stand in it), one for each part, one for each node that holds other nodes. A region stands in the image once, however
// many nodes show it, as one copy, or as one copy for each octant of directions.
//
// Transforms stand behind the primitives, one record of kTransformTexels texels for each node of the scene, by number:
//
//   R0 R1 R2   the rows of the inverse 3 x 3 matrix, each with a component of the translation T: in = inverse (out - T)
//   R3 R4 R5   the rows of the 3 x 3 matrix, in units of the image: powers of two that scale either space are in it;
//              in w the number of the node around it + 1 (0: the world), where the region behind it starts, its
//              copy_size
//   R6         the ball of what stands behind it, in its own space
//   R7         k of its first primitive, how many there are (0 0 in front of a group), depth (1: in the world), 0
//   R8 R9      where its leaf stands in each of the copies of the region around it
//
// Lights stand behind the transforms, kLightTexels texels each, in units of the world:
//
//   L0   position, radius     L1   colour, 1; or 0 0 0 0 for a light without one
//
// Layout `compact`. Texel i stands at (i mod width, i / width).
//   region       one depth-first copy of its trees (links `threaded`), or one per octant of directions (links `octant`:
//                bit a of the octant is set where direction component a is negative; children stand front to back),
//                each closed by an end texel. The world's stands at 0
//   then, from `primitive_start`                 primitive k: P0, P1(, P2) at primitive_start + primitive_stride * k
//   then, from `transform_start`                 record n at transform_start + kTransformTexels * n
//   then                                         light l at light_start + kLightTexels * l
//   A node with bounds `sphere` is one texel: the centre and a word. The word is a float whose absolute value is at
//   least the squared radius: its low `payload_bits` bits were set first, then the smallest bits above them that make
//   it so. With bounds `aabb` a node is two texels: lower corner and word, upper corner and 0; here the bits above the
//   payload are 0 but for the sign and kWordBase.
//     sign bit 0   inner node: the payload is the distance in texels to the next node where this one is not hit; where
//                  it is hit, the next node follows at once
//     sign bit 1   leaf: the payload is k of the cluster's first primitive, or primitive_count + n where node n of the
//                  scene is to be entered; hit or not, the next node follows at once
//   The end texel's word is -infinity: a leaf that no ray misses. In the world the walk ends there; elsewhere it leaves
//   the transform and goes on behind its leaf.
//
// Layout `paper` (the paper, section 4). Cell (x, y) is texels (x, 2y) and (x, 2y + 1), one above the other; cell i
// stands at (i mod width, i / width).
//   node         top: centre, squared radius rounded up (bounds `aabb`: two cells side by side on an even x: lower
//                corner, 0 | upper corner, 0)
//                below: in link, out link
//   primitive    `primitive_stride` cells side by side on an x divisible by it: top P0(, P1), below P1 or P2
//   transform    kTransformTexels / 2 cells in a row: R0 above R1, R2 above R3, ...
//   light        one cell: L0 above L1
//   link         (x + 0.5) / width + K, (2y + 0.5) / height: the half texel is baked in; the integer K tells what is
//                reached: 0 a node, kLinkTriangle or kLinkSphere the first primitive of a cluster (spheres may follow
//                triangles in it), kLinkTransform the record of a node to enter, kLinkEnd the end of the region
//   Traversal starts at the copy's first cell. Nodes stand depth first: the in link of an inner node leads to the next,
//   its out link behind all that stands below it. The in link of a leaf leads to its cluster or its transform; after it
//   comes the out link of the leaf. Chains that would end are ended at once. Copies share the primitives.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "tracer/scene_tree.h"
#include "tracer/sphere_tree.h"

namespace plumbline {

inline constexpr int kGeometryImageVersion = 3;
inline constexpr std::uint32_t kWordBase = 0x3f800000u;  ///< compact, aabb: makes every word a normal float
inline constexpr std::uint32_t kEndWord = 0xff800000u;   ///< compact: -infinity
inline constexpr int kMaxImageWidth = 16384;             ///< and height, in texels
inline constexpr int kMaxPayloadBits = 23;  ///< compact: at least the exponent of the squared radius is kept
inline constexpr float kKindTriangle = 0.0f, kKindSphere = 1.0f;
inline constexpr int kLinkTriangle = -1, kLinkSphere = -2, kLinkTransform = -3, kLinkEnd = -4;
inline constexpr std::uint32_t kTransformTexels = 10;
inline constexpr std::uint32_t kLightTexels = 2;
inline constexpr std::uint32_t kMaxExactFloat = 1u << 24;        ///< whole numbers up to here are exact in a texel
inline constexpr std::uint32_t kMaxPrimitives = (1u << 24) - 2;  ///< labels are exact floats

enum class Layout { paper, compact };
enum class Bounds { sphere, aabb };
enum class Links { threaded, octant };
/// What a ray becomes when it leaves a transform: its own self of before, by the inverse of what took it in (the paper;
/// rounding adds up), or derived anew from the world's ray (nothing adds up).
enum class TransformOut { inverse, restore };
/// Where transforms stand: in a tree over their bounds, or all at the root in a list (the paper).
enum class TransformList { tree, root };

struct BakeOptions {
  Layout layout = Layout::compact;
  Bounds bounds = Bounds::sphere;
  Links links = Links::octant;
  TransformOut transform_out = TransformOut::restore;
  TransformList transform_list = TransformList::tree;
  int width = 512;  ///< texels, a power of two, 16 to 16384; grows to what the tree needs
  TreeOptions tree;
};

struct GeometryImage {
  BakeOptions options;
  std::string scene_name;
  int width = 0, height = 0;      ///< texels, powers of two
  std::vector<glm::vec4> texels;  ///< width * height, row by row, row 0 first
  /// Nodes that the longest walk visits, ends included and all instances entered, at most 2^31 - 1: the cap of the
  /// traversal loop.
  std::uint32_t cell_count = 0;
  glm::vec3 center{0.0f};  ///< of the scene's ball, instances included, in the image's units; far rays are moved near
                           ///< it before they walk
  float radius = 0.0f;     ///< likewise, rounded up
  int scale_exponent = 0;  ///< image units = world units * 2^scale_exponent
  std::uint32_t triangle_count = 0;  ///< triangles with area in the image, copies by splitting not counted
  std::uint32_t sphere_count = 0;
  std::uint32_t primitive_count = 0;  ///< primitives stored, copies by splitting counted
  std::uint32_t primitive_start = 0;  ///< compact: texel; paper: cell
  std::uint32_t primitive_stride =
      0;  ///< compact: texels (3, or 2 without triangles); paper: cells (2, or 1 without triangles)
  std::uint32_t world_primitives = 0;  ///< of those stored, the first so many stand in world space
  std::uint32_t transform_start = 0;   ///< compact: texel; paper: cell
  std::uint32_t transform_count = 0;   ///< records: nodes of the scene
  std::uint32_t light_count = 0;       ///< lights of the scene
  std::uint32_t copy_count = 0;        ///< 1 (threaded) or 8 (octant)
  std::uint32_t copy_size = 0;         ///< of the world's region; compact: texels, end included; paper: cells
  int payload_bits = 0;                ///< compact: low bits of a node's word
};

/// Bakes a tree of the scene. Throws InputError where the image would outgrow 16384 x 16384 texels or what the format
/// can number, for options out of range, and for coordinates that are not finite.
GeometryImage bake(const Scene& scene, const SceneTree& tree, const BakeOptions& options = {});

/// Builds the trees that `options` ask for and bakes them.
GeometryImage bake(const Scene& scene, const BakeOptions& options = {});

/// Texels that follow one another, row after row.
struct TexelRange {
  std::uint32_t first = 0, count = 0;
};

/// Brings the image up to date with scene.nodes after the transforms of the nodes `moved` changed: rewrites their cells
/// and the spheres above them, in place. Returns the texels whose bits changed, ascending. The image then equals
/// bake(scene, tree) bit for bit. `tree` and `image` must belong together and to the scene.
std::vector<TexelRange> update_transforms(const Scene& scene, std::span<const std::uint32_t> moved, SceneTree& tree,
                                          GeometryImage& image);

/// Writes an OpenEXR file: 32-bit floats, lossless, metadata as attributes. Throws EnvironmentError where it cannot be
/// written.
void write_geometry_image(const GeometryImage& image, const std::filesystem::path& path);

/// Reads what write_geometry_image wrote, bit for bit. Throws InputError for any other file: one of a newer format,
/// truncated, or whose attributes contradict one another; what the header tells is checked before memory is asked for.
GeometryImage read_geometry_image(const std::filesystem::path& path);

/// How many texels (compact) or cells (paper) a primitive takes in an image with or without triangles.
std::uint32_t primitive_stride(Layout layout, bool has_triangles);

/// Where texel i of the record of scene node n stands in GeometryImage::texels.
std::size_t transform_texel(const GeometryImage& image, std::uint32_t n, std::uint32_t i);
/// Where texel i of light l stands.
std::size_t light_texel(const GeometryImage& image, std::uint32_t l, std::uint32_t i);
/// A light as it is stored.
std::array<glm::vec4, kLightTexels> light_texels(const Light& light);

/// "compact", "sphere", "octant", ...: the names used in files, options and reports.
const char* name_of(Layout layout);
const char* name_of(Bounds bounds);
const char* name_of(Links links);
const char* name_of(TransformOut out);
const char* name_of(TransformList list);

}  // namespace plumbline
