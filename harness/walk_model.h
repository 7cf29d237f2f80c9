// SPDX-License-Identifier: GPL-3.0-or-later
// The walk of a geometry image re-enacted in double precision, from the format and the paper alone: how many nodes a
// ray visits, how many primitives it tests, how many transforms it enters. A walk that finds what it should may still
// go where it need not; this tells.
#pragma once

#include <cstdint>

#include "scenes/ray.h"
#include "tracer/geometry_image.h"

namespace plumbline {

struct ModelWalk {
  std::uint32_t steps = 0, tests = 0, transforms = 0;
  /// No comparison on the way was nearer to a draw than 2^-15 of the space at hand, far more than 32 bits lose. Else
  /// the shader may walk otherwise.
  bool is_clear = true;
};

/// Of a defined ray in a sound image whose units are the world's. `any`: of a shadow ray, which ends at the first
/// cluster in which something is hit. A clear ray meets no triangle that the shader may find to be seen edge-on.
ModelWalk model_walk(const GeometryImage& image, const Ray& ray, bool any = false);

}  // namespace plumbline
