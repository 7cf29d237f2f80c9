// SPDX-License-Identifier: MIT
#include "tracer/gl_objects.h"

#include <array>

#include "scenes/error.h"

namespace plumbline {

GlTexture::GlTexture(GlContext& context, GLenum internal_format, GLenum format, GLenum type, int width, int height,
                     const void* texels)
    : context_(&context) {
  const GlFunctions& gl = context.use();
  gl.GenTextures(1, &name_);
  gl.BindTexture(GL_TEXTURE_2D, name_);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type, texels);
  context.check("allocating a texture");
}

GlTexture GlTexture::linear(GlContext& context, std::span<const glm::vec4> texels) {
  const GlFunctions& gl = context.use();
  GlTexture texture;
  texture.context_ = &context;
  texture.target_ = GL_TEXTURE_BUFFER;
  gl.GenBuffers(1, &texture.buffer_);
  gl.BindBuffer(GL_TEXTURE_BUFFER, texture.buffer_);
  gl.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels.size_bytes()), texels.data(), GL_STATIC_DRAW);
  gl.GenTextures(1, &texture.name_);
  gl.BindTexture(GL_TEXTURE_BUFFER, texture.name_);
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, texture.buffer_);
  context.check("allocating a buffer texture");
  return texture;
}

void GlTexture::update(std::span<const glm::vec4> texels, std::size_t first) const {
  const GlFunctions& gl = context_->use();
  gl.BindBuffer(GL_TEXTURE_BUFFER, buffer_);
  gl.BufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(first * sizeof(glm::vec4)),
                   static_cast<GLsizeiptr>(texels.size_bytes()), texels.data());
}

void GlTexture::update_row(int x, int y, std::span<const glm::vec4> texels) const {
  const GlFunctions& gl = context_->use();
  gl.BindTexture(GL_TEXTURE_2D, name_);
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, x, y, static_cast<GLsizei>(texels.size()), 1, GL_RGBA, GL_FLOAT, texels.data());
}

void GlTexture::update_rows(int y, int width, std::span<const glm::vec4> texels) const {
  const GlFunctions& gl = context_->use();
  gl.BindTexture(GL_TEXTURE_2D, name_);
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, width, static_cast<GLsizei>(texels.size()) / width, GL_RGBA, GL_FLOAT,
                   texels.data());
}

GlTexture::~GlTexture() {
  if (name_ != 0) context_->use().DeleteTextures(1, &name_);
  if (buffer_ != 0) context_->use().DeleteBuffers(1, &buffer_);
}

void GlTexture::bind(int unit) const {
  const GlFunctions& gl = context_->use();
  gl.ActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  gl.BindTexture(target_, name_);
}

GlCounters::GlCounters(GlContext& context, std::size_t count) : context_(&context), count_(count) {
  const GlFunctions& gl = context.use();
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (gl.GetError() != GL_NO_ERROR || count * sizeof(std::uint32_t) > static_cast<std::size_t>(most)) {
    throw EnvironmentError("the OpenGL driver (" + context.renderer() + ") has no storage buffer of " +
                           std::to_string(count) + " counters");
  }
  const std::vector<std::uint32_t> zeros(count, 0);
  gl.GenBuffers(1, &name_);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(count * sizeof(std::uint32_t)), zeros.data(),
                GL_DYNAMIC_COPY);
  context.check("allocating counters");
}

GlCounters::~GlCounters() {
  if (name_ != 0) context_->use().DeleteBuffers(1, &name_);
}

void GlCounters::bind(GLuint index) const { context_->use().BindBufferBase(GL_SHADER_STORAGE_BUFFER, index, name_); }

std::vector<std::uint32_t> GlCounters::read() const {
  const GlFunctions& gl = context_->use();
  std::vector<std::uint32_t> counts(count_, 0);
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(count_ * sizeof(std::uint32_t)),
                      counts.data());
  context_->check("reading counters");
  return counts;
}

GlFramebuffer::GlFramebuffer(GlContext& context, const GlTexture* targets, int count) : context_(&context) {
  const GlFunctions& gl = context.use();
  gl.GenFramebuffers(1, &name_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, name_);
  std::array<GLenum, 8> buffers{};
  for (int i = 0; i < count; ++i) {
    buffers[static_cast<std::size_t>(i)] = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, buffers[static_cast<std::size_t>(i)], GL_TEXTURE_2D, targets[i].name(), 0);
  }
  gl.DrawBuffers(count, buffers.data());
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw EnvironmentError("the OpenGL driver can't draw into textures of 32-bit channels (" + context.renderer() +
                           ")");
  }
}

GlFramebuffer::~GlFramebuffer() {
  if (name_ != 0) context_->use().DeleteFramebuffers(1, &name_);
}

GlProgram::GlProgram(GlContext& context, GLuint program) : context_(&context), program_(program) {
  context.use().GenVertexArrays(1, &vertex_array_);
}

GlProgram::~GlProgram() {
  if (program_ != 0) context_->use().DeleteProgram(program_);
  if (vertex_array_ != 0) context_->use().DeleteVertexArrays(1, &vertex_array_);
}

void GlProgram::use() const { context_->use().UseProgram(program_); }

void GlProgram::set(const char* name, int value) const {
  const GlFunctions& gl = context_->use();
  gl.Uniform1i(gl.GetUniformLocation(program_, name), value);
}
void GlProgram::set(const char* name, const glm::vec4& value) const {
  const GlFunctions& gl = context_->use();
  gl.Uniform4f(gl.GetUniformLocation(program_, name), value.x, value.y, value.z, value.w);
}
void GlProgram::set(const char* name, const glm::ivec4& value) const {
  const GlFunctions& gl = context_->use();
  gl.Uniform4i(gl.GetUniformLocation(program_, name), value.x, value.y, value.z, value.w);
}

void GlProgram::draw(int width, int height) const {
  const GlFunctions& gl = context_->use();
  gl.UseProgram(program_);
  gl.BindVertexArray(vertex_array_);
  gl.Viewport(0, 0, width, height);
  set("u_size", glm::ivec4(width, height, 0, 0));
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace plumbline
