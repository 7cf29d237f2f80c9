// SPDX-License-Identifier: GPL-3.0-or-later
// A ray as it arrives in an instance's own space, and how far the tracer's own ray may be from it there. The derivation
// stands in placed_ray.cpp.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// A node's matrix and its inverse, with the sizes that rounding errors follow.
struct NodeStep {
  glm::dmat3 linear{1.0}, inverse{1.0};
  glm::dmat3 abs_linear{1.0}, abs_inverse{1.0};  ///< of each entry the absolute value
  glm::dmat3 inverse_error{0.0};                 ///< how far the tracer's inverse in floats may be from the exact one
  glm::dvec3 translation{0.0};
  Ball content;  ///< around what stands behind the node, in its own space
};

/// How an instance stands in the world, as far as bounds need to know.
struct PlacedSpace {
  TransformD to_world;
  double stretch = 1.0;          ///< largest_stretch of to_world
  double inverse_stretch = 1.0;  ///< and of its inverse
};

/// What leaving transforms by their inverses may add to a ray, for each transform left, world units: the origin's error
/// is at most scale * |o| + offset, the direction's scale * |d|.
struct Drift {
  double scale = 0.0, offset = 0.0;
};

/// All nodes of a scene, made once.
struct PlacedSpaces {
  std::vector<NodeStep> nodes;         ///< as Scene::nodes
  std::vector<PlacedSpace> instances;  ///< as Scene::nodes; the identity for groups
  Drift drift;                         ///< the greatest of all nodes
  double entering_scale = 0.0;         ///< over all instances: how much entering may displace a ray, world units, is
  double entering_offset = 0.0;        ///< at most entering_scale * (|o| + distance) + entering_offset
  double carried = 1.0;                ///< how much entering may magnify an error of the world's ray, seen in the world
};
/// `contents`: of each node, the ball around what stands behind it, near which the tracer moves far origins.
PlacedSpaces make_placed_spaces(const Scene& scene, std::span<const Ball> contents);

/// A ray in the space where a primitive stands.
struct PlacedRay {
  std::uint32_t instance = kNone;
  glm::dvec3 origin{0.0}, direction{0.0};  ///< the exact ray from t_origin on, but for rounding in double
  double t_origin = 0.0;                   ///< t of `origin`: not 0 where the tracer moved a far origin on the way
  double t_rounding = 0.0;                 ///< what moving origins on the way adds to the error of t
  double length = 0.0;                     ///< of the direction
  /// Of each component, how far the tracer's own ray may be from it before it computes anything with it; zero in world
  /// space, unless transforms were left by their inverses.
  glm::dvec3 origin_error{0.0}, direction_error{0.0};
  bool is_exact = true;  ///< both are zero
  /// What the rounding of an origin that the tracer moves near its space's ball comes to, in lengths across the ray,
  /// and how far at most the moved origin is from anything in the ball; where it is not moved 0 and infinity.
  double moved_error = 0.0, farthest = std::numeric_limits<double>::infinity();
};

/// The ray in an instance's space (kNone: the world's, whose contents lie in `world`). `left`: how many transforms the
/// tracer may have left by their inverses before; 0 where it restores the ray.
PlacedRay place_ray(const PlacedSpaces& spaces, const Scene& scene, const Ball& world, const Ray& ray,
                    std::uint32_t instance, std::uint32_t left);

/// What the rounding of an origin that is moved near a ball comes to, in lengths across the ray.
double moved_error(const Ball& ball);

/// Bounds on what bringing a position and a normal from an instance's space to the world adds to their errors.
/// `position` and `normal` are the exact ones, local. `normal_world_length` is the length of the inverse transpose
/// times the unit normal.
struct LeavingErrors {
  double position = 0.0;  ///< world units
  double normal = 0.0;    ///< in units of normal_world_length
  double normal_world_length = 1.0;
};
LeavingErrors leaving_errors(const PlacedSpaces& spaces, const Scene& scene, std::uint32_t instance,
                             const glm::dvec3& position, const glm::dvec3& normal);

}  // namespace plumbline
