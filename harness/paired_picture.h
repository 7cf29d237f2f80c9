// SPDX-License-Identifier: GPL-3.0-or-later
// A small picture by the tracer, tapped, and compared sample by sample.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/paired.h"

namespace plumbline {

/// Which effects a paired picture has.
enum class PairedEffects { none, aa, dof, soft_shadow, glossy, motion_blur, all };
inline constexpr std::array kPairedEffects{
    PairedEffects::none,   PairedEffects::aa,          PairedEffects::dof, PairedEffects::soft_shadow,
    PairedEffects::glossy, PairedEffects::motion_blur, PairedEffects::all};
const char* name_of(PairedEffects effects);  ///< as in case names; of none it is "shading"

/// The scene with the switches set, and with amounts where it has none of its own: a lens of a hundredth of the
/// distance of what is sharp, lights of a twentieth of the scene's radius, 0.05 for reflections.
Scene with_effects(const Stage& stage, PairedEffects effects, Effects::Model model);

struct PairedSettings {
  int width = 32, height = 24;  ///< pixels
  std::uint32_t frames = 1;
  std::uint64_t seed = 1;
  RandomKind random = RandomKind::hash;
  Layout layout = Layout::compact;   ///< of the geometry image
  std::vector<ShaderPatch> patches;  ///< faults on purpose
  GlContext* context = nullptr;      ///< that the tracer renders in; null: the session's
};

/// Renders `scene`, which is that of the stage but for lights, camera and effects, and compares every sample. Adds to
/// `tally`. Where things move each frame has a stage of its own, in place of the session's. Throws as Renderer does.
void compare_picture(Session& session, const std::string& spec, const Scene& scene, const PairedSettings& settings,
                     PairedTally& tally);

}  // namespace plumbline
