// SPDX-License-Identifier: MIT
#include "tracer/small_pass.h"

namespace plumbline {

std::vector<AnswerWords> run_small_pass(GlContext& context, const SmallPass& pass, const InputTexels& input) {
  const GlFunctions& gl = context.use();
  const GlTexture texture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, input.width, input.height, input.texels.data());
  const GlTexture target =
      pass.has_float_target
          ? GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, pass.width, pass.height)
          : GlTexture(context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, pass.width, pass.height);
  const GlFramebuffer framebuffer(context, &target, 1);
  const GlProgram program(context, link_program(context, probe_vertex_shader(), pass.fragment));
  program.use();
  program.set("u_input", 0);
  program.set("u_factor", glm::vec4(1.0f));
  if (pass.set_uniforms) pass.set_uniforms(program);
  texture.bind(0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  program.draw(pass.width, pass.height);
  std::vector<AnswerWords> answers(static_cast<std::size_t>(pass.width) * static_cast<std::size_t>(pass.height));
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  if (pass.has_float_target) {
    gl.ReadPixels(0, 0, pass.width, pass.height, GL_RGBA, GL_FLOAT, answers.data());
  } else {
    gl.ReadPixels(0, 0, pass.width, pass.height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, answers.data());
  }
  context.check("reading a pass of questions");
  return answers;
}

}  // namespace plumbline
