// SPDX-License-Identifier: MIT
#include "tracer/ray_targets.h"

#include "tracer/shader_words.h"

namespace plumbline {

template <int kCount>
FloatTargets<kCount>::FloatTargets(GlContext& context) {
  for (GlTexture& texture : textures)
    texture = GlTexture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, kBatchWidth, kRenderRows);
  framebuffer = GlFramebuffer(context, textures.data(), kCount);
}
template struct FloatTargets<1>;
template struct FloatTargets<2>;
template struct FloatTargets<3>;
template struct FloatTargets<4>;

HitTargets::HitTargets(GlContext& context, int count) {
  for (int i = 0; i < count; ++i)
    textures[static_cast<std::size_t>(i)] =
        GlTexture(context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kBatchWidth, kRenderRows);
  framebuffer = GlFramebuffer(context, textures.data(), count);
}

GlSampleCount::GlSampleCount(GlContext& context) : context_(&context) { context.use().GenQueries(1, &name_); }
GlSampleCount::~GlSampleCount() {
  if (name_ != 0) context_->use().DeleteQueries(1, &name_);
}
void GlSampleCount::begin() const { context_->use().BeginQuery(GL_SAMPLES_PASSED, name_); }
std::uint32_t GlSampleCount::end() const {
  const GlFunctions& gl = context_->use();
  gl.EndQuery(GL_SAMPLES_PASSED);
  GLuint count = 0;
  gl.GetQueryObjectuiv(name_, GL_QUERY_RESULT, &count);
  return count;
}

}  // namespace plumbline
