// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/independent.h"

#include <algorithm>
#include <cmath>

#include "harness/picture_changes.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

/// Places everything of a scene without transforms by one node that moves by `way` while the shutter is open.
void move_world(Scene& scene, const glm::dvec3& way) {
  if (!scene.nodes.empty() || !scene.animation.empty()) return;
  scene.parts.push_back({.name = "world",
                         .triangle_count = static_cast<std::uint32_t>(scene.triangles.size()),
                         .sphere_count = static_cast<std::uint32_t>(scene.spheres.size())});
  scene.nodes.push_back({.name = "world", .part = 0, .transform = {}, .rest = {}});
  Animation animation;
  animation.node = 0;
  animation.translation = {{0.0, glm::dvec3(0.0)}, {1.0, way}};
  scene.animation.push_back(animation);
}

/// What rounding of places does to pixels. A float engine's rays and hits are off by up to 4 u t + 8 u E (u = 2^-24; the
/// direction's roundings at distance t, a hit's at coordinates E; SEMANTICS 6.5), together 12 u of the greater one at
/// most, 2^-20 of it: what a slope of the picture (a texture's edge, a highlight, a curved mirror) makes of that is
/// told by the truth itself, with the same random numbers, from cameras that are moved so far along each axis.
std::vector<glm::dvec3> shifts_of_places(const Scene& scene, const MakePictureEngine& truth,
                                         const PictureSettings& settings) {
  constexpr std::uint32_t kFrames = 16;
  const PictureMoments still = truth(scene, settings)->render(0, kFrames);
  const Ball ball = bounding_ball(scene);
  const double reach = glm::length(ball.center) + ball.radius + glm::length(glm::dvec3(scene.camera.from));
  std::vector<glm::dvec3> shifts(still.mean.size(), glm::dvec3(0.0));
  for (int axis = 0; axis < 3; ++axis) {
    Scene moved = scene;
    const auto step = static_cast<float>(0x1p-20 * reach);
    moved.camera.from[axis] += step, moved.camera.at[axis] += step;
    const PictureMoments picture = truth(moved, settings)->render(0, kFrames);
    for (std::size_t i = 0; i < shifts.size(); ++i) shifts[i] += glm::abs(picture.mean[i] - still.mean[i]);
  }
  return shifts;
}

}  // namespace

const std::vector<std::string>& effect_names() {
  static const std::vector<std::string> names{"aa", "soft_shadow", "dof", "glossy", "motion_blur"};
  return names;
}

Effects effects_of(const Scene& scene, const std::vector<std::string>& names, Effects::Model model) {
  Effects effects = scene.effects;
  effects.model = model;
  effects.antialias = effects.soft_shadows = effects.depth_of_field = false;
  effects.motion_blur = effects.glossy_reflections = false;
  for (const std::string& name : names) {
    if (name == "aa") {
      effects.antialias = true;
    } else if (name == "soft_shadow") {
      effects.soft_shadows = true;
    } else if (name == "dof") {
      effects.depth_of_field = true;
    } else if (name == "glossy") {
      effects.glossy_reflections = true;
    } else if (name == "motion_blur") {
      effects.motion_blur = true;
    } else {
      throw InputError("there is no effect '" + name + "'");
    }
  }
  return effects;
}

Scene with_effects(Scene scene) {
  Camera& camera = scene.camera;
  if (scene.lights.empty()) scene.lights.push_back(default_light(camera));
  for (Light& light : scene.lights)
    if (!(light.radius > 0.0f)) light.radius = 0.05f * glm::distance(light.position, camera.at);
  if (!(camera.aperture > 0.0f))
    camera.aperture = 0.01f * (camera.focus > 0.0f ? camera.focus : glm::distance(camera.from, camera.at));
  if (!(scene.effects.glossy > 0.0f)) scene.effects.glossy = 0.05f;
  if (scene.nodes.empty() && scene.animation.empty()) {
    const CameraFrame frame = camera_frame(camera);
    move_world(scene, 0.1 * bounding_ball(scene).radius * frame.right);
  }
  if (camera.shutter_open == camera.shutter_close) camera.shutter_close = camera.shutter_open + 1.0f;
  return scene;
}

Scene drt_scene(const std::string& spec) {
  if (spec != "mirrors") return with_effects(load_scene(spec));
  Scene scene = load_scene("sphereflake:3");
  for (Material& material : scene.materials) material.specular = 0.9f, material.diffuse = 0.3f;
  return with_effects(std::move(scene));
}

PictureComparison compare_engines(const Scene& scene, const Effects& effects, const Depth& depth, std::uint64_t seed,
                                  const MakePictureEngine& tested, const MakePictureEngine& truth,
                                  const std::function<void(double)>& progress) {
  PictureSettings settings{depth.width, depth.height, effects, 0, 0.0};
  const auto seeded = [&](const char* purpose) {
    PictureSettings own = settings;
    own.seed = mix64(seed ^ name_hash(purpose));
    return own;
  };
  const auto part = [&](double from, double to) {
    return [&progress, from, to](double share) {
      if (progress) progress(from + share * (to - from));
    };
  };
  CompareOptions options;
  options.pixels_independent = depth.pixels_independent;
  options.most_flips = depth.most_flips;
  options.seed = mix64(seed ^ name_hash("signs"));
  const std::vector<PictureChange> changes = small_changes(scene, effects);
  const auto share = static_cast<std::uint32_t>(depth.batches * depth.frames / (changes.size() + 1));
  options.directions = directions_of(changes, scene, seeded("directions"), share);
  part(0.0, 0.2)(1.0);
  const auto of_tested = take_batches(*tested(scene, seeded("tested")), depth.batches, depth.frames, part(0.2, 0.6));
  const auto of_truth = take_batches(*truth(scene, seeded("truth")), depth.batches, depth.frames, part(0.6, 0.95));
  for (std::size_t i = 0; i < of_truth.front().mean.size(); ++i) {
    glm::dvec3 size(0.0);
    for (const PictureMoments& batch : of_truth) size += glm::abs(batch.mean[i]) / static_cast<double>(depth.batches);
    options.rounding.push_back(depth.rounding * size);
  }
  const std::vector<glm::dvec3> of_places = shifts_of_places(scene, truth, seeded("places"));
  for (std::size_t i = 0; i < of_places.size(); ++i) options.rounding[i] += of_places[i];
  return compare_pictures(of_tested, of_truth, options);
}

}  // namespace plumbline
