// SPDX-License-Identifier: MIT
// What every pass through probe.frag.glsl is given and gives: the image as a texture, its constants, results as hits.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>

#include "scenes/ray.h"
#include "tracer/geometry_image.h"
#include "tracer/gl_objects.h"

namespace plumbline {

enum PassUnit { kGeometryUnit = 0, kRayUnit = 1, kStateUnit = 2 };

/// Targets that results are written to; the last one only where there are transforms.
inline constexpr int kPassTargets = 4;

/// Texels of the targets.
using PassWords = glm::uvec4;

/// The constants of pass_constants.glsl that depend on the image.
struct PassConstants {
  glm::vec4 ball{0.0f}, factor{0.0f};
  glm::ivec4 shape{0}, walk{0}, transforms{0};
  int scale_exponent = 0;
};
PassConstants pass_constants(const GeometryImage& image);

/// Sets the constants of the program in use, and its texture units. `range` is u_range.
void set_pass(const GlProgram& program, const PassConstants& constants, const glm::ivec4& range);

/// Throws InputError for an image that is larger than the driver's textures.
void require_fitting_image(GlContext& context, const GeometryImage& image);
/// The same for texels of a buffer texture, where the driver would cut what is too much off without a word. `what`
/// names them: "the textures of medieval"; `instead` tells what to do.
void require_fitting_texels(GlContext& context, std::size_t texels, const std::string& what,
                            const std::string& instead);
/// An image that fits, as a texture.
GlTexture upload_image(GlContext& context, const GeometryImage& image);
/// Uploads the texels of an image that have changed, and no others; returns how many.
std::uint64_t update_texels(const GlTexture& geometry, const GeometryImage& image, std::span<const TexelRange> changed);

/// What the targets hold of one pixel whose walk has ended. `d` is null where there are no transforms.
Hit unpack_hit(const PassWords& a, const PassWords& b, const PassWords& c, const PassWords* d);

}  // namespace plumbline
