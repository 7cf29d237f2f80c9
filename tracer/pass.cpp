// SPDX-License-Identifier: MIT
#include "tracer/pass.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "scenes/error.h"
#include "tracer/shader_words.h"

namespace plumbline {

namespace {

/// Steps at which a walk counts as endless. Layout `paper` has no cells for ends: a walk that has visited every node
/// may still have to leave a space, which is asked for behind the check.
int step_limit(const GeometryImage& image) {
  const bool leaves_late = image.options.layout == Layout::paper && image.transform_count > 0;
  constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<int>(std::min(kMost, image.cell_count + (leaves_late ? 1u : 0u)));
}

}  // namespace

PassConstants pass_constants(const GeometryImage& image) {
  const auto integer = [](std::uint32_t value) { return static_cast<int>(value); };
  PassConstants c;
  c.scale_exponent = image.scale_exponent;
  c.ball = glm::vec4(image.center, image.radius);
  c.factor = glm::vec4(1.0f, 1.0f / static_cast<float>(image.width), 1.0f / static_cast<float>(image.height), 0.0f);
  c.shape = {image.width - 1, std::countr_zero(static_cast<unsigned>(image.width)), integer(image.primitive_start),
             integer(image.primitive_count)};
  c.walk = {integer(image.copy_size), image.copy_count == 8 ? 7 : 0, (1 << image.payload_bits) - 1, step_limit(image)};
  c.transforms = {integer(image.transform_start), integer(image.transform_count), integer(image.world_primitives), 0};
  return c;
}

void set_pass(const GlProgram& program, const PassConstants& constants, const glm::ivec4& range) {
  program.set("u_geometry", kGeometryUnit);
  program.set("u_rays", kRayUnit);
  program.set("u_state", kStateUnit);
  program.set("u_ball", constants.ball);
  program.set("u_factor", constants.factor);
  program.set("u_image", constants.shape);
  program.set("u_walk", constants.walk);
  program.set("u_transforms", constants.transforms);
  program.set("u_range", range);
}

void require_fitting_texels(GlContext& context, std::size_t texels, const std::string& what,
                            const std::string& instead) {
  if (texels <= static_cast<std::size_t>(context.max_buffer_texels())) return;
  throw InputError(what + " is " + std::to_string(texels) + " texels, but buffer textures of this OpenGL driver (" +
                   context.renderer() + ") end at " + std::to_string(context.max_buffer_texels()) + "; " + instead);
}

void require_fitting_image(GlContext& context, const GeometryImage& image) {
  const std::string what = "the geometry image of " + image.scene_name;
  const std::string instead = "bake with links `threaded` or a smaller scene";
  if (image.options.layout == Layout::compact) {
    require_fitting_texels(context, image.texels.size(), what, instead);
  } else if (std::max(image.width, image.height) > context.max_texture_size()) {
    throw InputError(what + " is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " texels, but textures of this OpenGL driver (" + context.renderer() + ") end at " +
                     std::to_string(context.max_texture_size()) + "; " + instead);
  }
}

GlTexture upload_image(GlContext& context, const GeometryImage& image) {
  if (image.options.layout == Layout::compact) return GlTexture::linear(context, image.texels);
  return GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, image.width, image.height, image.texels.data());
}

std::uint64_t update_texels(const GlTexture& geometry, const GeometryImage& image,
                            std::span<const TexelRange> changed) {
  std::uint64_t uploaded = 0;
  const auto width = static_cast<std::uint32_t>(image.width);
  for (const TexelRange& range : changed) {
    uploaded += range.count;
    std::span<const glm::vec4> texels = std::span(image.texels).subspan(range.first, range.count);
    if (image.options.layout == Layout::compact) {
      geometry.update(texels, range.first);
      continue;
    }
    for (std::uint32_t at = range.first; !texels.empty();) {
      const std::size_t count = std::min<std::size_t>(texels.size(), width - at % width);
      geometry.update_row(static_cast<int>(at % width), static_cast<int>(at / width), texels.first(count));
      texels = texels.subspan(count);
      at += static_cast<std::uint32_t>(count);
    }
  }
  return uploaded;
}

Hit unpack_hit(const PassWords& a, const PassWords& b, const PassWords& c, const PassWords* d) {
  const auto value = [](std::uint32_t word) { return std::bit_cast<float>(word); };
  Hit hit;
  hit.steps = a.z;
  hit.primitive_tests = a.w;
  hit.transforms = d != nullptr ? d->y : 0;
  switch (a.x & 7u) {
    case kWordHit:
      hit.kind = HitKind::hit;
      hit.primitive = a.x >> 3;
      hit.instance = d != nullptr ? d->x - 1u : kNone;  // 0: the world
      hit.t = value(a.y);
      hit.position = {value(b.x), value(b.y), value(b.z)};
      hit.normal = {value(c.x), value(c.y), value(c.z)};
      hit.barycentrics = {value(b.w), value(c.w)};
      break;
    case kWordMiss:
      hit.kind = HitKind::miss;
      break;
    case kWordUndefined:
      hit.kind = HitKind::undefined;
      break;
    default:
      hit.kind = HitKind::capped;
      break;
  }
  return hit;
}

}  // namespace plumbline
