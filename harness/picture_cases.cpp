// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `hits.picture.*`: what the camera sees, pixel by pixel, with a verdict for each, as pictures to look at.
#include <cmath>

#include "harness/catalogue.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "reports/picture.h"
#include "scenes/camera.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr int kWidth = 384;  ///< pixels; the height follows the camera

/// |cosine| between ray and normal, so that the shape is seen.
template <class AnyHit>
std::vector<float> brightness_of(std::span<const Ray> rays, const std::vector<AnyHit>& hits) {
  std::vector<float> brightness(rays.size(), 0.0f);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (hits[i].kind == HitKind::hit)
      brightness[i] = std::abs(glm::dot(glm::normalize(rays[i].direction), glm::normalize(glm::vec3(hits[i].normal))));
  return brightness;
}

/// A number that tells what was hit from its neighbours, the same primitive in another instance too; kNone for a miss.
template <class AnyHit>
std::uint32_t number_of(const AnyHit& hit) {
  if (hit.kind != HitKind::hit) return kNone;
  if (hit.instance == kNone) return hit.primitive;
  return static_cast<std::uint32_t>(mix64(std::uint64_t{hit.instance} << 32 | hit.primitive) % kNone);
}

}  // namespace

Case picture_case(const ListedScene& scene) {
  Case c = scene_case("hits.picture." + scene.name, "hits", scene, "4",
                      "Every pixel of the camera's view hits what exact arithmetic says.");
  c.family = "picture";
  c.run = [](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    Camera camera = stage.scene.camera;
    const int height = std::clamp(kWidth * camera.height / std::max(1, camera.width), 16, 4 * kWidth);
    camera.width = kWidth, camera.height = height;
    const CameraFrame frame = camera_frame(camera);
    std::vector<Ray> rays;
    rays.reserve(static_cast<std::size_t>(kWidth) * height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < kWidth; ++x) rays.push_back(camera_ray(frame, x, y));

    TraceBuffers buffers;
    buffers.tracer.resize(rays.size()), buffers.reference.resize(rays.size());
    Probe& probe = context.session.probe(stage);
    probe.trace(rays, buffers.tracer);
    record.trace_seconds = probe.draw_seconds();
    stage.embree.intersect(rays, buffers.reference);
    const std::uint64_t seed = case_seed(context.seed, self.name);
    Tally tally;
    std::vector<Verdict> judged(rays.size());
    judge_batch(stage.judge, rays, buffers.tracer, buffers.reference, 0, seed, 1024, tally, judged);
    explain_failing(context, examined_of(stage), self.name, "./plumbline explain " + quoted(self.spec), tally);
    record_tally(tally, self.spec, record);
    conclude(tally, rays.size(), record);

    std::vector<std::uint32_t> primitives(rays.size());
    std::vector<float> steps(rays.size()), tests(rays.size());
    std::vector<std::uint8_t> verdicts(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit& h = buffers.tracer[i];
      primitives[i] = number_of(h);
      steps[i] = static_cast<float>(h.steps), tests[i] = static_cast<float>(h.primitive_tests);
      verdicts[i] = static_cast<std::uint8_t>(judged[i]);
    }
    std::vector<std::string> names;
    for (const Verdict v : kVerdicts) names.emplace_back(verdict_name(v));
    const std::vector<float> brightness = brightness_of(rays, buffers.tracer);
    const auto add = [&](const Picture& picture, const char* stem, const char* title, const char* caption) {
      record.pictures.push_back(save_picture(picture, context.out, self.name + "." + stem, title, caption));
    };
    add(paint_primitives(primitives, brightness, kWidth, height), "hits", "Hit map",
        "A colour for each primitive of each instance hit by the production tracer, darker where the ray grazes it.");
    for (std::size_t i = 0; i < rays.size(); ++i) primitives[i] = number_of(buffers.reference[i]);
    add(paint_primitives(primitives, brightness_of(rays, buffers.reference), kWidth, height), "reference",
        "Hit map of the reference", "The same by Embree: flip between the two.");
    add(paint_values(steps, kWidth, height, "cells"), "steps", "Steps per pixel",
        "Cells of the geometry image that the ray visited.");
    add(paint_values(tests, kWidth, height, "tests"), "tests", "Primitive tests per pixel",
        "Primitives that the ray was tested against.");
    add(paint_verdicts(verdicts, names, brightness, kWidth, height), "verdicts", "Verdicts",
        "Where the two tracers disagreed, and who was right; grey where they agree. Marks are enlarged.");
  };
  return c;
}

}  // namespace plumbline
