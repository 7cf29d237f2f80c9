// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures by a renderer whose shaders are mutants: the reference follows each sample with the numbers that were
// drawn, step by step.
#include <memory>

#include "harness/mutation_oracles.h"
#include "harness/paired_picture.h"
#include "tracer/render_passes.h"

namespace plumbline {
namespace {

struct Asked {
  const char* spec;
  PairedEffects effects = PairedEffects::all;
  Effects::Model model = Effects::Model::paper;
};

/// A session of its own, which knows nothing of mutants.
struct Known {
  Session session;
  Stage* stage = nullptr;
};

std::vector<ActiveLines> programs_of(const Scene& scene, Effects::Model model) {
  const GeometryImage image = bake(scene);
  const ProgramVariant walk = program_variant(image, false, false);  // whose mutants others see
  ShadingVariant variant;
  variant.has_triangles = walk.has_triangles, variant.has_spheres = walk.has_spheres;
  variant.has_transforms = walk.has_transforms, variant.has_textures = !scene.textures.empty();
  variant.is_physical = model == Effects::Model::physical;
  variant.primitive_count = scene.primitive_count();
  std::vector<ActiveLines> all;
  for (const auto& [pass, tap] :
       {std::pair{RenderPass::camera, PassTap::none}, std::pair{RenderPass::light, PassTap::none},
        std::pair{RenderPass::add_light, PassTap::none}, std::pair{RenderPass::scatter, PassTap::none},
        std::pair{RenderPass::camera, PassTap::lens_numbers}, std::pair{RenderPass::light, PassTap::numbers},
        std::pair{RenderPass::scatter, PassTap::numbers}})
    all.push_back(active_lines(render_shader(pass, variant, tap)));
  return all;
}

MutationOracle picture_oracle(GlContext& context, const Asked& asked) {
  auto known = std::make_shared<Known>();
  known->stage = &known->session.stage(asked.spec);
  const Scene scene = with_effects(*known->stage, asked.effects, asked.model);
  MutationOracle oracle;
  oracle.name = std::string("paired.") + asked.spec;
  oracle.programs = programs_of(scene, asked.model);
  oracle.ask = [&context, known, scene, asked](const Mutant&) -> std::string {
    PairedSettings settings;
    settings.width = 16, settings.height = 16;
    settings.context = &context;
    PairedTally tally;
    compare_picture(known->session, asked.spec, scene, settings, tally);
    if (tally.differ > 0) return tally.kept.front().event;
    // What stands apart hangs on a tie or a grazing ray: in a sound picture few do (at most 1 in 100).
    if (tally.apart > tally.samples / 50) return std::to_string(tally.apart) + " samples stand apart";
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> picture_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  using M = Effects::Model;
  for (const Asked& asked :
       {Asked{"bumped_ground", PairedEffects::all, M::paper}, Asked{"figure_1", PairedEffects::all, M::physical},
        Asked{"dof", PairedEffects::all, M::paper}})
    oracles.push_back(picture_oracle(context, asked));
  return oracles;
}

}  // namespace plumbline
