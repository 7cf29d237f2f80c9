// SPDX-License-Identifier: MIT
#include "tracer/accumulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "scenes/error.h"

namespace plumbline {
namespace {

/// Samples that a shader sums up before the host takes the sums over: N. With u = 2^-24, m the mean of |x| and d = x -
/// x0, each addition loses at most 7 u^2 of the largest sum so far (accumulate.frag.glsl), and that is at most sum |d|
/// <= sum |x| + N |x0| <= (N + 1) N m: x0, be it an outlier, is one of the samples. So the mean is off by 7 u^2 N (N +
/// 1) m at most, which is 2^-25 m. The sum of squares S is off by 8 u^2 N S, and the square of the sum, divided by N,
/// by 14 u^2 N S; S is at most N + 1 times the sum of squared deviations from the mean, which therefore is off by 22
/// u^2 N (N + 1) of itself: 2^-23.5. What the host does in doubles adds less than 2^-30.
constexpr std::uint32_t kChunk = 1024;
constexpr double kScale = 0x1p12;  // of the sum of differences

// Flags of a pixel: three bits of each channel, and one.
constexpr std::uint32_t kNan = 1, kInfinite = 2, kMinusInfinite = 4, kEndlessWalk = 512;

constexpr int kFirstKeptUnit = 1;

double mean_of(double mean, std::uint32_t flags, int channel) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::uint32_t kinds = (flags >> (3 * channel)) & 7;
  if (kinds == 0 && (flags & kEndlessWalk) == 0) return mean;
  if ((flags & kEndlessWalk) != 0 || (kinds != kInfinite && kinds != kMinusInfinite))
    return std::numeric_limits<double>::quiet_NaN();
  return kinds == kInfinite ? kInfinity : -kInfinity;
}

std::size_t area(int width, int height) { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

}  // namespace

ShaderText accumulate_shader(GlslDialect dialect, std::span<const ShaderPatch> patches) {
  static constexpr std::array<std::string_view, 3> kFiles{"pass_constants.glsl", "exact.glsl", "accumulate.frag.glsl"};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}};
  return compose_shader(kFiles, defines, patches, dialect);
}

Accumulator::Targets::Targets(GlContext& context, int width, int height) {
  for (GlTexture& texture : textures) texture = GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, width, height);
  framebuffer = GlFramebuffer(context, textures.data(), static_cast<int>(textures.size()));
}

Accumulator::Accumulator(GlContext& context, int width, int height, std::span<const ShaderPatch> patches)
    : context_(&context), width_(width), height_(height) {
  const std::vector<ShaderPatch> own = patches_for(accumulate_shader(), patches);
  program_ =
      GlProgram(context, link_program(context, probe_vertex_shader(), accumulate_shader(GlslDialect::glsl_330, own)));
}

void Accumulator::clear() { tiles_.clear(); }

Accumulator::Tile& Accumulator::tile_of(const RenderBatch& batch) {
  for (Tile& tile : tiles_) {
    if (tile.x == batch.tile_x && tile.y == batch.tile_y && tile.width == batch.tile_width &&
        tile.height == batch.tile_height)
      return tile;
    PLUMBLINE_ASSERT(tile.x + tile.width <= batch.tile_x || batch.tile_x + batch.tile_width <= tile.x ||
                     tile.y + tile.height <= batch.tile_y || batch.tile_y + batch.tile_height <= tile.y);
  }
  PLUMBLINE_ASSERT(batch.tile_x >= 0 && batch.tile_y >= 0 && batch.tile_x + batch.tile_width <= width_ &&
                   batch.tile_y + batch.tile_height <= height_);
  Tile tile;
  tile.x = batch.tile_x, tile.y = batch.tile_y, tile.width = batch.tile_width, tile.height = batch.tile_height;
  tile.now = Targets(*context_, tile.width, tile.height);
  return tiles_.emplace_back(std::move(tile));
}

void Accumulator::add(const GlTexture& samples, const RenderBatch& batch) {
  Tile& tile = tile_of(batch);
  const auto count = static_cast<std::uint32_t>(batch.lanes * batch.blocks);
  for (std::uint32_t first = 0; first < count;) {
    const std::uint32_t end = std::min(count, first + kChunk - tile.in_chunk);
    draw(tile, samples, batch, first, end);
    tile.in_chunk += end - first;
    first = end;
    if (tile.in_chunk < kChunk) continue;
    tile.moments = moments_of(tile);
    tile.in_moments += tile.in_chunk;
    tile.in_chunk = 0;
  }
}

Accumulator::Spare& Accumulator::spare_of(int width, int height) {
  for (Spare& spare : spares_)
    if (spare.width == width && spare.height == height) return spare;
  return spares_.emplace_back(Spare{width, height, Targets(*context_, width, height)});
}

void Accumulator::draw(Tile& tile, const GlTexture& samples, const RenderBatch& batch, std::uint32_t first,
                       std::uint32_t end) {
  static constexpr std::array<const char*, 4> kNames{"u_kept_0", "u_kept_1", "u_kept_2", "u_kept_3"};
  const GlFunctions& gl = context_->use();
  Spare& spare = spare_of(tile.width, tile.height);
  program_.use();
  samples.bind(0);
  program_.set("u_samples", 0);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const int unit = kFirstKeptUnit + static_cast<int>(i);
    tile.now.textures[i].bind(unit);
    program_.set(kNames[i], unit);
  }
  program_.set("u_factor", glm::vec4(1.0f));
  program_.set("u_layout", glm::ivec4(batch.lanes, tile.height, static_cast<int>(first), static_cast<int>(end)));
  program_.set("u_is_new", tile.in_chunk == 0 ? 1 : 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, spare.targets.framebuffer.name());
  gl.Disable(GL_DITHER);
  program_.draw(tile.width, tile.height);
  std::swap(tile.now, spare.targets);
  context_->check("adding samples");
}

std::vector<Accumulator::Moments> Accumulator::moments_of(const Tile& tile) const {
  const std::size_t pixels = area(tile.width, tile.height);
  std::vector<Moments> moments = tile.moments;
  moments.resize(pixels);
  if (tile.in_chunk == 0) return moments;
  const GlFunctions& gl = context_->use();
  std::array<std::vector<glm::vec4>, 4> kept;
  gl.BindFramebuffer(GL_FRAMEBUFFER, tile.now.framebuffer.name());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i].resize(pixels);
    gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
    gl.ReadPixels(0, 0, tile.width, tile.height, GL_RGBA, GL_FLOAT, kept[i].data());
  }
  context_->check("reading sums of samples");

  const double n = tile.in_chunk, before = tile.in_moments;
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::dvec4 a(kept[0][i]), b(kept[1][i]), c(kept[2][i]), d(kept[3][i]);
    const glm::dvec3 sum = kScale * (glm::dvec3(b) + glm::dvec3(b.w, c.w, d.w));
    const glm::dvec3 mean = glm::dvec3(a) + sum / n;
    glm::dvec3 squares = glm::dvec3(c) + glm::dvec3(d);
    for (int k = 0; k < 3; ++k)
      squares[k] = std::isfinite(squares[k]) ? std::max(0.0, squares[k] - sum[k] * sum[k] / n)
                                             : std::numeric_limits<double>::infinity();
    // Two sets of samples become one (Chan, Golub and LeVeque 1979).
    Moments& all = moments[i];
    const glm::dvec3 apart = mean - all.mean;
    all.mean = before == 0.0 ? mean : all.mean + apart * (n / (before + n));
    all.squares += squares + (before == 0.0 ? glm::dvec3(0.0) : apart * apart * (before * n / (before + n)));
    all.flags |= static_cast<std::uint32_t>(a.w);
  }
  return moments;
}

AccumulatedMoments Accumulator::read() const {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  AccumulatedMoments result;
  std::size_t covered = 0;
  result.frames = std::numeric_limits<std::uint32_t>::max();
  for (const Tile& tile : tiles_) {
    covered += area(tile.width, tile.height);
    result.frames = std::min(result.frames, tile.in_moments + tile.in_chunk);
  }
  if (covered < area(width_, height_)) result.frames = 0;
  result.mean.assign(area(width_, height_), glm::dvec3(kNoNumber));
  if (result.frames > 1) result.variance.resize(result.mean.size());
  for (const Tile& tile : tiles_) {
    const std::vector<Moments> moments = moments_of(tile);
    const double n = tile.in_moments + tile.in_chunk;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const auto x = i % static_cast<std::size_t>(tile.width) + static_cast<std::size_t>(tile.x);
      const auto y = i / static_cast<std::size_t>(tile.width) + static_cast<std::size_t>(tile.y);
      const std::size_t to = y * static_cast<std::size_t>(width_) + x;
      for (int k = 0; k < 3; ++k) {
        const double mean = mean_of(moments[i].mean[k], moments[i].flags, k);
        result.mean[to][k] = mean;
        if (result.frames > 1)
          result.variance[to][k] = std::isfinite(mean) ? moments[i].squares[k] / (n - 1.0) : kNoNumber;
      }
    }
  }
  return result;
}

}  // namespace plumbline
