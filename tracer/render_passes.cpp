// SPDX-License-Identifier: MIT
#include "tracer/render_passes.h"

#include <algorithm>
#include <array>
#include <string>

#include "tracer/shader_words.h"

namespace plumbline {

std::string_view file_of(RenderPass pass) {
  switch (pass) {
    case RenderPass::camera:
      return "camera.frag.glsl";
    case RenderPass::light:
      return "light.frag.glsl";
    case RenderPass::add_light:
      return "add_light.frag.glsl";
    case RenderPass::scatter:
      return "scatter.frag.glsl";
    case RenderPass::channels:
      return "channels.frag.glsl";
    case RenderPass::count_rays:
      break;
  }
  return "count.frag.glsl";
}

ShaderText render_shader(RenderPass pass, const ShadingVariant& variant, PassTap tap,
                         std::span<const ShaderPatch> patches, GlslDialect dialect) {
  const auto number = [](auto value) { return std::to_string(value); };
  std::vector<ShaderDefine> defines{
      {"PASS_CONSTANT", "flat in"},
      {"KIND_MISS", number(kWordMiss) + "u"},
      {"KIND_HIT", number(kWordHit) + "u"},
      {"KIND_UNDEFINED", number(kWordUndefined) + "u"},
      {"PRIMITIVE_STRIDE", "1"},  // of the geometry image, where only lights are read here
      {"TRANSFORM_TEXELS", number(kTransformTexels)},
      {"LIGHT_TEXELS", number(kLightTexels)},
      {"MATERIAL_TEXELS", number(kMaterialTexels)},
      {"INSTANCE_TEXELS", number(kInstanceTexels)},
      {"SHADING_TRIANGLE_TEXELS", number(kShadingTriangleTexels)},
      {"SHADING_SPHERE_TEXELS", number(kShadingSphereTexels)},
      {"SHADING_WIDTH", number(kShadingWidth)},
      {"TEXTURE_BLOCK", number(kTextureBlock)},
      {"PRIMITIVE_COUNT", number(variant.primitive_count)},
      {"INFINITE", "uintBitsToFloat(0x7f800000u)"},
      {"DELTA", "7.62939453125e-6"},  // 2^-17, SEMANTICS 6.5
      {"BLOCK_PIXEL", number(kBlockPixel) + "u"},
      {"BLOCK_LENS", number(kBlockLens) + "u"},
      {"BLOCK_NORMAL", number(kBlockNormal) + "u"},
      {"BLOCK_LIGHTS", number(kBlockLights) + "u"},
  };
  const auto flag = [&](bool is_set, const char* name) {
    if (is_set) defines.emplace_back(name, "");
  };
  flag(variant.has_triangles, "HAS_TRIANGLES");
  flag(variant.has_spheres, "HAS_SPHERES");
  flag(variant.has_transforms, "HAS_TRANSFORMS");
  flag(variant.has_textures, "HAS_TEXTURES");
  flag(variant.is_paper, "LAYOUT_PAPER");
  flag(variant.is_physical, "MODEL_PHYSICAL");
  flag(variant.random == RandomKind::hash, "RANDOM_HASH");
  flag(variant.random == RandomKind::md5, "RANDOM_MD5");
  flag(variant.random == RandomKind::texture, "RANDOM_TEXTURE");
  flag(tap != PassTap::none, "TAP");
  flag(tap == PassTap::places || tap == PassTap::lens_places, "TAP_PLACES");
  flag(tap == PassTap::lens_numbers || tap == PassTap::lens_places, "TAP_LENS");
  const bool draws = pass == RenderPass::camera || pass == RenderPass::light || pass == RenderPass::scatter;
  std::vector<std::string_view> files;
  if (pass != RenderPass::count_rays) {
    files = {"pass_constants.glsl", "unit.glsl", "item.glsl"};
    if (draws) files.insert(files.end(), {"elementary.glsl", "random.glsl", "perturbation.glsl"});
    if (pass != RenderPass::camera) files.emplace_back("surface.glsl");
    if (pass == RenderPass::light) files.emplace_back(variant.is_paper ? "image_paper.glsl" : "image_compact.glsl");
  }
  files.push_back(file_of(pass));
  const std::vector<ShaderPatch> own = patches_for(compose_shader(files, defines, {}, dialect), patches);
  return compose_shader(files, defines, own, dialect);
}

}  // namespace plumbline
