// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation_scenes.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

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

/// What stands in the world stands there twice, and in two instances at the same place as well; two more are at
/// another place, and two are nested.
Scene doubles(bool has_nodes) {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("doubles"), 0);
  std::vector<std::array<glm::vec3, 3>> triangles;
  std::vector<Sphere> spheres;
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 at = cube_point(random);
    triangles.push_back(
        {at + 0.6f * cube_point(random), at + 0.6f * cube_point(random), at + 0.6f * cube_point(random)});
  }
  for (int i = 0; i < 3; ++i) spheres.push_back({cube_point(random), 0.25f, 0});
  for (int space = 0; space < (has_nodes ? 2 : 1); ++space) {
    Part part{"twice", static_cast<std::uint32_t>(scene.triangles.size()), 0,
              static_cast<std::uint32_t>(scene.spheres.size()), 0};
    for (int twice = 0; twice < 2; ++twice) {
      for (const auto& [a, b, c] : triangles) add_triangle(scene, a, b, c);
      scene.spheres.insert(scene.spheres.end(), spheres.begin(), spheres.end());
    }
    part.triangle_count = static_cast<std::uint32_t>(scene.triangles.size()) - part.first_triangle;
    part.sphere_count = static_cast<std::uint32_t>(scene.spheres.size()) - part.first_sphere;
    if (space > 0) scene.parts.push_back(part);
  }
  const auto node = [&](const char* name, std::uint32_t parent, std::uint32_t part, const Transform& transform) {
    scene.nodes.push_back({name, parent, part, transform, transform});
  };
  Transform aside, turned;
  aside.translation = {2.5f, 0.5f, -0.5f};
  turned.linear = glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.1f, -0.7f);
  turned.translation = {-2.5f, 0.25f, 1.0f};
  if (!has_nodes) {
    frame_camera(scene);
    return scene;
  }
  node("here", kNone, 0, {});
  node("here again", kNone, 0, {});
  node("aside", kNone, 0, aside);
  node("aside again", kNone, 0, aside);
  node("group", kNone, kNone, turned);
  node("inner", 4, 0, turned);
  node("inner again", 4, 0, turned);
  frame_camera(scene);
  return scene;
}

/// Triangles in a flat slab, which rays along it see edge-on, most of them several.
Scene slats() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("slats"), 0);
  const auto flat = [&] { return cube_point(random) * glm::vec3(1.0f, 1e-3f, 1.0f); };
  for (int i = 0; i < 12; ++i) {
    const glm::vec3 a = flat(), b = flat(), c = flat();
    add_triangle(scene, a, b, c);
  }
  frame_camera(scene);
  return scene;
}

/// Rays along the slab.
std::vector<Ray> rays_of_slats() {
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 512; ++i) {
    Random random(kSeed, name_hash("rays of slats"), i);
    const glm::vec3 thin(1.0f, 1e-3f, 1.0f), from = cube_point(random) * thin, to = cube_point(random) * thin;
    rays.push_back({from + (i % 2 == 0 ? 4.0f : 0.5f) * (from - to), to - from});
  }
  return rays;
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
      return load_scene("ellipsoids");
    case MutationScene::doubles:
      return doubles(true);
    case MutationScene::twins:
      return doubles(false);
    case MutationScene::slats:
      return slats();
    case MutationScene::scales:
      break;
  }
  return load_scene("scales");
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
  static constexpr std::array<const char*, 9> kNames{"mixed",   "spheres", "triangles", "nested", "spheres_placed",
                                                     "doubles", "twins",   "slats",     "scales"};
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
  sort_out(probe, scene == MutationScene::slats ? rays_of_slats() : mixed_rays(stage.rays, kSeed, kRaysOfFamily), plain,
           rare);
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

std::string first_failure(const Judge& judge_of_rays, const MutationRays& rays, const std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Judgement j = judge(judge_of_rays, rays.rays[i], hits[i], rays.truth[i]);
    if (is_failure(j.verdict))
      return "ray " + std::to_string(i) + " " + std::string(verdict_name(j.verdict)) + ": " + j.reason;
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
      return "ray " + std::to_string(i) + " " + describe(hits[i]) + ", by the loop over all primitives " +
             describe(known[i]);
  return {};
}

}  // namespace plumbline
