// SPDX-License-Identifier: MIT
// The ray families that aim at a feature: vertices, edges, outlines, tangents, planes, and the ends of segments.
#include <algorithm>
#include <cmath>

#include "scenes/ray_sampler.h"
#include "scenes/ulp.h"

namespace plumbline {
namespace {

constexpr int kMostUlps = 64;

/// Where a sphere's outline lies as seen from an eye outside it: a random point where lines from the eye touch it, and
/// the surface's unit normal there. An eye inside sees no outline: any point of the surface. In an instance, lines that
/// touch the part's sphere are those that touch its image.
SurfacePoint outline_point(RaySampler& s, const Sphere& sphere, const glm::vec3& eye) {
  const glm::dvec3 center(sphere.center), away = center - s.in(glm::dvec3(eye));
  const double distance = glm::length(away), radius = sphere.radius;
  SurfacePoint point;
  point.normal = s.random().direction();
  if (distance > radius) {
    const glm::dvec3 axis = away / distance;
    // The radius to the point of touch is at right angles to the line from the eye.
    const double cosine = radius / distance;
    point.normal = -cosine * axis + std::sqrt(1.0 - cosine * cosine) * s.across(axis);
  }
  point.position = s.out(center + radius * point.normal);
  point.normal = s.normal_out(point.normal);
  return point;
}

/// A point on an edge or a corner of a triangle and the direction in its plane that leads inwards from there.
struct Feature {
  glm::dvec3 point{0.0}, inwards{0.0};
};

Feature corner_feature(RaySampler& s, std::uint32_t triangle) {
  const auto c = s.corners(triangle);
  const std::uint32_t i = s.random().below(3);
  const glm::dvec3& at = c[i];
  // Between the two edges that leave the corner.
  const glm::dvec3 inwards =
      unit_or(c[(i + 1) % 3] - at, glm::dvec3(0.0)) + unit_or(c[(i + 2) % 3] - at, glm::dvec3(0.0));
  return {at, unit_or(inwards, s.random().direction())};
}

Feature edge_feature(RaySampler& s, std::uint32_t triangle) {
  const auto c = s.corners(triangle);
  const std::uint32_t i = s.random().below(3);
  const glm::dvec3 &a = c[i], &b = c[(i + 1) % 3], &opposite = c[(i + 2) % 3];
  // Midpoints are often exact; elsewhere any point does.
  const double along = s.random().below(4) == 0 ? 0.5 : s.random().uniform();
  const glm::dvec3 edge = unit_or(b - a, glm::dvec3(1, 0, 0)), side = opposite - a;
  return {a + along * (b - a), unit_or(side - glm::dot(side, edge) * edge, s.random().direction())};
}

/// At a point that lies `ulps` places inside (positive) or outside of an edge, a corner or an outline.
Ray aim_beside(RaySampler& s, int ulps) {
  if (s.at_triangle()) {
    const std::uint32_t triangle = s.triangle();
    const Feature feature = s.random().below(4) == 0 ? corner_feature(s, triangle) : edge_feature(s, triangle);
    return s.aim(feature.point + ulps * ulp(glm::vec3(feature.point)) * feature.inwards);
  }
  const Sphere& sphere = s.any_sphere();
  const glm::vec3 eye = s.eye();
  const SurfacePoint point = outline_point(s, sphere, eye);
  return s.ray_to(eye, point.position - ulps * ulp(glm::vec3(point.position)) * point.normal);
}

/// A line that touches a ball of the world `ulps` places outside its surface.
Ray touch(RaySampler& s, const glm::dvec3& center, double radius, int ulps) {
  const glm::dvec3 direction = s.random().direction(), normal = s.across(direction);
  const glm::dvec3 surface = center + radius * normal;
  const glm::dvec3 point = surface + ulps * ulp(glm::vec3(surface)) * normal;
  const glm::vec3 origin(point - (radius + s.radius()) * s.random().uniform(0.1, 2.0) * direction);
  return s.ray_to(origin, point);
}

/// The same of a sphere of the place: its tangents become those of its image.
Ray touch(RaySampler& s, const Sphere& sphere, int ulps) {
  if (s.place().instance == kNone) return touch(s, glm::dvec3(sphere.center), sphere.radius, ulps);
  const glm::dvec3 direction = s.random().direction(), normal = s.across(direction);
  const glm::dvec3 surface = s.out(glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * normal);
  const glm::dvec3 point = surface + ulps * ulp(glm::vec3(surface)) * s.normal_out(normal);
  const glm::dvec3 along = unit_or(s.vector_out(direction), direction);
  return s.ray_to(glm::vec3(point - 2.0 * s.radius() * s.random().uniform(0.1, 2.0) * along), point);
}

/// t of the plane or the sphere surface that a point aimed at lies on, in double; of a sphere's two the nearer to that
/// of the point. t is the same in every space.
double hit_parameter(const RaySampler& s, std::uint32_t primitive, const Ray& ray, const glm::dvec3& target) {
  const glm::dvec3 o = s.in(glm::dvec3(ray.origin)), d = s.vector_in(glm::dvec3(ray.direction));
  if (s.scene().is_triangle(primitive)) {
    const auto corner = s.scene().corners(primitive);
    const glm::dvec3 a(corner[0]);
    const glm::dvec3 normal =
        unit_or(glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a), glm::dvec3(0.0));
    return glm::dot(a - o, normal) / glm::dot(d, normal);
  }
  const Sphere& sphere = s.scene().sphere(primitive);
  const glm::dvec3 m = o - glm::dvec3(sphere.center);
  const double a = glm::dot(d, d), half_b = glm::dot(m, d), radius = sphere.radius;
  const double root = std::sqrt(half_b * half_b - a * (glm::dot(m, m) - radius * radius));
  const double near = (-half_b - root) / a, far = (-half_b + root) / a, guess = glm::dot(s.in(target)-o, d) / a;
  return std::abs(near - guess) <= std::abs(far - guess) ? near : far;
}

}  // namespace

Ray make_aimed_vertex(RaySampler& s) {
  if (s.at_triangle()) {
    const std::uint32_t triangle = s.triangle();
    return s.aim(s.corners(triangle)[s.random().below(3)]);
  }
  const Sphere& sphere = s.any_sphere();
  glm::vec3 pole = sphere.center;
  pole[static_cast<glm::length_t>(s.random().below(3))] += s.sign() * sphere.radius;
  return s.aim(s.out(glm::dvec3(pole)));
}

Ray make_aimed_edge(RaySampler& s) {
  return s.at_triangle() ? s.aim(edge_feature(s, s.triangle()).point) : aim_beside(s, 0);
}
Ray make_aimed_inside(RaySampler& s) { return aim_beside(s, s.octave(kMostUlps)); }
Ray make_aimed_outside(RaySampler& s) { return aim_beside(s, -s.octave(kMostUlps)); }

Ray make_tangent(RaySampler& s) {
  const int ulps = s.random().below(4) == 0 ? 0 : static_cast<int>(s.sign()) * s.octave(kMostUlps);
  const std::vector<glm::vec4>& nodes = s.source().node_spheres;
  const bool has_nodes = !nodes.empty(), has_spheres = s.has_spheres();
  if (has_nodes && (!has_spheres || s.coin())) {
    const glm::vec4& node = nodes[s.random().below(static_cast<std::uint32_t>(nodes.size()))];
    return touch(s, glm::dvec3(node), node.w, ulps);
  }
  if (has_spheres) return touch(s, s.any_sphere(), ulps);
  // Neither nodes nor spheres: the ball around a triangle's corners, as a tree of one triangle a leaf would have it.
  const auto c = s.corners(s.triangle());
  const glm::dvec3 center = (c[0] + c[1] + c[2]) / 3.0;
  double radius = 0.0;
  for (const glm::dvec3& corner : c) radius = std::max(radius, glm::length(corner - center));
  return touch(s, center, radius, ulps);
}

Ray make_in_plane(RaySampler& s) {
  if (!s.at_triangle()) {
    // In a plane that touches a sphere: through the point of touch, or past it.
    const Sphere& sphere = s.any_sphere();
    const glm::dvec3 local = s.coin() ? s.random().direction() : glm::dvec3(0.0, 0.0, static_cast<double>(s.sign()));
    const glm::dvec3 touch_point = s.out(glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * local);
    const glm::dvec3 normal = s.normal_out(local), direction = s.across(unit_or(normal, local));
    // Past it by up to two radii, of the image's mean size.
    const double size = s.place().instance == kNone
                            ? static_cast<double>(sphere.radius)
                            : glm::length(s.vector_out(static_cast<double>(sphere.radius) * direction));
    const glm::dvec3 past =
        s.coin() ? glm::dvec3(0.0) : s.random().uniform(-2.0, 2.0) * size * glm::cross(direction, normal);
    return s.ray_to(glm::vec3(touch_point - s.radius() * s.random().uniform(0.1, 2.0) * direction), touch_point + past);
  }
  const std::uint32_t triangle = s.triangle();
  const auto c = s.corners(triangle);
  const std::uint32_t i = s.random().below(3);
  const glm::dvec3 &a = c[i], &b = c[(i + 1) % 3], &opposite = c[(i + 2) % 3], center = (a + b + opposite) / 3.0;
  const glm::dvec3 interior = s.surface_point(triangle).position;
  switch (s.random().below(4)) {
    case 0: {  // along an edge, from the corner itself or from before it
      const double before = s.coin() ? static_cast<double>(s.random().below(3)) : s.random().uniform(0.0, 2.0);
      return {glm::vec3(a - before * (b - a)), glm::vec3(b - a)};
    }
    case 1:  // past the triangle: parallel to an edge, beyond the corner opposite
      return {
          glm::vec3(opposite + s.random().uniform(0.0, 2.0) * (opposite - a) - s.random().uniform(0.0, 3.0) * (b - a)),
          glm::vec3(b - a)};
    case 2:  // from within it
      return s.ray_to(glm::vec3(interior), center + 2.0 * (center - a));
    default:  // through it, from outside
      return s.ray_to(glm::vec3(interior + s.random().uniform(1.0, 4.0) * (a - center) * 3.0), interior);
  }
}

Ray make_segment(RaySampler& s) {
  constexpr int kMost = 8;
  const std::uint32_t primitive = s.primitive();
  glm::dvec3 target = s.surface_point(primitive).position;
  if (s.scene().is_triangle(primitive) && s.random().below(4) == 0) target = edge_feature(s, primitive).point;
  Ray ray = s.aim(target);
  const double t = hit_parameter(s, primitive, ray, target);
  // Every 64th ends before it starts: a miss, whatever lies there.
  if (s.random().below(64) == 0) {
    constexpr float kEnds[4] = {0.0f, -0.0f, -1.0f, -std::numeric_limits<float>::infinity()};
    ray.t_max = kEnds[s.random().below(4)];
    return ray;
  }
  const auto end = static_cast<float>(t);
  const int ulps = static_cast<int>(s.random().below(2 * kMost + 1)) - kMost;
  // Where no t is found (an edge-on triangle) the segment ends about where it was aimed.
  ray.t_max = std::isfinite(end) ? step_ulps(end, ulps) : 1.0f;
  return ray;
}

}  // namespace plumbline
