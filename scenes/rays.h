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
};

struct RayFamilyInfo {
  RayFamily family;
  std::string_view name;         ///< stable, of case names: "aimed_edges"
  std::string_view description;  ///< one sentence
};

/// All families, in a fixed order.
std::span<const RayFamilyInfo> ray_families();
const RayFamilyInfo& ray_family_info(RayFamily family);
/// Throws InputError for an unknown name, listing the known ones.
RayFamily find_ray_family(std::string_view name);

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
  std::vector<double> area_sum;  ///< running sums of the primitives' areas, in primitive order
  std::vector<glm::vec4> node_spheres;
  std::vector<Ray> captured;
};

/// Fills `out` with the rays first_index, first_index + 1, ... of a family. Thread-safe.
///
/// Every ray of every family but `undefined` is defined (is_defined); no ray of `undefined` is. All families give rays
/// for every scene. Where a scene has no triangles, those that speak of vertices aim at the poles of spheres, those
/// that speak of edges at their outlines as seen from the origin, and `in_plane` runs in planes that touch spheres. An
/// empty scene gets the rays of `chords`, of a ball of radius 1.
///
/// `camera` goes over the picture in tiles of 8 x 8 pixels, one after the other, each far from the one before; when all
/// pixels have had a ray it starts again. `secondary` repeats the captured rays in their order; from the second round
/// on, origin and direction move by up to 4 units in the last place; without captured rays it gives those of
/// `on_surface`.
///
/// `scaled` has rays whose hits lie beyond what a float can hold for t: with directions of length 1e-42, t is of the
/// order of 1e42.
void generate_rays(const RaySource& source, RayFamily family, std::uint64_t seed, std::uint64_t first_index,
                   std::span<Ray> out);

}  // namespace plumbline
