// SPDX-License-Identifier: MIT
// One pass of a fragment shader over a texture of numbers, its answers as words: for questions to the driver, and for
// tests of single shader files.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "tracer/gl_objects.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// What the shader reads as `uniform sampler2D u_input`: RGBA32F texels, row by row.
struct InputTexels {
  int width = 0, height = 0;
  std::vector<glm::vec4> texels;
};

/// What a pixel has written, bit by bit.
using AnswerWords = std::array<std::uint32_t, 4>;

struct SmallPass {
  ShaderText fragment;                                      ///< with one output, at location 0
  int width = 0, height = 0;                                ///< pixels drawn
  bool has_float_target = false;                            ///< the output is a vec4, else a uvec4
  std::function<void(const GlProgram&)> set_uniforms = {};  ///< those beside u_input and the constants of the pass
};

/// Draws and reads back, row by row. Throws EnvironmentError where the driver refuses.
std::vector<AnswerWords> run_small_pass(GlContext& context, const SmallPass& pass, const InputTexels& input);

}  // namespace plumbline
