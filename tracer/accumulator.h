// SPDX-License-Identifier: MIT
// Means and variances of the samples of each pixel (SEMANTICS 6.9), summed up by a shader with so little loss that
// neither the number of frames nor an outlier shows.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tracer/gl_objects.h"
#include "tracer/render_passes.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// Row by row from the top, linear colour.
struct AccumulatedMoments {
  std::uint32_t frames = 0;          ///< samples of each pixel: the least, where rendering has been ended early
  std::vector<glm::dvec3> mean;      ///< NaN where there is no sample
  std::vector<glm::dvec3> variance;  ///< of one sample, unbiased; empty below two frames
};

/// The fragment shader that adds samples to sums.
ShaderText accumulate_shader(GlslDialect dialect = GlslDialect::glsl_330, std::span<const ShaderPatch> patches = {});

/// The mean is within 2^-24 of the mean of |samples|, or 2^-110, whatever the number of frames: a NaN, or infinities of
/// both signs, make it NaN, and infinity stays. The variance is within 2^-22 of itself where samples differ by 2^-50 to
/// 2^57, and 0 where all are equal; it is infinite where it is too large for floats, and NaN where the mean is not
/// finite. Neither depends on how frames are put into batches.
class Accumulator {
 public:
  /// Of a picture of this size, pixels. `patches`: those of other shaders are left out.
  Accumulator(GlContext& context, int width, int height, std::span<const ShaderPatch> patches = {});
  /// Forgets all samples.
  void clear();
  /// Adds a batch of samples, as shaders/item.glsl lays it out in an RGBA32F texture. The fourth component is above 0
  /// where a walk found no end: the mean of such a pixel is NaN. Tiles must cover the same pixels as ones before, or
  /// none of theirs.
  void add(const GlTexture& samples, const RenderBatch& batch);
  AccumulatedMoments read() const;

 private:
  /// The moments of a pixel's samples that the host keeps: of whole chunks.
  struct Moments {
    glm::dvec3 mean{0.0}, squares{0.0};  ///< sum of squared deviations from the mean
    std::uint32_t flags = 0;
  };
  struct Targets {
    std::array<GlTexture, 4> textures;
    GlFramebuffer framebuffer;
    Targets() = default;
    Targets(GlContext& context, int width, int height);
  };
  struct Tile {
    int x = 0, y = 0, width = 0, height = 0;
    Targets now;
    std::uint32_t in_chunk = 0, in_moments = 0;  ///< samples of each pixel
    std::vector<Moments> moments;
  };

  /// What the next sums of a tile are drawn into, before the two change places: one for all tiles of a size.
  struct Spare {
    int width = 0, height = 0;
    Targets targets;
  };

  Tile& tile_of(const RenderBatch& batch);
  Spare& spare_of(int width, int height);
  void draw(Tile& tile, const GlTexture& samples, const RenderBatch& batch, std::uint32_t first, std::uint32_t end);
  /// The moments of all samples of a tile.
  std::vector<Moments> moments_of(const Tile& tile) const;

  GlContext* context_;
  int width_, height_;
  GlProgram program_;
  std::vector<Tile> tiles_;
  std::vector<Spare> spares_;
};

}  // namespace plumbline
