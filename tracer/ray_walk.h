// SPDX-License-Identifier: MIT
// Rays that shaders have made walk the geometry image, without leaving the driver: the program of the probe, fed from
// textures.
#pragma once

#include <memory>
#include <span>

#include "tracer/geometry_image.h"
#include "tracer/ray_targets.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// What a walk asks for.
enum class RayQuery {
  nearest,  ///< the hit with the least t
  any,      ///< whether there is a hit (shadow rays): kind alone is told
};

/// Origins and t_max, directions (the fourth component is not the walk's) of a batch's rays.
struct RayTextures {
  const GlTexture* origins = nullptr;
  const GlTexture* directions = nullptr;
};

/// The fragment shader that brings what bundles have written to where their rays stand: all results of two rays, or the
/// kinds alone that shadow rays are asked for.
ShaderText spread_shader(int bundle, bool kinds, bool has_transforms, GlslDialect dialect = GlslDialect::glsl_330);

class RayWalk {
 public:
  /// Throws as Probe's constructor does.
  RayWalk(GlContext& context, const GeometryImage& image, int bundle, std::span<const ShaderPatch> patches);
  ~RayWalk();
  RayWalk(RayWalk&&) noexcept;
  RayWalk& operator=(RayWalk&&) noexcept;

  /// Uploads the texels of the image that have changed, and no others.
  void update(const GeometryImage& image, std::span<const TexelRange> changed);

  /// Walks the rays of a batch's first rows and columns (columns: whole bundles). A ray without direction is none and
  /// comes out as `undefined`. The hits stay valid until the next walk with the same query.
  /// `together` false: each alone, whatever the bundles, so that its steps are its own.
  const HitTargets& trace(const RayTextures& rays, int columns, int rows, RayQuery query, bool together = true);

  int hit_targets() const;  ///< how many targets hits have
  const GlTexture& geometry() const;
  const PassConstants& constants() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
