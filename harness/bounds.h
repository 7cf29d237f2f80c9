// SPDX-License-Identifier: GPL-3.0-or-later
// How far the production tracer's 32-bit answers may lie from the exact ones: forward error bounds of its formulas,
// computed per ray from the geometry. The derivation stands in bounds.cpp; bounds_test.cpp shows that they hold and
// that they are not slack.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "harness/placed_ray.h"
#include "scenes/ray.h"
#include "scenes/scene.h"
#include "tracer/scene_tree.h"

namespace plumbline {

/// What the bounds need to know of one space, the world or a part: where its ball is, since the tracer moves far
/// origins near it, and how large its primitives are. Lengths are in units of the space.
struct SpaceExtent {
  Ball ball;                     ///< as the tracer has it; of the world: around everything that is placed
  double longest_edge = 0.0;     ///< of all triangles; 0 without triangles
  double smallest_radius = 0.0;  ///< of all spheres; 0 without spheres
  double largest_radius = 0.0;   ///< likewise
};

struct BoundsContext {
  const Scene* scene = nullptr;
  SpaceExtent world;
  std::vector<SpaceExtent> parts;  ///< as Scene::parts
  PlacedSpaces spaces;
  double longest_edge = 0.0;    ///< of everything placed, world units, at least
  double largest_radius = 0.0;  ///< likewise
  /// Over all instances: how far computing in their spaces displaces a ray, in world units; how much it does for each
  /// unit that the ray was displaced before; and the least stretched radius.
  double local_rounding = 0.0, local_amplified = 0.0, least_radius = std::numeric_limits<double>::infinity();
  const SpaceExtent& extent_of(std::uint32_t instance) const {
    return instance == kNone ? world : parts[scene->nodes[instance].part];
  }
};
/// `tree`: the tracer's, whose balls decide which origins are far and where they are moved.
BoundsContext make_bounds_context(const Scene& scene, const SceneTree& tree);

/// The ray in an instance's space (kNone: the world's). `left`: how many transforms the tracer may have left by their
/// inverses when it met the primitive; 0 where it restores the ray.
PlacedRay place_ray(const BoundsContext& context, const Ray& ray, std::uint32_t instance, std::uint32_t left = 0);
/// The same ray when everything may stand up to `blur` (world units) from where it should, beside what rounding does.
PlacedRay blurred(const BoundsContext& context, PlacedRay ray, double blur);

/// Bounds on the absolute errors of one hit. Every member is >= 0 and may be infinite where 32 bits resolve nothing.
struct ValueBounds {
  double t = 0.0;             ///< in units of the ray's direction
  double position = 0.0;      ///< world units, length of the difference
  double normal = 0.0;        ///< length of the difference of unit vectors, at most 2 and a rounding
  double barycentrics = 0.0;  ///< each weight
};
/// `t` is that of the exact hit.
ValueBounds value_bounds(const BoundsContext& context, const PlacedRay& ray, std::uint32_t primitive, double t);
/// Bounds that are never above value_bounds, for a primitive of the world and a ray in world space, at a fraction of
/// the cost. What lies within them needs no others.
ValueBounds least_value_bounds(const BoundsContext& context, const PlacedRay& ray, std::uint32_t primitive, double t);

/// How far, in units of the ray's space and perpendicular to it, a ray may pass inside of the primitive's outline and
/// still be missed by the tracer, or outside of it and still be taken for a hit.
double lateral_bound(const BoundsContext& context, const PlacedRay& ray, std::uint32_t primitive);

/// An upper bound of lateral_bound over all primitives of the ray's space.
double lateral_bound_of_space(const BoundsContext& context, const PlacedRay& ray);

/// An upper bound over everything that is placed, in world units: of lateral_bound over the world's primitives, and of
/// each instance's over the primitives that the ray comes near, stretched as the instance stretches lengths.
double lateral_bound_of_scene(const BoundsContext& context, const Ray& ray, std::uint32_t left = 0);

}  // namespace plumbline
