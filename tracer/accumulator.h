#pragma once
#include <vector>
#include "tracer/gl_objects.h"
#include "tracer/render_passes.h"
namespace plumbline {
struct AccumulatedMoments { std::uint32_t frames = 0; std::vector<glm::dvec3> mean, variance; };
class Accumulator {
 public:
  Accumulator(GlContext& c, int w, int h) : context(&c), width(w), height(h) { clear(); }
  void clear() { sum.assign(size_t(width) * height, glm::dvec3(0.0)); squares = sum; count.assign(sum.size(), 0); }
  void add(const GlTexture& samples, const RenderBatch& b) {
    const GlFunctions& gl = context->use();
    GlFramebuffer fb(*context, &samples, 1);
    std::vector<glm::vec4> v(size_t(b.columns) * b.rows);
    gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl.ReadPixels(0, 0, b.columns, b.rows, GL_RGBA, GL_FLOAT, v.data());
    for (int y = 0; y < b.tile_height; ++y) for (int x = 0; x < b.tile_width; ++x)
      for (int k = 0; k < b.blocks; ++k) for (int l = 0; l < b.lanes; ++l) {
        glm::dvec3 c(v[size_t(k * b.tile_height + y) * b.columns + x * b.lanes + l]);
        size_t p = size_t(b.tile_y + y) * width + b.tile_x + x;
        sum[p] += c; squares[p] += c * c; ++count[p];
      }
  }
  AccumulatedMoments read() const {
    AccumulatedMoments m; m.frames = count.empty() ? 0 : count[0];
    for (size_t i = 0; i < sum.size(); ++i) { double n = count[i]; m.mean.push_back(sum[i] / n); if (m.frames > 1) m.variance.push_back((squares[i] - sum[i] * sum[i] / n) / (n - 1)); }
    return m;
  }
 private:
  GlContext* context; int width, height; std::vector<glm::dvec3> sum, squares; std::vector<std::uint32_t> count;
};
}
