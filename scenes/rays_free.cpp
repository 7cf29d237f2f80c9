// SPDX-License-Identifier: MIT
// The ray families that start from an origin or a picture: camera, secondary, chords, axis, inside, on_surface, far,
// scaled, undefined.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scenes/ray_sampler.h"
#include "scenes/ulp.h"

namespace plumbline {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A number coprime to n near n / golden ratio: its multiples modulo n visit all of n, each far from those before.
std::uint64_t golden_stride(std::uint64_t n) {
  auto stride = static_cast<std::uint64_t>(0.6180339887498949 * static_cast<double>(n)) | 1u;
  while (std::gcd(stride, n) != 1) ++stride;
  return stride;
}

float denormal(RaySampler& s) { return s.sign() * std::bit_cast<float>(s.random().below((1u << 23) - 1) + 1); }

}  // namespace

Ray make_camera(RaySampler& s) {
  constexpr std::uint64_t kTile = 8;
  const auto width = static_cast<std::uint64_t>(s.source().width),
             height = static_cast<std::uint64_t>(s.source().height);
  const std::uint64_t columns = (width + kTile - 1) / kTile, tiles = columns * ((height + kTile - 1) / kTile);
  const std::uint64_t within = s.index() % (kTile * kTile);
  const std::uint64_t tile = (s.index() / (kTile * kTile)) % tiles * golden_stride(tiles) % tiles;
  // Tiles that reach over the border give their last row or column again, at other points of the pixel.
  const std::uint64_t x = std::min(tile % columns * kTile + within % kTile, width - 1);
  const std::uint64_t y = std::min(tile / columns * kTile + within / kTile, height - 1);
  const double dx = s.random().uniform(-0.5, 0.5), dy = s.random().uniform(-0.5, 0.5);
  return camera_ray(s.source().frame, static_cast<double>(x) + dx, static_cast<double>(y) + dy);
}

Ray make_secondary(RaySampler& s) {
  const std::vector<Ray>& captured = s.source().captured;
  if (captured.empty()) return make_on_surface(s);
  Ray ray = captured[s.index() % captured.size()];
  if (s.index() < captured.size()) return ray;
  for (int i = 0; i < 3; ++i) {
    ray.origin[i] = step_ulps(ray.origin[i], static_cast<int>(s.random().below(9)) - 4);
    ray.direction[i] = step_ulps(ray.direction[i], static_cast<int>(s.random().below(9)) - 4);
  }
  return ray;
}

Ray make_chord(RaySampler& s) {
  const Ball& ball = s.source().ball;
  const glm::vec3 origin(ball.center + ball.radius * s.random().direction());
  const glm::dvec3 end = ball.center + ball.radius * s.random().direction();
  return {origin, glm::vec3(end - glm::dvec3(origin))};
}

Ray make_axis(RaySampler& s) {
  glm::vec3 through(0.0f);
  const auto rounded = [&](const glm::vec3& local) {
    return s.place().instance == kNone ? local : glm::vec3(s.out(glm::dvec3(local)));
  };
  switch (s.random().below(3)) {
    case 0: {  // a vertex, or where a line parallel to an axis touches a sphere
      const std::uint32_t p = s.primitive();
      if (s.scene().is_triangle(p)) {
        through = rounded(s.scene().corners(p)[s.random().below(3)]);
      } else {
        through = s.scene().sphere(p).center;
        through[static_cast<glm::length_t>(s.random().below(3))] += s.sign() * s.scene().sphere(p).radius;
        through = rounded(through);
      }
      break;
    }
    case 1: {
      const std::uint32_t p = s.primitive();
      if (s.scene().is_triangle(p)) {
        const auto c = s.corners(p);
        through = glm::vec3((c[0] + c[1] + c[2]) / 3.0);
      } else {
        through = rounded(s.scene().sphere(p).center);
      }
      break;
    }
    default:
      through = glm::vec3(s.point_in_ball());
  }
  const auto axis = static_cast<glm::length_t>(s.random().below(3));
  Ray ray;
  ray.origin = through;
  for (int i = 0; i < 3; ++i) ray.direction[i] = s.coin() ? 0.0f : -0.0f;
  const float towards = s.sign();
  // From before the point, from the point itself, or from a plane through the origin of space.
  switch (s.random().below(4)) {
    case 0:
      break;
    case 1:
      ray.origin[axis] = s.coin() ? 0.0f : -0.0f;
      break;
    default:
      ray.origin[axis] =
          static_cast<float>(through[axis] - static_cast<double>(towards) * s.radius() * s.random().uniform(0.0, 3.0));
  }
  ray.direction[axis] =
      towards * (s.coin() ? 1.0f : static_cast<float>(std::exp2(static_cast<int>(s.random().below(41)) - 20)));
  return ray;
}

Ray make_inside(RaySampler& s) {
  const auto direction = glm::vec3(s.random().direction());
  switch (s.random().below(3)) {
    case 0:
      return {glm::vec3(s.point_in_ball()), direction};
    case 1:
      if (s.has_spheres()) {
        const Sphere& sphere = s.any_sphere();
        const double depth = std::cbrt(s.random().uniform()) * sphere.radius;
        return {glm::vec3(s.out(glm::dvec3(sphere.center) + depth * s.random().direction())), direction};
      }
      [[fallthrough]];
    default: {
      // Behind the surface by 2^-20 to 1 of the scene's radius.
      const SurfacePoint point = s.surface_point();
      const double depth = s.radius() * std::exp2(s.random().uniform(-20.0, 0.0));
      return {glm::vec3(point.position - depth * point.normal), direction};
    }
  }
}

Ray make_into_instances(RaySampler& s) {
  if (!s.has_instances()) return make_inside(s);
  // Behind the surface by 2^-10 to 1 of the place's own radius: in it, or through and out at the other side.
  const SurfacePoint start = s.surface_point();
  const double depth = s.place().ball.radius * std::exp2(s.random().uniform(-10.0, 0.0));
  const glm::vec3 origin(start.position - depth * start.normal);
  if (s.random().below(4) == 0) return {origin, glm::vec3(s.random().direction())};
  s.go_elsewhere();
  return s.ray_to(origin, s.surface_point().position);
}

Ray make_between_instances(RaySampler& s) {
  if (!s.has_instances()) return make_chord(s);
  const glm::dvec3 from = s.surface_point().position;
  const double before = s.coin() ? 0.0 : s.random().uniform(0.0, 2.0);
  s.go_elsewhere();
  const glm::dvec3 to = s.surface_point().position;
  const glm::vec3 origin(from - before * (to - from));
  // A segment that ends at the other instance, or a ray through it.
  if (s.random().below(4) == 0) return {origin, glm::vec3(to - glm::dvec3(origin)), 1.0f};
  return s.ray_to(origin, to);
}

Ray make_on_surface(RaySampler& s) {
  const SurfacePoint point = s.surface_point();
  Ray ray;
  ray.origin = glm::vec3(point.position);
  if (s.scene().is_triangle(point.primitive) && s.random().below(16) == 0) {
    ray.origin = glm::vec3(s.corners(point.primitive)[s.random().below(3)]);
  }
  const glm::dvec3 origin(ray.origin);
  glm::dvec3 direction(0.0);
  switch (s.random().below(4)) {
    case 0:  // diffuse, to either side
      direction = s.random().direction() + static_cast<double>(s.sign()) * point.normal;
      break;
    case 1: {  // the camera's ray mirrored
      const glm::dvec3 view = unit_or(origin - s.source().frame.from, s.random().direction());
      direction = view - 2.0 * glm::dot(view, point.normal) * point.normal;
      break;
    }
    case 2:
      if (!s.scene().lights.empty()) {  // a shadow ray ends at its light
        const auto& light = s.scene().lights[s.random().below(static_cast<std::uint32_t>(s.scene().lights.size()))];
        ray.direction = glm::vec3(glm::dvec3(light.position) - origin);
        ray.t_max = 1.0f;
        return ray;
      }
      [[fallthrough]];
    default:  // skimming the surface: 2^-24 to 1 off its plane
      direction = s.across(unit_or(point.normal, glm::dvec3(0, 0, 1))) +
                  static_cast<double>(s.sign()) * std::exp2(s.random().uniform(-24.0, 0.0)) * point.normal;
  }
  ray.direction = glm::vec3(unit_or(direction, s.random().direction()));
  return ray;
}

Ray make_far(RaySampler& s) {
  const double distance = s.radius() * std::pow(10.0, s.random().uniform(3.0, 6.0));
  const glm::vec3 origin(s.source().ball.center + distance * s.random().direction());
  const glm::dvec3 target = s.coin() ? s.surface_point().position : s.point_in_ball();
  return s.ray_to(origin, target);
}

Ray make_scaled(RaySampler& s) {
  glm::vec3 origin = s.eye();
  if (s.random().below(4) == 0) {
    for (int i = 0; i < 3; ++i) {
      if (s.coin()) origin[i] = denormal(s);
    }
  }
  const glm::dvec3 direction =
      unit_or((s.coin() ? s.surface_point().position : s.point_in_ball()) - glm::dvec3(origin), s.random().direction());
  Ray ray{origin, glm::vec3(direction * std::pow(10.0, s.random().uniform(-42.0, 37.0)))};
  if (s.random().below(8) == 0) ray.direction[static_cast<glm::length_t>(s.random().below(3))] = denormal(s);
  return ray;
}

Ray make_undefined(RaySampler& s) {
  Ray ray = make_chord(s);
  // The seven numbers of a ray in turn, each with every value that spoils it; then zero directions; then two at once.
  float* const place[7] = {&ray.origin.x,    &ray.origin.y,    &ray.origin.z, &ray.direction.x,
                           &ray.direction.y, &ray.direction.z, &ray.t_max};
  const float values[4] = {kNaN, -kNaN, kInfinity, -kInfinity};
  const std::uint64_t turn = s.index() % 37;
  if (turn < 24) {
    *place[turn / 4] = values[turn % 4];
  } else if (turn < 26) {
    ray.t_max = values[turn - 24];
  } else if (turn < 34) {
    for (int i = 0; i < 3; ++i) ray.direction[i] = ((turn - 26) >> i & 1u) != 0 ? -0.0f : 0.0f;
  } else if (turn < 36) {
    *place[s.random().below(7)] = values[s.random().below(2)];
    *place[s.random().below(6)] = values[s.random().below(4)];
  } else {
    for (float* const each : place) *each = values[s.random().below(2)];
  }
  return ray;
}

}  // namespace plumbline
