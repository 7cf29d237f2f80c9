// SPDX-License-Identifier: MIT
// Where each ray of a batch is put in the batch's picture. The driver walks neighbouring pixels together, eight at a
// time, and each waits for the slowest: so neighbours should go the same way. No answer depends on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

enum class RayOrder {
  picture,  ///< as given, row by row: neighbours in the picture are neighbours in the batch
  groups,   ///< as given, each eight rays in a row side by side
  sorted,   ///< sorted by direction and place, then as groups
};

/// The order that brings similar rays together, judged by a sample of them. `ball` is the scene's.
RayOrder choose_ray_order(std::span<const Ray> rays, const Ball& ball);

/// The pixel of each ray, counted row by row of kBatchWidth, and how many rows are needed. At most kBatchWidth *
/// kBatchHeight rays.
struct RayPlaces {
  std::vector<std::uint32_t> pixel;  ///< of ray i; all different
  int rows = 0;
};
RayPlaces place_rays(std::span<const Ray> rays, RayOrder order, const Ball& ball);

}  // namespace plumbline
