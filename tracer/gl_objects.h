// SPDX-License-Identifier: MIT
// Owners of single GL objects: what a probe or a driver case creates is deleted with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "tracer/gl_context.h"

namespace plumbline {

/// A texture without filtering or further levels. Moves; deletes the texture in its own context.
class GlTexture {
 public:
  GlTexture() = default;
  /// A buffer texture: RGBA32F texels in one row of any length up to the driver's limit.
  static GlTexture linear(GlContext& context, std::span<const glm::vec4> texels);
  /// Replaces texels of a buffer texture, from `first` on.
  void update(std::span<const glm::vec4> texels, std::size_t first = 0) const;
  /// Replaces a rectangle of one row of an RGBA32F texture.
  void update_row(int x, int y, std::span<const glm::vec4> texels) const;
  /// Replaces whole rows of an RGBA32F texture of this width.
  void update_rows(int y, int width, std::span<const glm::vec4> texels) const;
  /// Allocates width * height texels, from `texels` if it is not null.
  GlTexture(GlContext& context, GLenum internal_format, GLenum format, GLenum type, int width, int height,
            const void* texels = nullptr);
  ~GlTexture();
  GlTexture(GlTexture&& other) noexcept { *this = std::move(other); }
  GlTexture& operator=(GlTexture&& other) noexcept {
    std::swap(context_, other.context_), std::swap(target_, other.target_);
    std::swap(name_, other.name_), std::swap(buffer_, other.buffer_);
    return *this;
  }
  GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }
  /// Makes this the texture of a unit.
  void bind(int unit) const;

 private:
  GlContext* context_ = nullptr;
  GLenum target_ = GL_TEXTURE_2D;
  GLuint name_ = 0, buffer_ = 0;
};

/// Counters that shaders add to: a storage buffer of unsigned integers, all 0 to begin with.
class GlCounters {
 public:
  GlCounters() = default;
  /// Throws EnvironmentError where the driver has no storage buffers, or none as large.
  GlCounters(GlContext& context, std::size_t count);
  ~GlCounters();
  GlCounters(GlCounters&& other) noexcept { *this = std::move(other); }
  GlCounters& operator=(GlCounters&& other) noexcept {
    std::swap(context_, other.context_), std::swap(name_, other.name_), std::swap(count_, other.count_);
    return *this;
  }
  explicit operator bool() const { return name_ != 0; }
  /// Makes these the counters of the storage block `index`.
  void bind(GLuint index) const;
  /// The counts so far, when all that was drawn has ended.
  std::vector<std::uint32_t> read() const;

 private:
  GlContext* context_ = nullptr;
  GLuint name_ = 0;
  std::size_t count_ = 0;
};

/// A framebuffer that draws into textures, attachment i into targets[i].
class GlFramebuffer {
 public:
  GlFramebuffer() = default;
  GlFramebuffer(GlContext& context, const GlTexture* targets, int count);
  ~GlFramebuffer();
  GlFramebuffer(GlFramebuffer&& other) noexcept : context_(other.context_), name_(std::exchange(other.name_, 0)) {}
  GlFramebuffer& operator=(GlFramebuffer&& other) noexcept {
    std::swap(context_, other.context_), std::swap(name_, other.name_);
    return *this;
  }
  GLuint name() const { return name_; }

 private:
  GlContext* context_ = nullptr;
  GLuint name_ = 0;
};

/// A linked program, and the vertex array that a core profile wants bound while drawing.
class GlProgram {
 public:
  GlProgram() = default;
  GlProgram(GlContext& context, GLuint program);
  ~GlProgram();
  GlProgram(GlProgram&& other) noexcept
      : context_(other.context_),
        program_(std::exchange(other.program_, 0)),
        vertex_array_(std::exchange(other.vertex_array_, 0)) {}
  GlProgram& operator=(GlProgram&& other) noexcept {
    std::swap(context_, other.context_), std::swap(program_, other.program_),
        std::swap(vertex_array_, other.vertex_array_);
    return *this;
  }
  void use() const;
  /// Sets a uniform of the program in use; a name that the compiler has dropped is ignored.
  void set(const char* name, int value) const;
  void set(const char* name, const glm::vec4& value) const;
  void set(const char* name, const glm::ivec4& value) const;
  /// Draws one triangle over a viewport of this size, which the program may read as `u_size`.
  void draw(int width, int height) const;

 private:
  GlContext* context_ = nullptr;
  GLuint program_ = 0, vertex_array_ = 0;
};

}  // namespace plumbline
