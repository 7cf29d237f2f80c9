// SPDX-License-Identifier: MIT
// An OpenGL core context without a window, and the GL functions that the tracer calls. Its .cpp is the only file that
// names OSMesa.
#pragma once

#include <GL/glcorearb.h>

#include <memory>
#include <string>
#include <vector>

#include "tracer/shader_patch.h"

/// Every GL function that this project calls: X(member of GlFunctions, type). Add a line to use another.
#define PLUMBLINE_GL_FUNCTIONS(X)                            \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                   \
  X(AttachShader, PFNGLATTACHSHADERPROC)                     \
  X(BeginQuery, PFNGLBEGINQUERYPROC)                         \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                         \
  X(BindBufferBase, PFNGLBINDBUFFERBASEPROC)                 \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)               \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                       \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)               \
  X(BufferSubData, PFNGLBUFFERSUBDATAPROC)                   \
  X(BufferData, PFNGLBUFFERDATAPROC)                         \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC) \
  X(ClearBufferfv, PFNGLCLEARBUFFERFVPROC)                   \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                   \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                   \
  X(CreateShader, PFNGLCREATESHADERPROC)                     \
  X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                   \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)         \
  X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                   \
  X(DeleteQueries, PFNGLDELETEQUERIESPROC)                   \
  X(DeleteShader, PFNGLDELETESHADERPROC)                     \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                 \
  X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)         \
  X(Disable, PFNGLDISABLEPROC)                               \
  X(DrawArrays, PFNGLDRAWARRAYSPROC)                         \
  X(DrawBuffers, PFNGLDRAWBUFFERSPROC)                       \
  X(EndQuery, PFNGLENDQUERYPROC)                             \
  X(Finish, PFNGLFINISHPROC)                                 \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)     \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                         \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)               \
  X(GenQueries, PFNGLGENQUERIESPROC)                         \
  X(GenTextures, PFNGLGENTEXTURESPROC)                       \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)               \
  X(GetBufferSubData, PFNGLGETBUFFERSUBDATAPROC)             \
  X(GetError, PFNGLGETERRORPROC)                             \
  X(GetIntegerv, PFNGLGETINTEGERVPROC)                       \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)           \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                     \
  X(GetQueryObjectuiv, PFNGLGETQUERYOBJECTUIVPROC)           \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)             \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                       \
  X(GetString, PFNGLGETSTRINGPROC)                           \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)         \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                       \
  X(MemoryBarrier, PFNGLMEMORYBARRIERPROC)                   \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                         \
  X(ReadPixels, PFNGLREADPIXELSPROC)                         \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                     \
  X(TexBuffer, PFNGLTEXBUFFERPROC)                           \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                         \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                   \
  X(TexSubImage2D, PFNGLTEXSUBIMAGE2DPROC)                   \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                           \
  X(Uniform4f, PFNGLUNIFORM4FPROC)                           \
  X(Uniform4i, PFNGLUNIFORM4IPROC)                           \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                         \
  X(Viewport, PFNGLVIEWPORTPROC)

namespace plumbline {

/// The loaded entry points: `gl.DrawArrays(...)` is glDrawArrays.
struct GlFunctions {
#define PLUMBLINE_GL_MEMBER(name, type) type name = nullptr;
  PLUMBLINE_GL_FUNCTIONS(PLUMBLINE_GL_MEMBER)
#undef PLUMBLINE_GL_MEMBER
};

/// Owns one OpenGL core context (4.5 where the driver has it, at least 3.3). Several may live side by side, also in
/// several threads; each is used by one thread at a time.
class GlContext {
 public:
  /// Throws EnvironmentError where the machine offers no such context.
  GlContext();
  ~GlContext();
  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;

  /// Makes the context current in this thread and returns its functions. Cheap where it is current already.
  const GlFunctions& use();

  const std::string& renderer() const;  ///< GL_RENDERER, "llvmpipe (LLVM 15.0.6, 256 bits)"
  const std::string& version() const;   ///< GL_VERSION, "4.5 (Core Profile) Mesa 22.3.6"
  int max_texture_size() const;         ///< texels per side
  int max_buffer_texels() const;        ///< of a buffer texture

  /// Changes to shader files that every program linked from now on has where it contains the file: faults on purpose.
  void set_patches(std::vector<ShaderPatch> patches);
  const std::vector<ShaderPatch>& patches() const;

  /// Throws EnvironmentError naming `doing` if the driver has recorded an error since the last call.
  void check(const char* doing);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
