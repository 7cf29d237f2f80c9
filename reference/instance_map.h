// SPDX-License-Identifier: GPL-3.0-or-later
// The way between an instance's own space and the world, composed exactly and rounded once; and a ray's line in that
// space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/bounded.h"
#include "reference/formulas.h"

namespace plumbline {

/// x_world = L x + T, with L and T the exact product of the matrices of the nodes from `instance` outwards.
struct InstanceMap {
  std::uint32_t instance = kNone, part = kNone;
  std::vector<Transform> chain;                 ///< the matrices, outermost first
  std::array<Vec<BoundedT>, 3> inverse_rows{};  ///< of L^-1: each number is off by at most one unit in the last place
  Vec<BoundedT> translation{};                  ///< T likewise
  std::array<Vec<long double>, 3> inverse_rest{};  ///< what these lack, to 2^-120 of them
  Vec<long double> translation_rest{};
  TransformD to_world;  ///< L and T in double, each number off by at most one unit in the last place
};

/// Of a node that holds a part. In exact.cpp.
InstanceMap instance_map(const Scene& scene, std::uint32_t instance);
/// Of all instances in ascending order, on all cores.
std::vector<InstanceMap> instance_maps(const Scene& scene);

/// A ray's line in an instance's space, in double and with more bits.
struct LocalLine {
  Line line;
  LineOf<BoundedT> wide;
};

/// The line of a defined ray, moved to the neighbourhood of `ball`, which is in the instance's space, as line_near
/// does.
///
/// Everything is computed in extended precision from the maps' rounded numbers, o' = L^-1 (o - T) and d' = L^-1 d: each
/// component of o' is off by some 2^-62 |L^-1| (|o| + |T|), of d' by 2^-62 |L^-1| |d|, taken component by component.
/// The errors in the result are computed along (Bounded).
LocalLine local_line(const Ray& ray, const InstanceMap& map, const Ball& ball);
/// The same, computed in 113 bits and then rounded, at several times the price: for values on primitives that are small
/// beside their distance from the ray's origin.
LocalLine fine_local_line(const Ray& ray, const InstanceMap& map, const Ball& ball);
/// The same `line`, without bounds of its errors (point_error and direction_error are zero) in a third of the time.
Line plain_local_line(const Ray& ray, const InstanceMap& map, const Ball& ball);

/// A normal of the instance's space in the world, of unit length: by the inverse transpose, in double.
glm::dvec3 normal_to_world(const InstanceMap& map, const glm::dvec3& normal);

/// A box in double.
struct BoxD {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};
};
/// A world box around the image of a box of the instance's space, whatever the rounding.
BoxD world_box(const InstanceMap& map, const BoxD& local);

}  // namespace plumbline
