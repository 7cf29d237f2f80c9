// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures by a renderer whose shaders are mutants: the reference follows each sample with the numbers that were
// drawn, step by step; those numbers are hashed anew in C++; and what the sharp rays have met tells the channels.
#include <cmath>
#include <memory>

#include "harness/mutation_oracles.h"
#include "harness/mutation_rooms.h"
#include "harness/paired_bounds.h"
#include "harness/paired_picture.h"
#include "tracer/random_numbers.h"
#include "tracer/ray_targets.h"
#include "tracer/render_passes.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr int kWidth = 20, kHeight = 12;  // pixels, unlike sides

struct Asked {
  MutationRoom room;
  PairedEffects effects;
  Effects::Model model;
  Layout layout = Layout::compact;
};

/// A session of its own, which knows nothing of mutants.
struct Known {
  Session session;
  Scene scene;
};

std::shared_ptr<Known> known_of(const Asked& asked) {
  auto known = std::make_shared<Known>();
  const Stage& stage = known->session.stage(name_of(asked.room), mutation_room(asked.room));
  known->scene = with_effects(stage, asked.effects, asked.model);
  return known;
}

std::string name_of(const Asked& asked) {
  return std::string(name_of(asked.room)) + "." + name_of(asked.effects) +
         (asked.model == Effects::Model::physical ? ".physical" : ".paper");
}

RenderSettings settings_of(const Asked& asked) {
  RenderSettings settings;
  settings.width = kWidth, settings.height = kHeight;
  settings.seed = 1;
  settings.bake.layout = asked.layout;
  return settings;
}

ShadingVariant variant_of(const Asked& asked, const Scene& scene) {
  const ProgramVariant walk = program_variant(bake(scene), false, false);  // whose mutants others see
  ShadingVariant variant;
  variant.has_triangles = walk.has_triangles, variant.has_spheres = walk.has_spheres;
  variant.has_transforms = walk.has_transforms, variant.has_textures = !scene.textures.empty();
  variant.is_paper = asked.layout == Layout::paper;
  variant.is_physical = asked.model == Effects::Model::physical;
  variant.primitive_count = scene.primitive_count();
  return variant;
}

MutationOracle picture_oracle(GlContext& context, const Asked& asked) {
  const std::shared_ptr<Known> known = known_of(asked);
  MutationOracle oracle;
  oracle.name = "paired." + name_of(asked);
  const ShadingVariant variant = variant_of(asked, known->scene);
  for (const auto& [pass, tap] :
       {std::pair{RenderPass::camera, PassTap::none}, std::pair{RenderPass::light, PassTap::none},
        std::pair{RenderPass::add_light, PassTap::none}, std::pair{RenderPass::scatter, PassTap::none},
        std::pair{RenderPass::camera, PassTap::lens_numbers}, std::pair{RenderPass::light, PassTap::numbers},
        std::pair{RenderPass::scatter, PassTap::numbers}})
    oracle.programs.push_back(active_lines(render_shader(pass, variant, tap)));
  oracle.ask = [&context, known, asked](const Mutant&) -> std::string {
    PairedSettings settings;
    settings.width = kWidth, settings.height = kHeight;
    settings.layout = asked.layout;
    settings.context = &context;
    PairedTally tally;
    compare_picture(known->session, name_of(asked.room), known->scene, settings, tally);
    if (tally.differ > 0) return tally.kept.front().event;
    // What stands apart hangs on a tie or a grazing ray. In the sound rooms nothing does (0 of 240 samples in each); a
    // mutant that is right may round one or two to such a place.
    if (tally.apart > tally.samples / 100) return std::to_string(tally.apart) + " samples stand apart";
    return {};
  };
  return oracle;
}

/// Compares what passes say that they have drawn with the numbers that C++ makes of pixel, frame, ray and block, and
/// perturbations with what these numbers are to become (SEMANTICS 7.4).
class NumbersTap final : public RenderTap {
 public:
  NumbersTap(const Effects& effects, const RenderSettings& settings)
      : effects_(effects), size_(settings.width, settings.height) {}
  std::string wrong;

  void rays(const TappedBatch&, std::uint32_t, std::uint32_t, std::span<const Ray>, std::span<const Hit>) override {}
  void samples(const TappedBatch&, std::span<const glm::vec4>) override {}

  void numbers(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first,
               std::span<const glm::vec4> numbers) override {
    const bool may_be_missing = first >= 5;  // where nothing is hit; paired comparison tells which must be there
    const std::uint32_t block = first == 0   ? kBlockPixel
                                : first == 2 ? kBlockLens
                                : first == 5 ? kBlockNormal
                                             : kBlockLights + (first - 8) / 3;
    const bool is_drawn = first == 0   ? effects_.antialias
                          : first == 2 ? effects_.depth_of_field
                          : first == 5 ? effects_.glossy_reflections
                                       : effects_.soft_shadows;
    const glm::vec4 instead(first == 0 ? 0.5f : 0.0f);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (may_be_missing && glm::vec3(numbers[i]) == glm::vec3(0.0f)) continue;
      const glm::uvec2 pixel = batch.pixel(i);
      const glm::vec4 known =
          is_drawn ? hashed_block(1, pixel.y * size_.x + pixel.x, batch.frame(i), ray, block) : instead;
      const int count = first == 0 ? 2 : 3;
      for (int k = 0; k < count; ++k)
        if (numbers[i][k] != known[k]) complain("the numbers", ray, first, i);
    }
    drawn_.assign(numbers.begin(), numbers.end());
  }

  void places(const TappedBatch&, std::uint32_t ray, std::uint32_t first, std::span<const glm::vec4> places) override {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const glm::dvec3 u(drawn_[i]);
      if (u == glm::dvec3(0.0)) continue;
      const glm::dvec3 place = place_of(u, first == 2);
      const double bound = effects_.model == Effects::Model::physical ? 16.0 * 0x1p-24 : 0.0;
      if (!(glm::length(glm::dvec3(places[i]) - place) <= bound)) complain("the perturbation", ray, first, i);
      if (places[i].w != (first == 2 ? 0.0f : drawn_[i].w)) complain("the fourth number", ray, first, i);
    }
  }

 private:
  void complain(const char* what, std::uint32_t ray, std::uint32_t first, std::size_t item) {
    if (wrong.empty())
      wrong = std::string(what) + " of ray " + std::to_string(ray) + ", dimension " + std::to_string(first) +
              ", item " + std::to_string(item) + " are others in C++";
  }

  glm::dvec3 place_of(const glm::dvec3& u, bool is_lens) const {
    if (effects_.model == Effects::Model::paper) return 2.0 * u - 1.0;
    const double angle = 2.0 * 3.14159265358979323846 * u.y;
    const glm::dvec2 turned(std::cos(angle), std::sin(angle));
    if (is_lens) return {std::sqrt(u.x) * turned, 0.0};
    return std::cbrt(u.z) * glm::dvec3(2.0 * std::sqrt(u.x * (1.0 - u.x)) * turned, 1.0 - 2.0 * u.x);
  }

  const Effects& effects_;
  const glm::uvec2 size_;  // pixels
  std::vector<glm::vec4> drawn_;
};

/// 51 frames of the usual size have lanes and blocks; a picture higher than a batch has tiles.
MutationOracle numbers_oracle(GlContext& context, const Asked& asked, int width, int height, std::uint32_t frames) {
  const std::shared_ptr<Known> known = known_of(asked);
  MutationOracle oracle;
  oracle.name = "numbers." + name_of(asked);
  const ShadingVariant variant = variant_of(asked, known->scene);
  for (const auto& [pass, tap] :
       {std::pair{RenderPass::camera, PassTap::numbers}, std::pair{RenderPass::camera, PassTap::lens_numbers},
        std::pair{RenderPass::camera, PassTap::lens_places}, std::pair{RenderPass::light, PassTap::numbers},
        std::pair{RenderPass::light, PassTap::places}, std::pair{RenderPass::scatter, PassTap::numbers},
        std::pair{RenderPass::scatter, PassTap::places}}) {
    ActiveLines lines = active_lines(render_shader(pass, variant, tap));
    lines.erase("surface.glsl");  // numbers do not tell of it
    oracle.programs.push_back(std::move(lines));
  }
  RenderSettings settings = settings_of(asked);
  settings.width = width, settings.height = height, settings.frames = frames;
  oracle.ask = [&context, known, settings](const Mutant&) -> std::string {
    Renderer renderer(context, known->scene, settings);
    NumbersTap tap(known->scene.effects, settings);
    renderer.set_tap(&tap);
    renderer.add_frames(0, settings.frames);
    return tap.wrong;
  };
  return oracle;
}

/// Against the sharp rays and their hits, whose truth others tell, and the ground in double; from the camera or from
/// near the ground.
MutationOracle channels_oracle(GlContext& context, const Asked& asked, bool is_near) {
  const std::shared_ptr<Known> known = known_of(asked);
  if (is_near) {
    const Ground& ground = known->scene.ground;
    known->scene.camera.from = ground.center + 0.5f * ground.normal;
    known->scene.camera.at = ground.center + ground.u_axis;
  }
  MutationOracle oracle;
  oracle.name = "channels." + name_of(asked);
  const ActiveLines lines =
      active_lines(render_shader(RenderPass::channels, variant_of(asked, known->scene), PassTap::none));
  oracle.programs.push_back({{"channels.frag.glsl", lines.at("channels.frag.glsl")}});
  oracle.ask = [&context, known, asked](const Mutant&) -> std::string {
    const Scene& scene = known->scene;
    Renderer renderer(context, scene, settings_of(asked));
    SampleTap tap;
    renderer.set_tap(&tap);
    renderer.add_frames(0, 1);
    renderer.set_tap(nullptr);
    const RenderedPicture picture = renderer.picture();
    const TappedSamples& samples = tap.batches.at(0);
    for (std::size_t i = 0; i < samples.colors.size(); ++i) {
      const glm::uvec2 pixel = samples.batch.pixel(i);
      const std::size_t at = pixel.y * std::size_t{kWidth} + pixel.x;
      const Hit& hit = samples.paths[1].hits[i];
      const SeenGround ground = meet_ground(scene, samples.paths[1].rays[i]);
      const bool is_hit = hit.kind == HitKind::hit;
      const auto t = static_cast<double>(hit.t);
      if (!ground.undecided.empty() || (ground.hit && is_hit && std::abs(ground.hit->t - t) <= ground.t)) continue;
      const bool on_ground = ground.hit && (!is_hit || ground.hit->t < t);
      const std::uint32_t primitive = on_ground ? scene.primitive_count() : is_hit ? hit.primitive : kNone;
      const std::uint32_t instance = is_hit && !on_ground ? hit.instance : kNone;
      const glm::dvec3 normal = on_ground ? scene.ground.normal : is_hit ? hit.normal : glm::vec3(0.0f);
      const bool is_deep = on_ground ? std::abs(picture.depth[at] - ground.hit->t) <= ground.t
                           : is_hit  ? picture.depth[at] == t
                                     : std::isinf(picture.depth[at]) && picture.depth[at] > 0.0;
      if (!is_deep || picture.normal[at] != normal || picture.primitive[at] != primitive ||
          picture.instance[at] != instance || picture.steps[at] != hit.steps)
        return "pixel (" + std::to_string(pixel.x) + ", " + std::to_string(pixel.y) +
               ") has other channels than its ray";
    }
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> picture_oracles(GlContext& context) {
  using R = MutationRoom;
  using E = PairedEffects;
  using M = Effects::Model;
  std::vector<MutationOracle> oracles;
  for (const Asked& asked : {Asked{R::furnished, E::all, M::paper}, Asked{R::papered, E::all, M::physical},
                             Asked{R::balls, E::none, M::paper, Layout::paper}, Asked{R::papered, E::glossy, M::paper},
                             Asked{R::furnished, E::none, M::physical}})
    oracles.push_back(picture_oracle(context, asked));
  oracles.push_back(numbers_oracle(context, {R::furnished, E::all, M::paper}, kWidth, kHeight, 51));
  oracles.push_back(numbers_oracle(context, {R::balls, E::all, M::physical}, 3, kRenderRows + 1, 1));
  oracles.push_back(numbers_oracle(context, {R::furnished, E::none, M::paper}, kWidth, kHeight, 1));
  oracles.push_back(channels_oracle(context, {R::furnished, E::none, M::paper}, false));
  oracles.push_back(channels_oracle(context, {R::papered, E::none, M::paper}, true));
  return oracles;
}

}  // namespace plumbline
