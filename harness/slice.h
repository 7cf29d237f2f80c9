// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a walk: a cut through the volumes that the ray met, by a plane that holds the ray.
#pragma once

#include "reports/explanation.h"
#include "scenes/scene.h"
#include "tracer/walk_analysis.h"

namespace plumbline {

/// What is drawn beside the volumes.
struct SliceMarks {
  ExpectedHit truth;  ///< primitive kNone: a miss
  Hit answer;
};

/// Cuts along the ray, and through the middle of what is at fault (or of the truth's primitive), so that it is seen at
/// its full size. Volumes of every space stand where the image's own matrices place them. Of more than `most` volumes
/// those on the chain, then those that were entered, then the first are drawn.
SliceRecord slice_of(const GeometryImage& image, const Scene& scene, const Walk& walk, const Loss& loss,
                     const SliceMarks& marks, std::size_t most = 1200);

}  // namespace plumbline
