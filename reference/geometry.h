// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's triangles and spheres, sorted by the space that they are in, as Embree is to have them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/instance_map.h"
#include "scenes/scene.h"

namespace plumbline {

/// A sphere of a Geometry.
struct Round {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

/// An ellipsoid's map from the space of its sphere, and back.
struct Image {
  TransformD to_here, from_here;
};

/// What one space holds: the world, a part's own, or the world with all instances brought into it.
struct Geometry {
  std::vector<glm::vec3> positions;
  std::vector<glm::dvec3> fine_positions;  ///< instead of `positions`, where instances were brought into the world
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Round> rounds;
  std::vector<Image> images;
  /// Of each round, into `images`: what is meant is the sphere's image, an ellipsoid; kNone: the sphere itself. Empty
  /// where there are no images.
  std::vector<std::uint32_t> image_of;

  /// Of triangles[0] and rounds[0], where numbers follow one another.
  std::uint32_t first_triangle = 0, first_sphere = 0;
  /// Of each triangle and then of each sphere, where instances were brought into the world; else empty.
  struct Source {
    std::uint32_t instance = kNone, primitive = kNone;
    bool turned = false;  ///< mirrored: the cross product of its corners points to the other side than its normal
  };
  std::vector<Source> sources;

  std::array<glm::dvec3, 3> corners(std::size_t triangle) const {
    const auto& p = triangles[triangle];
    if (!fine_positions.empty()) return {fine_positions[p[0]], fine_positions[p[1]], fine_positions[p[2]]};
    return {positions[p[0]], positions[p[1]], positions[p[2]]};
  }
  const Image* image(std::size_t round) const {
    return image_of.empty() || image_of[round] == kNone ? nullptr : &images[image_of[round]];
  }
  Source source_of_triangle(std::uint32_t i) const {
    return sources.empty() ? Source{kNone, first_triangle + i} : sources[i];
  }
  Source source_of_sphere(std::uint32_t i) const {
    return sources.empty() ? Source{kNone, first_sphere + i} : sources[triangles.size() + i];
  }
};

/// What stands in the world itself.
Geometry world_geometry(const Scene& scene);
/// What a part holds, in its own space.
Geometry part_geometry(const Scene& scene, const Part& part);

/// Pairs (instance, primitive) that flattened_geometry takes at most: each costs some 250 bytes, tree included.
inline constexpr std::uint64_t kMostFlattened = 8'000'000;
/// The world with every instance brought into it, each by its map composed in double, corners in double. Spheres stay
/// spheres under maps that keep angles but for rounding in double; under others they become ellipsoids. Throws
/// InputError where more than kMostFlattened pairs would be made.
Geometry flattened_geometry(const Scene& scene);

/// A box around a round, in its geometry's space: exact but for a few roundings in double.
BoxD box_of_round(const Geometry& geometry, std::size_t round);
/// A box around all; empty where there is nothing.
BoxD box_of(const Geometry& geometry);

}  // namespace plumbline
