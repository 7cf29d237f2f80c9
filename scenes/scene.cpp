// SPDX-License-Identifier: MIT
#include "scenes/scene.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

namespace {

/// The ball around triangles [first, first + count) and around given balls, about the centre of their box.
Ball ball_around(const Scene& scene, std::uint32_t first, std::uint32_t count, const std::vector<Ball>& balls) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (count == 0 && balls.empty()) return {};
  glm::dvec3 lower(kInfinity), upper(-kInfinity);
  for (std::uint32_t t = first; t < first + count; ++t) {
    for (const glm::vec3& corner : scene.corners(t)) {
      lower = glm::min(lower, glm::dvec3(corner));
      upper = glm::max(upper, glm::dvec3(corner));
    }
  }
  for (const Ball& ball : balls) {
    lower = glm::min(lower, ball.center - glm::dvec3(ball.radius));
    upper = glm::max(upper, ball.center + glm::dvec3(ball.radius));
  }
  Ball ball;
  ball.center = 0.5 * (lower + upper);
  double squared = 0.0;
  for (std::uint32_t t = first; t < first + count; ++t) {
    for (const glm::vec3& corner : scene.corners(t)) {
      const glm::dvec3 offset = glm::dvec3(corner) - ball.center;
      squared = std::max(squared, glm::dot(offset, offset));
    }
  }
  double radius = std::sqrt(squared);
  for (const Ball& other : balls) radius = std::max(radius, glm::length(other.center - ball.center) + other.radius);
  // A distance costs a subtraction, three squares, two sums, a root and a sum: fewer than 8 roundings of 2^-53 each.
  ball.radius = radius * (1.0 + 8.0 * 0x1p-52);
  return ball;
}

void add_spheres(const Scene& scene, std::uint32_t first, std::uint32_t count, std::vector<Ball>& balls) {
  for (std::uint32_t i = first; i < first + count; ++i)
    balls.push_back({glm::dvec3(scene.spheres[i].center), scene.spheres[i].radius});
}

}  // namespace

Ball bounding_ball(const Scene& scene, const Part& part) {
  std::vector<Ball> balls;
  add_spheres(scene, part.first_sphere, part.sphere_count, balls);
  return ball_around(scene, part.first_triangle, part.triangle_count, balls);
}

Ball bounding_ball(const Scene& scene) {
  std::vector<Ball> balls;
  add_spheres(scene, 0, scene.world_sphere_count(), balls);
  std::vector<Ball> of_parts;
  for (const Part& part : scene.parts) of_parts.push_back(bounding_ball(scene, part));
  for (const std::uint32_t instance : instances_of(scene)) {
    const TransformD transform = to_world(scene, instance);
    const Ball& ball = of_parts[scene.nodes[instance].part];
    const glm::dvec3 center = transform_point(transform, ball.center);
    // Composing and transforming cost a few roundings for each level, relative to what is summed.
    const double rounding = 0x1p-45 * (glm::length(center) + glm::length(transform.translation) + ball.radius);
    balls.push_back({center, largest_stretch(transform.linear) * ball.radius * (1.0 + 0x1p-45) + rounding});
  }
  return ball_around(scene, 0, scene.world_triangle_count(), balls);
}

TransformD to_world(const Scene& scene, std::uint32_t instance) {
  if (instance == kNone) return {};
  TransformD transform = to_double(scene.nodes[instance].transform);
  for (std::uint32_t n = scene.nodes[instance].parent; n != kNone; n = scene.nodes[n].parent)
    transform = compose(to_double(scene.nodes[n].transform), transform);
  return transform;
}

std::vector<std::uint32_t> chain_of(const Scene& scene, std::uint32_t instance) {
  std::vector<std::uint32_t> chain;
  for (std::uint32_t n = instance; n != kNone; n = scene.nodes[n].parent) chain.push_back(n);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

std::vector<std::uint32_t> instances_of(const Scene& scene) {
  std::vector<std::uint32_t> instances;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
    if (scene.nodes[n].part != kNone) instances.push_back(n);
  return instances;
}

std::uint64_t placed_count(const Scene& scene) {
  std::uint64_t count = std::uint64_t{scene.world_triangle_count()} + scene.world_sphere_count();
  for (const Node& node : scene.nodes)
    if (node.part != kNone)
      count += std::uint64_t{scene.parts[node.part].triangle_count} + scene.parts[node.part].sphere_count;
  return count;
}

bool Scene::is_placed(std::uint32_t instance, std::uint32_t primitive) const {
  if (primitive >= primitive_count()) return false;
  const auto within = [](std::uint32_t i, std::uint32_t first, std::uint32_t count) {
    return i >= first && i - first < count;
  };
  if (instance == kNone)
    return is_triangle(primitive) ? primitive < world_triangle_count()
                                  : primitive - triangles.size() < world_sphere_count();
  if (instance >= nodes.size() || nodes[instance].part == kNone) return false;
  const Part& part = parts[nodes[instance].part];
  return is_triangle(primitive)
             ? within(primitive, part.first_triangle, part.triangle_count)
             : within(primitive - static_cast<std::uint32_t>(triangles.size()), part.first_sphere, part.sphere_count);
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
