// SPDX-License-Identifier: MIT
// A ray, and the answer to "what does it hit first?". The meaning of every field is settled in SEMANTICS.md.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "scenes/scene.h"

namespace plumbline {

/// The points origin + t * direction with 0 < t <= t_max. World space; the direction may have any length but zero.
struct Ray {
  glm::vec3 origin{0.0f};
  glm::vec3 direction{0.0f, 0.0f, 1.0f};
  float t_max = std::numeric_limits<float>::infinity();
};

/// False for a ray that has no answer: a NaN anywhere, an infinite origin or direction, a zero direction.
inline bool is_defined(const Ray& ray) {
  const auto finite = [](const glm::vec3& v) {
    constexpr float kMax = std::numeric_limits<float>::max();
    return v.x >= -kMax && v.x <= kMax && v.y >= -kMax && v.y <= kMax && v.z >= -kMax && v.z <= kMax;
  };
  return finite(ray.origin) && finite(ray.direction) && ray.t_max == ray.t_max &&
         (ray.direction.x != 0.0f || ray.direction.y != 0.0f || ray.direction.z != 0.0f);
}

enum class HitKind : std::uint32_t {
  miss = 0,
  hit = 1,
  undefined = 2,  ///< the ray has no answer (is_defined is false)
  capped = 3,     ///< traversal did not end within the image's number of cells: the tree is broken
};

/// What the production tracer answers, in its own 32 bits.
struct Hit {
  HitKind kind = HitKind::miss;
  std::uint32_t primitive = kNone;                   ///< see Scene; kNone unless kind is hit
  std::uint32_t instance = kNone;                    ///< the node that placed it; kNone in world space
  float t = std::numeric_limits<float>::infinity();  ///< in units of the ray's direction
  glm::vec3 position{0.0f};                          ///< world space
  glm::vec3 normal{0.0f};             ///< geometric, of unit length, world space; not turned towards the ray
  glm::vec2 barycentrics{0.0f};       ///< weights of the second and third corner; 0 for spheres
  std::uint32_t steps = 0;            ///< cells visited
  std::uint32_t primitive_tests = 0;  ///< primitives tested
  std::uint32_t transforms = 0;       ///< transforms entered
};

/// What the reference answers, in double precision.
struct ReferenceHit {
  HitKind kind = HitKind::miss;
  std::uint32_t primitive = kNone;
  std::uint32_t instance = kNone;
  double t = std::numeric_limits<double>::infinity();
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};
  glm::dvec2 barycentrics{0.0};
};

}  // namespace plumbline
