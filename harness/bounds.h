// SPDX-License-Identifier: GPL-3.0-or-later
// How far the production tracer's 32-bit answers may lie from the exact ones: forward error bounds of its formulas,
// computed per ray from the geometry. The derivation stands in bounds.cpp; bounds_test.cpp shows that they hold and
// that they are not slack.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// What the bounds need to know of the scene: where its ball is, since the tracer moves far origins near it.
struct BoundsContext {
  const Scene* scene = nullptr;
  Ball ball;
  double longest_edge = 0.0;     ///< of all triangles; 0 without triangles
  double smallest_radius = 0.0;  ///< of all spheres; 0 without spheres
  double largest_radius = 0.0;   ///< likewise
};
BoundsContext make_bounds_context(const Scene& scene);

/// Bounds on the absolute errors of one hit. Every member is >= 0 and may be infinite where 32 bits resolve nothing.
struct ValueBounds {
  double t = 0.0;             ///< in units of the ray's direction
  double position = 0.0;      ///< world units, length of the difference
  double normal = 0.0;        ///< length of the difference of unit vectors, at most 2
  double barycentrics = 0.0;  ///< each weight
};
ValueBounds value_bounds(const BoundsContext& context, const Ray& ray, std::uint32_t primitive, double t);

/// How far, in world units perpendicular to the ray, a ray may pass inside of the primitive's outline and still be
/// missed by the tracer, or outside of it and still be taken for a hit.
double lateral_bound(const BoundsContext& context, const Ray& ray, std::uint32_t primitive);

/// An upper bound of lateral_bound over all primitives of the scene.
double lateral_bound_of_scene(const BoundsContext& context, const Ray& ray);

}  // namespace plumbline
