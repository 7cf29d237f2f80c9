// SPDX-License-Identifier: GPL-3.0-or-later
// Camera, light, reflection and refraction. Formulas are in double; a ray is rounded to floats once, when it is traced.
#include "reference/path_steps.h"

#include <algorithm>
#include <cmath>

#include "reference/perturbation.h"

namespace plumbline {

namespace {

constexpr std::uint32_t kPixelDimension = 0, kLensDimension = 2, kNormalDimension = 5, kLightDimension = 8;

Ray rounded(const glm::dvec3& origin, const glm::dvec3& direction) { return {glm::vec3(origin), glm::vec3(direction)}; }

/// `direction` mirrored at the plane of `normal` where it points away from that side.
bool turn_towards(const glm::dvec3& normal, glm::dvec3& direction) {
  const double across = glm::dot(direction, normal);
  if (!(across < 0.0)) return false;
  direction -= 2.0 * across * normal;
  return true;
}

glm::dvec3 three(const SampleNumbers& n, std::uint32_t ray, std::uint32_t dimension) {
  std::array<double, 3> u;
  Draw draw = n.sample;
  draw.ray = ray;
  draw.dimension = dimension;
  n.numbers.fill(draw, u);
  return {u[0], u[1], u[2]};
}

bool is_physical(const SampleNumbers& n) { return n.prepared.effects.model == Effects::Model::physical; }

/// A perturbation of lights and normals.
glm::dvec3 in_body(const SampleNumbers& n, std::uint32_t ray, std::uint32_t dimension) {
  const glm::dvec3 u = three(n, ray, dimension);
  return is_physical(n) ? in_ball(u) : in_cube(u);
}

/// The ray of a hit that starts on this side of its surface; `which` is 0 for the reflected one, 1 for the other.
PathRay next(const Surface& surface, const PathRay& path, std::uint32_t which, const glm::dvec3& direction,
             const glm::dvec3& side) {
  return {surface.position + surface.offset * side, glm::normalize(direction), 2 * path.number + which,
          path.bounce + 1};
}

}  // namespace

Ray rounded(const PathRay& ray) { return rounded(ray.origin, ray.direction); }

PathRay primary_ray(const SampleNumbers& n) {
  const CameraFrame& camera = n.prepared.camera;
  std::array<double, 2> place{0.5, 0.5};
  if (n.prepared.effects.antialias) {
    Draw draw = n.sample;
    draw.dimension = kPixelDimension;
    n.numbers.fill(draw, place);
  }
  const glm::dvec3 through = camera.forward +
                             camera.pixel * (n.sample.x - 0.5 + place[0] - camera.centre_x) * camera.right +
                             camera.pixel * (camera.centre_y - (n.sample.y - 0.5 + place[1])) * camera.up;
  const double aperture = n.prepared.aperture;
  if (!(n.prepared.effects.depth_of_field && aperture > 0.0)) return {camera.from, glm::normalize(through)};
  const glm::dvec3 u = three(n, 1, kLensDimension);
  const glm::dvec3 p = is_physical(n) ? on_disc(u) : in_cube(u);
  const glm::dvec3 eye = aperture * (p.x * camera.right + p.y * camera.up + p.z * camera.forward);
  return {camera.from + eye, glm::normalize(n.prepared.focus * through - eye)};
}

glm::dvec3 light_place(const SampleNumbers& n, std::uint32_t ray, std::uint32_t k) {
  const Light& light = n.prepared.scene->lights[k];
  const glm::dvec3 place(light.position);
  if (!(n.prepared.effects.soft_shadows && light.radius > 0.0f)) return place;
  return place + static_cast<double>(light.radius) * in_body(n, ray, kLightDimension + 3 * k);
}

LightOutcome faces_light(const Surface& surface, const glm::dvec3& place) {
  const glm::dvec3 way = place - surface.position;
  if (way == glm::dvec3(0.0)) return LightOutcome::at_light;
  if (!(glm::dot(surface.facing, way) > 0.0)) return LightOutcome::below;
  if (!(glm::dot(surface.shading, way) > 0.0)) return LightOutcome::averted;
  return LightOutcome::lit;
}

Ray shadow_ray(const Surface& surface, const glm::dvec3& place) {
  const glm::dvec3 start = surface.position + surface.offset * surface.facing;
  Ray ray = rounded(start, place - start);
  ray.t_max = 1.0f;
  return ray;
}

glm::dvec3 brightness_of(const Scene& scene, const Light& light) {
  if (light.has_color) return glm::dvec3(light.color);
  const auto count = static_cast<double>(scene.lights.size());
  return glm::dvec3(std::sqrt(count) / (2.0 * count));
}

glm::dvec3 shine(const Surface& surface, const glm::dvec3& place, const glm::dvec3& direction) {
  const Material& material = *surface.material;
  const glm::dvec3 to_light = glm::normalize(place - surface.position);
  glm::dvec3 sum = static_cast<double>(material.diffuse) * surface.color * glm::dot(surface.shading, to_light);
  if (material.specular == 0.0f) return sum;
  const glm::dvec3 half = to_light - direction;
  const double length = glm::length(half), cosine = glm::dot(surface.shading, half) / length;
  if (cosine > 0.0)  // false for light from straight behind, where `half` is zero
    sum +=
        static_cast<double>(material.specular) * std::pow(cosine, static_cast<double>(std::max(material.shine, 0.0f)));
  return sum;
}

glm::dvec3 normal_perturbation(const SampleNumbers& n, const Surface& surface, std::uint32_t ray) {
  const float own = surface.material->glossy;
  const auto glossy = static_cast<double>(own >= 0.0f ? own : n.prepared.effects.glossy);
  if (!(n.prepared.effects.glossy_reflections && glossy > 0.0)) return glm::dvec3(0.0);
  return glossy * in_body(n, ray, kNormalDimension);
}

PathRay reflected_ray(const SampleNumbers& n, const Surface& surface, const PathRay& path, RayEvent* event) {
  const glm::dvec3 perturbation = normal_perturbation(n, surface, path.number);
  glm::dvec3 normal = surface.shading;
  if (perturbation != glm::dvec3(0.0)) {
    const glm::dvec3 sum = normal + perturbation;
    const double length = glm::length(sum);
    if (length > 0.0) normal = sum / length;
  }
  glm::dvec3 direction = path.direction - 2.0 * glm::dot(path.direction, normal) * normal;
  const bool turned = turn_towards(surface.facing, direction);
  if (event != nullptr) event->reflected_above = !turned;
  return next(surface, path, 0, direction, surface.facing);
}

PathRay refracted_ray(const Surface& surface, const PathRay& path, RayEvent* event) {
  const glm::dvec3 &d = path.direction, &n = surface.shading;
  const double index =
      surface.material->refraction_index > 0.0f ? static_cast<double>(surface.material->refraction_index) : 1.0;
  const double eta = glm::dot(d, surface.outside) <= 0.0 ? 1.0 / index : index;
  const double c = -glm::dot(d, n), k = 1.0 - eta * eta * (1.0 - c * c);
  const bool total = k < 0.0;
  const glm::dvec3 side = total ? surface.facing : -surface.facing;
  glm::dvec3 direction = total ? d + 2.0 * c * n : eta * d + (eta * c - std::sqrt(k)) * n;
  const bool turned = turn_towards(side, direction);
  if (event != nullptr) event->totally_reflected = total, event->refracted_below = !turned;
  return next(surface, path, 1, direction, side);
}

}  // namespace plumbline
