// SPDX-License-Identifier: MIT
// What the ray families share: random points of a scene, eyes to look from, and rays between two points. Internal to
// rays*.cpp.
#pragma once

#include <array>

#include "scenes/random.h"
#include "scenes/rays.h"

namespace plumbline {

/// A point on a primitive, in double, with the surface's unit normal there (zero for a triangle without area). World
/// space.
struct SurfacePoint {
  std::uint32_t primitive = kNone;
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};
};

/// One ray's random numbers, and the place that it is about: the world or an instance, chosen at the start in scenes
/// with nodes. Primitives, corners and spheres are those of this place.
class RaySampler {
 public:
  RaySampler(const RaySource& source, std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

  const RaySource& source() const { return source_; }
  const Scene& scene() const { return *source_.scene; }
  Random& random() { return random_; }
  std::uint64_t index() const { return index_; }
  /// What eyes stand around: the whole scene or, half of the time in scenes with nodes, this place.
  const Ball& ball() const { return ball_; }
  double radius() const { return ball_.radius; }

  bool coin() { return (random_.bits() & 1u) != 0; }
  float sign() { return coin() ? 1.0f : -1.0f; }
  /// 1 to most, each octave as often as the others.
  int octave(int most);

  const PlacedGeometry& place() const { return *place_; }
  bool has_instances() const { return !scene().nodes.empty(); }
  /// Goes to another place than this one, if there is one.
  void go_elsewhere();
  /// From the place's own space to the world and back; the very same numbers in the world.
  glm::dvec3 out(const glm::dvec3& point) const;
  glm::dvec3 in(const glm::dvec3& point) const;
  glm::dvec3 vector_out(const glm::dvec3& vector) const;
  glm::dvec3 vector_in(const glm::dvec3& vector) const;
  /// A normal of unit length.
  glm::dvec3 normal_out(const glm::dvec3& normal) const;

  /// Any primitive, each as often; or, half of the time, by its area.
  std::uint32_t primitive();
  /// A triangle, each as often. The place must have one.
  std::uint32_t triangle() { return place_->first_triangle + random_.below(place_->triangle_count); }
  /// World space.
  std::array<glm::dvec3, 3> corners(std::uint32_t triangle) const;
  /// Unit normal, world space; zero where the triangle has no area.
  glm::dvec3 triangle_normal(std::uint32_t triangle) const;
  /// Whether the next aim is at a triangle, in proportion to the number of triangles and spheres.
  bool at_triangle() { return random_.below(place_->triangle_count + place_->sphere_count) < place_->triangle_count; }
  bool has_spheres() const { return place_->sphere_count > 0; }
  /// In the place's own space: an ellipsoid in the world, perhaps.
  const Sphere& any_sphere() { return scene().spheres[place_->first_sphere + random_.below(place_->sphere_count)]; }

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
  std::uint32_t any_place();

  const RaySource& source_;
  std::uint64_t index_;
  Random random_;
  const PlacedGeometry* place_;
  Ball ball_;
};

/// A primitive's area, in its own space.
double primitive_area(const Scene& scene, std::uint32_t primitive);
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
Ray make_into_instances(RaySampler&);
Ray make_between_instances(RaySampler&);

}  // namespace plumbline
