// SPDX-License-Identifier: GPL-3.0-or-later
// The true values of a hit on a given primitive, to check bounds by.
#pragma once

#include "reference/instance_map.h"
#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

/// What SEMANTICS 3 says of the ray's hit on one primitive as an instance shows it (kNone: in the world), as if the
/// scene held nothing else. The pair must be placed (Scene::is_placed).
///
/// kind is `hit` exactly where the ray hits the primitive, `undefined` for an undefined ray, else `miss`. Of a miss the
/// values are still told where they mean something: on a triangle those of the point in its plane (weights then lie
/// outside [0, 1], or t outside (0, t_max]); on a sphere that the line meets, those of the root nearest to being valid.
/// Where there is no such point (a line parallel to the plane, or past the sphere) the hit keeps its defaults, except
/// `primitive` and `instance`.
///
/// t is within one unit in the last place; vectors and weights within 2^-53 of their largest component (of 1 where that
/// is smaller, for weights), however edge-on the triangle and whatever the transforms.
ReferenceHit exact_hit(const Scene& scene, const Ray& ray, std::uint32_t instance, std::uint32_t primitive);
/// In the world.
ReferenceHit exact_hit(const Scene& scene, const Ray& ray, std::uint32_t primitive);
/// With the instance's map at hand (Arbiter::map_of), which takes ten to a hundred microseconds to make.
ReferenceHit exact_hit(const Scene& scene, const Ray& ray, const InstanceMap& map, std::uint32_t primitive);

}  // namespace plumbline
