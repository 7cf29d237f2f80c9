// SPDX-License-Identifier: MIT
// What is traced: geometry, the places where it stands, materials, lights and camera as plain data. Readers and
// generators make a Scene; the tracer and the reference each build their own structures from it and share nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scenes/animation.h"
#include "scenes/transform.h"

namespace plumbline {

/// A surface as SPD's `f` line describes it. Colours are linear, factors are in [0, 1].
struct Material {
  std::string name;                       ///< as in the file; empty where the format has no names
  glm::vec3 color{1.0f};                  ///< linear RGB that modulates the diffuse term
  float diffuse = 1.0f;                   ///< Kd
  float specular = 0.0f;                  ///< Ks: highlight and reflection
  float shine = 1.0f;                     ///< Blinn-Phong exponent
  float transmittance = 0.0f;             ///< T
  float refraction_index = 1.0f;          ///< relative to the outside; 0 in some SPD files means opaque
  std::uint32_t diffuse_texture = kNone;  ///< index into Scene::textures; modulates Kd
  std::uint32_t bump_texture = kNone;     ///< index into Scene::textures; a height map (Blinn 1978)
  float bump_scale = 1.0f;                ///< length that a height of 1 stands for, in the space of the geometry
  float glossy = -1.0f;                   ///< as Effects::glossy, of this surface; below 0: that of the scene
};

/// An image in memory, row 0 at the top, linear values.
struct Texture {
  std::string path;               ///< where it was read from
  int width = 0, height = 0;      ///< texels
  std::vector<glm::vec3> texels;  ///< width * height, row by row
};

/// Three indices into Scene::positions, and optionally into normals and texcoords.
struct Triangle {
  std::array<std::uint32_t, 3> position{};
  std::array<std::uint32_t, 3> normal{kNone, kNone, kNone};    ///< all absent or all present
  std::array<std::uint32_t, 3> texcoord{kNone, kNone, kNone};  ///< all absent or all present
  std::uint32_t material = 0;
};

struct Sphere {
  glm::vec3 center{0.0f};
  float radius = 1.0f;  ///< > 0
  std::uint32_t material = 0;
};

struct Light {
  glm::vec3 position{0.0f};  ///< world space
  glm::vec3 color{0.0f};     ///< linear RGB intensity; meaningful only where has_color
  bool has_color = false;    ///< without one the intensity is sqrt(n)/(2n) for n lights (NFF)
  float radius = 0.0f;       ///< world units; 0: a point
};

/// A camera as NFF's `v` describes it, world space. `angle_radians` spans the centres of the outermost pixel rows.
struct Camera {
  glm::vec3 from{0.0f, 0.0f, 1.0f};
  glm::vec3 at{0.0f};
  glm::vec3 up{0.0f, 1.0f, 0.0f};  ///< need not be perpendicular to the view, nor of unit length
  float angle_radians = 0.7853982f;
  float hither = 0.0f;
  int width = 512, height = 512;  ///< pixels
  float aperture = 0.0f;          ///< radius of the lens, world units; 0: a pinhole
  float focus = 0.0f;             ///< distance of what is sharp, world units along the view; 0: that of `at`
  float shutter_open = 0.0f, shutter_close = 0.0f;  ///< seconds of the animation, relative to the time of the frame
};

/// What a renderer does with a scene beyond one sharp ray through each pixel (design section 6). Read by renderers
/// alone: no ray of a comparison depends on it. Soft shadows also need lights with a radius, depth of field a camera
/// with an aperture, motion blur a shutter and an animation.
struct Effects {
  enum class Model { paper, physical };
  Model model = Model::paper;  ///< the densities that are sampled
  bool antialias = true;
  bool soft_shadows = true;
  bool depth_of_field = true;
  bool motion_blur = true;
  bool glossy_reflections = true;
  float glossy = 0.0f;      ///< half-side or radius of what is added to the normal of a reflection; 0: a mirror
  std::uint32_t depth = 5;  ///< of reflections and refractions, at most 5
};

/// A round plane outside of the tree: the paper's global geometry test (SEMANTICS.md, 6.8). World space. It is none of
/// the scene's primitives, and no bounding ball holds it.
struct Ground {
  glm::vec3 center{0.0f};
  glm::vec3 normal{0.0f, 1.0f, 0.0f};                             ///< of unit length, rounded
  glm::vec3 u_axis{1.0f, 0.0f, 0.0f}, v_axis{0.0f, 0.0f, -1.0f};  ///< of its texture, of unit length, rounded
  float radius = 0.0f;                                            ///< 0: there is no ground
  float texture_size = 1.0f;                                      ///< > 0, side of one repetition of the texture
  std::uint32_t material = 0;
};

/// What a reader found in its file, before polygons, cones and cylinders became triangles.
struct SourceCounts {
  std::size_t polygons = 0;  ///< `p`, or OBJ faces without vertex normals
  std::size_t patches = 0;   ///< `pp`, or OBJ faces with vertex normals
  std::size_t spheres = 0;
  std::size_t cones = 0;      ///< `c` with two radii that differ
  std::size_t cylinders = 0;  ///< `c` with equal radii
  std::size_t total() const { return polygons + patches + spheres + cones + cylinders; }
};

/// Geometry in a space of its own, to be placed by nodes, as often as they like: ranges of Scene::triangles and
/// Scene::spheres. Not empty.
struct Part {
  std::string name;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_sphere = 0, sphere_count = 0;  ///< into Scene::spheres
};

/// One node of the tree of transforms. It holds a part or other nodes, not both (readers put a node that would hold
/// both above one of its own with the identity). A node with a part is an *instance*: its index is the instance's
/// number in hits.
struct Node {
  std::string name;              ///< unique within the scene, as "walker/leg.2"
  std::uint32_t parent = kNone;  ///< into Scene::nodes, smaller than this node's own index; kNone: the world
  std::uint32_t part = kNone;    ///< into Scene::parts; kNone: a group, which may be empty
  Transform transform;           ///< from this node's space to its parent's; never singular
  Transform rest;  ///< where the tree over the nodes is built; equal to `transform` until the node is moved
};

/// Primitives are numbered triangles first, then spheres: primitive p is triangles[p] where p < triangles.size(), else
/// spheres[p - triangles.size()]. A scene without parts is all world space. With parts, the triangles and spheres
/// before the first part's are in world space, and those of the parts follow, part by part, without gaps.
///
/// What a ray meets is named by (instance, primitive): the node that placed it, kNone in world space, and the number
/// above. One primitive may be met in many instances.
struct Scene {
  std::string name;                  ///< short, for case names: the file's stem or the generator's name
  std::vector<glm::vec3> positions;  ///< each in the space of the triangles that use it; parts share none
  std::vector<glm::vec3> normals;    ///< as in the file: not always of unit length
  std::vector<glm::vec2> texcoords;  ///< as in the file: (0, 0) is the bottom left corner of a texture, v goes up
  std::vector<Triangle> triangles;
  std::vector<Sphere> spheres;
  std::vector<Part> parts;
  std::vector<Node> nodes;           ///< parents before children
  std::vector<Animation> animation;  ///< at most one for each node
  std::vector<Material> materials;   ///< at least one where there are primitives
  std::vector<Texture> textures;
  std::vector<Light> lights;
  Camera camera;
  bool has_camera = false;  ///< false: `camera` is a view chosen to frame the scene (frame_camera)
  glm::vec3 background{0.0f};
  Effects effects;
  Ground ground;
  SourceCounts source;
  std::vector<std::string> warnings;  ///< "file:line: what was done and why", for the user to read

  std::uint32_t primitive_count() const { return static_cast<std::uint32_t>(triangles.size() + spheres.size()); }
  bool is_triangle(std::uint32_t primitive) const { return primitive < triangles.size(); }
  const Sphere& sphere(std::uint32_t primitive) const { return spheres[primitive - triangles.size()]; }
  std::uint32_t world_triangle_count() const {
    return parts.empty() ? static_cast<std::uint32_t>(triangles.size()) : parts.front().first_triangle;
  }
  std::uint32_t world_sphere_count() const {
    return parts.empty() ? static_cast<std::uint32_t>(spheres.size()) : parts.front().first_sphere;
  }
  /// Whether this pair names something: a primitive of the world (instance kNone), or of the instance's part.
  bool is_placed(std::uint32_t instance, std::uint32_t primitive) const;
  /// The three corners of triangle `primitive`, in its own space.
  std::array<glm::vec3, 3> corners(std::uint32_t primitive) const {
    const auto& p = triangles[primitive].position;
    return {positions[p[0]], positions[p[1]], positions[p[2]]};
  }
};

/// A ball; radius 0: nothing is in it.
struct Ball {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};
/// Around everything that the scene places, instances included, world space. In double, rounded outwards.
Ball bounding_ball(const Scene& scene);
/// Around a part, in its own space.
Ball bounding_ball(const Scene& scene, const Part& part);

/// From the instance's own space to the world, composed in double; the identity for kNone.
TransformD to_world(const Scene& scene, std::uint32_t instance);
/// The nodes from the outermost to `instance` itself; empty for kNone.
std::vector<std::uint32_t> chain_of(const Scene& scene, std::uint32_t instance);
/// Indices of the nodes that hold a part, ascending.
std::vector<std::uint32_t> instances_of(const Scene& scene);
/// How many pairs (instance, primitive) the scene shows: 7e8 for ten thousand bunnies.
std::uint64_t placed_count(const Scene& scene);

/// Sets `camera` so that the bounding ball fills a 512x512 frame, seen from (1, 0.6, 1.2) at 40 degrees.
void frame_camera(Scene& scene);

}  // namespace plumbline
