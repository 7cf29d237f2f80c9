// SPDX-License-Identifier: GPL-3.0-or-later
// Mutants are found by rule, where code is and nowhere else, and each fits its shader as a patch.
#include "harness/mutants.h"

#include <catch2/catch.hpp>
#include <set>

#include "tracer/embedded_shaders.h"

namespace plumbline {
namespace {

/// "3: < -> <=" of each mutant: its column, what stands there and what becomes of it.
std::vector<std::string> changes(std::string_view text) {
  std::vector<std::string> all;
  for (const Mutant& m : mutants_of("a.glsl", text))
    all.push_back(std::to_string(m.column) + ": " + m.before + " -> " + m.after);
  return all;
}
using Changes = std::vector<std::string>;

}  // namespace

TEST_CASE("each rule changes what it names", "[mutants]") {
  CHECK(changes("a < b;") == Changes{"3: < -> <=", "3: < -> >"});
  CHECK(changes("a >= b;") == Changes{"3: >= -> >"});
  CHECK(changes("a == b && !c;") == Changes{"3: == -> !=", "8: && -> ||", "11: ! -> "});
  CHECK(changes("a = -b - c;") == Changes{"5: - -> ", "8: - -> +"});
  CHECK(changes("return -a;") == Changes{"8: - -> "});
  CHECK(changes("(a) - b[i] * -c;") == Changes{"5: - -> +", "12: * -> /", "14: - -> "});
  CHECK(changes("++a; a *= b >> c;") == Changes{"1: ++ -> --", "8: *= -> /=", "13: >> -> <<"});
  CHECK(changes("a &= ~b | c ^ d;") == Changes{"3: &= -> |=", "6: ~ -> ", "9: | -> &", "13: ^ -> |"});
  CHECK(changes("f(0, 7, 0u, 0xffu, 4294967295u);") ==
        Changes{"3: 0 -> 1", "6: 7 -> 8", "9: 0u -> 1u", "13: 0xffu -> 0x100u", "20: 4294967295u -> 0u"});
  CHECK(changes("f(0.0, 1.5e-3, .5, true);") ==
        Changes{"3: 0.0 -> 1.0", "8: 1.5e-3 -> (2.0 * 1.5e-3)", "16: .5 -> (2.0 * .5)", "20: true -> false"});
  CHECK(changes("a.x, b.xyz, c[1].yx, d.t, e.xx;") ==
        Changes{"3: x -> y", "8: xyz -> yzx", "15: 1 -> 2", "18: yx -> xy", "29: xx -> yx"});
}

TEST_CASE("comments, directives and layouts have no mutants, macros do", "[mutants]") {
  CHECK(changes("// a < 1\n/* b + 2\n - 3 */\n#if A > 1 && B\n#include <x>\n  #endif\n").empty());
  CHECK(changes("layout(location = 3) out vec4 v;").empty());
  CHECK(changes("layout(location = 3) out vec4 v; a + b;") == Changes{"36: + -> -"});
  CHECK(changes("#define N 3\n#define F(x, y) ((x) & 1)\n") == Changes{"11: 3 -> 4", "22: & -> |", "24: 1 -> 2"});
  CHECK(changes("#ifdef CAPTURE\na + b;\n#ifdef X\n1\n#endif\n2\n#else\n  c - d;\n#endif\n3\n") ==
        Changes{"5: - -> +", "1: 3 -> 4"});
  const std::vector<Mutant> mutants = mutants_of("a.glsl", "int f() {\n  return a\n    + b;  // sum\n}\n");
  REQUIRE(mutants.size() == 1);
  CHECK(mutants[0].line == 3);
  CHECK(mutants[0].line_text == "+ b;  // sum");
  CHECK(name_of(mutants[0]) == "a.glsl:3:5: + becomes -");
}

TEST_CASE("every mutant of the production shaders fits its file, and no two are alike", "[mutants]") {
  const std::vector<Mutant> all = all_mutants();
  CHECK(all.size() > 2000);
  std::set<std::string> names, files;
  for (const Mutant& m : all) {
    names.insert(name_of(m));
    files.insert(m.file);
    CHECK_FALSE(exclusion_of(m.file));
  }
  CHECK(names.size() == all.size());
  std::set<std::string> expected;
  for (const EmbeddedShader& shader : embedded_shaders()) {
    if (!exclusion_of(shader.name) && shader.name != "pass_constants.glsl") expected.emplace(shader.name);
    for (const Mutant& m : mutants_of(shader.name, shader.text)) {
      CHECK(shader.text.substr(m.at, m.before.size()) == m.before);
      CHECK(m.before != m.after);
    }
  }
  CHECK(files == expected);
}

}  // namespace plumbline
