// SPDX-License-Identifier: MIT
// Adds polygons, spheres, cones and cylinders to a Scene: what readers and generators share.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

/// Sides of the prism that stands for a cone or a cylinder.
inline constexpr int kConeSides = 16;

/// What became of a shape.
enum class Added {
  whole,        ///< it stands as it was given
  blended,      ///< its edges cross: corners were added where they do
  no_area,      ///< nothing was added
  too_complex,  ///< nothing was added: see triangulate.h
};

/// Adds the triangles of a polygon of any size and counts it once: as a patch where it has normals, else as a polygon.
/// `normals` is empty or as long as `corners`.
Added add_polygon(Scene& scene, std::span<const glm::vec3> corners, std::span<const glm::vec3> normals,
                  std::uint32_t material);

/// Adds a sphere and counts it. The radius must be > 0.
void add_sphere(Scene& scene, const glm::vec3& center, float radius, std::uint32_t material);

/// Adds an open cone (a cylinder where the radii are equal) as kConeSides strips with smooth normals, corners on the
/// true surface, and counts it. Radii must be >= 0. Nothing is added where both radii are zero or the ends coincide.
Added add_cone(Scene& scene, const glm::vec3& base, float base_radius, const glm::vec3& apex, float apex_radius,
               std::uint32_t material);

/// Adds a material as SPD's `f` line has it and returns its index.
std::uint32_t add_material(Scene& scene, const Material& material);

/// Gives every triangle of the scene smooth normals, one per position: the mean of the normals around it, weighted by
/// area.
void add_smooth_normals(Scene& scene);

}  // namespace plumbline
