// SPDX-License-Identifier: MIT
// Where rendering passes leave rays and hits for one another: textures of one batch, and the count of what is left to do.
#pragma once

#include <array>
#include <cstdint>

#include "tracer/gl_objects.h"
#include "tracer/pass.h"

namespace plumbline {

/// A batch: samples side by side. Its width is kBatchWidth (tracer/shader_words.h), since shaders count rays by it.
inline constexpr int kRenderRows = 256;

/// Float textures of a batch's size that are drawn into together.
template <int kCount>
struct FloatTargets {
  std::array<GlTexture, kCount> textures;
  GlFramebuffer framebuffer;
  FloatTargets() = default;
  explicit FloatTargets(GlContext& context);
  explicit operator bool() const { return static_cast<bool>(textures[0]); }
};
extern template struct FloatTargets<1>;
extern template struct FloatTargets<2>;
extern template struct FloatTargets<3>;
extern template struct FloatTargets<4>;

/// What the walk's program writes of each ray; the last target only where there are transforms.
struct HitTargets {
  std::array<GlTexture, kPassTargets> textures;
  GlFramebuffer framebuffer;
  HitTargets() = default;
  HitTargets(GlContext& context, int count);
};

/// Counts the pixels that pass while it is active.
class GlSampleCount {
 public:
  GlSampleCount() = default;
  explicit GlSampleCount(GlContext& context);
  ~GlSampleCount();
  GlSampleCount(GlSampleCount&& other) noexcept
      : context_(other.context_), name_(std::exchange(other.name_, 0)) {}
  GlSampleCount& operator=(GlSampleCount&& other) noexcept {
    std::swap(context_, other.context_), std::swap(name_, other.name_);
    return *this;
  }
  void begin() const;
  /// Waits for what was drawn since begin().
  std::uint32_t end() const;

 private:
  GlContext* context_ = nullptr;
  GLuint name_ = 0;
};

}  // namespace plumbline
