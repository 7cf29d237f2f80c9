// SPDX-License-Identifier: MIT
// Shaders are composed of files, compile in both dialects and every variant, and their errors name our files and lines.
#include "tracer/shader_source.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "scenes/error.h"
#include "tracer/embedded_shaders.h"
#include "tracer/gl_objects.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

std::string embedded(std::string_view name) {
  for (const EmbeddedShader& shader : embedded_shaders()) {
    if (shader.name == name) return std::string(shader.text);
  }
  return {};
}

/// The number of the line on which `text` stands in a shader file, from 1.
std::string line_of(const char* file, const std::string& text) {
  const std::string source = embedded(file);
  const std::size_t at = source.find(text);
  REQUIRE(at != std::string::npos);
  return std::to_string(1 + std::count(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace

TEST_CASE("every variant compiles, in GLSL 3.30 and in GLSL ES 3.00", "[shader]") {
  GlContext context;
  for (const GlslDialect dialect : {GlslDialect::glsl_330, GlslDialect::es_300}) {
    for (const Layout layout : {Layout::compact, Layout::paper}) {
      for (const bool brute_force : {false, true}) {
        for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
          for (const int kinds : {1, 2, 3}) {
            const ProgramVariant variant{layout,           bounds,      (kinds & 1) != 0,
                                         (kinds & 2) != 0, brute_force, brute_force != (kinds == 3)};
            INFO("layout " << name_of(layout) << ", bounds " << name_of(bounds) << ", kinds " << kinds
                           << ", brute force " << brute_force);
            REQUIRE_NOTHROW(GlProgram(context, link_program(context, probe_vertex_shader(dialect),
                                                            probe_fragment_shader(variant, {}, dialect))));
          }
        }
      }
    }
  }
}

TEST_CASE("bundles compile, in GLSL 3.30 and in GLSL ES 3.00", "[shader]") {
  GlContext context;
  for (const GlslDialect dialect : {GlslDialect::glsl_330, GlslDialect::es_300}) {
    for (const int rays : {2, 3, 4}) {
      ProgramVariant variant;
      variant.has_triangles = variant.has_spheres = true;
      variant.bundle = rays;
      variant.layout = rays == 3 ? Layout::paper : Layout::compact;
      variant.has_transforms = variant.out_inverse = rays == 2;
      INFO("bundles of " << rays);
      REQUIRE_NOTHROW(GlProgram(
          context, link_program(context, probe_vertex_shader(dialect), probe_fragment_shader(variant, {}, dialect))));
    }
  }
}

TEST_CASE("a compile error names our file and line", "[shader]") {
  GlContext context;
  const std::array<ShaderPatch, 1> patches{
      ShaderPatch{"triangle.glsl", "float inverse = 1.0 / det;", "float inverse = 1.0 / no_such_name;"}};
  const ShaderText shader =
      probe_fragment_shader({Layout::compact, Bounds::sphere, true, false, false, false}, patches);
  const std::string place =
      "tracer/shaders/triangle.glsl:" + line_of("triangle.glsl", "float inverse = 1.0 / det;") + ":";
  CHECK_THROWS_AS(link_program(context, probe_vertex_shader(), shader), EnvironmentError);
  CHECK_THROWS_WITH(link_program(context, probe_vertex_shader(), shader), Contains(place) && Contains("no_such_name"));
}

TEST_CASE("messages of several drivers are understood", "[shader]") {
  ShaderText shader;
  shader.files = {"exact.glsl", "triangle.glsl"};
  CHECK(translate_log(shader, "0:20012(5): error: x\n") == "tracer/shaders/triangle.glsl:12: error: x\n");
  CHECK(translate_log(shader, "0(10007) : error C0000: y\n") == "tracer/shaders/exact.glsl:7: error C0000: y\n");
  CHECK(translate_log(shader, "ERROR: 0:20003: z\n") == "ERROR: tracer/shaders/triangle.glsl:3: z\n");
  CHECK(translate_log(shader, "linking failed\n") == "linking failed\n");
}

TEST_CASE("a patch must fit exactly once", "[shader]") {
  const ProgramVariant variant{Layout::compact, Bounds::sphere, true, true, false, false};
  const auto composed = [&](ShaderPatch patch) {
    const std::array<ShaderPatch, 1> patches{std::move(patch)};
    return probe_fragment_shader(variant, patches).text;
  };
  CHECK_THROWS_AS(composed({"triangle.glsl", "no such text", ""}), InputError);
  CHECK_THROWS_AS(composed({"triangle.glsl", "vec3", ""}), InputError);
  CHECK_THROWS_AS(composed({"triangle.glsl", "", "x"}), InputError);
  CHECK_THROWS_AS(composed({"walk_paper.glsl", "vec2 at", "x"}), InputError);  // not part of this shader
  CHECK_THAT(composed({"sphere.glsl", "foot - half_chord", "foot + half_chord"}),
             Contains("enter = foot + half_chord"));
  CHECK_THROWS_AS(compose_shader(std::array<std::string_view, 1>{"no_such_file.glsl"}, {}), InputError);
}
