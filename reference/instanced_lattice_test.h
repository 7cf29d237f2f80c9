// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: lattices (lattice_test.h) placed by nested transforms of every legal kind, and rays at what they show.
#pragma once

#include "reference/lattice_test.h"

namespace plumbline::lattice {

/// Adds the primitives of `from` to those of `to`, whose triangles come first.
inline Part add_part(const Scene& from, Scene& to) {
  Part part{"part", static_cast<std::uint32_t>(to.triangles.size()), static_cast<std::uint32_t>(from.triangles.size()),
            static_cast<std::uint32_t>(to.spheres.size()), static_cast<std::uint32_t>(from.spheres.size())};
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  for (Triangle t : from.triangles) {
    for (auto& corner : t.position) corner += first;
    to.triangles.push_back(t);
  }
  to.spheres.insert(to.spheres.end(), from.spheres.begin(), from.spheres.end());
  return part;
}

inline Transform scale(float x, float y, float z) { return {glm::mat3(x, 0, 0, 0, y, 0, 0, 0, z), glm::vec3(0.0f)}; }

/// Kinds of transforms: the first ones keep lattices exact, the others round.
enum class Kind { identity, shift, mirror, shear, swap, stretch, shrink_grow, far, turn, wild };
inline constexpr int kExactKinds = 6, kKinds = 10;

inline Transform transform(Kind kind, Random& random) {
  Transform result;
  const auto nonzero = [&] { return (random.below(2) == 0 ? 1.0f : -1.0f) * (0.5f + 0.25f * random.below(5)); };
  switch (kind) {
    case Kind::identity:
      break;
    case Kind::shift:
      result.translation = point(random);
      break;
    case Kind::mirror:
      result = scale(random.below(2) == 0 ? -1.0f : 1.0f, 1, -1);
      break;
    case Kind::shear:
      result.linear[1][0] = 0.25f * static_cast<float>(random.below(5));
      result.linear[2][1] = -0.5f;
      break;
    case Kind::swap:
      result.linear = {glm::vec3(0, 1, 0), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0)};
      break;
    case Kind::stretch:
      result = scale(2, 0.5f, -1);
      break;
    case Kind::shrink_grow:
      result = scale(nonzero(), 1e-3f, 1e3f);
      break;
    case Kind::far:
      result.translation = 1e5f * point(random) + point(random);
      break;
    case Kind::turn:
    case Kind::wild:
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) result.linear[column][row] = static_cast<float>(random.uniform(-1.0, 1.0));
        result.linear[column][column] += 2.0f;
      }
      if (kind == Kind::wild) result.translation = glm::vec3(random.direction());
      break;
  }
  return result;
}

/// Transforms that undo most of what `kind` does to sizes and places, so that rays find the instances.
inline Transform undone(Kind kind, const Transform& t) {
  Transform result;
  if (kind == Kind::shrink_grow) result = scale(1.0f / t.linear[0][0], 1e3f, 1e-3f);
  if (kind == Kind::far) result.translation = -t.translation;
  return result;
}

/// Two parts, and a few primitives of the world that stand in the second part too; eight chains of one to five nodes,
/// some of them coincident. `exact`: only transforms that keep coordinates on a lattice.
inline Scene instanced_scene(std::uint64_t seed, bool exact) {
  Random random(seed, name_hash("lattice.instances"), 0);
  Scene result = scene(seed, 4, 2);
  result.positions.resize(12);
  for (int i = 0; i < 2; ++i) result.parts.push_back(add_part(scene(seed + 1000 * (1 - i), 6, 3), result));
  for (int chain = 0; chain < 8; ++chain) {
    std::uint32_t parent = kNone;
    const auto add = [&](const Transform& t, std::uint32_t part) {
      const auto number = static_cast<std::uint32_t>(result.nodes.size());
      result.nodes.push_back({"node " + std::to_string(number), parent, part, t, t});
      parent = number;
    };
    const int depth = chain == 7 ? 0 : static_cast<int>(random.below(3));
    for (int level = 0; level < depth; ++level) {
      const auto kind = static_cast<Kind>(random.below(exact ? kExactKinds : kKinds));
      const Transform t = transform(kind, random);
      add(t, kNone);
      if (kind == Kind::far || kind == Kind::shrink_grow) add(undone(kind, t), kNone);
    }
    const Kind last = chain % 4 == 3 ? Kind::identity : static_cast<Kind>(random.below(exact ? kExactKinds : kKinds));
    Transform t = transform(last, random);
    if (last == Kind::far) t = transform(Kind::shift, random);
    add(t, static_cast<std::uint32_t>(chain) % 2);
  }
  return result;
}

/// From a lattice point towards the image of a corner, of an edge's or a triangle's middle, or of a point beside a
/// sphere, or towards another lattice point; t_max infinite or a round number.
inline Ray instanced_ray(const Scene& scene, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, name_hash("lattice.instanced_ray"), index);
  Ray ray;
  const auto instances = instances_of(scene);
  do {
    ray.origin = point(random);
    glm::vec3 target = point(random);
    const std::uint32_t instance = instances[random.below(static_cast<std::uint32_t>(instances.size()))];
    const Part& part = scene.parts[scene.nodes[instance].part];
    const TransformD map = to_world(scene, instance);
    const auto corners = scene.corners(part.first_triangle + random.below(part.triangle_count));
    const Sphere& sphere = scene.spheres[part.first_sphere + random.below(part.sphere_count)];
    switch (random.below(6)) {
      case 0:
        target = glm::vec3(transform_point(map, corners[random.below(3)]));
        break;
      case 1:
        target = glm::vec3(transform_point(map, 0.5 * (glm::dvec3(corners[0]) + glm::dvec3(corners[1]))));
        break;
      case 2:
        target = glm::vec3(transform_point(
            map, 0.25 * (glm::dvec3(corners[0]) + glm::dvec3(corners[1])) + 0.5 * glm::dvec3(corners[2])));
        break;
      case 3:
        target = glm::vec3(transform_point(map, glm::dvec3(sphere.center)));
        break;
      case 4: {  // a tangent of the sphere
        const glm::dvec3 from = glm::dvec3(sphere.center) + glm::dvec3(sphere.radius, 0.5, 0.0);
        ray.origin = glm::vec3(transform_point(map, from));
        target = glm::vec3(transform_point(map, from - glm::dvec3(0.0, 1.0, 0.0)));
        break;
      }
      default:
        break;
    }
    ray.direction = target - ray.origin;
  } while (ray.direction == glm::vec3(0.0f));
  if (random.below(3) == 0) ray.t_max = 0.25f * static_cast<float>(1 + random.below(8));
  return ray;
}

}  // namespace plumbline::lattice
