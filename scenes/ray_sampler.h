// SPDX-License-Identifier: MIT
// What the ray families share: random points of a scene, eyes to look from, and rays between two points. Internal to
// rays*.cpp.
#pragma once

#include "scenes/random.h"
#include "scenes/rays.h"

namespace plumbline {

/// A point on a primitive, in double, with the primitive's unit normal there (zero for a triangle without area).
struct SurfacePoint {
  std::uint32_t primitive = kNone;
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};
};

class RaySampler {
 public:
  RaySampler(const RaySource& source, std::uint64_t seed, std::uint64_t stream, std::uint64_t index)
      : source_(source), index_(index), random_(seed, stream, index) {}

  const RaySource& source() const { return source_; }
  const Scene& scene() const { return *source_.scene; }
  Random& random() { return random_; }
  std::uint64_t index() const { return index_; }
  double radius() const { return source_.ball.radius; }

  bool coin() { return (random_.bits() & 1u) != 0; }
  float sign() { return coin() ? 1.0f : -1.0f; }
  /// 1 to most, each octave as often as the others.
  int octave(int most);

  /// Any primitive, each as often; or, half of the time, by its area.
  std::uint32_t primitive();
  /// A triangle, each as often. The scene must have one.
  std::uint32_t triangle() { return random_.below(static_cast<std::uint32_t>(scene().triangles.size())); }
  bool has_triangles() const { return !scene().triangles.empty(); }
  /// Whether the next aim is at a triangle, in proportion to the number of triangles and spheres.
  bool at_triangle() { return random_.below(scene().primitive_count()) < scene().triangles.size(); }
  const Sphere& any_sphere() {
    return scene().spheres[random_.below(static_cast<std::uint32_t>(scene().spheres.size()))];
  }

  SurfacePoint surface_point();
  SurfacePoint surface_point(std::uint32_t primitive);
  glm::dvec3 point_in_ball(double scale = 1.0);
  /// A unit vector across `axis`, which must be of unit length.
  glm::dvec3 across(const glm::dvec3& axis);
  /// Where to look from: mostly one to three radii from the scene's middle, else within the scene.
  glm::vec3 eye();

  /// A ray from `origin` to `target`, its direction rounded once: of the full length (t is about 1 there), of unit
  /// length, or of a random power of two of that.
  Ray ray_to(const glm::vec3& origin, const glm::dvec3& target);
  /// A ray from an eye to a point. One in four comes along a coordinate axis, and meets the float nearest to the target
  /// exactly; one in four starts on a coarse grid, so that differences to round coordinates are exact.
  Ray aim(const glm::dvec3& target);

 private:
  const RaySource& source_;
  std::uint64_t index_;
  Random random_;
};

/// A primitive's area.
double primitive_area(const Scene& scene, std::uint32_t primitive);
/// A triangle's unit normal, zero where it has no area.
glm::dvec3 triangle_normal(const Scene& scene, std::uint32_t triangle);
/// v / |v|, or `otherwise` where that has no direction.
glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise);

using RayMaker = Ray (*)(RaySampler&);
Ray make_camera(RaySampler&);
Ray make_secondary(RaySampler&);
Ray make_chord(RaySampler&);
Ray make_aimed_vertex(RaySampler&);
Ray make_aimed_edge(RaySampler&);
Ray make_aimed_inside(RaySampler&);
Ray make_aimed_outside(RaySampler&);
Ray make_tangent(RaySampler&);
Ray make_in_plane(RaySampler&);
Ray make_axis(RaySampler&);
Ray make_inside(RaySampler&);
Ray make_on_surface(RaySampler&);
Ray make_far(RaySampler&);
Ray make_scaled(RaySampler&);
Ray make_segment(RaySampler&);
Ray make_undefined(RaySampler&);

}  // namespace plumbline
