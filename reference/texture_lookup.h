// SPDX-License-Identifier: GPL-3.0-or-later
// The value of a texture at a place, and the slopes of a height map (SEMANTICS 6.4, points 4 and 5).
#pragma once

#include "scenes/scene.h"

namespace plumbline {

/// The colour at (u, v): bilinear, repeated in both directions; (0, 0) is the lower left corner.
glm::dvec3 texture_value(const Texture& texture, const glm::dvec2& uv);

/// The derivatives of a height map by u and v at (u, v): central differences of its texels, filtered like colours.
glm::dvec2 height_slopes(const Texture& texture, const glm::dvec2& uv);

}  // namespace plumbline
