// SPDX-License-Identifier: GPL-3.0-or-later
// How far one step of a sample may be off in the tracer's 32 bits, if the step before it is given: the surface at a
// hit, the light that it sees, the rays that leave it. The derivation stands in paired_bounds.cpp.
#pragma once

#include <optional>
#include <string>

#include "harness/bounds.h"
#include "reference/path_steps.h"

namespace plumbline {

/// Bounds on the lengths of differences.
struct RayBounds {
  double origin = 0.0;     ///< world units
  double direction = 0.0;  ///< of shadow rays world units, of others a difference of unit vectors
};

RayBounds primary_bounds(const SampleNumbers& numbers);

/// The surface at a hit as the tracer must see it, and how far it may be off.
struct SeenSurface {
  Surface surface;
  double position = 0.0;    ///< world units
  double shading = 0.0;     ///< of n, a difference of unit vectors
  double offset = 0.0;      ///< of delta, world units
  glm::dvec3 color{0.0};    ///< of C
  std::string undecided{};  ///< which choice 32 bits do not settle; empty: none
};
/// At the hit that the tracer has told: place, normal and weights are taken as they are.
SeenSurface see_surface(const PreparedScene& prepared, const BoundsContext& context, const Ray& ray, const Hit& hit);
/// At a hit of the ground in double.
SeenSurface see_ground(const PreparedScene& prepared, const Ray& ray, const ReferenceHit& hit);

/// What the ray meets of the ground.
struct SeenGround {
  std::optional<ReferenceHit> hit;
  double t = 0.0;           ///< how far t may be off
  std::string undecided{};  ///< why 32 bits do not settle whether it is hit; empty: they do
};
SeenGround meet_ground(const Scene& scene, const Ray& ray);

/// One light at a hit: the shadow ray, and what it brings where nothing stands in its way.
struct SeenLight {
  LightOutcome outcome = LightOutcome::below;  ///< `lit`: a shadow ray decides
  Ray shadow;
  RayBounds shadow_bounds;
  glm::dvec3 brought{0.0}, brought_bounds{0.0};  ///< for a ray of weight 1
  std::string undecided{};
};
/// `direction`: of the ray that hit, unit length.
SeenLight see_light(const SampleNumbers& numbers, const SeenSurface& seen, const glm::dvec3& direction,
                    std::uint32_t ray, std::uint32_t light);

/// A ray that leaves a hit.
struct SeenRay {
  PathRay ray;
  RayBounds bounds;
  std::string undecided{};
};
SeenRay see_reflected(const SampleNumbers& numbers, const SeenSurface& seen, const PathRay& path);
SeenRay see_refracted(const SeenSurface& seen, const PathRay& path);

}  // namespace plumbline
