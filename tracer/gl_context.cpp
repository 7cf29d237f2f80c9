// SPDX-License-Identifier: MIT
// Creates the context through OSMesa, Mesa's off-screen interface, and loads the GL functions from it.
#include "tracer/gl_context.h"

#include <GL/osmesa.h>

#include <array>
#include <cstdint>
#include <utility>

#include "scenes/error.h"

#ifdef __SANITIZE_ADDRESS__
// OSMesa keeps a list of its framebuffers until the process ends: 1.6 KB that are no leak of ours.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa\n";
}  // NOLINT(bugprone-reserved-identifier)
#endif

namespace plumbline {

struct GlContext::Impl {
  OSMesaContext context = nullptr;
  std::array<std::uint8_t, 4> window{};  // OSMesa wants a colour buffer; everything is drawn into textures instead
  GlFunctions functions;
  std::string renderer, version;
  int max_texture_size = 0, max_buffer_texels = 0;
  std::vector<ShaderPatch> patches;

  ~Impl() {
    if (context != nullptr) OSMesaDestroyContext(context);
  }
  void make_current() {
    if (OSMesaGetCurrentContext() == context) return;
    if (!OSMesaMakeCurrent(context, window.data(), GL_UNSIGNED_BYTE, 1, 1)) {
      throw EnvironmentError("OSMesa refuses to make its OpenGL context current; reinstall the package libosmesa6");
    }
  }
};

namespace {

OSMesaContext create_context() {
  for (const auto& [major, minor] : {std::pair{4, 5}, std::pair{3, 3}}) {
    const std::array<int, 13> attributes{OSMESA_FORMAT,
                                         OSMESA_RGBA,
                                         OSMESA_DEPTH_BITS,
                                         0,
                                         OSMESA_PROFILE,
                                         OSMESA_CORE_PROFILE,
                                         OSMESA_CONTEXT_MAJOR_VERSION,
                                         major,
                                         OSMESA_CONTEXT_MINOR_VERSION,
                                         minor,
                                         0,
                                         0,
                                         0};
    if (OSMesaContext context = OSMesaCreateContextAttribs(attributes.data(), nullptr)) return context;
  }
  throw EnvironmentError(
      "OSMesa offers no OpenGL 3.3 core context; install the package libosmesa6 and unset GALLIUM_DRIVER, "
      "MESA_GL_VERSION_OVERRIDE and LIBGL_DRIVERS_PATH");
}

}  // namespace

GlContext::GlContext() : impl_(std::make_unique<Impl>()) {
  impl_->context = create_context();
  impl_->make_current();
  GlFunctions& gl = impl_->functions;
#define PLUMBLINE_GL_LOAD(name, type)                                 \
  gl.name = reinterpret_cast<type>(OSMesaGetProcAddress("gl" #name)); \
  if (gl.name == nullptr) throw EnvironmentError("the OpenGL driver lacks the function gl" #name);
  PLUMBLINE_GL_FUNCTIONS(PLUMBLINE_GL_LOAD)
#undef PLUMBLINE_GL_LOAD
  impl_->renderer = reinterpret_cast<const char*>(gl.GetString(GL_RENDERER));
  impl_->version = reinterpret_cast<const char*>(gl.GetString(GL_VERSION));
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &impl_->max_texture_size);
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &impl_->max_buffer_texels);
}

GlContext::~GlContext() = default;
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;

const GlFunctions& GlContext::use() {
  impl_->make_current();
  return impl_->functions;
}

const std::string& GlContext::renderer() const { return impl_->renderer; }
const std::string& GlContext::version() const { return impl_->version; }
int GlContext::max_texture_size() const { return impl_->max_texture_size; }
int GlContext::max_buffer_texels() const { return impl_->max_buffer_texels; }

void GlContext::set_patches(std::vector<ShaderPatch> patches) { impl_->patches = std::move(patches); }
const std::vector<ShaderPatch>& GlContext::patches() const { return impl_->patches; }

void GlContext::check(const char* doing) {
  const GLenum error = use().GetError();
  if (error == GL_NO_ERROR) return;
  const char* name = error == GL_OUT_OF_MEMORY       ? "out of memory"
                     : error == GL_INVALID_ENUM      ? "invalid enum"
                     : error == GL_INVALID_VALUE     ? "invalid value"
                     : error == GL_INVALID_OPERATION ? "invalid operation"
                                                     : "invalid framebuffer operation";
  throw EnvironmentError(std::string("the OpenGL driver reports \"") + name + "\" while " + doing + " (" + renderer() +
                         ")");
}

}  // namespace plumbline
