// SPDX-License-Identifier: MIT
#include "scenes/animation.h"

#include <algorithm>
#include <limits>

#include "scenes/scene.h"

namespace plumbline {
namespace {

template <class T, class Mix>
T value_at(const std::vector<Keyframe<T>>& keys, double time, const T& rest, Mix mix) {
  if (keys.empty()) return rest;
  const auto next =
      std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Keyframe<T>& key) { return t < key.time; });
  if (next == keys.begin()) return keys.front().value;
  const Keyframe<T>& before = *(next - 1);
  if (next == keys.end()) return before.value;
  return mix(before.value, next->value, (time - before.time) / (next->time - before.time));
}

glm::dvec3 mix_vectors(const glm::dvec3& a, const glm::dvec3& b, double share) { return glm::mix(a, b, share); }

}  // namespace

Transform transform_at(const Animation& animation, double time) {
  const glm::dvec3 translation = value_at(animation.translation, time, animation.rest_translation, mix_vectors);
  const glm::dvec3 scale = value_at(animation.scale, time, animation.rest_scale, mix_vectors);
  const glm::dquat rotation =
      value_at(animation.rotation, time, animation.rest_rotation,
               [](const glm::dquat& a, const glm::dquat& b, double share) { return glm::slerp(a, b, share); });
  glm::dmat3 linear = glm::mat3_cast(rotation);
  for (int axis = 0; axis < 3; ++axis) linear[axis] *= scale[axis];
  return {glm::mat3(linear), glm::vec3(translation)};
}

TimeRange time_range(const Scene& scene) {
  TimeRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto include = [&](const auto& keys) {
    if (keys.empty()) return;
    range.first = std::min(range.first, keys.front().time);
    range.last = std::max(range.last, keys.back().time);
  };
  for (const Animation& animation : scene.animation) {
    include(animation.translation);
    include(animation.rotation);
    include(animation.scale);
  }
  return range.first <= range.last ? range : TimeRange{};
}

std::vector<std::uint32_t> set_time(Scene& scene, double time) {
  std::vector<std::uint32_t> moved;
  for (const Animation& animation : scene.animation) {
    scene.nodes[animation.node].transform = transform_at(animation, time);
    moved.push_back(animation.node);
  }
  return moved;
}

}  // namespace plumbline
