// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/paired_picture.h"

#include "reference/surface.h"
#include "scenes/camera.h"
#include "tracer/random_numbers.h"

namespace plumbline {

const char* name_of(PairedEffects effects) {
  static constexpr std::array<const char*, kPairedEffects.size()> kNames{"shading", "aa",          "dof", "soft_shadow",
                                                                         "glossy",  "motion_blur", "all"};
  return kNames[static_cast<std::size_t>(effects)];
}

Scene with_effects(const Stage& stage, PairedEffects wanted, Effects::Model model) {
  Scene scene = stage.scene;
  const auto has = [&](PairedEffects effect) { return wanted == effect || wanted == PairedEffects::all; };
  Effects& effects = scene.effects;
  effects.model = model;
  effects.antialias = has(PairedEffects::aa);
  effects.depth_of_field = has(PairedEffects::dof);
  effects.soft_shadows = has(PairedEffects::soft_shadow);
  effects.glossy_reflections = has(PairedEffects::glossy);
  effects.motion_blur = has(PairedEffects::motion_blur);
  if (!effects.motion_blur) scene.animation = {};
  if (scene.lights.empty()) scene.lights.push_back(default_light(scene.camera));
  if (scene.camera.aperture == 0.0f) scene.camera.aperture = static_cast<float>(0.01 * focus_distance(scene.camera));
  for (Light& light : scene.lights)
    if (light.radius == 0.0f) light.radius = static_cast<float>(0.05 * stage.rays.ball.radius);
  if (effects.glossy == 0.0f) effects.glossy = 0.05f;
  return scene;
}

void compare_picture(Session& session, const std::string& spec, const Scene& scene, const PairedSettings& settings,
                     PairedTally& tally) {
  RenderSettings asked;
  asked.width = settings.width, asked.height = settings.height;
  asked.frames = settings.frames;
  asked.seed = settings.seed;
  asked.random = settings.random;
  asked.bake.layout = settings.layout;
  asked.patches = settings.patches;
  Renderer renderer(settings.context != nullptr ? *settings.context : session.context(), scene, asked);
  Scene seen = scene;
  seen.camera.width = settings.width, seen.camera.height = settings.height;
  const auto compare = [&](const Stage& stage, std::uint32_t first, std::uint32_t frames) {
    SampleTap tap;
    renderer.set_tap(&tap);
    renderer.add_frames(first, frames);
    renderer.set_tap(nullptr);
    PreparedScene prepared;
    prepared.scene = &seen;
    prepared.hits = &stage.embree;
    prepared.views = instance_views(seen);
    prepared.camera = camera_frame(seen.camera);
    prepared.aperture = static_cast<double>(seen.camera.aperture);
    prepared.focus = focus_distance(seen.camera);
    prepared.effects = seen.effects;
    for (const TappedSamples& samples : tap.batches)
      compare_samples(session, stage, prepared, samples, settings.seed, tally);
  };
  const Camera& camera = seen.camera;
  if (seen.animation.empty() || camera.shutter_open == camera.shutter_close)
    return compare(session.stage(spec), 0, settings.frames);
  for (std::uint32_t frame = 0; frame < settings.frames; ++frame) {
    const auto open = static_cast<double>(camera.shutter_open), close = static_cast<double>(camera.shutter_close);
    const double time = open + frame_time_number(settings.seed, frame) * (close - open);
    set_time(seen, time);
    compare(session.stage(spec + " at " + std::to_string(time) + " s", seen), frame, 1);
  }
}

}  // namespace plumbline
