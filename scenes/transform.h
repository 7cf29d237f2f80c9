// SPDX-License-Identifier: MIT
// Affine maps between a node's space and the one around it. The matrices of a scene are floats taken as exact numbers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace plumbline {

/// No index: an optional reference (normal, texture coordinate, texture, node, primitive) that is absent.
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// x becomes linear * x + translation. Points transform so; directions by `linear` alone, so that t of a ray means the
/// same in every space; normals by the inverse transpose of `linear`, normalised.
struct Transform {
  glm::mat3 linear{1.0f};  ///< columns, as GLM has them
  glm::vec3 translation{0.0f};
  friend bool operator==(const Transform&, const Transform&) = default;
};

/// The same in double, for what is composed of several.
struct TransformD {
  glm::dmat3 linear{1.0};
  glm::dvec3 translation{0.0};
};

TransformD to_double(const Transform& transform);
/// First `inner`, then `outer`.
TransformD compose(const TransformD& outer, const TransformD& inner);
/// Of a regular transform.
TransformD inverse(const TransformD& transform);
inline glm::dvec3 transform_point(const TransformD& t, const glm::dvec3& p) { return t.linear * p + t.translation; }
inline glm::dvec3 transform_vector(const TransformD& t, const glm::dvec3& v) { return t.linear * v; }

/// The largest singular value: how much lengths grow at most. At least the true value, and less than 2^-39 of it above.
double largest_stretch(const glm::dmat3& linear);

/// Why a transform cannot be used: "is singular", "holds a NaN", ...; empty where it can. Singular means that the
/// determinant, computed exactly enough for its sign, is zero, or that the inverse has no finite floats.
const char* transform_error(const Transform& transform);

}  // namespace plumbline
