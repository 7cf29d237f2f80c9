// SPDX-License-Identifier: GPL-3.0-or-later
// Mutation testing kills what it should, lets live what changes nothing, and tells which lines a program compiles.
#include "harness/mutation.h"

#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "harness/active_lines.h"
#include "harness/hit_cases.h"
#include "harness/mutation_oracles.h"
#include "harness/mutation_scenes.h"
#include "harness/walk_model.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/rays.h"
#include "tracer/embedded_shaders.h"
#include "tracer/probe.h"

namespace plumbline {
namespace {

ShaderText shader_of(const std::string& text) {
  ShaderText shader;
  shader.files = {"a.glsl"};
  shader.starts = {0};
  shader.text = text;
  return shader;
}

/// The lines that are compiled, directives left out, one after the other.
std::string compiled(const std::string& text) {
  std::string kept;
  const ActiveLines lines = active_lines(shader_of(text));
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);)
    if (is_active(lines, "a.glsl", ++number) && !line.starts_with('#')) kept += line;
  return kept;
}

/// What the oracle of that name says of a mutant.
std::string verdict_of(std::vector<MutationOracle>& oracles, GlContext& context, const std::string& oracle,
                       const std::string& mutant) {
  for (const Mutant& m : all_mutants()) {
    if (!name_of(m).starts_with(mutant)) continue;
    for (const MutationOracle& o : oracles) {
      if (o.name != oracle) continue;
      CHECK(o.sees(m));
      context.set_patches({patch_of(m)});
      const std::string what = o.ask(m);
      context.set_patches({});
      return what;
    }
  }
  throw std::runtime_error("there is no mutant " + mutant + ", or no oracle " + oracle);
}

}  // namespace

TEST_CASE("lines that a program compiles are told by its conditions", "[mutation]") {
  CHECK(compiled("a\n#ifdef X\nb\n#else\nc\n#endif\nd\n") == "acd");
  CHECK(compiled("#define X\n#ifdef X\nb\n#else\nc\n#endif\n") == "b");
  CHECK(compiled("#define N 3\n#if N > 2 && !defined(Y)\nb\n#elif N == 3\nc\n#endif\n") == "b");
  CHECK(compiled("#define N 3\n#if N < 2\nb\n#elif N == 3\nc\n#else\nd\n#endif\n") == "c");
  // What stands under #if 0 is a text to be read: nothing is switched off here.
  CHECK(compiled("#if 0\n#if 1\na\n#else\nb\n#endif\n#endif\nc\n") == "c");
  CHECK(compiled("#if UNKNOWN\na\n#endif\n#if (1 || 0) && 2 >= 2\nb\n#endif\n") == "b");
  CHECK_THROWS_AS(active_lines(shader_of("#if 1 +\n#endif\n")), InputError);
  CHECK_THROWS_AS(active_lines(shader_of("#endif\n")), InputError);
}

TEST_CASE("a mutant is seen, and one that changes nothing is not", "[mutation]") {
  GlContext context;
  std::vector<MutationOracle> oracles = arithmetic_oracles(context);
  for (const MutationOracle& oracle : oracles) CHECK(oracle.ask({}).empty());
  // The rotation of a step of MD5; a value that both branches after it overwrite.
  CHECK_FALSE(verdict_of(oracles, context, "random.digests", "random.glsl:35:85: - becomes +").empty());
  CHECK(verdict_of(oracles, context, "sums", "accumulate.frag.glsl:50:21: 0.0 becomes 1.0").empty());
}

TEST_CASE("judges whose answers follow from whole numbers are silent on the sound shaders", "[mutation]") {
  GlContext context;
  for (const MutationOracle& oracle : tie_oracles(context))
    CHECK(oracle.name + ": " + oracle.ask({}) == oracle.name + ": ");
}

TEST_CASE("walks are re-enacted in C++, node by node", "[mutation]") {
  const Scene scene = generate_scene("sphereflake", 2);
  const RaySource source(scene);
  std::vector<Ray> rays(512);
  generate_rays(source, RayFamily::chords, 1, 0, rays);
  GlContext context;
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      BakeOptions options;
      options.layout = layout, options.bounds = bounds;
      const GeometryImage image = bake(scene, options);
      std::vector<Hit> hits(rays.size());
      Probe(context, image).trace(rays, hits);
      std::size_t clear = 0, wrong = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const ModelWalk model = model_walk(image, rays[i]);
        clear += model.is_clear;
        wrong += model.is_clear && (model.steps != hits[i].steps || model.tests != hits[i].primitive_tests);
      }
      CHECK(clear > rays.size() / 2);
      CHECK(wrong == 0);
    }
}

TEST_CASE("walks are interrupted where no mutant is", "[mutation]") {
  GlContext context;
  for (const char* name : {"sphereflake:1", "nested"})
    for (const Layout layout : {Layout::compact, Layout::paper}) {
      BakeOptions options;
      options.layout = layout;
      const GeometryImage image = bake(load_scene(name), options);
      std::vector<std::vector<ShaderPatch>> interruptions{slices_of(image)};
      if (image.transform_count > 0) interruptions.push_back(loops_that_end(image, 8));
      for (const std::vector<ShaderPatch>& patches : interruptions)
        for (const ShaderPatch& patch : patches) {
          std::string_view text;
          for (const EmbeddedShader& file : embedded_shaders())
            if (file.name == patch.file) text = file.text;
          const std::size_t at = text.find(patch.find);
          REQUIRE(at != std::string_view::npos);
          for (const Mutant& m : mutants_of(patch.file, text))
            CHECK((m.at + m.before.size() <= at || m.at >= at + patch.find.size()));
          // And a mutant before it in the file does not move it.
          const AddedPatches mutant(context, std::array{patch_of(mutants_of(patch.file, text).front())});
          const AddedPatches added(context, patches);
          CHECK_NOTHROW(Probe(context, image));
        }
    }
}

TEST_CASE("walks whose loops a driver ends go on, and answer as a loop over all primitives does", "[mutation]") {
  GlContext context;
  const Scene scene = load_scene("nested");
  const RaySource source(scene);
  const std::vector<Ray> rays = mixed_rays(source, 1, 96);
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    BakeOptions options;
    options.layout = layout;
    const GeometryImage image = bake(scene, options);
    std::vector<Hit> known(rays.size());
    Probe(context, image, Traversal::brute_force).trace(rays, known);
    for (const int rounds : {16, 40})
      for (const int bundle : {1, 2, 4}) {
        const AddedPatches ended(context, loops_that_end(image, rounds));
        std::vector<Hit> hits(rays.size());
        Probe probe = bundle > 1 ? Probe(context, image, BundleSize{bundle}) : Probe(context, image);
        probe.trace(rays, hits);
        CHECK(probe.resumed_passes() > 0);
        std::size_t other = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) other += same_bits(hits[i], known[i]) ? 0 : 1;
        INFO(name_of(layout) << ", " << rounds << " rounds, bundles of " << bundle);
        CHECK(other == 0);
      }
  }
}

TEST_CASE("the list of equivalent mutants is read whole or refused", "[mutation]") {
  CHECK_FALSE(read_equivalent_mutants(equivalent_mutants_file()).empty());
  const auto file = std::filesystem::temp_directory_path() / "plumbline_equivalent_test.json";
  const auto refused = [&](const std::string& text) {
    std::ofstream(file) << text;
    CHECK_THROWS_AS(read_equivalent_mutants(file), InputError);
  };
  refused("{}");
  refused(R"([{"file": "a.glsl", "line": "x"}])");
  refused(R"([{"file": "a.glsl", "reason": "x"}])");
  refused(R"([{"file": "a.glsl", "line": "x", "reason": "y", "why": "z"}])");
  std::filesystem::remove(file);
}

}  // namespace plumbline
