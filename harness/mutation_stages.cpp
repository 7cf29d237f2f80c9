// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of scenes and rays without a mutant, how walks are interrupted, and what is wrong with an answer.
#include <map>
#include <memory>

#include "harness/hit_cases.h"
#include "harness/mutation_scenes.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// Cuts rays into those whose walks end in the first pass and the others.
void sort_out(Probe& probe, std::span<const Ray> rays, std::vector<Ray>& plain, std::vector<Ray>& rare) {
  if (rays.empty()) return;
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  if (probe.resumed_passes() == 0) {
    plain.insert(plain.end(), rays.begin(), rays.end());
  } else if (rays.size() == 1) {
    rare.push_back(rays[0]);
  } else {
    sort_out(probe, rays.first(rays.size() / 2), plain, rare);
    sort_out(probe, rays.subspan(rays.size() / 2), plain, rare);
  }
}

void know(GlContext& context, const Stage& stage, MutationRays& rays) {
  rays.truth.resize(rays.rays.size());
  stage.embree.intersect(rays.rays, rays.truth);
  BakeOptions options;
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    options.layout = layout;
    std::vector<Hit>& hits = layout == Layout::compact ? rays.brute_compact : rays.brute_paper;
    hits.resize(rays.rays.size());
    Probe(context, bake(stage.scene, options), Traversal::brute_force).trace(rays.rays, hits);
  }
}

}  // namespace

// Text in which no mutant is (mutation_test.cpp).
std::vector<ShaderPatch> slices_of(const GeometryImage& image, int steps) {
  const std::string is_over = "walk.steps > slice + " + std::to_string(steps);
  if (image.transform_count > 0)
    return {{"probe.frag.glsl", "      walk_tree();\n      change_space();\n",
             "      walk_tree();\n      change_space();\n      if ((walk.steps & 3) == 3) break;\n"}};
  if (image.options.layout == Layout::compact)
    return {{"walk_compact.glsl", "#endif\n  for (;;) {",
             "#endif\n  int slice = walk.steps;\n  for (;;) {\n    if (" + is_over + ") break;"}};
  return {{"walk_paper.glsl", "  for (;;) {\n    if (walk.ended) break;",
           "  int slice = walk.steps;\n  for (;;) {\n    if (walk.ended || " + is_over + ") break;"}};
}

std::vector<ShaderPatch> loops_that_end(const GeometryImage& image, int rounds) {
  PLUMBLINE_ASSERT(image.transform_count > 0);
  const std::string breaks = "if (--rounds_left < 0) break;\n";
  const std::string comment = "    // A pixel that has left the loop must";
  return {
      {"ray_prepare.glsl", "PRECISE WalkRay ray;\n",
       "PRECISE WalkRay ray;\nint rounds_left = " + std::to_string(rounds) + ";\n"},
      {"ray_prepare.glsl", ") {\n    advance", ") {\n    " + breaks + "    advance"},
      {"transform.glsl", "      enter_space(node);\n", "      " + breaks + "      enter_space(node);\n"},
      // The inner loop's condition asks for `level`, which then lies beyond `above`.
      {"transform.glsl", "    int above = depth;\n",
       "    int above = depth;\n    bool is_over = --rounds_left < 0;\n#define level (is_over ? above + 1 : level)\n"},
      {"transform.glsl", comment, "#undef level\n" + comment},
      {"result.glsl", "      normal = times_transposed(back_0, back_1, back_2, normal);\n",
       "      " + breaks + "      normal = times_transposed(back_0, back_1, back_2, normal);\n"}};
}

AddedPatches::AddedPatches(GlContext& context, std::span<const ShaderPatch> patches)
    : context_(context), before_(context.patches()) {
  std::vector<ShaderPatch> all = before_;
  all.insert(all.end(), patches.begin(), patches.end());
  context.set_patches(std::move(all));
}
AddedPatches::~AddedPatches() { context_.set_patches(before_); }

const MutationStage& mutation_stage(GlContext& context, MutationScene scene) {
  static std::map<MutationScene, std::unique_ptr<MutationStage>> kStages;
  std::unique_ptr<MutationStage>& made_stage = kStages[scene];
  if (made_stage) return *made_stage;
  PLUMBLINE_ASSERT(context.patches().empty());
  made_stage = std::make_unique<MutationStage>(name_of(scene), mutation_scene(scene));
  const Stage& stage = made_stage->stage;
  std::vector<Ray> plain, rare;
  Probe probe(context, stage.image);
  sort_out(probe, mutation_rays(scene, stage.rays), plain, rare);
  made_stage->plain.odd_from = plain.size();
  sort_out(probe, odd_rays(stage.rays.ball), plain, rare);
  PLUMBLINE_ASSERT(!rare.empty());
  made_stage->plain.rays = plain;
  // Rare rays have ordinary ones for neighbours.
  for (std::size_t i = 0; i < plain.size(); i += 4)
    rare.insert(rare.begin() + static_cast<std::ptrdiff_t>(i % (rare.size() + 1)), plain[i]);
  made_stage->rare.rays = rare;
  know(context, stage, made_stage->plain);
  know(context, stage, made_stage->rare);
  return *made_stage;
}

std::string first_failure(const Judge& judge_of_rays, const MutationRays& rays, const std::vector<Hit>& hits,
                          std::vector<Hit>& passed) {
  Hit none;
  none.kind = HitKind::capped;
  passed.resize(hits.size(), none);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].transforms == passed[i].transforms && same_bits(hits[i], passed[i])) continue;
    const Judgement j = judge(judge_of_rays, rays.rays[i], hits[i], rays.truth[i]);
    if (is_failure(j.verdict))
      return "ray " + std::to_string(i) + " " + std::string(verdict_name(j.verdict)) + ": " + j.reason;
    passed[i] = hits[i];
  }
  return {};
}

std::string first_wrong_tie(const Scene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  // Two are the same where their places and their numbers are.
  const auto same_place = [&](std::uint32_t a, std::uint32_t b) {
    const TransformD x = to_world(scene, a), y = to_world(scene, b);
    return x.linear == y.linear && x.translation == y.translation;
  };
  const auto same_primitive = [&](std::uint32_t a, std::uint32_t b) {
    if (scene.is_triangle(a) != scene.is_triangle(b)) return false;
    if (scene.is_triangle(a)) return scene.corners(a) == scene.corners(b);
    return scene.sphere(a).center == scene.sphere(b).center && scene.sphere(a).radius == scene.sphere(b).radius;
  };
  std::vector<std::uint32_t> spaces = instances_of(scene);
  spaces.insert(spaces.begin(), kNone);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].kind != HitKind::hit) continue;
    for (const std::uint32_t space : spaces) {
      if (space != kNone && hits[i].instance != kNone && space > hits[i].instance) break;
      if (space != kNone && hits[i].instance == kNone) break;
      // A ray that starts outside is moved near the ball of what stands in a space, and the world's is another.
      if (space == kNone && hits[i].instance != kNone && !(glm::length(rays[i].origin) < 1.0f)) continue;
      if (!same_place(space, hits[i].instance)) continue;
      for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
        if (space == hits[i].instance && p >= hits[i].primitive) break;
        if (scene.is_placed(space, p) && same_primitive(p, hits[i].primitive))
          return "ray " + std::to_string(i) + " " + describe(hits[i]) + ", not the same primitive that comes first";
      }
    }
  }
  return {};
}

std::string first_difference(const MutationRays& rays, const std::vector<Hit>& hits, const std::vector<Hit>& known) {
  PLUMBLINE_ASSERT(hits.size() == known.size() && hits.size() == rays.rays.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (!same_bits(hits[i], known[i]))
      return "ray " + std::to_string(i) + " " + describe(hits[i]) + ", not " + describe(known[i]);
  return {};
}

}  // namespace plumbline
