// SPDX-License-Identifier: MIT
// The ray families (design section 5): named, seeded, repeatable. Each ray is a function of scene, family, seed and
// index alone, so any part of a family can be made in any order, by any number of threads, in bounded memory.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scenes/camera.h"
#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

enum class RayFamily {
  camera,
  secondary,
  chords,
  aimed_vertices,
  aimed_edges,
  aimed_inside,
  aimed_outside,
  tangents,
  in_plane,
  axis,
  inside,
  on_surface,
  far,
  scaled,
  segments,
  undefined,
  into_instances,
  between_instances,
};

struct RayFamilyInfo {
  RayFamily family;
  std::string_view name;         ///< stable, of case names: "aimed_edges"
  std::string_view description;  ///< one sentence
  bool needs_instances = false;  ///< gives nothing of its own in a scene without nodes
};

/// All families, in a fixed order.
std::span<const RayFamilyInfo> ray_families();
const RayFamilyInfo& ray_family_info(RayFamily family);
/// Throws InputError for an unknown name, listing the known ones.
RayFamily find_ray_family(std::string_view name);

/// Where a part of the scene's geometry stands: the world, or an instance.
struct PlacedGeometry {
  std::uint32_t instance = kNone;
  TransformD to_world, to_local;  ///< the identity where instance is kNone
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_sphere = 0, sphere_count = 0;  ///< into Scene::spheres
  Ball ball;                                         ///< around it, world space
};

/// What families take from a scene, built once. Keeps a reference to the scene, which must outlive it and stay as it
/// is.
struct RaySource {
  /// `node_spheres`: centres and radii of bounding spheres, for `tangents`.
  explicit RaySource(const Scene& scene, std::vector<glm::vec4> node_spheres = {});

  /// The rays that `secondary` repeats: those that a renderer shot. Undefined ones are left out.
  void set_captured(std::vector<Ray> rays);

  const Scene* scene;
  Ball ball;
  CameraFrame frame;             ///< of the scene's camera
  int width = 1, height = 1;     ///< of the camera's picture, pixels
  std::vector<double> area_sum;  ///< running sums of the primitives' areas, each in its own space, in primitive order
  std::vector<PlacedGeometry> placed;   ///< the world, where it holds anything, then the instances
  std::vector<double> placed_area_sum;  ///< running sums of their areas in the world, as far as one factor tells
  std::vector<glm::vec4> node_spheres;
  std::vector<Ray> captured;
};

/// Fills `out` with the rays first_index, first_index + 1, ... of a family. Thread-safe.
///
/// Every ray of every family but `undefined` is defined (is_defined); no ray of `undefined` is. All families give rays
/// for every scene. A family that aims at something chooses first where: in scenes with nodes, half of the time any
/// place (the world, an instance) as often as another, else by area; then looks from around that place or from around
/// the whole scene; what it aims at is transformed in double. Where a scene has no triangles, those that speak of
/// vertices aim at the poles of spheres, those that speak of edges at their outlines as seen from the origin, and
/// `in_plane` runs in planes that touch spheres. An empty scene gets the rays of `chords`, of a ball of radius 1.
///
/// `camera` goes over the picture in tiles of 8 x 8 pixels, one after the other, each far from the one before; when all
/// pixels have had a ray it starts again. `secondary` repeats the captured rays in their order; from the second round
/// on, origin and direction move by up to 4 units in the last place; without captured rays it gives those of
/// `on_surface`.
///
/// `into_instances` starts inside an instance and `between_instances` at one or before it, both mostly aimed at a point
/// of another; without nodes they give the rays of `inside` and `chords`.
///
/// `scaled` has rays whose hits lie beyond what a float can hold for t: with directions of length 1e-42, t is of the
/// order of 1e42.
void generate_rays(const RaySource& source, RayFamily family, std::uint64_t seed, std::uint64_t first_index,
                   std::span<Ray> out);

}  // namespace plumbline
