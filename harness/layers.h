// SPDX-License-Identifier: GPL-3.0-or-later
// Layers told apart: which part of the tracer gave the wrong answer to a ray.
#pragma once

#include <string_view>

#include "scenes/ray.h"
#include "tracer/walk_analysis.h"

namespace plumbline {

enum class Layer { none, tree, links, bounds, transform, primitive_arithmetic, driver };
std::string_view name_of(Layer layer);  ///< "tree", "primitive arithmetic"; empty for none

/// What the layer is told from.
struct LayerEvidence {
  const GeometryImage* image = nullptr;
  const GeometryImage* sound = nullptr;  ///< a bake of the same shape that is known to be right; null: none at hand
  const Walk* walk = nullptr;
  const Loss* loss = nullptr;  ///< where the truth is a hit
  Hit tracer;                  ///< what production answered
  bool brute_same = false;     ///< a loop over all primitives, in the same arithmetic, answers the same in every value
  ExpectedHit expected;        ///< primitive kNone: the truth is a miss
};

/// The layer of a wrong answer.
///   driver                the walk's pixels came to different ends, or the walk to another than production did
///   primitive arithmetic  a loop over all primitives answers the same: the tree is not asked there; or the right
///                         primitive was found, but t and weights contradict each other on the captured ray, or its
///                         normal points to the other side
///   transform             the ray was taken wrongly into a space or out of it: by the walk's Loss, or by the captured
///                         ray's distance from where the record's matrix takes it; or the right primitive was found as
///                         it should be in its space, and only what came out of it is wrong
///   bounds, links         by the walk's Loss
///   tree                  anything else: the image holds what it should not, or lacks what it should hold
Layer layer_of(const LayerEvidence& evidence);

/// The scene's node into whose space the captured ray was taken elsewhere than the record's matrix takes it; kNone:
/// none. An image's own wrong matrix is none of these.
std::uint32_t ray_led_astray(const GeometryImage& image, const Walk& walk);

}  // namespace plumbline
