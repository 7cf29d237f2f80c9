// SPDX-License-Identifier: GPL-3.0-or-later
// The rays that the renderer really sends: tapped from a small picture with all effects, for the hit-by-hit comparison.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/ray.h"
#include "scenes/scene.h"
#include "tracer/gl_context.h"

namespace plumbline {

/// Rays of a picture, in the order in which the passes traced them.
struct CapturedRays {
  std::vector<Ray> rays;              ///< world space; shadow rays end at t_max = 1
  std::vector<Hit> hits;              ///< what the renderer's own walk answered; of shadow rays only the kind is told
  std::vector<bool> is_shadow;        ///< asked whether it hits anything, not what first
  std::vector<std::uint32_t> number;  ///< of the ray within its sample, 1 to 63; of a shadow ray that of the hit's ray
  std::uint64_t traced = 0;           ///< rays of the picture, of which these are an even choice
};

/// At most `most` rays of a picture of the scene as it stands: its animation is left out, so that all rays belong to
/// one placing of the instances. The picture is as large as `most` asks for. Where it sends more, rays are taken at
/// even distances from all of them. Throws as Renderer does.
CapturedRays capture_rays(GlContext& context, const Scene& scene, std::uint64_t seed, std::size_t most);

}  // namespace plumbline
