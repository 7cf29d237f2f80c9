// SPDX-License-Identifier: MIT
// The programs of rendering passes that do not walk: camera, lights, sums, reflections, channels; and what all of them
// are told of the scene.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/camera.h"
#include "tracer/ray_walk.h"
#include "tracer/renderer.h"
#include "tracer/shading_image.h"

namespace plumbline {

enum class RenderPass { camera, light, add_light, scatter, channels, count_rays };

/// What a pass hands out in place of its first target, for taps.
enum class PassTap { none, numbers, places, lens_numbers, lens_places };

/// A part of the picture in some frames, as shaders/item.glsl lays it out.
struct RenderBatch {
  int tile_x = 0, tile_y = 0, tile_width = 0, tile_height = 0;  ///< pixels
  int lanes = 1, blocks = 1;                                    ///< lanes * blocks frames, from first_frame on
  std::uint32_t first_frame = 0;
  int columns = 0, rows = 0;  ///< items; columns rounded up to whole bundles
};

/// What the shading programs of a scene are compiled for.
struct ShadingVariant {
  bool has_triangles = false, has_spheres = false, has_transforms = false, has_textures = false;
  bool is_paper = false;     ///< layout of the geometry image
  bool is_physical = false;  ///< model of the effects
  RandomKind random = RandomKind::hash;
  std::uint32_t primitive_count = 0;  ///< of the scene
};

/// The fragment shader of a pass.
ShaderText render_shader(RenderPass pass, const ShadingVariant& variant, PassTap tap = PassTap::none,
                         std::span<const ShaderPatch> patches = {}, GlslDialect dialect = GlslDialect::glsl_330);

/// The file of a pass's main function: "light.frag.glsl".
std::string_view file_of(RenderPass pass);

}  // namespace plumbline
