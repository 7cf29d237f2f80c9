// SPDX-License-Identifier: GPL-3.0-or-later
// What is around the walks: the dialect of GLSL ES, where texels have two coordinates; the pixels that a pass covers,
// and those beyond; and the counts of what is left to do.
#include <algorithm>
#include <array>
#include <bit>

#include "harness/hit_cases.h"
#include "harness/mutation_oracles.h"
#include "harness/mutation_scenes.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "tracer/embedded_shaders.h"
#include "tracer/pass.h"
#include "tracer/probe.h"
#include "tracer/ray_targets.h"
#include "tracer/render_passes.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants of passes");

/// Rays that end in a first pass, walked by the program that GLSL ES 3.00 has.
MutationOracle es_walk(GlContext& context) {
  const MutationStage& stage = mutation_stage(context, MutationScene::mixed);
  BakeOptions options;
  options.width = 32;  // many rows
  auto image = std::make_shared<const GeometryImage>(bake(stage.stage.scene, options));
  const ShaderText shader = probe_fragment_shader(program_variant(*image, false, false), {}, GlslDialect::es_300);
  const MutationRays& rays = stage.plain;
  MutationOracle oracle;
  oracle.name = "es.mixed";
  oracle.programs = {active_lines(shader), active_lines(probe_vertex_shader(GlslDialect::es_300))};
  oracle.ask = [&context, &stage, &rays, image, shader](const Mutant&) -> std::string {
    const int rows = static_cast<int>(rays.rays.size()) / kBatchWidth + 1;
    std::vector<glm::vec4> texels;
    for (const Ray& ray : rays.rays) {
      texels.emplace_back(ray.origin, ray.t_max);
      texels.emplace_back(ray.direction, 0.0f);
    }
    texels.resize(std::size_t{2} * kBatchWidth * static_cast<std::size_t>(rows), glm::vec4(0.0f));
    const GlTexture of_rays(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, 2 * kBatchWidth, rows, texels.data());
    const GlTexture geometry(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, image->width, image->height, image->texels.data());
    constexpr int kTargets = kPassTargets - 1;
    std::array<GlTexture, kTargets> targets;
    for (GlTexture& target : targets)
      target = GlTexture(context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kBatchWidth, rows);
    const GlFramebuffer framebuffer(context, targets.data(), kTargets);
    const GlProgram program(context, link_program(context, probe_vertex_shader(GlslDialect::es_300), shader));
    const GlFunctions& gl = context.use();
    geometry.bind(kGeometryUnit);
    of_rays.bind(kRayUnit);
    program.use();
    set_pass(program, pass_constants(*image), {image->scale_exponent, 0, static_cast<int>(image->primitive_count), 0});
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    program.draw(kBatchWidth, rows);
    std::array<std::vector<PassWords>, kTargets> words;
    for (int i = 0; i < kTargets; ++i) {
      words[static_cast<std::size_t>(i)].resize(static_cast<std::size_t>(kBatchWidth * rows));
      gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
      gl.ReadPixels(0, 0, kBatchWidth, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                    words[static_cast<std::size_t>(i)].data());
    }
    context.check("walking in GLSL ES");
    // Without `precise` sums round in another way: of rays at a border others wait for a second pass, one of 1,067.
    std::size_t waiting = 0;
    for (std::size_t i = 0; i < rays.rays.size(); ++i) {
      if ((words[0][i].x & 7u) == kWordUnfinished) {
        ++waiting;
        continue;
      }
      const Hit hit = unpack_hit(words[0][i], words[1][i], words[2][i], nullptr);
      const Judgement j = judge(stage.stage.judge, rays.rays[i], hit, rays.truth[i]);
      if (is_failure(j.verdict)) return "ray " + std::to_string(i) + ": " + j.reason;
    }
    return waiting > rays.rays.size() / 200 ? std::to_string(waiting) + " rays wait for another pass" : std::string();
  };
  return oracle;
}

/// The pixels that a query counts, of a picture of which C++ knows them; first of all pixels, which a pass must cover.
MutationOracle counts(GlContext& context, bool of_rays) {
  constexpr int kWidth = 300, kHeight = 170;
  std::vector<glm::vec4> directions;
  std::vector<glm::uvec4> words;
  std::uint32_t count = 0;
  for (std::uint64_t i = 0; i < kWidth * kHeight; ++i) {
    Random random(kSeed, 1, i);
    // Directions with one component; kinds below flags.
    const std::uint32_t which = random.below(5);
    glm::vec4 direction(0.0f, 0.0f, 0.0f, 1.0f);
    if (which < 3) direction[static_cast<int>(which)] = -1.0f;
    const std::uint32_t kind = random.below(5), primitive = random.below(1u << 24);
    directions.push_back(direction);
    words.emplace_back(kind + 8 * primitive, kWordUnfinished, kWordUnfinished, kWordUnfinished);
    count += of_rays ? which < 3 : kind == kWordUnfinished;
  }
  // As the renderer and the walk compose them.
  const std::array<std::string_view, 1> files{"count.frag.glsl"};
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"COUNT_UNFINISHED", ""},
                                            ShaderDefine{"KIND_UNFINISHED", std::to_string(kWordUnfinished) + "u"}};
  const ShaderText shader = of_rays ? render_shader(RenderPass::count_rays, {}) : compose_shader(files, defines);
  MutationOracle oracle;
  oracle.name = of_rays ? "count.rays" : "count.unfinished";
  oracle.programs = {active_lines(shader), active_lines(probe_vertex_shader())};
  oracle.ask = [&context, shader, of_rays, directions, words, count](const Mutant&) -> std::string {
    for (const bool is_full : {true, false}) {
      std::vector<glm::vec4> rays = directions;
      std::vector<glm::uvec4> hits = words;
      if (is_full) {
        std::fill(rays.begin(), rays.end(), glm::vec4(1.0f));
        std::fill(hits.begin(), hits.end(), glm::uvec4(kWordUnfinished));
      }
      const GlTexture texture =
          of_rays ? GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, kWidth, kHeight, rays.data())
                  : GlTexture(context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kWidth, kHeight, hits.data());
      const GlTexture target(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, kWidth, kHeight);
      const GlFramebuffer framebuffer(context, &target, 1);
      const GlProgram program(context, link_program(context, probe_vertex_shader(), shader));
      const GlSampleCount query(context);
      program.use();
      program.set(of_rays ? "u_ray_directions" : "u_hit_0", 0);
      texture.bind(0);
      context.use().BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
      query.begin();
      program.draw(kWidth, kHeight);
      const std::uint32_t got = query.end(), wanted = is_full ? kWidth * kHeight : count;
      if (got != wanted) return std::to_string(got) + " pixels are counted, not " + std::to_string(wanted);
    }
    return {};
  };
  return oracle;
}

/// Pixels beyond the rows of a pass, of which the driver shades whole blocks, do not walk from what stands there. (As
/// transform_test.cpp tells: else rays beside them lose the loops by which they leave their instances.)
MutationOracle beyond(GlContext& context) {
  auto scene = std::make_shared<const Scene>(load_scene("crowd"));
  auto image = std::make_shared<const GeometryImage>(bake(*scene));
  std::vector<Ray> rays, many;  // from so far away that another pass brings them near; others beyond their rows
  for (std::uint32_t i = 0; i < 64; ++i) {
    const glm::vec3 target = scene->nodes[i * 150].transform.translation + glm::vec3(0.0f, 0.1f, 0.0f);
    rays.push_back({target + glm::vec3(0.0f, 1e8f, 0.0f), glm::vec3(0.0f, -1.0f, 0.0f)});
  }
  for (std::size_t i = 0; i < std::size_t{kBatchWidth} * 8; ++i)
    many.push_back({rays[i % 64].origin * glm::vec3(1, 1e-7f, 1), rays[0].direction});
  auto known = std::make_shared<std::vector<Hit>>(rays.size());
  Probe(context, *image, Traversal::brute_force).trace(rays, *known);
  MutationOracle oracle;
  oracle.name = "beyond.crowd";
  const ShaderText shader = probe_fragment_shader(program_variant(*image, false, false));
  std::vector<bool>& lines = oracle.programs.emplace_back()["ray_start.glsl"];
  lines = active_lines(shader).at("ray_start.glsl");
  // Of the line that holds pixel_of_pass() alone: it is a large scene.
  for (const EmbeddedShader& file : embedded_shaders()) {
    if (file.name != "ray_start.glsl") continue;
    const std::string_view before = file.text.substr(0, file.text.find("ivec2 pixel_of_pass()"));
    const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i] = lines[i] && i == line;
  }
  oracle.ask = [&context, image, rays, many, known](const Mutant&) -> std::string {
    Probe probe(context, *image);
    std::vector<Hit> hits(rays.size()), of_many(many.size());
    probe.trace(rays, hits);
    const GlFunctions& gl = context.use();
    gl.ActiveTexture(GL_TEXTURE0 + kStateUnit);
    const glm::uvec4 unfinished(kWordUnfinished, 0x7f800000u, 0u, 0u), nowhere(0x7ffffff0u, 0u, ~0u, 0u);
    const glm::uvec4 no_hit(std::bit_cast<std::uint32_t>(static_cast<float>(kNoLabel)), 0u, 0u, 0u);
    const glm::uvec4 world(0u, 0u, ~0u, 0u);
    std::vector<glm::uvec4> states;
    for (int i = 0; i < kBatchWidth * (kBatchHeight - 1); ++i)
      states.insert(states.end(), {unfinished, nowhere, no_hit, world});
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 1, kPassTargets * kBatchWidth, kBatchHeight - 1, GL_RGBA_INTEGER,
                     GL_UNSIGNED_INT, states.data());
    probe.trace(many, of_many);
    probe.trace(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (!same_bits(hits[i], (*known)[i])) return "ray " + std::to_string(i) + " " + describe(hits[i]);
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> pass_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  oracles.push_back(counts(context, true));
  oracles.push_back(counts(context, false));
  oracles.push_back(es_walk(context));
  oracles.push_back(beyond(context));
  return oracles;
}

}  // namespace plumbline
