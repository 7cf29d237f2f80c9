// SPDX-License-Identifier: GPL-3.0-or-later
// Camera, light, reflection and refraction of one sample. Formulas are in double; a ray is rounded to floats once, when
// it is traced.
#include "reference/sample.h"

#include <algorithm>
#include <cmath>

#include "reference/perturbation.h"

namespace plumbline {

namespace {

constexpr std::uint32_t kPixelDimension = 0, kLensDimension = 2, kNormalDimension = 5, kLightDimension = 8;

/// A ray of a sample: its direction in double, of unit length, beside what is traced.
struct Path {
  glm::dvec3 origin{0.0}, direction{0.0};
  std::uint32_t number = 1, bounce = 0;
};

Ray rounded(const glm::dvec3& origin, const glm::dvec3& direction) { return {glm::vec3(origin), glm::vec3(direction)}; }

/// `direction` mirrored at the plane of `normal` where it points away from that side.
bool turn_towards(const glm::dvec3& normal, glm::dvec3& direction) {
  const double across = glm::dot(direction, normal);
  if (!(across < 0.0)) return false;
  direction -= 2.0 * across * normal;
  return true;
}

class PathTracer {
 public:
  PathTracer(const PreparedScene& prepared, const RandomSource& numbers, const Draw& sample, SampleRecord* record)
      : prepared_(prepared), scene_(*prepared.scene), numbers_(numbers), sample_(sample), record_(record) {}

  /// The ray through the sample's place in its pixel (SEMANTICS 6.2).
  Path primary() const {
    const CameraFrame& camera = prepared_.camera;
    std::array<double, 2> place{0.5, 0.5};
    if (prepared_.effects.antialias) {
      Draw draw = sample_;
      draw.dimension = kPixelDimension;
      numbers_.fill(draw, place);
    }
    const glm::dvec3 through = camera.forward +
                               camera.pixel * (sample_.x - 0.5 + place[0] - camera.centre_x) * camera.right +
                               camera.pixel * (camera.centre_y - (sample_.y - 0.5 + place[1])) * camera.up;
    if (!(prepared_.effects.depth_of_field && prepared_.aperture > 0.0)) return {camera.from, glm::normalize(through)};
    const glm::dvec3 u = three(1, kLensDimension);
    const glm::dvec3 p = prepared_.effects.model == Effects::Model::physical ? on_disc(u) : in_cube(u);
    const glm::dvec3 eye = prepared_.aperture * (p.x * camera.right + p.y * camera.up + p.z * camera.forward);
    return {camera.from + eye, glm::normalize(prepared_.focus * through - eye)};
  }

  glm::dvec3 color(const Path& path) {
    const std::size_t event = note(path);
    const ReferenceHit hit = first_hit(prepared_, rounded(path.origin, path.direction));
    if (hit.kind != HitKind::hit) return glm::dvec3(scene_.background);
    const Surface surface = surface_at(scene_, prepared_.views, hit, path.direction);
    if (record_ != nullptr) {
      RayEvent& e = record_->rays[event];
      e.instance = hit.instance;
      e.primitive = hit.primitive;
      e.from_outside = glm::dot(path.direction, surface.outside) <= 0.0;
    }
    const Material& material = *surface.material;
    glm::dvec3 sum = lit(surface, path);
    if (path.bounce >= std::min(prepared_.effects.depth, 5u)) return sum;
    if (material.specular > 0.0f)
      sum += static_cast<double>(material.specular) * color(reflected(surface, path, event));
    if (material.transmittance > 0.0f)
      sum += static_cast<double>(material.transmittance) * color(refracted(surface, path, event));
    return sum;
  }

 private:
  glm::dvec3 three(std::uint32_t ray, std::uint32_t dimension) const {
    std::array<double, 3> u;
    Draw draw = sample_;
    draw.ray = ray;
    draw.dimension = dimension;
    numbers_.fill(draw, u);
    return {u[0], u[1], u[2]};
  }
  /// A perturbation of lights and normals.
  glm::dvec3 in_body(std::uint32_t ray, std::uint32_t dimension) const {
    const glm::dvec3 u = three(ray, dimension);
    return prepared_.effects.model == Effects::Model::physical ? in_ball(u) : in_cube(u);
  }

  std::size_t note(const Path& path) {
    if (record_ == nullptr) return 0;
    record_->rays.emplace_back().ray = path.number;
    return record_->rays.size() - 1;
  }

  /// SEMANTICS 6.6.
  glm::dvec3 lit(const Surface& surface, const Path& path) {
    glm::dvec3 sum(0.0);
    for (std::uint32_t k = 0; k < scene_.lights.size(); ++k) {
      const Light& light = scene_.lights[k];
      glm::dvec3 place(light.position);
      if (prepared_.effects.soft_shadows && light.radius > 0.0f)
        place += static_cast<double>(light.radius) * in_body(path.number, kLightDimension + 3 * k);
      const LightOutcome outcome = reaches(surface, place);
      if (record_ != nullptr) record_->lights.push_back(outcome);
      if (outcome == LightOutcome::lit) sum += brightness(light) * shine(surface, place, path.direction);
    }
    return sum;
  }

  LightOutcome reaches(const Surface& surface, const glm::dvec3& light) const {
    const glm::dvec3 way = light - surface.position;
    if (way == glm::dvec3(0.0)) return LightOutcome::at_light;
    if (!(glm::dot(surface.facing, way) > 0.0)) return LightOutcome::below;
    if (!(glm::dot(surface.shading, way) > 0.0)) return LightOutcome::averted;
    const glm::dvec3 start = surface.position + surface.offset * surface.facing;
    Ray ray = rounded(start, light - start);
    ray.t_max = 1.0f;
    const bool blocked = prepared_.hits->is_blocked(ray) || ground_hit(scene_, ray);
    return blocked ? LightOutcome::shadowed : LightOutcome::lit;
  }

  glm::dvec3 brightness(const Light& light) const {
    if (light.has_color) return glm::dvec3(light.color);
    const auto count = static_cast<double>(scene_.lights.size());
    return glm::dvec3(std::sqrt(count) / (2.0 * count));
  }

  /// Diffuse term and highlight of a light that is seen, for brightness 1.
  static glm::dvec3 shine(const Surface& surface, const glm::dvec3& place, const glm::dvec3& direction) {
    const Material& material = *surface.material;
    const glm::dvec3 to_light = glm::normalize(place - surface.position);
    glm::dvec3 sum = static_cast<double>(material.diffuse) * surface.color * glm::dot(surface.shading, to_light);
    if (material.specular == 0.0f) return sum;
    const glm::dvec3 half = to_light - direction;
    const double length = glm::length(half), cosine = glm::dot(surface.shading, half) / length;
    if (cosine > 0.0)  // false for light from straight behind, where `half` is zero
      sum += static_cast<double>(material.specular) *
             std::pow(cosine, static_cast<double>(std::max(material.shine, 0.0f)));
    return sum;
  }

  /// SEMANTICS 6.7, point 1.
  Path reflected(const Surface& surface, const Path& path, std::size_t event) const {
    const float own = surface.material->glossy;
    const auto glossy = static_cast<double>(own >= 0.0f ? own : prepared_.effects.glossy);
    glm::dvec3 normal = surface.shading;
    if (prepared_.effects.glossy_reflections && glossy > 0.0) {
      const glm::dvec3 sum = normal + glossy * in_body(path.number, kNormalDimension);
      const double length = glm::length(sum);
      if (length > 0.0) normal = sum / length;
    }
    glm::dvec3 direction = path.direction - 2.0 * glm::dot(path.direction, normal) * normal;
    const bool turned = turn_towards(surface.facing, direction);
    if (record_ != nullptr) record_->rays[event].reflected_above = !turned;
    return next(surface, path, 0, direction, surface.facing);
  }

  /// SEMANTICS 6.7, points 2 and 3.
  Path refracted(const Surface& surface, const Path& path, std::size_t event) const {
    const glm::dvec3 &d = path.direction, &n = surface.shading;
    const double index =
        surface.material->refraction_index > 0.0f ? static_cast<double>(surface.material->refraction_index) : 1.0;
    const double eta = glm::dot(d, surface.outside) <= 0.0 ? 1.0 / index : index;
    const double c = -glm::dot(d, n), k = 1.0 - eta * eta * (1.0 - c * c);
    const bool total = k < 0.0;
    const glm::dvec3 side = total ? surface.facing : -surface.facing;
    glm::dvec3 direction = total ? d + 2.0 * c * n : eta * d + (eta * c - std::sqrt(k)) * n;
    const bool turned = turn_towards(side, direction);
    if (record_ != nullptr) {
      record_->rays[event].totally_reflected = total;
      record_->rays[event].refracted_below = !turned;
    }
    return next(surface, path, 1, direction, side);
  }

  /// The ray of a hit that starts on this side of its surface; `which` is 0 for the reflected one, 1 for the other.
  static Path next(const Surface& surface, const Path& path, std::uint32_t which, const glm::dvec3& direction,
                   const glm::dvec3& side) {
    return {surface.position + surface.offset * side, glm::normalize(direction), 2 * path.number + which,
            path.bounce + 1};
  }

  const PreparedScene& prepared_;
  const Scene& scene_;
  const RandomSource& numbers_;
  const Draw sample_;
  SampleRecord* const record_;
};

}  // namespace

ReferenceHit first_hit(const PreparedScene& prepared, const Ray& ray) {
  const ReferenceHit hit = prepared.hits->first_hit(ray);
  if (const auto ground = ground_hit(*prepared.scene, ray); ground && ground->t < hit.t) return *ground;
  return hit;
}

glm::dvec3 sample_color(const PreparedScene& prepared, const RandomSource& numbers, std::uint32_t x, std::uint32_t y,
                        std::uint32_t frame, SampleRecord* record) {
  if (record != nullptr) *record = {};
  PathTracer tracer(prepared, numbers, {x, y, frame, 1, 0}, record);
  return tracer.color(tracer.primary());
}

}  // namespace plumbline
