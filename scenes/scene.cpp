// SPDX-License-Identifier: MIT
#include "scenes/scene.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

Ball bounding_ball(const Scene& scene) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lower(kInfinity), upper(-kInfinity);
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    for (const glm::vec3& corner : scene.corners(t)) {
      lower = glm::min(lower, glm::dvec3(corner));
      upper = glm::max(upper, glm::dvec3(corner));
    }
  }
  for (const Sphere& sphere : scene.spheres) {
    lower = glm::min(lower, glm::dvec3(sphere.center) - glm::dvec3(sphere.radius));
    upper = glm::max(upper, glm::dvec3(sphere.center) + glm::dvec3(sphere.radius));
  }
  if (scene.primitive_count() == 0) return {};

  Ball ball;
  ball.center = 0.5 * (lower + upper);
  double squared = 0.0;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    for (const glm::vec3& corner : scene.corners(t)) {
      const glm::dvec3 offset = glm::dvec3(corner) - ball.center;
      squared = std::max(squared, glm::dot(offset, offset));
    }
  }
  double radius = std::sqrt(squared);
  for (const Sphere& sphere : scene.spheres) {
    radius = std::max(radius, glm::length(glm::dvec3(sphere.center) - ball.center) + sphere.radius);
  }
  // A distance costs a subtraction, three squares, two sums, a root and a sum: fewer than 8 roundings of 2^-53 each.
  ball.radius = radius * (1.0 + 8.0 * 0x1p-52);
  return ball;
}

void frame_camera(Scene& scene) {
  const Ball ball = bounding_ball(scene);
  const double radius = ball.radius > 0.0 ? ball.radius : 1.0;
  const double angle = glm::radians(40.0);
  const glm::dvec3 towards_eye = glm::normalize(glm::dvec3(1.0, 0.6, 1.2));
  scene.camera = Camera{};
  scene.camera.angle_radians = static_cast<float>(angle);
  scene.camera.at = glm::vec3(ball.center);
  // The ball touches the cone of half that angle around the view.
  scene.camera.from = glm::vec3(ball.center + towards_eye * (radius / std::sin(0.5 * angle)));
}

}  // namespace plumbline
