// SPDX-License-Identifier: GPL-3.0-or-later
// The paired comparison finds nothing where nothing is wrong, and every fault that is put into the shaders on purpose.
#include <array>
#include <catch2/catch.hpp>

#include "harness/paired_picture.h"
#include "harness/renderer_faults.h"
#include "scenes/scene.h"

namespace plumbline {
namespace {

Session& session() {
  static Session instance;
  return instance;
}

constexpr const char* kGlass = "glass in a mirror";

/// A ball and a box of glass within a hollow mirror, and the eye with them: every ray is reflected to the last bounce,
/// and passes into and out of glass, or cannot leave the box.
Scene glass_in_a_mirror() {
  Scene scene;
  scene.name = kGlass;
  Material mirror, glass;
  mirror.color = {0.6f, 0.4f, 0.3f};
  mirror.diffuse = 0.6f, mirror.specular = 0.4f, mirror.shine = 20.0f;
  glass.diffuse = 0.1f, glass.specular = 0.2f, glass.shine = 80.0f;
  glass.transmittance = 0.7f, glass.refraction_index = 1.5f;
  scene.materials = {mirror, glass};
  scene.spheres = {{{0.1f, 0.2f, -0.1f}, 3.0f, 0}, {{0.2f, 0.0f, -0.6f}, 0.7f, 1}};
  for (int i = 0; i < 8; ++i)
    scene.positions.emplace_back(-1.0f + 0.8f * (i & 1), -0.6f + 0.7f * (i >> 1 & 1), -0.3f + 0.6f * (i >> 2));
  static constexpr std::array<std::array<std::uint32_t, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : kSides)
    for (const auto& corners : {std::array{a, b, c}, std::array{a, c, d}}) {
      scene.triangles.emplace_back().position = corners;
      scene.triangles.back().material = 1;
    }
  scene.lights = {Light{}};
  scene.lights[0].position = {1.2f, 1.5f, 1.0f};
  scene.camera.from = {0.0f, 0.3f, 2.0f};
  return scene;
}

const Stage& stage_of(const std::string& spec) {
  if (spec == kGlass) return session().stage(spec, glass_in_a_mirror());
  return session().stage(spec);
}

PairedTally compared(const std::string& spec, PairedEffects effects, Effects::Model model,
                     std::vector<ShaderPatch> patches = {}) {
  PairedSettings settings;
  settings.width = 20, settings.height = 15;
  settings.patches = std::move(patches);
  PairedTally tally;
  compare_picture(session(), spec, with_effects(stage_of(spec), effects, model), settings, tally);
  return tally;
}

struct Fault {
  const char* name;
  const char* spec;
  PairedEffects effects;
  PairedStep step;  ///< where it must show first
  ShaderPatch patch;
};

const std::vector<Fault> kFaults{
    {"highlight with the perturbed normal", "sphereflake:2", PairedEffects::glossy, PairedStep::color,
     renderer_patch("highlight")},
    {"reflected ray not mirrored above the surface", "bumped_ground", PairedEffects::none, PairedStep::reflected,
     renderer_patch("not_mirrored")},
    {"light radius off by 3 %", "soft_shadow", PairedEffects::soft_shadow, PairedStep::shadow,
     renderer_patch("light_radius")},
    {"depth limit 4", kGlass, PairedEffects::none, PairedStep::reflected, renderer_patch("depth_4")},
    {"shadow ray towards the light's centre", "soft_shadow", PairedEffects::soft_shadow, PairedStep::shadow,
     renderer_patch("light_centre")},
    {"aperture off by 3 %", "dof", PairedEffects::dof, PairedStep::primary, renderer_patch("aperture")},
    {"glossiness off by 5 %", "glossy", PairedEffects::glossy, PairedStep::reflected, renderer_patch("glossiness")},
    {"half a pixel off", "glossy", PairedEffects::aa, PairedStep::primary, renderer_patch("half_pixel")},
    {"glass left as it is entered",
     kGlass,
     PairedEffects::none,
     PairedStep::refracted,
     {"scatter.frag.glsl", "float eta = dot(d, s.outside) > 0.0 ? s.index : 1.0 / s.index;",
      "float eta = 1.0 / s.index;"}},
    {"total reflection forgotten",
     kGlass,
     PairedEffects::none,
     PairedStep::refracted,
     {"scatter.frag.glsl", "bool is_total = k < 0.0;", "bool is_total = false;"}},
    {"textures fainter by one part in 1000",
     "dof",
     PairedEffects::none,
     PairedStep::color,
     {"surface.glsl", "s.color *= look_up", "s.color *= 0.999 * look_up"}},
    {"diffuse term brighter by 2^-15",
     "glossy",
     PairedEffects::none,
     PairedStep::color,
     {"light.frag.glsl", "(s.kd * along * s.color", "(1.000030517578125 * s.kd * along * s.color"}},
};

}  // namespace

TEST_CASE("Every sample is what the reference computes from the same numbers", "[paired]") {
  Effects::Model model = Effects::Model::paper;
  for (const char* spec :
       {"bumped_ground", "soft_shadow", "dof", "glossy", "motion", "sphereflake:2", "figure_1", kGlass}) {
    const PairedTally tally = compared(spec, PairedEffects::all, model);
    INFO(spec << (tally.kept.empty() ? "" : ": " + tally.kept.front().event));
    CHECK(tally.samples == 300);
    CHECK(tally.differ == 0);
    CHECK(tally.apart <= 3);  // 1 %
    CHECK(tally.rays >= 300);
    model = model == Effects::Model::paper ? Effects::Model::physical : Effects::Model::paper;
  }
}

TEST_CASE("Faults put into the shaders are found, each at its own step", "[paired]") {
  for (const Fault& fault : kFaults) {
    const PairedTally tally = compared(fault.spec, fault.effects, Effects::Model::paper, {fault.patch});
    INFO(fault.name << (tally.kept.empty() ? "" : ": " + tally.kept.front().event));
    CHECK(tally.differ > 0);
    if (tally.kept.empty()) continue;
    CHECK(tally.kept.front().verdict == SampleVerdict::differ);
    CHECK(std::string(name_of(tally.kept.front().step)) == name_of(fault.step));
  }
}

}  // namespace plumbline
