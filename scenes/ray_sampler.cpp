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

RaySampler::RaySampler(const RaySource& source, std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
    : source_(source), index_(index), random_(seed, stream, index), place_(&source.placed.front()), ball_(source.ball) {
  if (!has_instances()) return;
  place_ = &source.placed[any_place()];
  if (coin() && place_->ball.radius > 0.0) ball_ = place_->ball;
}

std::uint32_t RaySampler::any_place() {
  const std::vector<double>& sum = source_.placed_area_sum;
  if (coin() && sum.back() > 0.0) {
    const auto found = std::upper_bound(sum.begin(), sum.end(), random_.uniform() * sum.back());
    return static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found - sum.begin(), std::ssize(sum) - 1));
  }
  return random_.below(static_cast<std::uint32_t>(sum.size()));
}

void RaySampler::go_elsewhere() {
  const auto count = static_cast<std::uint32_t>(source_.placed.size());
  if (count < 2) return;
  const auto here = static_cast<std::uint32_t>(place_ - source_.placed.data());
  std::uint32_t there = any_place();
  if (there == here) there = (here + 1 + random_.below(count - 1)) % count;
  place_ = &source_.placed[there];
}

glm::dvec3 RaySampler::out(const glm::dvec3& point) const {
  return place_->instance == kNone ? point : transform_point(place_->to_world, point);
}
glm::dvec3 RaySampler::in(const glm::dvec3& point) const {
  return place_->instance == kNone ? point : transform_point(place_->to_local, point);
}
glm::dvec3 RaySampler::vector_out(const glm::dvec3& vector) const {
  return place_->instance == kNone ? vector : transform_vector(place_->to_world, vector);
}
glm::dvec3 RaySampler::vector_in(const glm::dvec3& vector) const {
  return place_->instance == kNone ? vector : transform_vector(place_->to_local, vector);
}
glm::dvec3 RaySampler::normal_out(const glm::dvec3& normal) const {
  return place_->instance == kNone ? normal : unit_or(normal * place_->to_local.linear, glm::dvec3(0.0));
}

std::array<glm::dvec3, 3> RaySampler::corners(std::uint32_t triangle) const {
  const auto corner = scene().corners(triangle);
  return {out(glm::dvec3(corner[0])), out(glm::dvec3(corner[1])), out(glm::dvec3(corner[2]))};
}

glm::dvec3 RaySampler::triangle_normal(std::uint32_t triangle) const {
  const auto corner = scene().corners(triangle);
  const glm::dvec3 a(corner[0]);
  return normal_out(unit_or(glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a), glm::dvec3(0.0)));
}

int RaySampler::octave(int most) {
  return std::clamp(static_cast<int>(std::exp2(random_.uniform(0.0, std::log2(most + 1.0)))), 1, most);
}

std::uint32_t RaySampler::primitive() {
  const std::vector<double>& sum = source_.area_sum;
  const auto triangle_total = static_cast<std::uint32_t>(scene().triangles.size());
  const std::uint32_t first[2] = {place_->first_triangle, triangle_total + place_->first_sphere};
  const std::uint32_t count[2] = {place_->triangle_count, place_->sphere_count};
  // The area before a range, and up to its end.
  const auto before = [&](int kind) { return first[kind] > 0 && count[kind] > 0 ? sum[first[kind] - 1] : 0.0; };
  const auto within = [&](int kind) {
    return count[kind] > 0 ? sum[first[kind] + count[kind] - 1] - before(kind) : 0.0;
  };
  if (coin()) {
    // In a scene without parts both ranges are one: its sums are taken as they are, for the same choice always.
    const bool is_whole = scene().parts.empty();
    const double area = is_whole ? sum.back() : within(0) + within(1);
    if (area > 0.0) {
      double at = random_.uniform() * area;
      auto begin = sum.begin(), end = sum.end();
      if (!is_whole) {
        const int kind = at < within(0) || count[1] == 0 ? 0 : 1;
        at += before(kind) - (kind == 1 ? within(0) : 0.0);
        begin += first[kind];
        end = begin + count[kind];
      }
      const auto found = std::upper_bound(begin, end, at);
      return static_cast<std::uint32_t>(std::min(found, end - 1) - sum.begin());
    }
  }
  const std::uint32_t any = random_.below(count[0] + count[1]);
  return any < count[0] ? first[0] + any : first[1] + (any - count[0]);
}

SurfacePoint RaySampler::surface_point() { return surface_point(primitive()); }

SurfacePoint RaySampler::surface_point(std::uint32_t primitive) {
  SurfacePoint point;
  point.primitive = primitive;
  if (scene().is_triangle(primitive)) {
    const auto corner = corners(primitive);
    double u = random_.uniform(), v = random_.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const glm::dvec3& a = corner[0];
    point.position = a + u * (corner[1] - a) + v * (corner[2] - a);
    point.normal = triangle_normal(primitive);
  } else {
    const Sphere& sphere = scene().sphere(primitive);
    const glm::dvec3 direction = random_.direction();
    point.normal = normal_out(direction);
    point.position = out(glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * direction);
  }
  return point;
}

glm::dvec3 RaySampler::point_in_ball(double scale) {
  const double distance = radius() * scale * std::cbrt(random_.uniform());
  return ball_.center + distance * random_.direction();
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
  return glm::vec3(ball_.center + radius() * random_.uniform(1.0, 3.0) * random_.direction());
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
