// SPDX-License-Identifier: GPL-3.0-or-later
// The surface at a hit: where it is, how it is turned, what it is made of, and how far off new rays start
// (SEMANTICS 6.4, 6.5 and 6.8).
#pragma once

#include <optional>
#include <vector>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// World space; all directions are of unit length.
struct Surface {
  glm::dvec3 position{0.0};
  glm::dvec3 outside{0.0};  ///< N: the geometric normal, on the side that the surface's orientation calls outside
  glm::dvec3 facing{0.0};   ///< n_g: N, or -N, whichever faces the ray
  glm::dvec3 shading{0.0};  ///< n: interpolated and bumped, on the side of n_g
  double offset = 0.0;      ///< delta: what rays start away from `position`, along n_g or against it
  glm::dvec3 color{1.0};    ///< C: the material's times its texture's
  const Material* material = nullptr;
};

/// What an instance does to points, normals and bounds, worked out once for each time of a scene.
struct InstanceView {
  TransformD to_world, from_world;
  glm::dmat3 normals{1.0};  ///< the inverse transpose
  glm::dmat3 reach{1.0};    ///< |L| |L^-1| |L|: what a bound of local numbers becomes in 6.5
  glm::dvec3 shift{0.0};    ///< |L| |L^-1| |T|
};

/// By the node's index; nodes that are no instances have the identity.
std::vector<InstanceView> instance_views(const Scene& scene);

/// The number that the ground goes by in hits.
inline std::uint32_t ground_number(const Scene& scene) { return scene.primitive_count(); }

/// Where a ray hits the round ground; nothing where it does not, or the scene has none.
std::optional<ReferenceHit> ground_hit(const Scene& scene, const Ray& ray);

/// The surface at a hit of a ray with this direction. `hit.kind` must be hit.
Surface surface_at(const Scene& scene, const std::vector<InstanceView>& views, const ReferenceHit& hit,
                   const glm::dvec3& direction);

}  // namespace plumbline
