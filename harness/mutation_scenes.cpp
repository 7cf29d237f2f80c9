// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation_scenes.h"

#include <algorithm>
#include <array>
#include <map>

#include "harness/hit_cases.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants");
constexpr std::size_t kRaysOfFamily = 48;

glm::vec3 cube_point(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.emplace_back().position = {first, first + 1, first + 2};
}

/// Triangles of three sizes and as many slivers, strewn around a closed mesh; spheres between them.
Scene strewn(std::uint32_t triangles, std::uint32_t spheres) {
  Scene scene = triangles > 0 ? generate_scene("icosphere", 1) : Scene{};
  scene.materials.resize(std::max<std::size_t>(scene.materials.size(), 1));
  Random random(kSeed, name_hash("strewn"), 0);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float size = std::array{0.8f, 0.2f, 0.02f, 0.5f}[i % 4];
    const glm::vec3 at = 1.6f * cube_point(random), a = at + size * cube_point(random);
    const glm::vec3 b = at + size * cube_point(random);
    const glm::vec3 c = i % 4 == 3 ? 0.5f * (a + b) + 1e-4f * cube_point(random) : at + size * cube_point(random);
    add_triangle(scene, a, b, c);
  }
  for (std::uint32_t i = 0; i < spheres; ++i) {
    const float radius = std::array{0.4f, 0.1f, 0.01f}[i % 3];
    scene.spheres.push_back({1.6f * cube_point(random), radius, 0});
  }
  scene.camera = {};
  frame_camera(scene);
  return scene;
}

Scene made(MutationScene scene) {
  switch (scene) {
    case MutationScene::mixed:
      return strewn(48, 24);
    case MutationScene::spheres:
      return strewn(0, 40);
    case MutationScene::triangles:
      return strewn(64, 0);
    case MutationScene::nested:
      return load_scene("nested");
    case MutationScene::spheres_placed:
      break;
  }
  return load_scene("ellipsoids");
}

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

const char* name_of(MutationScene scene) {
  static constexpr std::array<const char*, 5> kNames{"mixed", "spheres", "triangles", "nested", "spheres_placed"};
  return kNames[static_cast<std::size_t>(scene)];
}

const MutationStage& mutation_stage(GlContext& context, MutationScene scene) {
  static std::map<MutationScene, std::unique_ptr<MutationStage>> kStages;
  std::unique_ptr<MutationStage>& made_stage = kStages[scene];
  if (made_stage) return *made_stage;
  PLUMBLINE_ASSERT(context.patches().empty());
  made_stage = std::make_unique<MutationStage>(name_of(scene), made(scene));
  const Stage& stage = made_stage->stage;
  std::vector<Ray> plain, rare;
  Probe probe(context, stage.image);
  sort_out(probe, mixed_rays(stage.rays, kSeed, kRaysOfFamily), plain, rare);
  made_stage->plain.rays = plain;
  // Rare rays have ordinary ones for neighbours.
  for (std::size_t i = 0; i < plain.size(); i += 4)
    rare.insert(rare.begin() + static_cast<std::ptrdiff_t>(i % rare.size()), plain[i]);
  made_stage->rare.rays = rare;
  know(context, stage, made_stage->plain);
  know(context, stage, made_stage->rare);
  return *made_stage;
}

std::string first_failure(const Judge& judge_of_rays, const MutationRays& rays, const std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Judgement j = judge(judge_of_rays, rays.rays[i], hits[i], rays.truth[i]);
    if (is_failure(j.verdict))
      return "ray " + std::to_string(i) + " " + std::string(verdict_name(j.verdict)) + ": " + j.reason;
  }
  return {};
}

std::string first_difference(const MutationRays& rays, const std::vector<Hit>& hits, const std::vector<Hit>& known) {
  PLUMBLINE_ASSERT(hits.size() == known.size() && hits.size() == rays.rays.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (!same_bits(hits[i], known[i]))
      return "ray " + std::to_string(i) + " " + describe(hits[i]) + ", by the loop over all primitives " +
             describe(known[i]);
  return {};
}

}  // namespace plumbline
