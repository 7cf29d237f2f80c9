// SPDX-License-Identifier: MIT
// A judge for tests: intersects in double precision and says what is wrong with a hit beyond 32-bit rounding. Written
// from SEMANTICS.md, not from the shader.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

class Judge {
 public:
  explicit Judge(const Scene& scene) : scene_(scene), ball_(bounding_ball(scene)) {}

  /// Empty where the hit is right: what it names is met within rounding, values are those of the exact meeting within
  /// rounding, and nothing that the ray clearly meets lies clearly nearer.
  std::string fault_of(const Ray& ray, const Hit& hit) const {
    const std::string name = "primitive " + std::to_string(hit.primitive);
    double t = std::numeric_limits<double>::infinity();
    if (hit.kind == HitKind::hit) {
      const Meeting m = meet(ray, hit.primitive, hit.t);
      t = hit.t;
      if (!(m.margin >= -lateral(ray))) return name + " is passed by " + std::to_string(-m.margin);
      if (!(std::abs(hit.t - m.t) <= m.t_error)) return name + ": t is off by " + std::to_string(hit.t - m.t);
      if (!(glm::length(glm::dvec3(hit.position) - m.position) <= m.value_error)) return name + ": position is off";
      if (!(glm::length(glm::dvec3(hit.normal) - m.normal) <= m.normal_error)) return name + ": normal is off";
      if (!(glm::length(glm::dvec2(hit.barycentrics) - m.barycentrics) <= m.weight_error))
        return name + ": barycentrics are off";
    } else if (hit.kind != HitKind::miss) {
      return "neither hit nor miss";
    }
    for (std::uint32_t p = 0; p < scene_.primitive_count(); ++p) {
      const Meeting m = meet(ray, p, 0.0);
      if (m.margin > lateral(ray) && m.t - m.t_error > 0.0 && m.t + m.t_error < t && m.t + m.t_error <= ray.t_max) {
        return "primitive " + std::to_string(p) + " at " + std::to_string(m.t) + " is nearer than " + std::to_string(t);
      }
    }
    return {};
  }

 private:
  static constexpr double kUnit = 0x1p-24;

  struct Meeting {
    double t = -1.0;
    double margin = -std::numeric_limits<double>::infinity();  ///< across the ray, inside positive
    double t_error = 0.0, value_error = 0.0, normal_error = 0.0, weight_error = 0.0;
    glm::dvec3 position{0.0}, normal{0.0};
    glm::dvec2 barycentrics{0.0};
  };

  /// Length of the vectors that the shader subtracts: from a walking origin to the scene.
  double reach(const Ray& ray) const {
    return std::min(glm::length(glm::dvec3(ray.origin) - ball_.center) + ball_.radius, 3.5 * ball_.radius) +
           glm::length(ball_.center);
  }
  /// bake.h: accepted points lie within 25 units of the reach across and along the ray, most of it along. What edge
  /// functions add seen edge-on is far less than the bounds on weights below.
  double lateral(const Ray& ray) const { return 20.0 * kUnit * reach(ray); }

  using Real3 = glm::vec<3, long double>;

  /// A ray from the point next to the scene's centre: far origins would cost the cross products below all of their
  /// digits.
  struct NearRay {
    glm::dvec3 origin, direction;
    double t_origin;  ///< the given ray's t there
  };
  NearRay near_ray(const Ray& ray) const {
    const Real3 o(ray.origin), d(ray.direction);
    const long double t = glm::dot(Real3(ball_.center) - o, d) / glm::dot(d, d);
    const double rounded = static_cast<double>(t);
    return {glm::dvec3(o + static_cast<long double>(rounded) * d), glm::dvec3(d), rounded};
  }

  Meeting meet(const Ray& ray, std::uint32_t primitive, double near_t) const {
    return scene_.is_triangle(primitive) ? meet_triangle(ray, primitive)
                                         : meet_sphere(ray, scene_.sphere(primitive), near_t);
  }

  Meeting meet_triangle(const Ray& ray, std::uint32_t primitive) const {
    const auto corners = scene_.corners(primitive);
    const auto [o, d, t_origin] = near_ray(ray);
    const glm::dvec3 a = glm::dvec3(corners[0]) - o, b = glm::dvec3(corners[1]) - o, c = glm::dvec3(corners[2]) - o;
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double speed = glm::length(d), facing = glm::dot(n, d);
    Meeting m;
    if (facing == 0.0) return m;
    const double u = glm::dot(d, glm::cross(b, c)) / facing, v = glm::dot(d, glm::cross(c, a)) / facing,
                 w = glm::dot(d, glm::cross(a, b)) / facing;
    // A weight times its corner's height over the opposite edge, as the ray sees it, is the distance from that edge.
    const double area = std::abs(facing) / speed;
    const auto height = [&](const glm::dvec3& p, const glm::dvec3& q) {
      return area / glm::length(glm::cross(q - p, d / speed));
    };
    const double ha = height(b, c), hb = height(c, a), hc = height(a, b);
    m.margin = std::min({u * ha, v * hb, w * hc});
    const double t_near = glm::dot(a, n) / facing;
    m.t = t_origin + t_near;
    m.position = o + t_near * d;
    m.normal = glm::normalize(n);
    m.barycentrics = {v, w};
    // The projection's error moves the meeting along the triangle by its ratio to the height, at most by all of it.
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    const double least = std::min({ha, hb, hc});
    m.weight_error = 2.0 * lateral(ray) / least + 0x1p-20;
    m.value_error = lateral(ray) + std::min(m.weight_error, 2.0) * longest;
    m.t_error = (lateral(ray) + std::min(m.weight_error, 2.0) * longest) / speed + 4.0 * kUnit * std::abs(m.t);
    if (m.weight_error >= 1.0) {
      // Seen so nearly edge-on that 32 bits can't tell where it is met, or whether: anywhere on it will do.
      const double along = glm::dot((a + b + c) / 3.0, d) / (speed * speed);
      m.t = t_origin + along;
      m.position = o + along * d;
    }
    m.normal_error = 16.0 * kUnit * longest * longest / glm::length(n);
    return m;
  }

  Meeting meet_sphere(const Ray& ray, const Sphere& sphere, double near_t) const {
    const auto [o, d, t_origin] = near_ray(ray);
    const glm::dvec3 to_center = glm::dvec3(sphere.center) - o;
    const double speed = glm::length(d), r = sphere.radius, foot = glm::dot(to_center, d) / (speed * speed);
    const double distance = glm::length(to_center - foot * d);
    Meeting m;
    m.margin = r - distance;
    const double rest = std::max(r * r - distance * distance, 0.0), half = std::sqrt(rest) / speed;
    const double low = t_origin + (foot - half), high = t_origin + (foot + half);
    // The square root turns an error e of the distance into e r / sqrt(rest), and into sqrt(2 e r) next to a tangent.
    const double e = lateral(ray);
    const double chord_error =
        std::min(std::sqrt(2.0 * e * r) * 1.5, rest > 0.0 ? 2.0 * e * r / std::sqrt(rest) : 1e300);
    m.t_error = (chord_error + e) / speed + 4.0 * kUnit * std::abs(t_origin + foot);
    // Where rounding may have put the first root to either side of the origin, the hit says which root it means.
    const bool unclear = std::abs(low) <= m.t_error && near_t > 0.0;
    const bool first = unclear ? std::abs(near_t - low) <= std::abs(near_t - high) : low > 0.0;
    m.t = first ? low : high;
    m.position = o + (foot + (first ? -half : half)) * d;
    m.normal = glm::normalize(m.position - glm::dvec3(sphere.center));
    m.value_error = chord_error + 2.0 * e;
    m.normal_error = (chord_error + 2.0 * e) / r;
    m.weight_error = kUnit;
    return m;
  }

  const Scene& scene_;
  Ball ball_;
};

}  // namespace plumbline
