// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: a scene of two primitives, and short ways to compare answers.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "reference/arbiter.h"
#include "reference/embree.h"

namespace plumbline {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The triangle (0,0,0) (1,0,0) (0,1,0), and a sphere of radius 1 around (0,0,5).
inline Scene triangle_below_sphere() {
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.push_back({.position = {0, 1, 2}});
  scene.spheres.push_back({{0, 0, 5}, 1.0f, 0});
  return scene;
}

/// What a scene without instances answers, by number alone.
inline std::vector<std::uint32_t> nearest_in_world(const Arbiter& arbiter, const Ray& ray) {
  std::vector<std::uint32_t> numbers;
  for (const Placed& p : arbiter.nearest(ray)) numbers.push_back(p.instance == kNone ? p.primitive : kNone);
  return numbers;
}

inline ReferenceHit trace(const EmbreeScene& scene, const Ray& ray) {
  ReferenceHit hit;
  scene.intersect({&ray, 1}, {&hit, 1});
  return hit;
}

inline std::vector<ReferenceHit> trace(const EmbreeScene& scene, const std::vector<Ray>& rays) {
  std::vector<ReferenceHit> hits(rays.size());
  scene.intersect(rays, hits);
  return hits;
}

/// Whether Embree's answer is among the exact ones.
inline bool is_right(const ReferenceHit& hit, const std::vector<Placed>& nearest) {
  if (nearest.empty()) return hit.kind == HitKind::miss;
  return hit.kind == HitKind::hit &&
         std::binary_search(nearest.begin(), nearest.end(), Placed{hit.instance, hit.primitive});
}

}  // namespace plumbline
