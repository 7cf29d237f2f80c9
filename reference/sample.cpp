// SPDX-License-Identifier: GPL-3.0-or-later
// One sample's tree of rays, strung together from the steps of path_steps.h.
#include "reference/sample.h"

#include <algorithm>

#include "reference/path_steps.h"

namespace plumbline {

namespace {

class PathTracer {
 public:
  PathTracer(const SampleNumbers& numbers, SampleRecord* record) : numbers_(numbers), record_(record) {}

  glm::dvec3 color(const PathRay& path) {
    const std::size_t event = note(path);
    const ReferenceHit hit = first_hit(prepared_, rounded(path));
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
      sum += static_cast<double>(material.specular) * color(reflected_ray(numbers_, surface, path, at(event)));
    if (material.transmittance > 0.0f)
      sum += static_cast<double>(material.transmittance) * color(refracted_ray(surface, path, at(event)));
    return sum;
  }

 private:
  std::size_t note(const PathRay& path) {
    if (record_ == nullptr) return 0;
    record_->rays.emplace_back().ray = path.number;
    return record_->rays.size() - 1;
  }
  RayEvent* at(std::size_t event) { return record_ == nullptr ? nullptr : &record_->rays[event]; }

  /// SEMANTICS 6.6.
  glm::dvec3 lit(const Surface& surface, const PathRay& path) {
    glm::dvec3 sum(0.0);
    for (std::uint32_t k = 0; k < scene_.lights.size(); ++k) {
      const glm::dvec3 place = light_place(numbers_, path.number, k);
      const LightOutcome outcome = reaches(surface, place);
      if (record_ != nullptr) record_->lights.push_back(outcome);
      if (outcome == LightOutcome::lit)
        sum += brightness_of(scene_, scene_.lights[k]) * shine(surface, place, path.direction);
    }
    return sum;
  }

  LightOutcome reaches(const Surface& surface, const glm::dvec3& place) const {
    const LightOutcome outcome = faces_light(surface, place);
    if (outcome != LightOutcome::lit) return outcome;
    const Ray ray = shadow_ray(surface, place);
    const bool blocked = prepared_.hits->is_blocked(ray) || ground_hit(scene_, ray);
    return blocked ? LightOutcome::shadowed : LightOutcome::lit;
  }

  const SampleNumbers numbers_;
  const PreparedScene& prepared_ = numbers_.prepared;
  const Scene& scene_ = *prepared_.scene;
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
  const SampleNumbers sample{prepared, numbers, {x, y, frame, 1, 0}};
  return PathTracer(sample, record).color(primary_ray(sample));
}

}  // namespace plumbline
