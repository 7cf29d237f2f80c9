// SPDX-License-Identifier: GPL-3.0-or-later
// Bilinear lookups in double precision.
#include "reference/texture_lookup.h"

#include <cmath>

namespace plumbline {

namespace {

/// Texel (column, row), repeated; both are at most a few textures out of range.
glm::dvec3 texel(const Texture& texture, int column, int row) {
  const auto wrapped = [](int i, int size) { return ((i % size) + size) % size; };
  const std::size_t at =
      static_cast<std::size_t>(wrapped(row, texture.height)) * static_cast<std::size_t>(texture.width) +
      static_cast<std::size_t>(wrapped(column, texture.width));
  return glm::dvec3(texture.texels[at]);
}

/// The mean of `value` at the four texels around (u, v), weighted by nearness.
template <class Value>
auto bilinear(const Texture& texture, const glm::dvec2& uv, Value value) {
  const double x = (uv.x - std::floor(uv.x)) * texture.width - 0.5;
  const double y = (1.0 - (uv.y - std::floor(uv.y))) * texture.height - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double p = x - i, q = y - j;
  return (1.0 - q) * ((1.0 - p) * value(i, j) + p * value(i + 1, j)) +
         q * ((1.0 - p) * value(i, j + 1) + p * value(i + 1, j + 1));
}

}  // namespace

glm::dvec3 texture_value(const Texture& texture, const glm::dvec2& uv) {
  return bilinear(texture, uv, [&](int i, int j) { return texel(texture, i, j); });
}

glm::dvec2 height_slopes(const Texture& texture, const glm::dvec2& uv) {
  const glm::dvec2 difference = bilinear(texture, uv, [&](int i, int j) {
    // Rows go down, v goes up.
    return glm::dvec2(texel(texture, i + 1, j).r - texel(texture, i - 1, j).r,
                      texel(texture, i, j - 1).r - texel(texture, i, j + 1).r);
  });
  return 0.5 * glm::dvec2(texture.width, texture.height) * difference;
}

}  // namespace plumbline
