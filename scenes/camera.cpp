// SPDX-License-Identifier: MIT
#include "scenes/camera.h"

#include <algorithm>
#include <cmath>

#include "scenes/error.h"

namespace plumbline {

CameraFrame camera_frame(const Camera& camera) {
  CameraFrame frame;
  frame.from = glm::dvec3(camera.from);
  const glm::dvec3 view = glm::dvec3(camera.at) - frame.from;
  const double distance = glm::length(view);
  if (!(distance > 0.0) || !std::isfinite(distance)) throw InputError("camera: 'from' and 'at' must be two points");
  frame.forward = view / distance;
  const glm::dvec3 side = glm::cross(frame.forward, glm::dvec3(camera.up));
  const double length = glm::length(side);
  // The floats of `up` and the view are exact inputs, the cross product errs by a few units of 2^-53 of |up|: below
  // that it has no direction.
  if (!(length > 0x1p-50 * glm::length(glm::dvec3(camera.up))))
    throw InputError("camera: 'up' must not be zero nor parallel to the view");
  frame.right = side / length;
  frame.up = glm::cross(frame.right, frame.forward);
  // A picture of one row has no outermost rows to span: its row passes through the axis and a pixel is as large as if
  // there were two.
  frame.pixel = 2.0 * std::tan(0.5 * static_cast<double>(camera.angle_radians)) / std::max(camera.height - 1, 1);
  frame.centre_x = 0.5 * (camera.width - 1);
  frame.centre_y = 0.5 * (camera.height - 1);
  return frame;
}

Ray camera_ray(const CameraFrame& frame, double x, double y) {
  const glm::dvec3 direction =
      frame.forward + frame.pixel * (x - frame.centre_x) * frame.right + frame.pixel * (frame.centre_y - y) * frame.up;
  return {glm::vec3(frame.from), glm::vec3(glm::normalize(direction))};
}

Ray camera_ray(const Camera& camera, double x, double y) { return camera_ray(camera_frame(camera), x, y); }

double focus_distance(const Camera& camera) {
  return camera.focus > 0.0f ? static_cast<double>(camera.focus)
                             : glm::length(glm::dvec3(camera.at) - glm::dvec3(camera.from));
}

Light default_light(const Camera& camera) {
  const CameraFrame frame = camera_frame(camera);
  const double distance = glm::length(glm::dvec3(camera.at) - frame.from);
  Light light;
  light.position = glm::vec3(frame.from + 0.5 * distance * (frame.right + frame.up));
  return light;
}

}  // namespace plumbline
