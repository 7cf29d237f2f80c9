// SPDX-License-Identifier: MIT
// As the probe: a first pass walks all rays, and what it could not end goes on in further passes of the thorough
// program. Here the states stay in textures, two sets of which take turns, and a query tells whether any ray is left.
#include "tracer/ray_walk.h"

#include <array>
#include <utility>
#include <vector>

#include "scenes/error.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

/// Texture units beyond those of every pass.
constexpr int kOriginUnit = 1, kDirectionUnit = 2, kFirstStateUnit = 3;

/// Every resumed pass brings each of its rays on by thousands of nodes, or by all triangles that it meets edge-on.
/// A broken image may lead a walk in a circle for ever: beyond these passes it counts as having no end.
constexpr std::uint32_t most_passes(std::uint32_t cells) { return 16 + cells / 1024; }

}  // namespace

ShaderText spread_shader(int bundle, bool kinds, bool has_transforms, GlslDialect dialect) {
  const std::array<std::string_view, 1> files{"spread.frag.glsl"};
  std::vector<ShaderDefine> defines{{"BUNDLE_SIZE", std::to_string(bundle)}};
  if (kinds) defines.emplace_back("BUNDLE_KINDS", "");
  if (has_transforms) defines.emplace_back("HAS_TRANSFORMS", "");
  return compose_shader(files, defines, {}, dialect);
}

struct RayWalk::Impl {
  GlContext* context;
  int bundle;
  std::vector<ShaderPatch> patches;
  std::vector<std::pair<ProgramVariant, GlProgram>> programs;
  std::vector<std::string> state_names, found_names;
  GlTexture geometry;
  PassConstants constants;
  ProgramVariant variant;
  bool is_linear = false;
  int target_count = kPassTargets - 1;
  std::uint32_t cell_count = 0;
  struct Turns {
    HitTargets now, next;
  };
  std::array<Turns, 2> hits;  // by query
  std::vector<GlTexture> found;
  GlFramebuffer found_framebuffer, kinds_framebuffer;  // all of `found`; the first of each ray, of shadow rays
  FloatTargets<1> counted;
  GlProgram count_program, spread_results, spread_kinds;
  GlSampleCount count;

  Impl(GlContext& c, const GeometryImage& image, int rays, std::span<const ShaderPatch> p)
      : context(&c), bundle(rays), patches(p.begin(), p.end()) {
    PLUMBLINE_ASSERT(bundle >= 1 && bundle <= kMostBundled);
    require_fitting_image(c, image);
    variant = program_variant(image, false, false);
    variant.rendering = true;
    is_linear = image.options.layout == Layout::compact;
    target_count = image.transform_count > 0 ? kPassTargets : kPassTargets - 1;
    set_constants(image);
    geometry = upload_image(c, image);
    for (Turns& turns : hits) turns = {HitTargets(c, target_count), HitTargets(c, target_count)};
    if (bundle > 1) {
      const int wanted = bundle == kBundleWithResults ? bundle * target_count : 2 * bundle;
      for (int i = 0; i < wanted; ++i)
        found.emplace_back(c, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kBatchWidth / bundle, kRenderRows);
      found_framebuffer = GlFramebuffer(c, found.data(), wanted);
      kinds_framebuffer = GlFramebuffer(c, found.data(), bundle);
      const auto spreading = [&](bool kinds) {
        return GlProgram(c,
                         link_program(c, probe_vertex_shader(), spread_shader(bundle, kinds, variant.has_transforms)));
      };
      spread_kinds = spreading(true);
      if (bundle == kBundleWithResults) spread_results = spreading(false);
    }
    for (int i = 0; i < kPassTargets; ++i) state_names.push_back("u_state_" + std::to_string(i));
    for (int i = 0; i < 2 * kMostBundled; ++i) found_names.push_back("u_found_" + std::to_string(i));
    counted = FloatTargets<1>(c);
    const std::array<std::string_view, 1> files{"count.frag.glsl"};
    const std::array<ShaderDefine, 2> defines{ShaderDefine{"COUNT_UNFINISHED", ""},
                                              ShaderDefine{"KIND_UNFINISHED", std::to_string(kWordUnfinished) + "u"}};
    count_program = GlProgram(c, link_program(c, probe_vertex_shader(), compose_shader(files, defines)));
    count = GlSampleCount(c);
  }

  void set_constants(const GeometryImage& image) {
    constants = pass_constants(image);
    cell_count = image.cell_count;
  }

  const GlProgram& program(const ProgramVariant& wanted) {
    for (const auto& [known, compiled] : programs)
      if (known == wanted) return compiled;
    const std::vector<ShaderPatch> own = patches_for(probe_fragment_shader(wanted), patches);
    GlProgram compiled(*context, link_program(*context, probe_vertex_shader(), probe_fragment_shader(wanted, own)));
    return programs.emplace_back(wanted, std::move(compiled)).second;
  }

  void draw(const ProgramVariant& wanted, const RayTextures& rays, bool goes_on, const GlFramebuffer& into, int columns,
            int rows) {
    const GlProgram& pass = program(wanted);
    const GlFunctions& gl = context->use();
    geometry.bind(kGeometryUnit);
    rays.origins->bind(kOriginUnit);
    rays.directions->bind(kDirectionUnit);
    pass.use();
    set_pass(pass, constants, {constants.scale_exponent, goes_on ? 1 : 0, constants.shape.w, 0});
    pass.set("u_ray_origins", kOriginUnit);
    pass.set("u_ray_directions", kDirectionUnit);
    // Samplers of different kinds may not share a unit, read or not.
    const std::vector<std::string>& names = wanted.found_bundle > 1 ? found_names : state_names;
    for (std::size_t i = 0; i < names.size(); ++i) pass.set(names[i].c_str(), kFirstStateUnit + static_cast<int>(i));
    gl.BindFramebuffer(GL_FRAMEBUFFER, into.name());
    gl.Disable(GL_DITHER);
    pass.draw(columns, rows);
  }

  static void bind_state(std::span<const GlTexture> textures) {
    for (std::size_t i = 0; i < textures.size(); ++i) textures[i].bind(kFirstStateUnit + static_cast<int>(i));
  }

  std::uint32_t unfinished(const HitTargets& targets, int columns, int rows) {
    const GlFunctions& gl = context->use();
    targets.textures[0].bind(0);
    count_program.use();
    count_program.set("u_hit_0", 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, counted.framebuffer.name());
    count.begin();
    count_program.draw(columns, rows);
    return count.end();
  }

  /// Brings what bundles have written to where their rays stand.
  void spread(const GlProgram& by, const GlFramebuffer& into, int columns, int rows) {
    const GlFunctions& gl = context->use();
    by.use();
    for (std::size_t i = 0; i < found.size(); ++i)
      by.set(found_names[i].c_str(), kFirstStateUnit + static_cast<int>(i));
    gl.BindFramebuffer(GL_FRAMEBUFFER, into.name());
    gl.Disable(GL_DITHER);
    by.draw(columns, rows);
  }

  const HitTargets& trace(const RayTextures& rays, int columns, int rows, RayQuery query, bool together) {
    PLUMBLINE_ASSERT(columns % bundle == 0);
    Turns& turns = hits[query == RayQuery::any ? 1 : 0];
    ProgramVariant pass = variant;
    pass.any_hit = query == RayQuery::any;
    if (bundle == 1 || !together) {
      // Nothing is read from there, but what is drawn into must not be at hand for reading either.
      bind_state(std::span(turns.next.textures).first(static_cast<std::size_t>(target_count)));
      draw(pass, rays, false, turns.now.framebuffer, columns, rows);
    } else {
      ProgramVariant bundled = pass, finish = pass;
      bundled.bundle = bundle;
      draw(bundled, rays, false, pass.any_hit ? kinds_framebuffer : found_framebuffer, columns / bundle, rows);
      bind_state(found);
      if (pass.any_hit) {
        spread(spread_kinds, turns.now.framebuffer, columns, rows);
      } else if (bundle == kBundleWithResults) {
        spread(spread_results, turns.now.framebuffer, columns, rows);
      } else {
        finish.finish = true;
        finish.found_bundle = bundle;
        draw(finish, rays, true, turns.now.framebuffer, columns, rows);
      }
    }
    ProgramVariant thorough = pass;
    thorough.thorough = true;
    for (std::uint32_t i = 0; i < most_passes(cell_count) && unfinished(turns.now, columns, rows) > 0; ++i) {
      bind_state(std::span(turns.now.textures).first(static_cast<std::size_t>(target_count)));
      draw(thorough, rays, true, turns.next.framebuffer, columns, rows);
      std::swap(turns.now, turns.next);
    }
    context->check("walking rays of a picture");
    return turns.now;
  }
};

RayWalk::RayWalk(GlContext& context, const GeometryImage& image, int bundle, std::span<const ShaderPatch> patches)
    : impl_(std::make_unique<Impl>(context, image, bundle, patches)) {}
RayWalk::~RayWalk() = default;
RayWalk::RayWalk(RayWalk&&) noexcept = default;
RayWalk& RayWalk::operator=(RayWalk&&) noexcept = default;

void RayWalk::update(const GeometryImage& image, std::span<const TexelRange> changed) {
  impl_->set_constants(image);
  update_texels(impl_->geometry, image, changed);
}
const HitTargets& RayWalk::trace(const RayTextures& rays, int columns, int rows, RayQuery query, bool together) {
  return impl_->trace(rays, columns, rows, query, together);
}
int RayWalk::hit_targets() const { return impl_->target_count; }
const GlTexture& RayWalk::geometry() const { return impl_->geometry; }
const PassConstants& RayWalk::constants() const { return impl_->constants; }

}  // namespace plumbline
