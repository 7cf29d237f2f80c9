// SPDX-License-Identifier: MIT
#include "scenes/ray_sampler.h"

#include <algorithm>
#include <cmath>

#include "scenes/ulp.h"

namespace plumbline {

double primitive_area(const Scene& scene, std::uint32_t primitive) {
  if (!scene.is_triangle(primitive)) {
    const double radius = scene.sphere(primitive).radius;
    return 4.0 * 3.141592653589793 * radius * radius;
  }
  const auto corner = scene.corners(primitive);
  const glm::dvec3 a(corner[0]);
  return 0.5 * glm::length(glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a));
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : otherwise;
}

glm::dvec3 triangle_normal(const Scene& scene, std::uint32_t triangle) {
  const auto corner = scene.corners(triangle);
  const glm::dvec3 a(corner[0]);
  return unit_or(glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a), glm::dvec3(0.0));
}

int RaySampler::octave(int most) {
  return std::clamp(static_cast<int>(std::exp2(random_.uniform(0.0, std::log2(most + 1.0)))), 1, most);
}

std::uint32_t RaySampler::primitive() {
  const std::vector<double>& sum = source_.area_sum;
  if (coin() && sum.back() > 0.0) {
    const auto found = std::upper_bound(sum.begin(), sum.end(), random_.uniform() * sum.back());
    return static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found - sum.begin(), std::ssize(sum) - 1));
  }
  return random_.below(scene().primitive_count());
}

SurfacePoint RaySampler::surface_point() { return surface_point(primitive()); }

SurfacePoint RaySampler::surface_point(std::uint32_t primitive) {
  SurfacePoint point;
  point.primitive = primitive;
  if (scene().is_triangle(primitive)) {
    const auto corner = scene().corners(primitive);
    double u = random_.uniform(), v = random_.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const glm::dvec3 a(corner[0]);
    point.position = a + u * (glm::dvec3(corner[1]) - a) + v * (glm::dvec3(corner[2]) - a);
    point.normal = triangle_normal(scene(), primitive);
  } else {
    const Sphere& sphere = scene().sphere(primitive);
    point.normal = random_.direction();
    point.position = glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * point.normal;
  }
  return point;
}

glm::dvec3 RaySampler::point_in_ball(double scale) {
  const double distance = radius() * scale * std::cbrt(random_.uniform());
  return source_.ball.center + distance * random_.direction();
}

glm::dvec3 RaySampler::across(const glm::dvec3& axis) {
  const glm::dvec3 any = random_.direction();
  const glm::dvec3 size = glm::abs(axis);
  const glm::dvec3 fallback = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                              : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                   : glm::dvec3(0, 0, 1);
  return unit_or(glm::cross(axis, any), unit_or(glm::cross(axis, fallback), glm::dvec3(1, 0, 0)));
}

glm::vec3 RaySampler::eye() {
  if (random_.below(4) == 0) return glm::vec3(point_in_ball());
  return glm::vec3(source_.ball.center + radius() * random_.uniform(1.0, 3.0) * random_.direction());
}

Ray RaySampler::ray_to(const glm::vec3& origin, const glm::dvec3& target) {
  glm::dvec3 direction = target - glm::dvec3(origin);
  switch (random_.below(4)) {
    case 0:
      direction = unit_or(direction, direction);
      break;
    case 1:
      direction *= std::exp2(static_cast<int>(random_.below(21)) - 10);
      break;
    default:
      break;
  }
  return {origin, glm::vec3(direction)};
}

Ray RaySampler::aim(const glm::dvec3& target) {
  switch (random_.below(4)) {
    case 0: {
      const auto axis = static_cast<glm::length_t>(random_.below(3));
      Ray ray;
      ray.origin = glm::vec3(target);
      const float towards = sign();
      ray.origin[axis] =
          static_cast<float>(target[axis] - static_cast<double>(towards) * radius() * random_.uniform(0.1, 3.0));
      ray.direction = glm::vec3(0.0f);
      ray.direction[axis] = towards;
      return ray;
    }
    case 1: {
      const double step = std::exp2(std::ceil(std::log2(std::max(radius(), 0x1p-100))) - 6.0);
      const glm::dvec3 on_grid = glm::round(glm::dvec3(eye()) / step) * step;
      return {glm::vec3(on_grid), glm::vec3(target - glm::dvec3(glm::vec3(on_grid)))};
    }
    default:
      return ray_to(eye(), target);
  }
}

}  // namespace plumbline
