// SPDX-License-Identifier: MIT
// Transforms and keyframes as scene files write them (SCENE_FILES.md), computed in double.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <vector>

#include "scenes/animation.h"
#include "scenes/json_document.h"
#include "scenes/transform.h"

namespace plumbline {

struct FileTransform {
  TransformD matrix;
  bool is_simple = true;  ///< translation * rotation * scale, as below: what keyframes can move
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 scale{1.0};
};

/// An object of translate, rotate, shear, scale or matrix, or a list of such that are applied first to last.
FileTransform read_transform(const JsonPlace& place);

/// The rotation about an axis (not zero) by degrees. Quarter turns about coordinate axes are exact.
glm::dmat3 rotation_about(const glm::dvec3& axis, double degrees);

/// A list of keyframes for a node whose transform without them is `rest`. Animation::node is left open.
Animation read_keyframes(const JsonPlace& place, const FileTransform& rest);

/// The transforms of the copies that a node's `repeat` and `jitter` make of it, whose own transform is `own`; nullopt
/// without `repeat`. Throws where there are more than `most`.
std::optional<std::vector<TransformD>> read_copies(const JsonPlace& node, const TransformD& own, std::uint32_t most);

/// Rounded once to floats. Throws at `place` where the result cannot be used (transform_error).
Transform rounded(const JsonPlace& place, const TransformD& transform);

}  // namespace plumbline
