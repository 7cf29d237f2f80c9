// SPDX-License-Identifier: MIT
// The files of tracer/shaders/ as the build put them into the library (embed_shaders.cmake).
#pragma once

#include <span>
#include <string_view>

namespace plumbline {

struct EmbeddedShader {
  std::string_view name;  ///< "triangle.glsl"
  std::string_view text;
};
std::span<const EmbeddedShader> embedded_shaders();

}  // namespace plumbline
