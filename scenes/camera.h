// SPDX-License-Identifier: MIT
// The ray through a point of the picture, by SEMANTICS.md section 4, and what else follows from the view alone.
#pragma once

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// An orthonormal frame at the eye, world space, and the slope between the centres of neighbouring pixels.
struct CameraFrame {
  glm::dvec3 from{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0}, forward{0.0, 0.0, -1.0};
  double pixel = 0.0;                     ///< side of a pixel on the plane at distance 1
  double centre_x = 0.0, centre_y = 0.0;  ///< pixel coordinates of the axis
};

/// The frame of a camera. Throws InputError where from equals at, or where up is parallel to the view.
CameraFrame camera_frame(const Camera& camera);

/// The ray through (x, y) in pixels: (0, 0) is the centre of the top-left pixel, (width - 1, height - 1) of the
/// bottom-right one. The direction is of unit length, computed in double and rounded once; t_max is infinite.
Ray camera_ray(const CameraFrame& frame, double x, double y);
Ray camera_ray(const Camera& camera, double x, double y);

/// The distance along the view of what is sharp: `focus`, or that of `at` where it is 0.
double focus_distance(const Camera& camera);

/// What lights a scene without lights: a point without colour, above the eye and to its right, each by half the
/// distance from the eye to `at`. Throws as camera_frame does.
Light default_light(const Camera& camera);

}  // namespace plumbline
