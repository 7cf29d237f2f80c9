// SPDX-License-Identifier: MIT
// Keyframes of a node's transform: translation, rotation and scale, each with times of its own.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "scenes/transform.h"

namespace plumbline {

template <class T>
struct Keyframe {
  double time = 0.0;  ///< seconds, ascending
  T value{};
};

/// How one node moves: transform = translate * rotate * scale. A channel without keyframes keeps `rest`. Before the
/// first keyframe and after the last their values hold; between them translation and scale are linear, rotation is
/// slerped the short way.
struct Animation {
  std::uint32_t node = kNone;
  glm::dvec3 rest_translation{0.0};
  glm::dquat rest_rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 rest_scale{1.0};
  std::vector<Keyframe<glm::dvec3>> translation, scale;
  std::vector<Keyframe<glm::dquat>> rotation;  ///< unit quaternions
};

struct Scene;

/// The transform at a time, computed in double and rounded once.
Transform transform_at(const Animation& animation, double time);
/// First and last time of all keyframes; both 0 without any.
struct TimeRange {
  double first = 0.0, last = 0.0;
};
TimeRange time_range(const Scene& scene);
/// Sets the `transform` (not `rest`) of all animated nodes; returns their indices.
std::vector<std::uint32_t> set_time(Scene& scene, double time);

}  // namespace plumbline
