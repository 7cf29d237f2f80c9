// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: scenes and rays full of exact coincidences, made from small integers, and ways to disturb them.
#pragma once

#include <vector>

#include "scenes/random.h"
#include "scenes/ray.h"
#include "scenes/scene.h"
#include "scenes/ulp.h"

namespace plumbline::lattice {

/// A point with coordinates that are quarters in [-2, 2].
inline glm::vec3 point(Random& random) {
  const auto coordinate = [&] { return static_cast<float>(random.below(17)) * 0.25f - 2.0f; };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

/// Triangles that share corners, edges and planes, some without area, some twice; spheres that touch and coincide.
inline Scene scene(std::uint64_t seed, int triangles, int spheres) {
  Random random(seed, name_hash("lattice.scene"), 0);
  Scene result;
  result.materials.resize(1);
  for (int i = 0; i < 12; ++i) result.positions.push_back(point(random));
  for (int i = 0; i < triangles; ++i) {
    Triangle t;
    for (auto& corner : t.position) corner = random.below(12);
    result.triangles.push_back(i % 7 == 6 ? result.triangles.back() : t);
  }
  for (int i = 0; i < spheres; ++i) {
    const Sphere sphere{point(random), 0.25f * static_cast<float>(1 + random.below(8)), 0};
    result.spheres.push_back(i % 7 == 6 ? result.spheres.back() : sphere);
  }
  return result;
}

/// From a lattice point towards another or towards a corner; t_max infinite or a round number.
inline Ray ray(const Scene& scene, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, name_hash("lattice.ray"), index);
  Ray ray;
  do {
    ray.origin = point(random);
    const glm::vec3 target = random.below(2) == 0 ? scene.positions[random.below(12)] : point(random);
    ray.direction = target - ray.origin;
  } while (ray.direction == glm::vec3(0.0f));
  if (random.below(2) == 0) ray.t_max = 0.25f * static_cast<float>(1 + random.below(8));
  return ray;
}

/// Moves some of the ray's numbers by a few units in the last place.
inline Ray nudged(Ray ray, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, name_hash("lattice.nudge"), index);
  const auto nudge = [&](float x) {
    return random.below(2) == 0 ? x : step_ulps(x, static_cast<int>(random.below(5)) - 2);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.origin[axis] != 0.0f) ray.origin[axis] = nudge(ray.origin[axis]);
    if (ray.direction[axis] != 0.0f) ray.direction[axis] = nudge(ray.direction[axis]);
  }
  return ray;
}

/// The same picture at another size: all coordinates times a power of two.
inline Scene scaled(Scene scene, float factor) {
  for (glm::vec3& p : scene.positions) p *= factor;
  for (Sphere& s : scene.spheres) s.center *= factor, s.radius *= factor;
  return scene;
}

}  // namespace plumbline::lattice
