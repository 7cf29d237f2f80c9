// SPDX-License-Identifier: GPL-3.0-or-later
// Exact arithmetic on the floats of a ray and of primitives, as functions of plain numbers: signs are right whatever
// the input. The only file that names CGAL is exact.cpp.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "reference/line.h"

namespace plumbline {

/// A primitive's floats, apart from its scene.
struct Solid {
  bool is_sphere = false;
  std::array<glm::vec3, 3> corners{};  ///< of a triangle; corners[0] is a sphere's centre
  float radius = 0.0f;                 ///< of a sphere
};

Solid solid_of(const Scene& scene, std::uint32_t primitive);

/// Which of the points where the line meets a sphere. Both are the same on a triangle.
enum class Root { enter, leave };

/// A line in exact numbers, in the world or in an instance's space, where it is multiplied by the absolute determinant
/// of the instance's map so that nothing is divided. Movable; not shared between threads.
class ExactLine {
 public:
  /// `world` must be a line of the world.
  ExactLine(const Line& world);
  /// The same line in the space that `chain` leads to: the matrices of the nodes, outermost first.
  ExactLine(const Line& world, std::span<const Transform> chain);
  ~ExactLine();
  ExactLine(ExactLine&&) noexcept;
  ExactLine& operator=(ExactLine&&) noexcept;

  struct Impl;
  const Impl& operator*() const { return *impl_; }
  const Impl* operator->() const { return impl_.get(); }

 private:
  std::unique_ptr<Impl> impl_;
};

/// The sign of edge_moment (formulas.h): on which side the line passes the segment; 0 where it meets the segment's own
/// line.
int exact_edge_sign(const ExactLine& line, const glm::vec3& from, const glm::vec3& to);

/// The sign of direction . normal; 0 where the line is parallel to the triangle's plane, or the triangle has no area.
int exact_facing(const ExactLine& line, const Solid& triangle);

/// Whether the line lies in the triangle's plane, or the triangle has no area.
bool exact_in_plane(const ExactLine& line, const Solid& triangle);

/// The sign of (radius - distance of the line from the centre).
int exact_sphere_side(const ExactLine& line, const Solid& sphere);

/// Distances from the whole line in the primitive's own space, to within a few units in the last place; zero exactly
/// where they are zero. The sphere's is that of the line from its surface, |radius - distance from the centre|.
double exact_segment_distance(const ExactLine& line, const glm::vec3& from, const glm::vec3& to);
double exact_sphere_distance(const ExactLine& line, const Solid& sphere);

/// The sign of t - limit, t of the ray. The line must meet the sphere, or cross the triangle's plane.
int exact_compare_t(const ExactLine& line, const Solid& solid, Root root, double limit);

/// The sign of t of the one minus t of the other, each with the ray's line in its own space.
int exact_compare_t(const ExactLine& line_a, const Solid& a, Root root_a, const ExactLine& line_b, const Solid& b,
                    Root root_b);

/// t of the ray, rounded once.
double exact_t(const ExactLine& line, const Solid& solid, Root root);

/// All values, each rounded once (lengths of normals to 2^-120 before), position and normal in the world. kind is
/// `hit`; `primitive` and `instance` are left for the caller.
ReferenceHit exact_values_at(const ExactLine& line, const Solid& solid, Root root);

}  // namespace plumbline
