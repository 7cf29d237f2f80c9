// SPDX-License-Identifier: MIT
// The probe: takes rays from a texture, walks the geometry image in the production shader, and writes hits.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenes/ray.h"
#include "tracer/geometry_image.h"
#include "tracer/gl_context.h"
#include "tracer/shader_source.h"

namespace plumbline {

enum class Traversal {
  tree,         ///< the production traversal
  brute_force,  ///< a loop over all primitives of the image that uses the production's own primitive functions
};

/// How many rays walk the tree together, 1 to kMostBundled (tracer/shader_words.h).
struct BundleSize {
  int rays = 1;
};

class Probe {
 public:
  /// Compiles the shader for the image's layout and uploads the image. The context must outlive the probe. `patches`
  /// change the shader's text (faults on purpose). Throws EnvironmentError where the driver refuses the shader, naming
  /// our GLSL file and line, and InputError for an image that is larger than the driver's textures.
  Probe(GlContext& context, const GeometryImage& image, Traversal traversal = Traversal::tree,
        std::span<const ShaderPatch> patches = {});
  /// The production traversal with bundles: rays b N to b N + N - 1 walk together, N = bundle.rays. Every ray has the
  /// answer that it has alone, bit for bit. Its steps are those of its bundle; its primitive tests and transforms are
  /// not counted (0) unless it had to walk alone.
  Probe(GlContext& context, const GeometryImage& image, BundleSize bundle, std::span<const ShaderPatch> patches = {});
  ~Probe();
  Probe(Probe&&) noexcept;
  Probe& operator=(Probe&&) noexcept;

  /// Traces every ray; any number of them, cut into batches inside. hits is as long as rays. Hits are the shader's
  /// bits.
  void trace(std::span<const Ray> rays, std::span<Hit> hits);

  /// Replaces the geometry image. Compiles nothing if it has the layout, the bounds and the kinds of primitives of one
  /// that this probe has held before.
  void set_image(const GeometryImage& image);

  /// Uploads the texels of an image that this probe holds already and that update_transforms has changed, and no
  /// others.
  void update(const GeometryImage& image, std::span<const TexelRange> changed);

  /// Texels that the last set_image() or update() has sent to the driver.
  std::uint64_t texels_uploaded() const;

  /// Seconds spent in the driver by the last trace(): drawing until the results were there, without upload and
  /// unpacking.
  double draw_seconds() const;

  /// Of these, seconds in passes beyond one per batch.
  double resumed_seconds() const;

  /// Passes that the last trace() took beyond one per batch, for walks longer than the driver's loops (65,535
  /// iterations in Mesa 22.3).
  int resumed_passes() const;

  /// Rays of the last trace() that their bundle has left to walk alone: those that are seen edge-on by a triangle, come
  /// from very far, or drift out of transforms another way than the others.
  std::uint64_t rays_left_alone() const;

 private:
  friend class VisitProbe;
  /// Without an image.
  Probe(GlContext& context, Traversal traversal, std::span<const ShaderPatch> patches);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// How often walks came to a node.
struct NodeVisits {
  std::uint32_t visits = 0;
  std::uint32_t hits = 0;  ///< of these, how often its bounding volume was hit; the end of a region always is
};

/// The production traversal with a counter at every node, which it slows down a little and changes in nothing else. A
/// walk that is started anew by another pass (rays that drift, see probe.frag.glsl) is counted as often as it is made.
class VisitProbe {
 public:
  /// Throws as Probe's constructor does, and EnvironmentError where the driver has no storage buffers (OpenGL 4.3).
  VisitProbe(GlContext& context, const GeometryImage& image, std::span<const ShaderPatch> patches = {});

  /// As Probe::trace.
  void trace(std::span<const Ray> rays, std::span<Hit> hits);

  /// Of the unit (texel or cell) where a node stands, by number, up to the primitives: by all rays traced so far. Sums
  /// wrap around at 2^32.
  std::vector<NodeVisits> visits() const;

 private:
  Probe probe_;
};

}  // namespace plumbline
