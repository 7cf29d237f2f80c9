// SPDX-License-Identifier: GPL-3.0-or-later
// Tapping of rays, and the cases `hits.captured.*` that judge them.
#include "harness/captured_rays.h"

#include <algorithm>
#include <cmath>

#include "harness/catalogue.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "scenes/error.h"
#include "tracer/renderer.h"

namespace plumbline {
namespace {

/// A picture has a pixel for this many rays that are wanted, and at most so many frames.
constexpr std::size_t kRaysPerPixel = 8;
constexpr std::uint32_t kMostFrames = 8;
constexpr std::uint32_t kSampleOneIn = 1024;

class CapturingTap final : public RenderTap {
 public:
  CapturedRays captured;

  void rays(const TappedBatch&, std::uint32_t ray, std::uint32_t light, std::span<const Ray> rays,
            std::span<const Hit> hits) override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rays[i].direction == glm::vec3(0.0f)) continue;
      captured.rays.push_back(rays[i]);
      captured.hits.push_back(hits[i]);
      captured.is_shadow.push_back(light != kNone);
      captured.number.push_back(ray);
    }
  }
  void numbers(const TappedBatch&, std::uint32_t, std::uint32_t, std::span<const glm::vec4>) override {}
  void samples(const TappedBatch&, std::span<const glm::vec4>) override {}
};

/// `most` of the rays, at even distances.
CapturedRays thinned(CapturedRays all, std::size_t most) {
  all.traced = all.rays.size();
  if (all.rays.size() <= most) return all;
  CapturedRays some;
  some.traced = all.traced;
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t i = k * all.rays.size() / most;
    some.rays.push_back(all.rays[i]);
    some.hits.push_back(all.hits[i]);
    some.is_shadow.push_back(all.is_shadow[i]);
    some.number.push_back(all.number[i]);
  }
  return some;
}

/// Shadow rays whose walk, which ends at any hit, says otherwise than the walk for the nearest.
std::uint64_t wrong_shadows(const CapturedRays& captured, std::span<const Hit> nearest) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < captured.rays.size(); ++i)
    wrong += captured.is_shadow[i] && captured.hits[i].kind != nearest[i].kind;
  return wrong;
}

/// Other rays whose hit is not bit for bit what the probe answers.
std::uint64_t wrong_hits(const CapturedRays& captured, std::span<const Hit> nearest) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < captured.rays.size(); ++i)
    wrong += !captured.is_shadow[i] && !same_bits(captured.hits[i], nearest[i]);
  return wrong;
}

void run_captured(CaseContext& context, const Case& self, CaseRecord& record) {
  Stage& stage = context.session.stage(self.spec);
  if (is_skipped(stage, record)) return;
  const std::uint64_t seed = case_seed(context.seed, self.name);
  const CapturedRays captured = capture_rays(context.session.context(), stage.scene, seed, self.rays);
  context.progress(0.5);
  TraceBuffers buffers;
  Tally tally;
  trace_and_judge(stage.judge, context.session.probe(stage), stage.embree, captured.rays, 0, seed, buffers, tally);
  record.trace_seconds = buffers.trace_seconds;
  explain_failing(context, examined_of(stage), self.name, "./plumbline explain " + quoted(self.spec), tally);
  record_tally(tally, self.spec, record);
  conclude(tally, tally.rays(), record);

  const auto count = [&](auto holds) {
    double sum = 0.0;
    for (std::size_t i = 0; i < captured.rays.size(); ++i) sum += holds(i) ? 1.0 : 0.0;
    return sum;
  };
  const std::uint64_t shadows = wrong_shadows(captured, buffers.tracer), hits = wrong_hits(captured, buffers.tracer);
  const auto note = [&](const std::string& name, double value) { record.figures.push_back({name, "rays", value}); };
  note("rays of the picture", static_cast<double>(captured.traced));
  note("primary rays judged", count([&](std::size_t i) { return !captured.is_shadow[i] && captured.number[i] == 1; }));
  note("reflected and refracted rays judged",
       count([&](std::size_t i) { return !captured.is_shadow[i] && captured.number[i] > 1; }));
  note("shadow rays judged", count([&](std::size_t i) { return captured.is_shadow[i]; }));
  note("shadow rays, any hit against nearest hit", static_cast<double>(shadows));
  note("hits, renderer against probe", static_cast<double>(hits));
  const auto fail = [&](const std::string& text) {
    record.message = record.status == CaseStatus::failed ? record.message + "; " + text : text;
    record.status = CaseStatus::failed;
  };
  if (shadows > 0) fail(std::to_string(shadows) + " shadow rays are answered otherwise when any hit ends the walk");
  if (hits > 0) fail(std::to_string(hits) + " hits of the renderer are not bit for bit the probe's");
}

}  // namespace

CapturedRays capture_rays(GlContext& context, const Scene& scene, std::uint64_t seed, std::size_t most) {
  Scene still = scene;
  still.animation = {};
  Effects all = scene.effects;
  all.antialias = all.soft_shadows = all.depth_of_field = all.glossy_reflections = true;
  RenderSettings settings;
  const double pixels = static_cast<double>(std::max<std::size_t>(most / kRaysPerPixel, 64)),
               ratio = static_cast<double>(scene.camera.width) / std::max(1, scene.camera.height);
  settings.width = std::clamp(static_cast<int>(std::sqrt(pixels * ratio)), 4, 256);
  settings.height = std::clamp(static_cast<int>(std::sqrt(pixels / ratio)), 4, 256);
  settings.effects = all;
  settings.seed = seed;
  Renderer renderer(context, still, settings);
  CapturingTap tap;
  renderer.set_tap(&tap);
  for (std::uint32_t frame = 0; frame < kMostFrames && tap.captured.rays.size() < most; ++frame)
    renderer.add_frames(frame, 1);
  return thinned(std::move(tap.captured), most);
}

Case captured_case(const ListedScene& scene, std::uint64_t rays) {
  Case c = scene_case(
      "hits.captured." + scene.name, "hits", scene, "7",
      "The renderer's own rays, tapped from a picture with all effects, hit what exact arithmetic says; shadow rays, "
      "which end at any hit, are blocked just where there is a nearest one.");
  c.family = "captured";
  c.rays = rays;
  c.run = run_captured;
  return c;
}

}  // namespace plumbline
