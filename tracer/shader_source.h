// SPDX-License-Identifier: MIT
// The GLSL sources, which are built into the library, composed into whole shaders from explicit lists of files.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tracer/geometry_image.h"
#include "tracer/gl_context.h"
#include "tracer/shader_patch.h"

namespace plumbline {

/// A #define before the shader's own text; an empty value defines the bare name.
using ShaderDefine = std::pair<std::string, std::string>;

/// The GLSL dialects that the same files are valid in; a header is all that differs.
enum class GlslDialect { glsl_330, es_300 };

/// One shader composed of files. Lines are numbered so that compile errors can be told by file and line.
struct ShaderText {
  std::vector<std::string> files;   ///< in order, as under tracer/shaders/
  std::vector<std::size_t> starts;  ///< where in `text` each begins
  std::string text;
};

/// Joins the named files. Throws InputError for a patch that does not fit.
ShaderText compose_shader(std::span<const std::string_view> files, std::span<const ShaderDefine> defines,
                          std::span<const ShaderPatch> patches = {}, GlslDialect dialect = GlslDialect::glsl_330);

/// The patches that change files of a shader; the others are for other shaders.
std::vector<ShaderPatch> patches_for(const ShaderText& shader, std::span<const ShaderPatch> patches);

/// A driver's message with its line numbers replaced by ours: "tracer/shaders/triangle.glsl:12: ...".
std::string translate_log(const ShaderText& shader, const std::string& log);

/// Compiles and links a program, with the context's patches. Throws EnvironmentError with the translated messages, and
/// InputError for a patch that does not fit.
GLuint link_program(GlContext& context, const ShaderText& vertex, const ShaderText& fragment);

/// Which code a geometry image needs: the primitives in it decide too, since a driver may run both sides of every `if`.
struct ProgramVariant {
  Layout layout = Layout::compact;
  Bounds bounds = Bounds::sphere;
  bool has_triangles = false, has_spheres = false;
  bool brute_force = false;
  /// False: a ray that needs rare code (a triangle seen edge-on, an origin very far away) is left unfinished, to go on
  /// in the thorough program of the same image.
  bool thorough = false;
  bool has_transforms = false;
  bool out_inverse = false;   ///< of transforms
  bool capture = false;       ///< keeps what happens on the walk (walk_trace.h); else nothing of that is in the text
  bool count_visits = false;  ///< counts the visits of every node (Probe::count_visits); else nothing of that is
  bool finish = false;        ///< walks nothing: makes results of what bundles have found
  int bundle = 1;             ///< rays that walk the tree together; more than one: bundle.frag.glsl, never thorough
  bool rendering = false;     ///< rays, and states of walks that go on, come from textures that shaders have drawn into
  bool any_hit = false;       ///< ends at the first hit that is met; only whether there is one is told
  int found_bundle = 1;       ///< where `finish`: of what bundles
  bool operator==(const ProgramVariant&) const = default;
};
ProgramVariant program_variant(const GeometryImage& image, bool brute_force, bool thorough);

/// The production fragment shader of a variant, and its vertex shader.
ShaderText probe_fragment_shader(const ProgramVariant& variant, std::span<const ShaderPatch> patches = {},
                                 GlslDialect dialect = GlslDialect::glsl_330);
ShaderText probe_vertex_shader(GlslDialect dialect = GlslDialect::glsl_330);

}  // namespace plumbline
