// SPDX-License-Identifier: GPL-3.0-or-later
// Two walks of one ray beside each other: step by step where the images are of one shape, by what was tested and what
// came of it where they are built otherwise.
#pragma once

#include "reports/explanation.h"
#include "tracer/walk_analysis.h"

namespace plumbline {

/// A walk and what it went through.
struct ComparedWalk {
  const Walk* walk = nullptr;
  const GeometryImage* image = nullptr;  ///< null: a walk from a file, whose image is not at hand
  std::string shape;                     ///< shape_of(image)
};

/// `first` has an image. Fills all but `with` and `second_answer`.
ComparisonRecord compare_walks(const ComparedWalk& first, const ComparedWalk& second);

}  // namespace plumbline
