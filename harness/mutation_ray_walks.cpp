// SPDX-License-Identifier: GPL-3.0-or-later
// The same rays, walked as the renderer has them walked: from textures, with shadow rays that ask only whether there is
// a hit, in passes that leave their states in textures.
#include <array>

#include "harness/hit_cases.h"
#include "harness/mutation_oracles.h"
#include "harness/mutation_scenes.h"
#include "harness/walk_model.h"
#include "tracer/ray_walk.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

struct Asked {
  MutationScene scene;
  BakeOptions options;
  int bundle = 1;
  RayQuery query = RayQuery::nearest;
  bool alike = false;   ///< rays that end in the first pass, each in a bundle of its own: they walk as the model does
  bool sliced = false;  ///< the walk takes many passes
};

std::string name_of(const Asked& a) {
  std::string name = std::string("walk.") + name_of(a.scene) + "." + name_of(a.options.layout) + "_" +
                     name_of(a.options.bounds) + (a.query == RayQuery::any ? ".any" : ".nearest");
  if (a.options.transform_out == TransformOut::inverse) name += ".inverse";
  if (a.alike) name += ".alike";
  if (a.sliced) name += ".sliced";
  return name + (a.bundle > 1 ? ".bundles_of_" + std::to_string(a.bundle) : "");
}

std::vector<ActiveLines> lines_of(const GeometryImage& image, const Asked& a) {
  std::vector<ActiveLines> all;
  ProgramVariant variant = program_variant(image, false, false);
  variant.rendering = true, variant.any_hit = a.query == RayQuery::any;
  if (a.bundle > 1) {
    ProgramVariant bundled = variant;
    bundled.bundle = a.bundle;
    all.push_back(active_lines(probe_fragment_shader(bundled)));
    const bool is_any = a.query == RayQuery::any;
    ProgramVariant finish = variant;
    finish.finish = true, finish.found_bundle = a.bundle;
    all.push_back(active_lines(is_any || a.bundle == kBundleWithResults
                                   ? spread_shader(a.bundle, is_any, variant.has_transforms)
                                   : probe_fragment_shader(finish)));
  } else {
    all.push_back(active_lines(probe_fragment_shader(variant)));
  }
  variant.thorough = true;
  all.push_back(active_lines(probe_fragment_shader(variant)));
  const std::array<std::string_view, 1> files{"count.frag.glsl"};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"COUNT_UNFINISHED", ""}};
  all.push_back(active_lines(compose_shader(files, defines)));
  all.push_back(active_lines(probe_vertex_shader()));
  return all;
}

/// What the renderer's walk answers, ray by ray.
std::vector<Hit> walked(GlContext& context, const GeometryImage& image, const Asked& a, const std::vector<Ray>& rays) {
  const int columns = kBatchWidth / a.bundle * a.bundle;
  const int rows = (static_cast<int>(rays.size()) + columns - 1) / columns;
  const auto at = [&](std::size_t i) {
    const int k = static_cast<int>(i);
    return static_cast<std::size_t>(k / columns * kBatchWidth + k % columns);
  };
  std::vector<glm::vec4> origins(static_cast<std::size_t>(kBatchWidth * rows), glm::vec4(0.0f)), directions = origins;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    origins[at(i)] = glm::vec4(rays[i].origin, rays[i].t_max);
    directions[at(i)] = glm::vec4(rays[i].direction, 0.0f);
  }
  const GlTexture from(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, kBatchWidth, rows, origins.data());
  const GlTexture along(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, kBatchWidth, rows, directions.data());
  const AddedPatches added(context, a.sliced ? slices_of(image) : std::vector<ShaderPatch>{});
  RayWalk walk(context, image, a.bundle, {});
  const HitTargets& targets = walk.trace({&from, &along}, columns, rows, a.query);
  std::array<std::vector<PassWords>, kPassTargets> words;
  const GlFunctions& gl = context.use();
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer.name());
  for (int t = 0; t < walk.hit_targets(); ++t) {
    words[static_cast<std::size_t>(t)].resize(origins.size());
    gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + t));
    gl.ReadPixels(0, 0, kBatchWidth, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words[static_cast<std::size_t>(t)].data());
  }
  context.check("reading a mutant's hits");
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < rays.size(); ++i)
    hits.push_back(unpack_hit(words[0][at(i)], words[1][at(i)], words[2][at(i)],
                              walk.hit_targets() == kPassTargets ? &words[3][at(i)] : nullptr));
  return hits;
}

MutationOracle oracle_of(GlContext& context, const Asked& a) {
  const MutationStage& stage = mutation_stage(context, a.scene);
  auto image = std::make_shared<const GeometryImage>(bake(stage.stage.scene, a.options));
  const MutationRays& rays = stage.rare;
  const bool drifts = a.options.transform_out == TransformOut::inverse;
  // What a ray has drifted hangs on the transforms that it has left, which bundles do not count. And whether a shadow
  // ray hits anything is clear where the nearest hit is.
  auto alone = std::make_shared<std::vector<Hit>>(rays.rays.size());
  Probe(context, *image).trace(rays.rays, *alone);
  const Judge judge_of_rays = stage.stage.judge_of(a.options.transform_out);
  auto is_clear = std::make_shared<std::vector<bool>>();
  for (std::size_t i = 0; i < rays.rays.size(); ++i) {
    const Verdict v = judge(judge_of_rays, rays.rays[i], (*alone)[i], rays.truth[i]).verdict;
    is_clear->push_back(v == Verdict::agree || v == Verdict::tie || v == Verdict::undefined);
  }
  MutationOracle oracle;
  oracle.name = name_of(a);
  oracle.programs = lines_of(*image, a);
  if (a.alike) {
    auto alike = std::make_shared<std::vector<Ray>>();
    auto models = std::make_shared<std::vector<ModelWalk>>();
    for (const Ray& ray : stage.plain.rays) {
      if (!is_defined(ray)) continue;
      const ModelWalk model = model_walk(*image, ray, a.query == RayQuery::any);
      if (!model.is_clear) continue;
      alike->insert(alike->end(), static_cast<std::size_t>(a.bundle), ray);
      models->insert(models->end(), static_cast<std::size_t>(a.bundle), model);
    }
    oracle.ask = [&context, image, a, alike, models](const Mutant&) -> std::string {
      const std::vector<Hit> hits = walked(context, *image, a, *alike);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        const std::uint32_t steps = (*models)[i].steps, tests = a.bundle == 1 ? (*models)[i].tests : 0;
        const std::uint32_t transforms = a.bundle == 1 ? (*models)[i].transforms : 0;
        if (hits[i].steps != steps || hits[i].primitive_tests != tests || hits[i].transforms != transforms)
          return "ray " + std::to_string(i) + " has " + std::to_string(hits[i].steps) + " steps, " +
                 std::to_string(hits[i].primitive_tests) + " tests and " + std::to_string(hits[i].transforms) +
                 " transforms, not " + std::to_string(steps) + ", " + std::to_string(tests) + " and " +
                 std::to_string(transforms);
      }
      return {};
    };
    return oracle;
  }
  auto passed = std::make_shared<std::vector<Hit>>();
  oracle.ask = [&context, &rays, image, a, alone, passed, is_clear, judge_of_rays,
                drifts](const Mutant&) -> std::string {
    std::vector<Hit> hits = walked(context, *image, a, rays.rays);
    if (a.query == RayQuery::any) {
      for (std::size_t i = 0; i < hits.size(); ++i)
        if ((*is_clear)[i] && hits[i].kind != rays.truth[i].kind &&
            (is_defined(rays.rays[i]) || hits[i].kind != HitKind::undefined))
          return "shadow ray " + std::to_string(i) + " " + describe(hits[i]) + ", the truth is " +
                 describe(rays.truth[i]);
      return {};
    }
    for (std::size_t i = 0; i < hits.size() && drifts; ++i) hits[i].transforms = (*alone)[i].transforms;
    return first_failure(judge_of_rays, rays, hits, *passed);
  };
  return oracle;
}

/// Passes whose walks are cut off at once: what they leave waits for a triangle that is there, or for none.
MutationOracle states(GlContext& context, RayQuery query, bool thorough) {
  const MutationStage& stage = mutation_stage(context, MutationScene::mixed);
  auto image = std::make_shared<const GeometryImage>(bake(stage.stage.scene));
  ProgramVariant variant = program_variant(*image, false, thorough);
  variant.rendering = true, variant.any_hit = query == RayQuery::any;
  MutationOracle oracle;
  oracle.name =
      std::string("states.mixed") + (query == RayQuery::any ? ".any" : ".nearest") + (thorough ? ".thorough" : "");
  oracle.programs = {active_lines(probe_fragment_shader(variant)), active_lines(probe_vertex_shader())};
  oracle.ask = [&context, image, variant, &rays = stage.rare.rays](const Mutant&) -> std::string {
    std::vector<glm::vec4> origins, directions;
    for (const Ray& ray : rays)
      origins.emplace_back(ray.origin, ray.t_max), directions.emplace_back(ray.direction, 0.0f);
    const int columns = kBatchWidth, rows = static_cast<int>(rays.size()) / kBatchWidth + 1;
    origins.resize(static_cast<std::size_t>(columns * rows)), directions.resize(origins.size());
    const GlTexture from(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, columns, rows, origins.data());
    const GlTexture along(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, columns, rows, directions.data());
    const GlTexture geometry = upload_image(context, *image);
    const AddedPatches added(context, slices_of(*image, 0));
    const HitTargets targets(context, kPassTargets - 1);
    const GlProgram program(context, link_program(context, probe_vertex_shader(), probe_fragment_shader(variant)));
    const GlFunctions& gl = context.use();
    program.use();
    set_pass(program, pass_constants(*image), {image->scale_exponent, 0, static_cast<int>(image->primitive_count), 0});
    geometry.bind(0), from.bind(1), along.bind(2);
    program.set("u_ray_origins", 1), program.set("u_ray_directions", 2);
    for (int i = 0; i < kPassTargets; ++i) program.set(("u_state_" + std::to_string(i)).c_str(), 3 + i);
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer.name());
    program.draw(columns, rows);
    std::vector<PassWords> words(origins.size());
    gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl.ReadPixels(0, 0, columns, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words.data());
    context.check("reading states");
    std::size_t unfinished = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if ((words[i].x & 7u) != kWordUnfinished) continue;
      ++unfinished;
      if (words[i].x >> 3 > image->primitive_count)
        return "ray " + std::to_string(i) + " waits for a primitive that is not there";
    }
    return unfinished > rays.size() / 10 ? std::string() : "hardly any walk is left unfinished";
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> ray_walk_oracles(GlContext& context) {
  using S = MutationScene;
  const auto with = [](Layout layout, Bounds bounds, TransformOut out = TransformOut::restore) {
    BakeOptions options;
    options.layout = layout, options.bounds = bounds, options.transform_out = out;
    options.width = 32;
    return options;
  };
  const BakeOptions compact = with(Layout::compact, Bounds::sphere), paper = with(Layout::paper, Bounds::sphere),
                    drift = with(Layout::compact, Bounds::sphere, TransformOut::inverse);
  const RayQuery nearest = RayQuery::nearest, any = RayQuery::any;
  std::vector<MutationOracle> oracles;
  for (const Asked& a : {Asked{S::mixed, compact, 1, nearest},
                         Asked{S::mixed, compact, 1, any},
                         Asked{S::mixed, paper, 1, any},
                         Asked{S::nested, compact, 1, nearest},
                         Asked{S::nested, compact, 1, any},
                         Asked{S::nested, paper, 1, any},
                         Asked{S::nested, drift, 1, nearest},
                         Asked{S::mixed, compact, 2, nearest},
                         Asked{S::mixed, compact, 2, any},
                         Asked{S::mixed, compact, 3, nearest},
                         Asked{S::mixed, compact, 4, nearest},
                         Asked{S::mixed, compact, 4, any},
                         Asked{S::nested, compact, 2, nearest},
                         Asked{S::nested, compact, 2, any},
                         Asked{S::nested, compact, 4, nearest},
                         Asked{S::nested, compact, 3, any},
                         Asked{S::mixed, compact, 1, any, true},
                         Asked{S::mixed, paper, 1, any, true},
                         Asked{S::mixed, compact, 2, any, true},
                         Asked{S::nested, compact, 4, any, true},
                         Asked{S::mixed, compact, 3, nearest, true},
                         Asked{S::nested, compact, 4, nearest, true},
                         Asked{S::nested, compact, 2, nearest, true},
                         Asked{S::mixed, compact, 1, nearest, true, true},
                         Asked{S::nested, paper, 1, nearest, true, true},
                         Asked{S::mixed, paper, 1, any, true, true},
                         Asked{S::slats, compact, 1, nearest},
                         Asked{S::slats, compact, 1, any},
                         Asked{S::slats, compact, 2, nearest},
                         Asked{S::slats, compact, 3, any},
                         Asked{S::slats, compact, 3, nearest}})
    oracles.push_back(oracle_of(context, a));
  for (const RayQuery query : {nearest, any})
    for (const bool thorough : {false, true}) oracles.push_back(states(context, query, thorough));
  return oracles;
}

}  // namespace plumbline
