// SPDX-License-Identifier: MIT
// The production renderer: distributed ray tracing by SEMANTICS 6 and 7, wholly in shaders. All samples of a batch go
// through the same passes: their primary rays walk the geometry image, each light is asked by shadow rays, and what is
// reflected or refracted walks in turn, ray number by ray number. The host issues passes and moves no ray.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/rendered_picture.h"
#include "tracer/geometry_image.h"
#include "tracer/gl_context.h"
#include "tracer/probe.h"

namespace plumbline {

/// Where random numbers come from (SEMANTICS 7.1).
enum class RandomKind {
  hash,     ///< an integer hash in the shader
  md5,      ///< MD5 in the shader, the paper's future work
  texture,  ///< an image of noise, renewed each frame: the paper's
};
const char* name_of(RandomKind kind);

struct RenderSettings {
  int width = 0, height = 0;  ///< pixels; 0: the scene camera's
  std::uint32_t frames = 1;   ///< samples of each pixel, at least 1
  std::uint32_t first_frame = 0;
  std::uint64_t seed = 0;               ///< of the random numbers
  double time = 0.0;                    ///< of the picture, seconds
  std::optional<Effects> effects = {};  ///< instead of the scene's
  RandomKind random = RandomKind::hash;
  BundleSize bundle = {};  ///< rays that walk together: of the samples of a pixel where a batch
                           ///< holds several, else of its neighbours; 1 with motion blur
  BakeOptions bake;
  std::vector<ShaderPatch> patches;  ///< faults on purpose
};

/// What a sample's passes have done, handed out as it happens. Samples of a batch are told by position: see `pixel`.
struct TappedBatch {
  int tile_x = 0, tile_y = 0, tile_height = 0, lanes = 1;  ///< as in shaders/item.glsl
  int columns = 0, rows = 0;                               ///< items of the batch, row by row
  std::uint32_t first_frame = 0;
  glm::uvec2 pixel(std::size_t item) const;
  std::uint32_t frame(std::size_t item) const;
};
class RenderTap {
 public:
  virtual ~RenderTap() = default;
  /// Rays of one number and what they hit, one for each item. `light` is kNone, or that of shadow rays, of which only
  /// the kind of the hit is told. Items without such a ray have a direction of zero.
  virtual void rays(const TappedBatch& batch, std::uint32_t ray, std::uint32_t light, std::span<const Ray> rays,
                    std::span<const Hit> hits) = 0;
  /// The numbers that a ray's passes have drawn (SEMANTICS 7.3), from the dimension `first` on: three (two for the
  /// place in the pixel) for each item. Items that have drawn none have zeros
  /// (the place in the pixel a half).
  virtual void numbers(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first,
                       std::span<const glm::vec4> numbers) = 0;
  /// The perturbations that these numbers became (SEMANTICS 7.4), likewise: of the lens, a light, or a normal.
  virtual void places(const TappedBatch&, std::uint32_t /*ray*/, std::uint32_t /*first*/,
                      std::span<const glm::vec4> /*places*/) {}
  /// The colours of the batch's samples.
  virtual void samples(const TappedBatch& batch, std::span<const glm::vec4> colors) = 0;
};

/// Seconds that rays have walked for, passes after walks not among them.
struct WalkSeconds {
  double primary = 0.0, shadow = 0.0, bounced = 0.0;  ///< bounced: reflected and refracted
};

/// Called with the share that is done; false ends the rendering.
using RenderProgress = std::function<bool(double share)>;

class Renderer {
 public:
  /// Copies the scene, bakes it and compiles the shaders. The context must outlive the renderer. Throws InputError for
  /// a camera that sees nothing, a lens that reaches the plane of what is sharp, sizes or counts out of range, and as
  /// bake() and Probe do.
  Renderer(GlContext& context, const Scene& scene, const RenderSettings& settings);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  bool lit_by_default() const;             ///< the scene had no light, and is lit by default_light
  const RenderSettings& settings() const;  ///< with the size, the effects and the bundle that are meant
  const GeometryImage& image() const;      ///< at the time of what was drawn last

  /// Adds frames to the picture. False where `progress` ended it: some tiles then hold more frames than others, and
  /// restart() comes before anything else.
  bool add_frames(std::uint32_t first, std::uint32_t count, const RenderProgress& progress = {});
  /// Forgets all frames; another time may be set for those to come.
  void restart(double time);
  /// The picture of the frames added so far.
  RenderedPicture picture();
  /// The same without what sharp rays tell: mean and variance alone.
  RenderedPicture moments();

  /// restart, all frames of the settings, and the picture; nothing where `progress` ended it.
  std::optional<RenderedPicture> render(const RenderProgress& progress = {});

  /// Who is told of all rays from now on; null for none. Costs time.
  void set_tap(RenderTap* tap);

  /// Rays that have walked so far, shadow rays included, and passes that they took.
  std::uint64_t rays_traced() const;
  std::uint64_t passes() const;
  WalkSeconds walk_seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
