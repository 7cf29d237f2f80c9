// SPDX-License-Identifier: MIT
#include "tracer/shader_source.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <sstream>

#include "scenes/error.h"
#include "tracer/bake.h"
#include "tracer/embedded_shaders.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

// Mesa keeps the line of a #line directive but not its file number, so the file stands in the line: line 12 of the file
// number 3 (from 1) is line 30012.
constexpr int kLinesPerFile = 10000;

std::string_view shader_file(std::string_view name) {
  for (const EmbeddedShader& shader : embedded_shaders()) {
    if (shader.name == name) return shader.text;
  }
  throw InputError("there is no shader file tracer/shaders/" + std::string(name));
}

/// Where a patch's text begins in that of its file.
std::size_t place_of(const ShaderPatch& patch, std::string_view text) {
  const bool is_placed = patch.at != ShaderPatch::kAnywhere;
  const std::size_t at = is_placed ? patch.at : text.find(patch.find);
  const bool is_found = !patch.find.empty() && at <= text.size() && text.substr(at, patch.find.size()) == patch.find;
  if (!is_found || (!is_placed && text.find(patch.find, at + 1) != std::string_view::npos))
    throw InputError("a shader patch must find its text " + std::string(is_placed ? "in its place" : "exactly once") +
                     " in tracer/shaders/" + patch.file + ": " + patch.find);
  return at;
}

std::string patched(std::string_view name, std::span<const ShaderPatch> patches) {
  std::string text(shader_file(name));
  for (const ShaderPatch& patch : patches)
    if (patch.file == name) text.replace(place_of(patch, text), patch.find.size(), patch.replace);
  return text;
}

/// A composed shader with the context's patches.
ShaderText patched(ShaderText shader, std::span<const ShaderPatch> patches) {
  for (const ShaderPatch& patch : patches)
    for (std::size_t i = 0; i < shader.files.size(); ++i) {
      if (shader.files[i] != patch.file) continue;
      const std::size_t end = i + 1 < shader.files.size() ? shader.starts[i + 1] : shader.text.size();
      const std::string_view file = std::string_view(shader.text).substr(shader.starts[i], end - shader.starts[i]);
      shader.text.replace(shader.starts[i] + place_of(patch, file), patch.find.size(), patch.replace);
      for (std::size_t k = i + 1; k < shader.starts.size(); ++k)
        shader.starts[k] += patch.replace.size() - patch.find.size();
    }
  return shader;
}

/// A float as GLSL text that reads back as the same value: all of ours are short powers of two or whole numbers.
std::string glsl_float(double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.17e", value);
  return buffer.data();
}
std::string glsl_int(std::uint32_t bits) { return "int(" + std::to_string(bits) + "u)"; }

std::string compile_log(const GlFunctions& gl, GLuint object, bool is_program) {
  GLint length = 0;
  if (is_program) {
    gl.GetProgramiv(object, GL_INFO_LOG_LENGTH, &length);
  } else {
    gl.GetShaderiv(object, GL_INFO_LOG_LENGTH, &length);
  }
  std::string log(static_cast<std::size_t>(length), '\0');
  if (length == 0) return log;
  if (is_program) {
    gl.GetProgramInfoLog(object, length, nullptr, log.data());
  } else {
    gl.GetShaderInfoLog(object, length, nullptr, log.data());
  }
  log.resize(log.find('\0') == std::string::npos ? log.size() : log.find('\0'));
  return log;
}

void add_capture_defines(std::vector<ShaderDefine>& defines) {
  defines.emplace_back("CAPTURE", "");
  defines.emplace_back("CAPTURE_PIXELS", std::to_string(kCapturePixels));
  defines.emplace_back("CAPTURE_GOES_ON", std::to_string(kCaptureGoesOn));
  const std::pair<const char*, std::uint32_t> words[] = {{"CAPTURE_RAY", kCaptureRay},
                                                         {"CAPTURE_NODE", kCaptureNode},
                                                         {"CAPTURE_PRIMITIVE", kCapturePrimitive},
                                                         {"CAPTURE_EDGE_ON", kCaptureEdgeOn},
                                                         {"CAPTURE_ENTER", kCaptureEnter},
                                                         {"CAPTURE_LEAVE", kCaptureLeave},
                                                         {"CAPTURE_HIT", kCaptureHit},
                                                         {"CAPTURE_MISSES", kCaptureMisses},
                                                         {"CAPTURE_PENDING", kCapturePending},
                                                         {"CAPTURE_ACCEPTED", kCaptureAccepted},
                                                         {"CAPTURE_SPHERE", kCaptureSphere}};
  for (const auto& [name, value] : words) defines.emplace_back(name, std::to_string(value) + "u");
}

GLuint compile(const GlFunctions& gl, GLenum stage, const ShaderText& shader) {
  const GLuint object = gl.CreateShader(stage);
  const char* text = shader.text.c_str();
  gl.ShaderSource(object, 1, &text, nullptr);
  gl.CompileShader(object);
  GLint status = GL_FALSE;
  gl.GetShaderiv(object, GL_COMPILE_STATUS, &status);
  if (status == GL_TRUE) return object;
  const std::string log = translate_log(shader, compile_log(gl, object, false));
  gl.DeleteShader(object);
  throw EnvironmentError("the OpenGL driver refuses a shader:\n" + log);
}

}  // namespace

ShaderText compose_shader(std::span<const std::string_view> files, std::span<const ShaderDefine> defines,
                          std::span<const ShaderPatch> patches, GlslDialect dialect) {
  for (const ShaderPatch& patch : patches) {
    bool used = false;
    for (const std::string_view file : files) used = used || file == patch.file;
    if (!used)
      throw InputError("a shader patch names tracer/shaders/" + patch.file + ", which this shader does not contain");
  }
  ShaderText shader;
  shader.text = shader_file(dialect == GlslDialect::glsl_330 ? "header_330.glsl" : "header_300es.glsl");
  for (const auto& [name, value] : defines) shader.text += "#define " + name + " " + value + "\n";
  for (const std::string_view file : files) {
    shader.files.emplace_back(file);
    // The directive names the number of the line that follows it.
    shader.text += "#line " + std::to_string(static_cast<int>(shader.files.size()) * kLinesPerFile + 1) + "\n";
    shader.starts.push_back(shader.text.size());
    shader.text += patched(file, patches);
  }
  return shader;
}

std::vector<ShaderPatch> patches_for(const ShaderText& shader, std::span<const ShaderPatch> patches) {
  std::vector<ShaderPatch> own;
  for (const ShaderPatch& patch : patches)
    if (std::find(shader.files.begin(), shader.files.end(), patch.file) != shader.files.end()) own.push_back(patch);
  return own;
}

std::string translate_log(const ShaderText& shader, const std::string& log) {
  // Mesa: "0:30012(5): error: ..."; others: "0(30012) : error ..." or "ERROR: 0:30012: ...".
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::istringstream lines(log);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = std::min(line.find("0:"), line.find("0("));
    if (begin != std::string::npos && (begin == 0 || !is_digit(line[begin - 1]))) {
      int number = 0;
      const char* end = std::from_chars(line.data() + begin + 2, line.data() + line.size(), number).ptr;
      const std::size_t file = static_cast<std::size_t>(number / kLinesPerFile);
      if (file >= 1 && file <= shader.files.size()) {
        // What stands between the number and the message: a column in brackets, a closing bracket, a colon, spaces.
        std::size_t message = static_cast<std::size_t>(end - line.data());
        if (message < line.size() && line[message] == '(') message = std::min(line.find(')', message), line.size() - 1);
        while (message < line.size() && (line[message] == ')' || line[message] == ':' || line[message] == ' '))
          ++message;
        line = line.substr(0, begin) + "tracer/shaders/" + shader.files[file - 1] + ":" +
               std::to_string(number % kLinesPerFile) + ": " + line.substr(message);
      }
    }
    result += line + "\n";
  }
  return result;
}

GLuint link_program(GlContext& context, const ShaderText& vertex, const ShaderText& fragment) {
  const GlFunctions& gl = context.use();
  const GLuint vertex_shader = compile(gl, GL_VERTEX_SHADER, patched(vertex, context.patches()));
  GLuint fragment_shader = 0;
  try {
    fragment_shader = compile(gl, GL_FRAGMENT_SHADER, patched(fragment, context.patches()));
  } catch (...) {
    gl.DeleteShader(vertex_shader);
    throw;
  }
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, vertex_shader);
  gl.AttachShader(program, fragment_shader);
  gl.LinkProgram(program);
  gl.DeleteShader(vertex_shader);
  gl.DeleteShader(fragment_shader);
  GLint status = GL_FALSE;
  gl.GetProgramiv(program, GL_LINK_STATUS, &status);
  if (status == GL_TRUE) return program;
  const std::string log = translate_log(fragment, compile_log(gl, program, true));
  gl.DeleteProgram(program);
  throw EnvironmentError("the OpenGL driver refuses to link a shader:\n" + log);
}

ProgramVariant program_variant(const GeometryImage& image, bool brute_force, bool thorough) {
  // An image without primitives is walked by the code for triangles.
  return {image.options.layout,
          image.options.bounds,
          image.triangle_count > 0 || image.sphere_count == 0,
          image.sphere_count > 0,
          brute_force,
          thorough,
          image.transform_count > 0,
          image.transform_count > 0 && image.options.transform_out == TransformOut::inverse,
          false,
          false,
          false,
          1,
          false,
          false,
          1};
}

ShaderText probe_fragment_shader(const ProgramVariant& variant, std::span<const ShaderPatch> patches,
                                 GlslDialect dialect) {
  const bool compact = variant.layout == Layout::compact;
  std::vector<ShaderDefine> defines{
      {"EDGE_ON", glsl_float(kEdgeOn)},
      {"LEAST_DET", glsl_float(kLeastDet)},
      {"BATCH_WIDTH", std::to_string(kBatchWidth)},
      {"SHIFT_EXPONENT", std::to_string(kShiftExponent)},
      {"SHIFT_UNIT", glsl_float(1.0 / (1 << kShiftExponent))},
      {"NO_LABEL", glsl_float(kNoLabel)},
      {"KIND_SPHERE", glsl_float(kKindSphere)},
      {"END_WORD", glsl_int(kEndWord)},
      {"LINK_SPHERE", "(" + std::to_string(kLinkSphere) + ")"},
      {"LINK_TRANSFORM", "(" + std::to_string(kLinkTransform) + ")"},
      {"TRANSFORM_TEXELS", std::to_string(kTransformTexels)},
      {"MAX_DEPTH", std::to_string(kMaxDepth)},
      {"PRIMITIVE_STRIDE", std::to_string(primitive_stride(variant.layout, variant.has_triangles))},
      {"KIND_MISS", std::to_string(kWordMiss) + "u"},
      {"KIND_HIT", std::to_string(kWordHit) + "u"},
      {"KIND_UNDEFINED", std::to_string(kWordUndefined) + "u"},
      {"KIND_CAPPED", std::to_string(kWordCapped) + "u"},
      {"KIND_UNFINISHED", std::to_string(kWordUnfinished) + "u"},
      {"STATE_ENDED", std::to_string(kStateEnded) + "u"},
      {"STATE_NEW", std::to_string(kStateNew) + "u"},
      {"BUNDLE_SIZE", std::to_string(variant.bundle)},
      {"FOUND_BUNDLE", std::to_string(variant.found_bundle)},
  };
  if (variant.has_triangles) defines.emplace_back("HAS_TRIANGLES", "");
  if (variant.has_spheres) defines.emplace_back("HAS_SPHERES", "");
  if (variant.thorough) defines.emplace_back("THOROUGH", "");
  if (variant.has_transforms) defines.emplace_back("HAS_TRANSFORMS", "");
  if (variant.out_inverse) defines.emplace_back("OUT_INVERSE", "");
  if (variant.bounds == Bounds::aabb) defines.emplace_back("BOUNDS_AABB", "");
  if (variant.capture) add_capture_defines(defines);
  if (variant.count_visits) defines.emplace_back("COUNT_VISITS", "");
  if (variant.finish) defines.emplace_back("FINISH", "");
  // GLSL ES promises four targets only: there every bundle leaves its results to another pass.
  if (variant.bundle > 1 && variant.any_hit)
    defines.emplace_back("BUNDLE_KINDS", "");
  else if (variant.bundle == kBundleWithResults && dialect == GlslDialect::glsl_330)
    defines.emplace_back("BUNDLE_RESULTS", "");
  if (variant.rendering) defines.emplace_back("RENDERING", "");
  if (variant.any_hit) defines.emplace_back("ANY_HIT", "");
  defines.emplace_back("PASS_CONSTANT", "flat in");
  std::vector<std::string_view> files;
  if (variant.count_visits) files.emplace_back("count_visits.glsl");  // its #extension stands before everything else
  for (const char* file :
       {"pass_constants.glsl", "exact.glsl", "ray_prepare.glsl", "capture_event.glsl", "triangle.glsl", "sphere.glsl",
        compact ? "image_compact.glsl" : "image_paper.glsl", "walk_state.glsl"})
    if (variant.capture || file != std::string_view("capture_event.glsl")) files.emplace_back(file);
  if (variant.has_transforms) files.emplace_back("transform.glsl");
  for (const char* file : {"bundle.glsl", "candidate.glsl", "bounds.glsl"}) files.emplace_back(file);
  if (variant.capture) files.emplace_back("capture_walk.glsl");
  files.emplace_back(variant.brute_force ? "brute_force.glsl" : (compact ? "walk_compact.glsl" : "walk_paper.glsl"));
  if (variant.has_transforms && !variant.brute_force) files.emplace_back("change_space.glsl");
  if (variant.has_transforms && variant.bundle > 1) files.emplace_back("bundle_space.glsl");
  files.emplace_back("ray_start.glsl");
  if (variant.bundle == 1 || (variant.bundle == kBundleWithResults && !variant.any_hit)) files.emplace_back("result.glsl");
  files.emplace_back(variant.bundle > 1 ? "bundle.frag.glsl" : "probe.frag.glsl");
  return compose_shader(files, defines, patches, dialect);
}

ShaderText probe_vertex_shader(GlslDialect dialect) {
  const std::array<std::string_view, 2> files{"pass_constants.glsl", "probe.vert.glsl"};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"PASS_CONSTANT", "flat out"}};
  return compose_shader(files, defines, {}, dialect);
}

}  // namespace plumbline
