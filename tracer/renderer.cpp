// SPDX-License-Identifier: MIT
#include "tracer/renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "scenes/camera.h"
#include "scenes/error.h"
#include "tracer/accumulator.h"
#include "tracer/bake.h"
#include "tracer/random_numbers.h"
#include "tracer/ray_walk.h"
#include "tracer/render_passes.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kDeepestBounce = 5;  // SEMANTICS 6.1: rays are numbered to 63

// Texture units of passes that shade.
enum ShadingUnit { kHitUnit = 3, kShadingUnit = 7, kTextureUnit, kBroughtUnit, kSumUnit, kNoiseUnit };

RenderSettings completed(const Scene& scene, RenderSettings settings) {
  complete_picture_request(scene.camera, settings.width, settings.height, settings.first_frame, settings.frames,
                           settings.time);
  if (settings.bundle.rays < 1 || settings.bundle.rays > kMostBundled)
    throw InputError("bundles have 1 to " + std::to_string(kMostBundled) + " rays");
  if (!settings.effects) settings.effects = scene.effects;
  settings.effects->depth = std::min(settings.effects->depth, kDeepestBounce);
  return settings;
}

Scene lit(Scene scene, const RenderSettings& settings, bool& by_default) {
  scene.camera.width = settings.width;
  scene.camera.height = settings.height;
  by_default = scene.lights.empty();
  if (by_default) scene.lights.push_back(default_light(scene.camera));
  if (!scene.animation.empty()) set_time(scene, settings.time);
  return scene;
}

bool moves_in(const Scene& scene, const Effects& effects) {
  return effects.motion_blur && scene.camera.shutter_open != scene.camera.shutter_close && !scene.animation.empty();
}

/// Texels as a buffer texture, which then are the driver's alone.
GlTexture uploaded(GlContext& context, std::vector<glm::vec4>& texels, const std::string& what,
                   const std::string& instead) {
  require_fitting_texels(context, texels.size(), what, instead);
  GlTexture texture = GlTexture::linear(context, texels);
  texels = {};
  return texture;
}

/// Cuts a side into equal parts of at most `most`.
int part_of(int side, int most) {
  const int parts = (side + most - 1) / most;
  return (side + parts - 1) / parts;
}

}  // namespace

const char* name_of(RandomKind kind) {
  return kind == RandomKind::hash ? "hash" : kind == RandomKind::md5 ? "md5" : "texture";
}

glm::uvec2 TappedBatch::pixel(std::size_t item) const {
  const int x = static_cast<int>(item) % columns, y = static_cast<int>(item) / columns;
  return {static_cast<unsigned>(tile_x + x / lanes), static_cast<unsigned>(tile_y + y % tile_height)};
}
std::uint32_t TappedBatch::frame(std::size_t item) const {
  const int x = static_cast<int>(item) % columns, y = static_cast<int>(item) / columns;
  return first_frame + static_cast<std::uint32_t>(y / tile_height * lanes + x % lanes);
}

struct Renderer::Impl {
  GlContext* context;
  bool by_default = false;
  RenderSettings settings;
  Scene scene;
  bool moves;
  SceneTree tree;
  GeometryImage image;
  ShadingImage shading;
  ShadingVariant variant;
  CameraFrame camera;
  RayWalk walk;
  GlTexture shading_texture, texture_texture;
  FloatTargets<2> primary;
  std::array<FloatTargets<4>, kDeepestBounce + 1> children;  // by bounce: reflected, refracted
  FloatTargets<3> shadow;
  std::array<FloatTargets<1>, 2> sums;
  int sum_now = 0;
  FloatTargets<1> counted;
  FloatTargets<2> told;  // channels
  GlSampleCount count;
  std::vector<std::pair<std::pair<RenderPass, PassTap>, GlProgram>> programs;
  std::unique_ptr<NoiseImage> noise;
  Accumulator accumulator;
  double time_now;
  bool reflects = false, refracts = false;
  RenderTap* tap = nullptr;
  FloatTargets<3> tapped;
  std::uint64_t rays_traced = 0, passes = 0;
  WalkSeconds walked;
  RenderBatch batch;

  Impl(GlContext& c, const Scene& given, const RenderSettings& asked)
      : context(&c),
        settings(completed(given, asked)),
        scene(lit(given, settings, by_default)),
        moves(moves_in(scene, *settings.effects)),
        tree(build_scene_tree(scene, settings.bake.tree, settings.bake.transform_list == TransformList::root)),
        image(bake(scene, tree, settings.bake)),
        shading(shading_image(scene)),
        camera(camera_frame(scene.camera)),
        walk(c, image, moves ? 1 : settings.bundle.rays, settings.patches),
        shading_texture(uploaded(c, shading.texels, "what shading needs of " + scene.name, "use less geometry")),
        texture_texture(uploaded(c, shading.texture_texels, "the textures of " + scene.name, "use smaller ones")),
        primary(c),
        shadow(c),
        sums{FloatTargets<1>(c), FloatTargets<1>(c)},
        counted(c),
        told(c),
        count(c),
        accumulator(c, settings.width, settings.height, settings.patches),
        time_now(settings.time) {
    if (moves) settings.bundle = {};
    const Effects& effects = *settings.effects;
    if (effects.depth_of_field) require_lens_before_focus(scene.camera);
    const ProgramVariant of_image = program_variant(image, false, false);
    variant.has_triangles = of_image.has_triangles;
    variant.has_spheres = of_image.has_spheres;
    variant.has_transforms = of_image.has_transforms;
    variant.has_textures = !scene.textures.empty();
    variant.is_paper = image.options.layout == Layout::paper;
    variant.is_physical = effects.model == Effects::Model::physical;
    variant.random = settings.random;
    variant.primitive_count = scene.primitive_count();
    require_known_patches();
    for (const Material& material : scene.materials) {
      reflects = reflects || material.specular > 0.0f;
      refracts = refracts || material.transmittance > 0.0f;
    }
    for (std::uint32_t bounce = 1; bounce <= effects.depth && (reflects || refracts); ++bounce)
      children[bounce] = FloatTargets<4>(c);
    if (settings.random == RandomKind::texture)
      noise = std::make_unique<NoiseImage>(c, settings.seed, settings.width, settings.height,
                                           static_cast<std::uint32_t>(scene.lights.size()));
  }

  /// Throws InputError for a patch of a file that no program of this picture is composed of.
  void require_known_patches() const {
    std::vector<std::string> known;
    const auto add = [&](const ShaderText& shader) {
      known.insert(known.end(), shader.files.begin(), shader.files.end());
    };
    ProgramVariant of_walk = program_variant(image, false, false);
    add(probe_fragment_shader(of_walk));
    of_walk.bundle = settings.bundle.rays;
    add(probe_fragment_shader(of_walk));
    add(accumulate_shader());
    for (const RenderPass pass : {RenderPass::camera, RenderPass::light, RenderPass::add_light, RenderPass::scatter,
                                  RenderPass::channels, RenderPass::count_rays})
      add(render_shader(pass, variant));
    for (const ShaderPatch& patch : settings.patches)
      if (std::find(known.begin(), known.end(), patch.file) == known.end())
        throw InputError("a shader patch names tracer/shaders/" + patch.file + ", which renders nothing here");
  }

  const GlProgram& program(RenderPass pass, PassTap kind = PassTap::none) {
    for (const auto& [known, compiled] : programs)
      if (known == std::pair{pass, kind}) return compiled;
    GlProgram compiled(
        *context, link_program(*context, probe_vertex_shader(), render_shader(pass, variant, kind, settings.patches)));
    return programs.emplace_back(std::pair{pass, kind}, std::move(compiled)).second;
  }

  void draw(const GlProgram& pass, const GlFramebuffer& into) {
    const GlFunctions& gl = context->use();
    gl.BindFramebuffer(GL_FRAMEBUFFER, into.name());
    gl.Disable(GL_DITHER);
    pass.draw(batch.columns, batch.rows);
    ++passes;
  }

  /// Makes a pass's program the one in use, with all that does not depend on rays.
  const GlProgram& begin(RenderPass kind, PassTap tap_kind, std::uint32_t ray, std::uint32_t light) {
    const GlProgram& pass = program(kind, tap_kind);
    pass.use();
    set_pass(pass, walk.constants(), {walk.constants().scale_exponent, 0, 0, 0});
    walk.geometry().bind(kGeometryUnit);
    pass.set("u_tile", glm::ivec4(batch.tile_x, batch.tile_y, batch.tile_height, batch.lanes));
    pass.set("u_sample", glm::ivec4(batch.first_frame, ray, light, settings.width));
    set_random(pass);
    return pass;
  }

  void set_random(const GlProgram& pass) {
    const bool has_noise = noise && noise->is_made();
    pass.set("u_random",
             random_uniform(settings.seed, has_noise ? noise->texels() : 0u, has_noise ? noise->first_frame() : 0u));
    pass.set("u_noise", kNoiseUnit);
    if (has_noise) noise->bind(kNoiseUnit);
  }

  void set_rays(const GlProgram& pass, const RayTextures& rays, const HitTargets* hits) {
    rays.origins->bind(1);
    rays.directions->bind(2);
    pass.set("u_ray_origins", 1);
    pass.set("u_ray_directions", 2);
    static constexpr std::array<const char*, kPassTargets> kNames{"u_hit_0", "u_hit_1", "u_hit_2", "u_hit_3"};
    for (int i = 0; hits != nullptr && i < walk.hit_targets(); ++i) {
      hits->textures[static_cast<std::size_t>(i)].bind(kHitUnit + i);
      pass.set(kNames[static_cast<std::size_t>(i)], kHitUnit + i);
    }
  }

  void set_scene(const GlProgram& pass) {
    shading_texture.bind(kShadingUnit);
    texture_texture.bind(kTextureUnit);
    pass.set("u_shading", kShadingUnit);
    pass.set("u_textures", kTextureUnit);
    const auto at = [](std::uint32_t i) { return static_cast<int>(i); };
    pass.set("u_starts", glm::ivec4(at(shading.material_start), at(shading.texture_start), at(shading.triangle_start),
                                    at(shading.sphere_start)));
    const std::uint32_t record = variant.is_paper ? kTransformTexels / 2 : kTransformTexels;
    pass.set("u_scene", glm::ivec4(at(shading.instance_start), at(static_cast<std::uint32_t>(scene.triangles.size())),
                                   at(image.transform_start + record * image.transform_count),
                                   at(static_cast<std::uint32_t>(scene.lights.size()))));
    const Effects& effects = *settings.effects;
    pass.set("u_effects", glm::vec4(effects.glossy, effects.soft_shadows ? 1.0f : 0.0f,
                                    effects.glossy_reflections ? 1.0f : 0.0f, 0.0f));
    pass.set("u_background", glm::vec4(scene.background, 0.0f));
  }

  void set_camera(const GlProgram& pass, bool is_sharp) {
    const Effects& effects = *settings.effects;
    const bool has_lens = effects.depth_of_field && scene.camera.aperture > 0.0f && !is_sharp;
    pass.set("u_eye", glm::vec4(camera.from, has_lens ? scene.camera.aperture : 0.0f));
    pass.set("u_right", glm::vec4(camera.right, camera.pixel));
    pass.set("u_up", glm::vec4(camera.up, focus_distance(scene.camera)));
    pass.set("u_forward", glm::vec4(camera.forward, effects.antialias && !is_sharp ? 1.0f : 0.0f));
    pass.set("u_center", glm::vec4(camera.centre_x, camera.centre_y, 0.0, 0.0));
  }

  void make_primary_rays(bool is_sharp) {
    const GlProgram& pass = begin(RenderPass::camera, PassTap::none, 1, 0);
    set_camera(pass, is_sharp);
    draw(pass, primary.framebuffer);
  }

  static RayTextures textures_of(const FloatTargets<2>& targets) {
    return {&targets.textures[0], &targets.textures[1]};
  }

  std::uint32_t count_rays(const RayTextures& rays) {
    const GlProgram& pass = program(RenderPass::count_rays);
    pass.use();
    rays.directions->bind(2);
    pass.set("u_ray_directions", 2);
    count.begin();
    draw(pass, counted.framebuffer);
    return count.end();
  }

  void clear_sum() {
    const GlFunctions& gl = context->use();
    gl.BindFramebuffer(GL_FRAMEBUFFER, sums[0].framebuffer.name());
    const std::array<float, 4> zero{};
    gl.ClearBufferfv(GL_COLOR, 0, zero.data());
    sum_now = 0;
  }

  /// A walk ends with a question to the driver, and one comes before it (count_rays): so its time is its own.
  const HitTargets& walk_rays(const RayTextures& rays, RayQuery query, double& seconds, bool together = true) {
    ++passes;
    const auto start = std::chrono::steady_clock::now();
    const HitTargets& hits = walk.trace(rays, batch.columns, batch.rows, query, together);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return hits;
  }

  /// All that comes of rays of one number: their light, and the rays that leave where they hit.
  void follow(std::uint32_t ray, std::uint32_t bounce, const RayTextures& rays) {
    const std::uint32_t live = count_rays(rays);
    if (live == 0) return;
    rays_traced += live;
    const HitTargets& hits = walk_rays(rays, RayQuery::nearest, bounce == 0 ? walked.primary : walked.bounced);
    if (tap != nullptr) tap_rays(ray, kNone, rays, hits);
    for (std::uint32_t light = 0; light < scene.lights.size(); ++light) add_light(ray, light, rays, hits);
    if (bounce >= settings.effects->depth || (!reflects && !refracts)) return;
    const FloatTargets<4>& into = children[bounce + 1];
    draw_shading(RenderPass::scatter, PassTap::none, ray, 0, rays, hits, into.framebuffer);
    if (tap != nullptr) tap_numbers(RenderPass::scatter, ray, 0, 5, rays, hits);
    if (reflects) follow(2 * ray, bounce + 1, {&into.textures[0], &into.textures[1]});
    if (refracts) follow(2 * ray + 1, bounce + 1, {&into.textures[2], &into.textures[3]});
  }

  void draw_shading(RenderPass kind, PassTap tap_kind, std::uint32_t ray, std::uint32_t light, const RayTextures& rays,
                    const HitTargets& hits, const GlFramebuffer& into) {
    const GlProgram& pass = begin(kind, tap_kind, ray, light);
    set_scene(pass);
    set_rays(pass, rays, &hits);
    draw(pass, into);
  }

  void add_light(std::uint32_t ray, std::uint32_t light, const RayTextures& rays, const HitTargets& hits) {
    draw_shading(RenderPass::light, PassTap::none, ray, light, rays, hits, shadow.framebuffer);
    if (tap != nullptr) tap_numbers(RenderPass::light, ray, light, 8 + 3 * light, rays, hits);
    const RayTextures asking{&shadow.textures[0], &shadow.textures[1]};
    const std::uint32_t asked = count_rays(asking);
    if (asked == 0 && light > 0) return;
    rays_traced += asked;
    const HitTargets& blocked = walk_rays(asking, RayQuery::any, walked.shadow);
    if (tap != nullptr) tap_rays(ray, light, asking, blocked);
    const GlProgram& pass = begin(RenderPass::add_light, PassTap::none, ray, light);
    set_scene(pass);
    set_rays(pass, asking, &blocked);
    shadow.textures[2].bind(kBroughtUnit);
    pass.set("u_brought", kBroughtUnit);
    sums[static_cast<std::size_t>(sum_now)].textures[0].bind(kSumUnit);
    pass.set("u_sum", kSumUnit);
    sum_now = 1 - sum_now;
    draw(pass, sums[static_cast<std::size_t>(sum_now)].framebuffer);
  }

  void sample_batch() {
    clear_sum();
    make_primary_rays(false);
    if (tap != nullptr) tap_camera();
    follow(1, 0, textures_of(primary));
    const GlTexture& colors = sums[static_cast<std::size_t>(sum_now)].textures[0];
    if (tap != nullptr) tap_samples(sums[static_cast<std::size_t>(sum_now)].framebuffer);
    accumulator.add(colors, batch);
    context->check("rendering");
  }

  /// Calls `each` with the tiles of the picture in `batch`; false where it is false.
  template <class Each>
  bool over_tiles(Each each) {
    const int width = part_of(settings.width, kBatchWidth / settings.bundle.rays),
              height = part_of(settings.height, kRenderRows);
    for (int y = 0; y < settings.height; y += height)
      for (int x = 0; x < settings.width; x += width) {
        batch = {};
        batch.tile_x = x, batch.tile_y = y;
        batch.tile_width = std::min(width, settings.width - x),
        batch.tile_height = std::min(height, settings.height - y);
        if (!each()) return false;
      }
    return true;
  }

  /// Lays out as many of `count` frames as a batch holds; returns how many.
  std::uint32_t lay_out(std::uint32_t first, std::uint32_t wanted) {
    const auto bundle = static_cast<std::uint32_t>(settings.bundle.rays);
    std::uint32_t lanes = std::min(static_cast<std::uint32_t>(kBatchWidth / batch.tile_width), wanted);
    if (lanes > bundle) lanes -= lanes % bundle;
    const std::uint32_t blocks = std::min(static_cast<std::uint32_t>(kRenderRows / batch.tile_height), wanted / lanes);
    batch.lanes = static_cast<int>(lanes), batch.blocks = static_cast<int>(blocks);
    batch.first_frame = first;
    const int columns = batch.tile_width * batch.lanes, rest = columns % settings.bundle.rays;
    batch.columns = rest == 0 ? columns : columns + settings.bundle.rays - rest;
    batch.rows = batch.tile_height * batch.blocks;
    return lanes * blocks;
  }

  void go_to(double time) {
    if (time == time_now || scene.animation.empty()) return;
    const std::vector<std::uint32_t> moved = set_time(scene, time);
    const std::vector<TexelRange> changed = update_transforms(scene, moved, tree, image);
    walk.update(image, changed);
    shading_texture.update(instance_texels(scene), shading.instance_start);
    time_now = time;
  }

  double time_of(std::uint32_t frame) const {
    const auto open = static_cast<double>(scene.camera.shutter_open),
               close = static_cast<double>(scene.camera.shutter_close);
    return settings.time + open + frame_time_number(settings.seed, frame) * (close - open);
  }

  bool add_frames(std::uint32_t first, std::uint32_t wanted, const RenderProgress& progress) {
    const double all = static_cast<double>(settings.width) * settings.height * wanted;
    double done = 0.0;
    const auto tell = [&](std::uint32_t frames) {
      done += static_cast<double>(batch.tile_width) * batch.tile_height * frames;
      return !progress || progress(done / all);
    };
    if (moves || noise) return add_frame_by_frame(first, wanted, tell);
    go_to(settings.time);
    return over_tiles([&] {
      for (std::uint32_t f = 0; f < wanted;) {
        const std::uint32_t frames = lay_out(first + f, wanted - f);
        sample_batch();
        f += frames;
        if (!tell(frames)) return false;
      }
      return true;
    });
  }

  /// Frames outside, tiles inside: where the scene moves in between, one after the other; with an image of noise, as
  /// many at once as it has layers.
  template <class Tell>
  bool add_frame_by_frame(std::uint32_t first, std::uint32_t wanted, Tell tell) {
    const std::uint32_t most = moves ? 1u : noise->most_frames();
    for (std::uint32_t f = 0; f < wanted;) {
      const std::uint32_t frames = std::min(most, wanted - f);
      go_to(moves ? time_of(first + f) : settings.time);
      if (noise) noise->go_to(first + f, frames);
      const bool goes_on = over_tiles([&] {
        for (std::uint32_t k = 0; k < frames;) {
          const std::uint32_t laid_out = lay_out(first + f + k, frames - k);
          sample_batch();
          k += laid_out;
          if (!tell(laid_out)) return false;
        }
        return true;
      });
      if (!goes_on) return false;
      f += frames;
    }
    return true;
  }

  RenderedPicture moments() {
    RenderedPicture result;
    result.width = settings.width, result.height = settings.height;
    AccumulatedMoments read = accumulator.read();
    result.frames = read.frames;
    result.mean = std::move(read.mean);
    result.variance = std::move(read.variance);
    return result;
  }

  RenderedPicture picture() {
    RenderedPicture result = moments();
    const std::size_t pixels = static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
    result.depth.resize(pixels), result.normal.resize(pixels);
    result.primitive.resize(pixels), result.instance.resize(pixels), result.steps.resize(pixels);
    go_to(settings.time);
    over_tiles([&] {
      lay_out(0, 1);
      read_channels(result);
      return true;
    });
    return result;
  }

  void read_channels(RenderedPicture& result) {
    make_primary_rays(true);
    const HitTargets& hits = walk_rays(textures_of(primary), RayQuery::nearest, walked.primary, false);
    draw_shading(RenderPass::channels, PassTap::none, 1, 0, textures_of(primary), hits, told.framebuffer);
    const std::vector<glm::vec4> surface = read(told.framebuffer, 0), numbers = read(told.framebuffer, 1);
    const auto number = [](float x) { return x < 0.0f ? kNone : static_cast<std::uint32_t>(x); };
    for (int y = 0; y < batch.tile_height; ++y)
      for (int x = 0; x < batch.tile_width; ++x) {
        const auto from = static_cast<std::size_t>(y * batch.columns + x);
        const auto to = static_cast<std::size_t>(batch.tile_y + y) * static_cast<std::size_t>(settings.width) +
                        static_cast<std::size_t>(batch.tile_x + x);
        result.normal[to] = glm::dvec3(surface[from]);
        result.depth[to] = surface[from].w;
        result.primitive[to] = number(numbers[from].x);
        result.instance[to] = number(numbers[from].y);
        result.steps[to] = number(numbers[from].z);
      }
  }

  std::vector<glm::vec4> read(const GlFramebuffer& from, int target) {
    return read_words<glm::vec4>(from, target, GL_RGBA, GL_FLOAT);
  }
  template <class Word>
  std::vector<Word> read_words(const GlFramebuffer& from, int target, GLenum format, GLenum type) {
    const GlFunctions& gl = context->use();
    std::vector<Word> words(static_cast<std::size_t>(batch.columns * batch.rows));
    gl.BindFramebuffer(GL_FRAMEBUFFER, from.name());
    gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + target));
    gl.ReadPixels(0, 0, batch.columns, batch.rows, format, type, words.data());
    return words;
  }

  TappedBatch tapped_batch() const {
    return {batch.tile_x, batch.tile_y, batch.tile_height, batch.lanes, batch.columns, batch.rows, batch.first_frame};
  }

  void tap_rays(std::uint32_t ray, std::uint32_t light, const RayTextures& textures, const HitTargets& found) {
    const std::array<GlTexture const*, 2> both{textures.origins, textures.directions};
    const std::vector<glm::vec4> origins = read_texture(*both[0]), directions = read_texture(*both[1]);
    std::vector<Ray> rays(origins.size());
    std::vector<Hit> hits(origins.size());
    std::array<std::vector<PassWords>, kPassTargets> words;
    const int targets = walk.hit_targets();
    for (int i = 0; i < targets; ++i)
      words[static_cast<std::size_t>(i)] =
          read_words<PassWords>(found.framebuffer, i, GL_RGBA_INTEGER, GL_UNSIGNED_INT);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      rays[i] = {glm::vec3(origins[i]), glm::vec3(directions[i]), origins[i].w};
      hits[i] = unpack_hit(words[0][i], words[1][i], words[2][i], targets == kPassTargets ? &words[3][i] : nullptr);
    }
    tap->rays(tapped_batch(), ray, light, rays, hits);
  }

  std::vector<glm::vec4> read_texture(const GlTexture& texture) {
    const GlFramebuffer alone(*context, &texture, 1);
    return read(alone, 0);
  }

  void tap_numbers(RenderPass kind, std::uint32_t ray, std::uint32_t light, std::uint32_t first,
                   const RayTextures& rays, const HitTargets& hits) {
    if (!tapped) tapped = FloatTargets<3>(*context);
    draw_shading(kind, PassTap::numbers, ray, light, rays, hits, tapped.framebuffer);
    tap->numbers(tapped_batch(), ray, first, read(tapped.framebuffer, 0));
    draw_shading(kind, PassTap::places, ray, light, rays, hits, tapped.framebuffer);
    tap->places(tapped_batch(), ray, first, read(tapped.framebuffer, 0));
  }

  void tap_camera() {
    if (!tapped) tapped = FloatTargets<3>(*context);
    for (const PassTap kind : {PassTap::numbers, PassTap::lens_numbers, PassTap::lens_places}) {
      const GlProgram& pass = begin(RenderPass::camera, kind, 1, 0);
      set_camera(pass, false);
      draw(pass, tapped.framebuffer);
      const std::vector<glm::vec4> told_of = read(tapped.framebuffer, 0);
      if (kind == PassTap::lens_places)
        tap->places(tapped_batch(), 1, 2, told_of);
      else
        tap->numbers(tapped_batch(), 1, kind == PassTap::numbers ? 0 : 2, told_of);
    }
  }

  void tap_samples(const GlFramebuffer& colors) { tap->samples(tapped_batch(), read(colors, 0)); }
};

Renderer::Renderer(GlContext& context, const Scene& scene, const RenderSettings& settings)
    : impl_(std::make_unique<Impl>(context, scene, settings)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

bool Renderer::lit_by_default() const { return impl_->by_default; }
const RenderSettings& Renderer::settings() const { return impl_->settings; }
const GeometryImage& Renderer::image() const { return impl_->image; }

bool Renderer::add_frames(std::uint32_t first, std::uint32_t count, const RenderProgress& progress) {
  return impl_->add_frames(first, count, progress);
}
void Renderer::restart(double time) {
  impl_->accumulator.clear();
  impl_->settings.time = time;
}
RenderedPicture Renderer::picture() { return impl_->picture(); }

std::optional<RenderedPicture> Renderer::render(const RenderProgress& progress) {
  restart(impl_->settings.time);
  if (!add_frames(impl_->settings.first_frame, impl_->settings.frames, progress)) return std::nullopt;
  return picture();
}

RenderedPicture Renderer::moments() { return impl_->moments(); }
void Renderer::set_tap(RenderTap* tap) { impl_->tap = tap; }
std::uint64_t Renderer::rays_traced() const { return impl_->rays_traced; }
std::uint64_t Renderer::passes() const { return impl_->passes; }
WalkSeconds Renderer::walk_seconds() const { return impl_->walked; }

}  // namespace plumbline
