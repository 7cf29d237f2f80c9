// SPDX-License-Identifier: MIT
// Changes to the shaders' text, for faults on purpose.
#pragma once

#include <cstddef>
#include <string>

namespace plumbline {

/// A change to one shader file. Where `at` is not given, `find` must stand in the file exactly once.
struct ShaderPatch {
  static constexpr std::size_t kAnywhere = static_cast<std::size_t>(-1);
  std::string file;  ///< "triangle.glsl"
  std::string find, replace;
  std::size_t at = kAnywhere;  ///< where `find` begins, bytes from the start of the file
};

}  // namespace plumbline
