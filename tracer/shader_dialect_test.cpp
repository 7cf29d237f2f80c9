// SPDX-License-Identifier: MIT
// Every composed shader is GLSL ES 3.00 to the letter: judged by the language's reference compiler (glslangValidator),
// since a driver lets much pass that others refuse. (Of GLSL 3.30 it doesn't know `precise`; drivers judge that.)
#include <sys/wait.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "scenes/test_files.h"
#include "tracer/accumulator.h"
#include "tracer/ray_walk.h"
#include "tracer/render_passes.h"
#include "tracer/shader_source.h"

using namespace plumbline;

namespace {

/// What GLSL ES 3.00 promises; drivers of desktops have eight.
constexpr int kEsDrawBuffers = 4, kDrawBuffers = 8;

/// Shaders with the number of targets that they may have.
struct Judged {
  ShaderText shader;
  int draw_buffers = kEsDrawBuffers;
  const char* stage = "frag";
};

/// Settings of the compiler: its own, with other limits. An unset limit would count as 0.
std::string limits(int draw_buffers) {
  FILE* const pipe = ::popen("glslangValidator -c 2>/dev/null", "r");
  std::string text;
  std::array<char, 4096> buffer{};
  while (pipe != nullptr && std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) {
    const std::string line = buffer.data();
    text += line.starts_with("MaxDrawBuffers ") ? "MaxDrawBuffers " + std::to_string(draw_buffers) + "\n" : line;
  }
  if (pipe == nullptr || ::pclose(pipe) != 0 || text.find("MaxDrawBuffers") == std::string::npos)
    FAIL("glslangValidator is missing or doesn't run: install the package glslang-tools (see .ci/packages.txt)");
  return text;
}

/// What the compiler says against shaders, by our files and lines; empty if nothing.
std::string complaints(const std::vector<Judged>& all) {
  const TemporaryFolder folder;
  std::string found;
  for (const int draw_buffers : {kEsDrawBuffers, kDrawBuffers}) {
    std::map<std::string, const ShaderText*> shaders;
    std::string command = "glslangValidator " + folder.write("limits.conf", limits(draw_buffers)).string();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].draw_buffers != draw_buffers) continue;
      const std::string path = folder.write(std::to_string(i) + "." + all[i].stage, all[i].shader.text).string();
      shaders[path] = &all[i].shader;
      command += " " + path;
    }
    if (shaders.empty()) continue;
    const std::filesystem::path log = folder.path() / "log";
    const int status = std::system((command + " >" + log.string() + " 2>&1").c_str());
    const ShaderText* shader = nullptr;
    std::ifstream lines(log);
    std::size_t seen = 0;
    for (std::string line; std::getline(lines, line);) {
      if (const auto named = shaders.find(line); named != shaders.end()) {
        shader = named->second;
        ++seen;
      } else if (line.starts_with("ERROR: 0:") || line.starts_with("WARNING: 0:")) {
        found += shader == nullptr ? line + "\n" : shader->files.back() + ": " + translate_log(*shader, line);
      }
    }
    if (seen != shaders.size()) found += "the compiler did not judge every shader\n";
    if (found.empty() && (status == -1 || !WIFEXITED(status) || WEXITSTATUS(status) != 0))
      found += "the compiler fails: status " + std::to_string(status) + "\n";
  }
  return found;
}

/// Walks of every layout, kind of primitive and way of going out of transforms, as the probe and the renderer make
/// them.
std::vector<ProgramVariant> walks() {
  std::vector<ProgramVariant> all;
  int number = 0;
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const int kinds : {1, 2, 3}) {
      for (const int transforms : {0, 1, 2}) {
        if (transforms > 0 && kinds < 3) continue;  // primitives know nothing of transforms
        ProgramVariant v;
        v.layout = layout;
        v.bounds = number++ % 2 == 0 ? Bounds::sphere : Bounds::aabb;
        v.has_triangles = (kinds & 1) != 0, v.has_spheres = (kinds & 2) != 0;
        v.has_transforms = transforms > 0, v.out_inverse = transforms > 1;
        const auto add = [&](auto... changes) {
          ProgramVariant changed = v;
          (changes(changed), ...);
          all.push_back(changed);
        };
        const auto thorough = [](ProgramVariant& w) { w.thorough = true; };
        const auto brute = [](ProgramVariant& w) { w.brute_force = true; };
        const auto finish = [](ProgramVariant& w) { w.finish = true; };
        const auto capture = [](ProgramVariant& w) { w.capture = true; };
        const auto renders = [](ProgramVariant& w) { w.rendering = true; };
        const auto any = [](ProgramVariant& w) { w.rendering = w.any_hit = true; };
        const auto bundle = [](int rays) { return [rays](ProgramVariant& w) { w.bundle = rays; }; };
        const auto found = [](int rays) {
          return [rays](ProgramVariant& w) { w.finish = true, w.found_bundle = rays; };
        };
        add(), add(thorough), add(brute), add(brute, thorough), add(capture), add(capture, thorough), add(finish);
        add(renders), add(renders, thorough), add(any), add(any, thorough);
        for (const int rays : {2, 3, 4}) add(bundle(rays)), add(any, bundle(rays));
        add(renders, found(2 + number % 3));
      }
    }
  }
  return all;
}

std::vector<Judged> all_walks() {
  constexpr GlslDialect dialect = GlslDialect::es_300;
  std::vector<Judged> all{{probe_vertex_shader(dialect), kEsDrawBuffers, "vert"}};
  for (const ProgramVariant& walk : walks())
    all.push_back(
        {probe_fragment_shader(walk, {}, dialect), walk.bundle > 2 || walk.capture ? kDrawBuffers : kEsDrawBuffers});
  return all;
}

std::vector<Judged> all_shading() {
  std::vector<Judged> all{{accumulate_shader(GlslDialect::es_300)},
                          {spread_shader(2, false, false, GlslDialect::es_300)},
                          {spread_shader(2, false, true, GlslDialect::es_300)}};
  for (int bits = 0; bits < 64; ++bits) {
    ShadingVariant v;
    v.has_triangles = (bits & 1) != 0, v.has_spheres = (bits & 2) != 0, v.has_transforms = (bits & 4) != 0;
    v.has_textures = (bits & 8) != 0, v.is_paper = (bits & 16) != 0, v.is_physical = (bits & 32) != 0;
    v.primitive_count = 100;
    v.random = bits % 3 == 0 ? RandomKind::hash : bits % 3 == 1 ? RandomKind::md5 : RandomKind::texture;
    const auto add = [&](RenderPass pass, PassTap tap) {
      all.push_back({render_shader(pass, v, tap, {}, GlslDialect::es_300)});
    };
    add(RenderPass::light, PassTap::none), add(RenderPass::scatter, PassTap::none);
    if (bits % 4 == 3) add(RenderPass::light, PassTap::numbers), add(RenderPass::scatter, PassTap::numbers);
    if (!v.is_paper && !v.is_physical)
      add(RenderPass::add_light, PassTap::none), add(RenderPass::channels, PassTap::none);
    if (bits % 32 < 3)
      for (const PassTap tap : {PassTap::none, PassTap::numbers, PassTap::lens_numbers}) add(RenderPass::camera, tap);
    if (bits == 0) add(RenderPass::count_rays, PassTap::none);
  }
  return all;
}

}  // namespace

TEST_CASE("every walk is GLSL ES 3.00 to the letter, with the targets that it promises or, for large bundles, eight",
          "[dialect]") {
  // Capturing passes have eight as well: they are for looking at a walk on a desktop.
  CHECK(complaints(all_walks()) == "");
}

TEST_CASE("every shading pass is GLSL ES 3.00 to the letter, with the targets that ES promises", "[dialect]") {
  CHECK(complaints(all_shading()) == "");
}

TEST_CASE("what is not GLSL ES is found, by file and line", "[dialect]") {
  // A number is not converted by itself in ES.
  const std::array<ShaderPatch, 1> patches{
      ShaderPatch{"triangle.glsl", "float inverse = 1.0 / det;", "float inverse = 1 / det;"}};
  ProgramVariant variant;
  variant.has_triangles = true;
  const std::string found = complaints({{probe_fragment_shader(variant, patches, GlslDialect::es_300)}});
  CHECK_THAT(found, Catch::Matchers::Contains("tracer/shaders/triangle.glsl:"));
  // A fifth target is more than ES promises.
  variant.bundle = 3;
  const std::string bundle = complaints({{probe_fragment_shader(variant, {}, GlslDialect::es_300)}});
  CHECK_THAT(bundle, Catch::Matchers::Contains("tracer/shaders/bundle.frag.glsl:"));
}
