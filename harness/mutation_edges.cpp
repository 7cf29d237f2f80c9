// SPDX-License-Identifier: GPL-3.0-or-later
// The shading passes where SEMANTICS 6 decides between two sides and a picture never stands: made rays and hits whose
// numbers are exact in floats, and what must come of each by the text.
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "harness/mutation_oracles.h"
#include "tracer/pass.h"
#include "tracer/random_numbers.h"
#include "tracer/render_passes.h"
#include "tracer/shader_words.h"
#include "tracer/shading_image.h"

namespace plumbline {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// Triangles before those of the edges, so that texels fill more than a row where they stand in rows.
constexpr std::uint32_t kFirst = 600, kEdgeTriangles = 10;
static_assert(kShadingTriangleTexels * kFirst > kShadingWidth);

/// What the passes write of one item.
struct Written {
  std::array<glm::vec4, 3> light;
  std::array<glm::vec4, 4> scatter;
  std::array<glm::vec4, 2> channels;
  glm::vec4 sum;
};

/// One ray, what it is said to have hit, and what must come of it.
using Holds = bool (*)(const Written&);
struct Edge {
  const char* what;  ///< SEMANTICS 6
  Ray ray;
  std::uint32_t kind, triangle;
  glm::vec3 position;
  float t;
  Holds holds;
};
Edge hit(const char* what, const Ray& ray, std::uint32_t triangle, const glm::vec3& position, Holds holds,
         float t = 2.0f) {
  return {what, ray, kWordHit, triangle, position, t, holds};
}
Edge none(const char* what, const Ray& ray, Holds holds, std::uint32_t kind = kWordMiss) {
  return {what, ray, kind, 0, glm::vec3(0.0f), 0.0f, holds};
}

bool is_asked(const Written& w) { return glm::vec3(w.light[1]) != glm::vec3(0.0f); }
bool on_ground(const Written& w) { return w.channels[1].x == kFirst + kEdgeTriangles; }
bool is_added(const Written& w) { return glm::vec3(w.sum) == glm::vec3(0.75f); }

/// d of the ray below, n of the triangle that it hits, from a medium of index 1 into one of 1/2.
constexpr glm::vec3 kSlanted{0.96f, 0.0f, -0.28f}, kTilted{-0.8f, 0.0f, 0.6f};
bool is_refracted_downwards(const glm::dvec3& told) {
  const glm::dvec3 d(kSlanted), n(kTilted);
  const double eta = 2.0, c = -glm::dot(d, n), k = 1.0 - eta * eta * (1.0 - c * c);
  glm::dvec3 r = eta * d + (eta * c - std::sqrt(k)) * n;
  r.z = -r.z;  // it points up
  // k is off by 30 u and its root by 22 u, the others by less than 10 u.
  return r.z < -0.1 && glm::length(told - glm::normalize(r)) <= 64.0 * 0x1p-24;
}

/// Triangles in the plane z = 0, seen from above: plain; with normals in that plane; shining, with such normals; glass;
/// air; thinner than air, with tilted normals; bumped, where u hardly grows; painted; with normals that cancel; bumped,
/// with normals in that plane. Before them others, which nobody hits. A light at (0, 0, 4). The round ground, of radius
/// 1, stands at z = -8.
Scene plane(float ground_radius, float ground_x) {
  Scene scene;
  scene.name = "edges";
  scene.materials.resize(7);
  Material &shining = scene.materials[1], &glass = scene.materials[2], &air = scene.materials[3],
           &thin = scene.materials[4], &bumped = scene.materials[5], &painted = scene.materials[6];
  shining.diffuse = 0.0f, shining.specular = 1.0f, shining.shine = 0.0f, shining.glossy = 1.0f;
  glass.specular = 1.0f, glass.transmittance = 1.0f, glass.refraction_index = 2.0f;
  air.transmittance = 1.0f, air.refraction_index = 1.0f;
  thin.transmittance = 1.0f, thin.refraction_index = 0.5f;
  bumped.bump_texture = 1, bumped.bump_scale = 1e6f;
  painted.diffuse_texture = 2;
  scene.textures = {
      {"", 80, 60, std::vector<glm::vec3>(4800)},
      {"", 1, 3, {glm::vec3(0.0f), glm::vec3(0.25f), glm::vec3(1.0f)}},
      {"", 2, 2, {glm::vec3(1.0f, 0.5f, 0.25f), glm::vec3(0.0f), glm::vec3(0.5f, 0.25f, 0.125f), glm::vec3(0.0f)}}};
  scene.texcoords = {{0.0f, 0.0f}, {0x1p-123f, 0.0f}, {0.0f, 1.0f}, {1.0f, 0.0f}};
  scene.positions = {{-8.0f, -8.0f, 0.0f}, {8.0f, -8.0f, 0.0f}, {0.0f, 8.0f, 0.0f}};
  scene.normals = {{1.0f, 0.0f, 0.0f}, kTilted, {-1.0f, 0.0f, 0.0f}};
  scene.triangles.resize(kFirst);
  for (Triangle& t : scene.triangles) t.position = {0, 1, 2};
  for (const std::uint32_t material : {0u, 0u, 1u, 2u, 3u, 4u, 5u, 6u, 0u, 5u}) {
    Triangle& t = scene.triangles.emplace_back();
    t.position = {0, 1, 2};
    t.material = material;
    const bool has_normals = scene.triangles.size() == kFirst + 2 || material == 1;
    if (has_normals) t.normal = {0, 0, 0};
    if (material == 4) t.normal = {1, 1, 1};
    if (material == 5) t.texcoord = {0, 1, 2};
    if (material == 6) t.texcoord = {0, 3, 2};
    if (scene.triangles.size() == kFirst + 9) t.normal = {0, 0, 2};
    if (scene.triangles.size() == kFirst + 10) t.normal = {0, 0, 0}, t.texcoord = {0, 3, 2};
  }
  scene.lights = {{{0.0f, 0.0f, 4.0f}, glm::vec3(1.0f), true, 0.0f}};
  scene.background = glm::vec3(0.25f);
  scene.ground.normal = {0.0f, 0.0f, 1.0f};
  scene.ground.u_axis = {1.0f, 0.0f, 0.0f}, scene.ground.v_axis = {0.0f, 1.0f, 0.0f};
  scene.ground.center = {ground_x, 0.0f, -8.0f};
  scene.ground.radius = ground_radius;
  return scene;
}

std::vector<Edge> edges() {
  const Ray down{{0.0f, 0.0f, 2.0f}, {0.0f, 0.0f, -1.0f}, kInfinite},
      level{{-2.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, kInfinite}, slanted{-2.0f * kSlanted, kSlanted, kInfinite};
  // l of the light from (-3, 0, 0), as unit() makes it of (3, 0, 4).
  const float slope = 0.75f * (1.0f / 1.25f), height = 1.0f / 1.25f;
  const Ray mirrored{{-3.6f, 0.0f, 0.8f}, {slope, 0.0f, -height}, kInfinite};
  const auto ground_ray = [](float x, float z, float dz, float t_max) {
    return Ray{{x, 0.0f, z}, {0.0f, 0.0f, dz}, t_max};
  };
  std::vector<Edge> all{
      hit("6.6: a light in the surface's plane is not asked, whatever n", down, 1, {-1.0f, 0.0f, 4.0f},
          [](const Written& w) { return !is_asked(w) && w.light[2] == glm::vec4(0.0f); }),
      hit("6.6: a light at the hit is not asked", down, 0, {0.0f, 0.0f, 4.0f},
          [](const Written& w) { return !is_asked(w) && w.light[2] == glm::vec4(0.0f); }),
      hit("6.6: a light square to n is not asked", down, 1, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return !is_asked(w); }),
      hit("6.4: a normal square to N is not turned round", down, 1, {-3.0f, 0.0f, 0.0f}, is_asked),
      hit("6.6: a shadow ray ends at the light", down, 0, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return is_asked(w) && w.light[0].w == 1.0f; }),
      hit("6.4: n stays where no float holds A of the bump map", down, 6, {0.0f, 0.0f, 0.0f}, is_asked),
      hit("6.4: n stays where it lies in the plane of Pu and Pv", down, 9, {-3.0f, 0.0f, 0.0f}, is_asked),
      hit("6.4: C is the texture's", down, 7, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return glm::vec3(w.light[2]) == glm::vec3(0.75f, 0.375f, 0.1875f); }),
      hit("6.4: n is N where the normals cancel", down, 8, {0.0f, 0.0f, 0.0f}, is_asked),
      hit("6.7: what leaves is of unit length, along x", Ray{{-2.0f, 0.0f, 0.0f}, {1e30f, 0.0f, 0.0f}, kInfinite}, 3,
          {0.0f, 0.0f, 0.0f}, [](const Written& w) { return glm::vec3(w.scatter[1]) == glm::vec3(1.0f, 0.0f, 0.0f); }),
      hit("6.7: what leaves is of unit length, along y", Ray{{0.0f, -2.0f, 0.0f}, {0.0f, 1e30f, 0.0f}, kInfinite}, 3,
          {0.0f, 0.0f, 0.0f}, [](const Written& w) { return glm::vec3(w.scatter[1]) == glm::vec3(0.0f, 1.0f, 0.0f); }),
      hit("6.6: a highlight where n.h is 0 is dark, for shine 0 too", mirrored, 2, {-3.0f, 0.0f, 0.0f},
          [](const Written& w) { return is_asked(w) && w.light[2] == glm::vec4(0.0f); }),
      hit("6.7: n stays where n and its perturbation cancel", mirrored, 2, {-3.0f, 0.0f, 0.0f},
          [](const Written& w) { return w.scatter[1].x < -0.5f && w.scatter[1].z > 0.5f; }),
      hit("6.7: a ray along the surface enters", level, 3, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return w.scatter[2].z < 0.0f && w.scatter[3].z < -0.5f; }),
      hit("6.4: n_g is N for a ray along the surface", level, 3, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return w.scatter[0].z > 0.0f; }),
      hit("6.7: k = 0 is no total reflection", level, 4, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return w.scatter[2].z < 0.0f; }),
      hit("6.7: what would be refracted upwards is mirrored at the surface", slanted, 5, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return is_refracted_downwards(glm::dvec3(w.scatter[3])); }),
      none("6.8: the ground's rim is hit", ground_ray(1.0f, 0.0f, -1.0f, kInfinite), on_ground),
      none("6.8: the ground is hit at t_max", ground_ray(0.0f, 0.0f, -1.0f, 8.0f),
           [](const Written& w) { return on_ground(w) && w.channels[0].w == 8.0f && !is_added(w); }),
      none("6.8: the ground is not hit beyond t_max", ground_ray(0.0f, 0.0f, -1.0f, 7.5f),
           [](const Written& w) { return !on_ground(w) && is_added(w); }),
      none("6.8: the ground is hit from below along N", ground_ray(0.0f, -9.0f, 1.0f, kInfinite),
           [](const Written& w) { return on_ground(w) && !is_added(w); }),
      none("6.8: the ground is hit near the start", ground_ray(0.0f, -7.75f, -1.0f, kInfinite),
           [](const Written& w) { return on_ground(w) && w.channels[0].w == 0.25f && !is_added(w); }),
      none("6.8: the ground is not hit where the ray starts", ground_ray(0.0f, -8.0f, -1.0f, kInfinite),
           [](const Written& w) { return !on_ground(w) && is_added(w); }),
      hit(
          "6.8: a primitive at the same t stands before the ground", ground_ray(0.0f, 0.0f, -1.0f, kInfinite), 3,
          {0.0f, 0.0f, -8.0f},
          [](const Written& w) { return w.channels[1].x == kFirst + 3 && glm::vec3(w.scatter[3]) != glm::vec3(0.0f); },
          8.0f),
      hit("6.6: what is hit is in shadow", down, 0, {0.0f, 0.0f, 0.0f},
          [](const Written& w) { return glm::vec3(w.sum) == glm::vec3(0.5f) && w.sum.w == 3.0f; }),
      none("6.1: a ray that hits nothing brings the background", ground_ray(4.0f, 0.0f, 1.0f, kInfinite),
           [](const Written& w) { return w.light[2] == glm::vec4(0.25f, 0.25f, 0.25f, 0.0f) && w.sum.w == 3.0f; }),
      none(
          "a walk without an end is told, and is no hit of the ground", ground_ray(0.0f, 0.0f, -1.0f, kInfinite),
          [](const Written& w) { return w.light[2].w > 0.0f && w.sum.w == 4.0f && !is_asked(w) && !on_ground(w); },
          kWordCapped),
      none(
          "an undefined ray is a miss", ground_ray(4.0f, 0.0f, 1.0f, kInfinite),
          [](const Written& w) { return w.light[2].w == 0.0f && w.sum.w == 3.0f && is_added(w); }, kWordUndefined),
      none(
          "what is no ray brings nothing", Ray{glm::vec3(0.0f), glm::vec3(0.0f), 0.0f},
          [](const Written& w) { return w.light[2] == glm::vec4(0.0f); }, kWordCapped),
  };
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 there(0.1f, 0.2f, -8.0f),
        afar = glm::vec3(1000.0f, 2000.0f, 3000.0f) + 37.0f * static_cast<float>(i);
    all.push_back(none("6.4: a hit of the ground lies in its plane, from however far",
                       {afar, glm::normalize(there - afar), kInfinite}, [](const Written& w) {
                         const float above = w.light[0].z + 8.0f, delta = 0x1p-17f * 8.0f;
                         return on_ground(w) && above > 0.9f * delta && above < 1.1f * delta;
                       }));
  }
  return all;
}

std::vector<Edge> edges_without_ground() {
  return {none("6.8: a radius of 0 is no ground", {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, kInfinite},
               [](const Written& w) { return !on_ground(w) && is_added(w); })};
}

std::vector<Edge> edges_far_aside() {
  return {none("6.5: how far along the ground a hit is, is no matter",
               {{64.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, kInfinite}, [](const Written& w) {
                 const float above = w.light[0].z + 8.0f, delta = 0x1p-17f * 8.0f;
                 return on_ground(w) && above > 0.9f * delta && above < 1.1f * delta;
               })};
}

constexpr std::array<RenderPass, 4> kPasses{RenderPass::light, RenderPass::scatter, RenderPass::channels,
                                            RenderPass::add_light};

ShaderText shader_of(RenderPass pass, GlslDialect dialect) {
  ShadingVariant variant;
  variant.has_triangles = true;
  variant.random = RandomKind::texture;
  variant.primitive_count = kFirst + kEdgeTriangles;
  variant.has_textures = true;
  return render_shader(pass, variant, PassTap::none, {}, dialect);
}

/// Draws all passes over the edges, side by side in one row.
std::vector<Written> drawn(GlContext& context, const Scene& scene, const std::vector<Edge>& edges,
                           GlslDialect dialect) {
  const int count = static_cast<int>(edges.size());
  std::array<std::vector<glm::vec4>, 2> rays;
  std::array<std::vector<glm::uvec4>, 3> hits;
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  for (const Edge& e : edges) {
    rays[0].emplace_back(e.ray.origin, e.ray.t_max), rays[1].emplace_back(e.ray.direction, 1.0f);
    const glm::vec3& p = e.position;
    hits[0].emplace_back(e.kind + 8 * (kFirst + e.triangle), bits(e.t), 0, 0);
    hits[1].emplace_back(bits(p.x), bits(p.y), bits(p.z), bits(0.25f));
    hits[2].emplace_back(0, 0, bits(1.0f), bits(0.5f));
  }
  const auto floats = [&](const std::vector<glm::vec4>& texels) {
    return GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, static_cast<int>(texels.size()), 1, texels.data());
  };
  std::vector<GlTexture> inputs;  // unit i
  ShadingImage shading = shading_image(scene);
  const Light& light = scene.lights[0];
  // A line of texels, or where there are no buffer textures rows of this width.
  const auto lined_up = [&](std::vector<glm::vec4> texels, int width) {
    if (dialect == GlslDialect::glsl_330) return GlTexture::linear(context, texels);
    const int rows = (static_cast<int>(texels.size()) + width - 1) / width;
    texels.resize(static_cast<std::size_t>(rows * width));
    return GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, width, rows, texels.data());
  };
  constexpr int kWidth = 4, kLights = 5;  // of the geometry image, which holds the lights alone
  std::vector<glm::vec4> geometry(kLights);
  geometry.emplace_back(light.position, light.radius), geometry.emplace_back(light.color, light.has_color);
  inputs.push_back(lined_up(geometry, kWidth));
  inputs.push_back(floats(rays[0])), inputs.push_back(floats(rays[1]));
  for (const auto& words : hits)
    inputs.emplace_back(context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, count, 1, words.data());
  inputs.push_back(lined_up(shading.texels, kShadingWidth));
  inputs.push_back(lined_up(shading.texture_texels, kShadingWidth));
  inputs.push_back(floats({glm::vec4(0.0f, 0.5f, 0.5f, 0.0f)}));  // a noise that is (-1, 0, 0)
  const std::vector<glm::vec4> sums(edges.size(), {0.5f, 0.5f, 0.5f, 1.0f}),
      brought(edges.size(), {0.25f, 0.25f, 0.25f, 2.0f});
  inputs.push_back(floats(brought)), inputs.push_back(floats(sums));
  static constexpr std::array<const char*, 11> kNames{
      "u_geometry", "u_ray_origins", "u_ray_directions", "u_hit_0",   "u_hit_1", "u_hit_2",
      "u_shading",  "u_textures",    "u_noise",          "u_brought", "u_sum"};
  std::vector<Written> written(edges.size());
  const GlFunctions& gl = context.use();
  for (const RenderPass pass : kPasses) {
    std::array<GlTexture, 4> targets;
    const int outputs = pass == RenderPass::light      ? 3
                        : pass == RenderPass::scatter  ? 4
                        : pass == RenderPass::channels ? 2
                                                       : 1;
    for (int i = 0; i < outputs; ++i)
      targets[static_cast<std::size_t>(i)] = GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, count, 1);
    const GlFramebuffer framebuffer(context, targets.data(), outputs);
    const GlProgram program(context, link_program(context, probe_vertex_shader(dialect), shader_of(pass, dialect)));
    program.use();
    PassConstants constants;
    constants.shape = {kWidth - 1, 2, 0, 0};
    set_pass(program, constants, {});
    for (std::size_t unit = 0; unit < inputs.size(); ++unit) {
      inputs[unit].bind(static_cast<int>(unit));
      program.set(kNames[unit], static_cast<int>(unit));
    }
    program.set("u_random", random_uniform(0, 1, 0));
    program.set("u_tile", glm::ivec4(0, 0, 1, 1));
    program.set("u_sample", glm::ivec4(0, 1, 0, count));
    const auto at = [](std::uint32_t i) { return static_cast<int>(i); };
    program.set("u_starts", glm::ivec4(at(shading.material_start), at(shading.texture_start),
                                       at(shading.triangle_start), at(shading.sphere_start)));
    program.set("u_scene", glm::ivec4(at(shading.instance_start), at(scene.primitive_count()), kLights, 1));
    program.set("u_effects", glm::vec4(0.0f, 0.0f, 1.0f, 0.0f));
    program.set("u_background", glm::vec4(scene.background, 0.0f));
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    program.draw(count, 1);
    for (int i = 0; i < outputs; ++i) {
      std::vector<glm::vec4> texels(edges.size());
      gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
      gl.ReadPixels(0, 0, count, 1, GL_RGBA, GL_FLOAT, texels.data());
      const auto k = static_cast<std::size_t>(i);
      for (std::size_t e = 0; e < edges.size(); ++e)
        (pass == RenderPass::light      ? written[e].light[k]
         : pass == RenderPass::scatter  ? written[e].scatter[k]
         : pass == RenderPass::channels ? written[e].channels[k]
                                        : written[e].sum) = texels[e];
    }
  }
  context.check("drawing the edges of shading");
  return written;
}

}  // namespace

std::vector<MutationOracle> edge_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  struct Asked {
    const char* name;
    float ground_radius, ground_x;
    std::vector<Edge> edges;
    GlslDialect dialect = GlslDialect::glsl_330;
  };
  for (const Asked& asked :
       {Asked{"edges.shading", 1.0f, 0.0f, edges()}, Asked{"edges.no_ground", 0.0f, 0.0f, edges_without_ground()},
        Asked{"edges.far_aside", 1.0f, 64.0f, edges_far_aside()},
        Asked{"edges.es", 1.0f, 0.0f, edges(), GlslDialect::es_300}}) {
    MutationOracle& oracle = oracles.emplace_back();
    oracle.name = asked.name;
    for (const RenderPass pass : kPasses) oracle.programs.push_back(active_lines(shader_of(pass, asked.dialect)));
    oracle.ask = [&context, dialect = asked.dialect, scene = plane(asked.ground_radius, asked.ground_x),
                  all = asked.edges](const Mutant&) -> std::string {
      const std::vector<Written> written = drawn(context, scene, all, dialect);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (!all[i].holds(written[i])) return std::string("not so: ") + all[i].what;
      return {};
    };
  }
  return oracles;
}

}  // namespace plumbline
