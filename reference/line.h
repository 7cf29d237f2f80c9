// SPDX-License-Identifier: GPL-3.0-or-later
// A ray's line in double precision: the direction scaled by a power of two, the origin moved along the line to the
// neighbourhood of what is traced, so that arithmetic there is as accurate for far rays as for near ones. In the world
// nothing is lost; in an instance's own space (instance_map.h) the line says how little is.
#pragma once

#include "scenes/ray.h"

namespace plumbline {

/// The line of a ray, in the world or in an instance's own space. Positions on it are `point + rest + s * direction`;
/// s = 0 is `shift` past the ray's origin. In the world all of it is exact: point + rest = origin + shift * direction,
/// and direction = ray.direction * unit. In an instance's space each component of the true point lies within
/// point_error of point + rest, and of the true direction within direction_error of `direction`.
///
/// In the world nothing computed from it over- or underflows below degree 7: coordinates are floats (2^-149 to 2^128),
/// the direction's components are zero or 2^-277 to 2, so a product of three coordinate differences lies within 2^-447
/// to 2^390. In an instance's space the errors are never below 2^-350 and 2^-200, so that what underflows is within the
/// bounds computed from them; what overflows is not known (Bounded).
struct Line {
  glm::dvec3 point{0.0};
  glm::dvec3 rest{0.0};       ///< what `point` lost to rounding; in the world zero where shift is zero
  glm::dvec3 direction{0.0};  ///< its largest component is in [1, 2); in an instance's space it may round to 2
  double unit = 1.0;          ///< a power of two: t of the ray = (shift + s) * unit
  double shift = 0.0;         ///< of at most 29 bits; zero unless the ray starts far from what is traced
  double t_max = 0.0;         ///< the ray's, in units of `direction`, from the ray's origin; may be infinite
  double point_error = 0.0;   ///< infinite where the line is lost to rounding: only exact arithmetic has it
  double direction_error = 0.0;

  double ray_t(double s) const { return (shift + s) * unit; }
};

/// The world's line of a defined ray. An origin more than two radii outside the ball is moved to about two radii before
/// the point where the line passes the ball's centre.
Line line_near(const Ray& ray, const Ball& ball);

/// How far along a line (in units of `direction`) a point is moved to the neighbourhood of a ball: as line_near says; 0
/// where it is near.
double shift_near(const glm::dvec3& point, const glm::dvec3& direction, const Ball& ball);

}  // namespace plumbline
