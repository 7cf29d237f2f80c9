// SPDX-License-Identifier: GPL-3.0-or-later
// See drt_cases.h.
#include "harness/drt_cases.h"

#include "harness/convergence.h"
#include "harness/model_bias.h"
#include "harness/picture_report.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

/// The scene that shows an effect best.
ListedScene scene_for(const std::string& effect) {
  if (effect == "aa") return {"bumped_ground", "bumped_ground"};
  if (effect == "soft_shadow") return {"soft_shadow", "soft_shadow"};
  if (effect == "dof") return {"dof", "dof"};
  if (effect == "glossy") return {"glossy", "glossy"};
  return {"motion", "motion"};
}

/// Where effects meet: spheres, the paper's own scene, textures on blocks that are turned and stretched, a closed room.
std::vector<ListedScene> scenes_for_all() {
  return {{"figure_1", "figure_1"}, {"sphereflake_3", "sphereflake:3"}, {"blocks", "blocks"}, {"cornell", "cornell"}};
}

std::string model_name(Effects::Model model) { return model == Effects::Model::paper ? "paper" : "physical"; }

/// The effect where there is one alone; `combined` where several meet.
std::string feature_of(const std::vector<std::string>& effects) {
  return effects.size() == 1 ? effects.front() : "combined";
}

Case comparison_case(const std::string& name, const ListedScene& scene, const std::string& proves,
                     const std::vector<std::string>& effects, Effects::Model model, const EngineUnderTest& engine,
                     Depth depth) {
  const bool bounces = name.find(".bounces.") != std::string::npos;
  Case c = scene_case(name, bounces ? "shading" : feature_of(effects), scene, "7", proves);
  c.run = [=](CaseContext& context, const Case& self, CaseRecord& record) {
    const Scene prepared = drt_scene(self.spec);
    const PictureComparison result =
        compare_engines(prepared, effects_of(prepared, effects, model), depth, case_seed(context.seed, self.name),
                        engine(context), make_reference_engine, context.progress);
    record_comparison(result, context.out, self.name, record);
  };
  return c;
}

Case convergence_case(const std::string& name, const ListedScene& scene, const std::vector<std::string>& effects,
                      const EngineUnderTest& engine) {
  Case c = scene_case(name, feature_of(effects), scene, "7",
                      "The error against a long reference falls as one over the number of samples.");
  c.run = [=](CaseContext& context, const Case& self, CaseRecord& record) {
    const Scene prepared = drt_scene(self.spec);
    PictureSettings settings{32, 24, effects_of(prepared, effects, Effects::Model::paper), 0, 0.0};
    const auto made = [&](const MakePictureEngine& make, const char* purpose) {
      settings.seed = mix64(case_seed(context.seed, self.name) ^ name_hash(purpose));
      return make(prepared, settings);
    };
    const auto tested = made(engine(context), "tested"), reference = made(make_reference_engine, "reference"),
               truth = made(make_reference_engine, "truth");
    record_convergence(measure_convergence(*tested, *reference, *truth, {}, context.progress), context.out, self.name,
                       record);
  };
  return c;
}

}  // namespace

std::vector<Case> independent_cases(const EngineUnderTest& engine, const DrtOptions& options) {
  const std::string prefix = options.name.empty() ? "" : options.name + ".";
  const auto depth_of = [&](int width, int height, std::uint32_t frames) {
    Depth depth;
    depth.width = width;
    depth.height = height;
    depth.frames = frames;
    depth.rounding = options.rounding;
    depth.pixels_independent = options.pixels_independent;
    return depth;
  };
  std::vector<Case> cases;
  for (const std::string& effect : effect_names()) {
    const ListedScene scene = scene_for(effect);
    for (const Effects::Model model : {Effects::Model::paper, Effects::Model::physical}) {
      // These two have one model.
      if (model == Effects::Model::physical && (effect == "aa" || effect == "motion_blur")) continue;
      cases.push_back(comparison_case("drt.independent." + prefix + effect + "." + scene.name + "." + model_name(model),
                                      scene,
                                      "Alone, the effect draws from the same distribution as the reference: in every "
                                      "pixel, tile and the whole picture, in means and variances.",
                                      {effect}, model, engine, depth_of(64, 48, options.single_frames)));
    }
    cases.push_back(convergence_case("drt.convergence." + prefix + effect + "." + scene.name, scene, {effect}, engine));
  }
  cases.push_back(comparison_case("drt.independent." + prefix + "bounces.mirrors.paper", {"mirrors", "mirrors"},
                                  "Light that comes by up to five bounces between mirrors is all there, and no more.",
                                  {"aa"}, Effects::Model::paper, engine, depth_of(64, 48, options.all_frames)));
  for (const ListedScene& scene : scenes_for_all()) {
    const std::vector<std::string>& effects = effect_names();
    for (std::size_t i = 0; i < effects.size(); ++i)
      for (std::size_t k = i + 1; k < effects.size(); ++k)
        cases.push_back(comparison_case("drt.pairs." + prefix + effects[i] + "_" + effects[k] + "." + scene.name, scene,
                                        "Two effects at once are what the reference makes of them: neither shares "
                                        "numbers with the other nor undoes it.",
                                        {effects[i], effects[k]}, Effects::Model::paper, engine,
                                        depth_of(48, 36, options.pair_frames)));
    for (const Effects::Model model : {Effects::Model::paper, Effects::Model::physical})
      cases.push_back(comparison_case("drt.all." + prefix + scene.name + "." + model_name(model), scene,
                                      "All effects at once, as the reference makes them.", effects, model, engine,
                                      depth_of(64, 48, options.all_frames)));
  }
  return cases;
}

std::vector<Case> model_bias_cases() {
  std::vector<Case> cases;
  for (const char* effect : {"soft_shadow", "dof", "glossy"}) {
    const ListedScene scene = scene_for(effect);
    Case c = scene_case("drt.model_bias." + std::string(effect) + "." + scene.name, effect, scene, "7",
                        "How far the paper's cube is from disc and ball: told in figures, and no error.");
    c.run = [effects = std::vector<std::string>{effect}](CaseContext& context, const Case& self, CaseRecord& record) {
      const Scene prepared = drt_scene(self.spec);
      record_model_bias(measure_model_bias(prepared, effects, {}, case_seed(context.seed, self.name), context.progress),
                        context.out, self.name, record);
    };
    cases.push_back(std::move(c));
  }
  return cases;
}

}  // namespace plumbline
