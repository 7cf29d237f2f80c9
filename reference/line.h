// SPDX-License-Identifier: GPL-3.0-or-later
// A ray's line in double precision without any loss: the direction scaled by a power of two, the origin moved along the
// line to the neighbourhood of the scene, so that arithmetic near the scene is as accurate for far rays as for near
// ones.
#pragma once

#include "scenes/ray.h"

namespace plumbline {

/// The line of a ray. Positions on it are `point + rest + s * direction`; s = 0 is `shift` past the ray's origin.
/// All of it is exact: point + rest = origin + shift * direction, and direction = ray.direction * unit.
///
/// Nothing computed from it over- or underflows below degree 7: coordinates are floats (2^-149 to 2^128), the
/// direction's components are zero or 2^-277 to 2, so a product of three coordinate differences lies within 2^-447 to
/// 2^390.
struct Line {
  glm::dvec3 point{0.0};      ///< world units
  glm::dvec3 rest{0.0};       ///< what `point` lost to rounding; zero where shift is zero
  glm::dvec3 direction{0.0};  ///< its largest component is in [1, 2)
  double unit = 1.0;          ///< a power of two: t of the ray = (shift + s) * unit
  double shift = 0.0;         ///< of at most 29 bits; zero unless the ray starts far from the scene
  double t_max = 0.0;         ///< the ray's, in units of `direction`, from the ray's origin; may be infinite

  double ray_t(double s) const { return (shift + s) * unit; }
};

/// The line of a defined ray. An origin more than two radii outside the ball is moved to about two radii before the
/// point where the line passes the ball's centre.
Line line_near(const Ray& ray, const Ball& ball);

}  // namespace plumbline
