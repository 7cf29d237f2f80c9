// SPDX-License-Identifier: GPL-3.0-or-later
// Mutants: every operator, constant and swizzle of the production shaders changed by rule, one at a time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/shader_patch.h"

namespace plumbline {

/// What a rule changes.
///   relational   < <= > >= to its neighbour, < and > to each other as well; == to != and back
///   logical      && to || and back; ! dropped
///   arithmetic   + to -, * to / and back, % to /; ++ to -- and back; the same in assignments; unary minus dropped
///   bitwise      >> to <<, & to | and back, ^ to |; ~ dropped; the same in assignments
///   constant     0 to 1, integer c to c + 1, 0.0 to 1.0, float c to 2 c; true to false and back
///   swizzle      its components moved on by one: .xyz to .yzx, .xy to .yx, .x to .y
enum class MutationRule { relational, logical, arithmetic, bitwise, constant, swizzle };
const char* name_of(MutationRule rule);

struct Mutant {
  std::string file;          ///< "triangle.glsl"
  std::size_t at = 0;        ///< bytes from the start of the file
  int line = 0, column = 0;  ///< from 1
  MutationRule rule = MutationRule::relational;
  std::string before, after;  ///< the token and what stands in its place
  std::string line_text;      ///< the whole line, without the blanks around it
};

/// "triangle.glsl:45:12: < becomes <=".
std::string name_of(const Mutant& mutant);
ShaderPatch patch_of(const Mutant& mutant);

/// The mutants of a shader's text, in its order. Comments are left alone, and so are preprocessor lines but for the
/// text of macros; numbers in layout(...) are declarations of the interface. What stands under #ifdef CAPTURE or
/// COUNT_VISITS watches the walk for explanations, and is in no production program.
std::vector<Mutant> mutants_of(std::string_view file, std::string_view text);

/// Why a shader file has no mutants; nothing where it is production.
std::optional<std::string> exclusion_of(std::string_view file);

/// The mutants of all production shaders, file by file.
std::vector<Mutant> all_mutants();

/// The feature that a shader file serves, as the catalogue names features: "hits", "transforms", ...
std::string feature_of(std::string_view file);

}  // namespace plumbline
