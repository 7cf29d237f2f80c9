// SPDX-License-Identifier: GPL-3.0-or-later
// The derivation, for u = 2^-24. A node maps x to L x + T; A is the inverse of L, exactly, and A' the tracer's,
// computed in double and rounded once. |.| of a matrix or a vector takes the absolute value of each entry, and
// inequalities are meant entry by entry.
//
// The inverse. In double an entry is a cofactor over the determinant; of each the error is at most 2^-51 times the sum
// of its products' absolute values. With C the cofactors, C+ and D+ those sums:
//     |A' - A| <= Q = u|A| + 2^-51 (C+ / |D| + |A| D+ / |D|)
//
// Entering. From a ray (o, d) whose floats are off by (e, g), node by node from the outermost inwards:
//     m = o - T             off by e + u|m|
//     o' = A' m             three products and two sums, the first two products under three roundings: off by
//                           e' = |A|(e + u|m|) + 3u|A||m| + Q|m|
//     d' = A' d             off by g' = |A|g + 3u|A||d| + Q|d|
// Errors of second order, and those of computing all this in double, are covered by a factor of 1 + 2^-10. Components
// that are dropped as negligible, and flushed denormals, add kDropped times the largest. Scaling by powers of two is
// exact. In every space an origin farther than two radii from what stands there is moved along the ray by a step s, to
// two radii before the point next to the centre: the new one is off by e + |s| g, and by 2uN for its rounding, with N =
// |centre| + 3R. The sum of the steps, which leads back to the world's t, has three roundings more for each.
//
// Leaving by the inverse. o^ = L o' + T takes four roundings more, T one: the outer ray comes back off by
//     |L|(|A| u|m| + 3u|A||m| + Q|m|) + 4u|L||o'| + u|T| <= 9u K|m| + u|T| + |L|Q'|m|   with K = |L||A| and |o'| <=
//     |A||m| and d^ off by 3u|L||A||d| + |L|Q|d| + 3u|L||d'| <= 7u K|d| + |L|Q'|d|,            Q' = Q - u|A|
// An error made in a node's parent's space comes to the world by the |L| of all nodes above. Each transform left adds
// the greatest of these to the world's ray (Drift): where transforms are nested, the outer ones are left too, and count
// for themselves.
//
// Leaving for good. p^ = L p + T is off by |L|e + 4u|L||p| + u|T|, n^ = A'^T n by |A^T|e + 3u|A^T||n| + Q^T|n|. Unit
// vectors of two vectors a and b differ by at most 2|a - b| / (|a| + |b|) (Dunkl and Williams 1964).
#include "harness/placed_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double u = 0x1p-24;
constexpr double kDropped = 0x1p-59;       ///< of the largest component, or of the radius of a space
constexpr double kSlop = 1.0 + 0x1p-10;    ///< for errors of second order
constexpr std::size_t kMostLevels = 1024;  ///< of nested transforms; the tracer takes fewer
constexpr double kRootOf3 = 1.7320508075688774;

glm::dmat3 abs_of(const glm::dmat3& m) { return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])}; }

/// At least the largest stretch of a matrix without negative entries.
double norm_of(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

NodeStep make_step(const Transform& transform, const Ball& content) {
  NodeStep s;
  s.content = content;
  s.linear = glm::dmat3(transform.linear);
  s.translation = glm::dvec3(transform.translation);
  s.abs_linear = abs_of(s.linear);
  const glm::dmat3& m = s.linear;
  // Cofactors, and the sums of their products' absolute values; inverse[column][row] belongs to entry (row, column).
  glm::dmat3 cofactor, sum;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) {
      const int c1 = (c + 1) % 3, c2 = (c + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
      const double a = m[c1][r1] * m[c2][r2], b = m[c1][r2] * m[c2][r1];
      cofactor[r][c] = a - b;
      sum[r][c] = std::abs(a) + std::abs(b);
    }
  const double det = m[0][0] * cofactor[0][0] + m[0][1] * cofactor[1][0] + m[0][2] * cofactor[2][0];
  const double det_sum =
      s.abs_linear[0][0] * sum[0][0] + s.abs_linear[0][1] * sum[1][0] + s.abs_linear[0][2] * sum[2][0];
  s.inverse = cofactor / det;
  s.abs_inverse = abs_of(s.inverse);
  const double scale = 1.0 / std::abs(det);
  s.inverse_error = s.abs_inverse * u + 0x1p-51 * (sum * scale + s.abs_inverse * (det_sum * scale));
  return s;
}

}  // namespace

PlacedSpaces make_placed_spaces(const Scene& scene, std::span<const Ball> contents) {
  PLUMBLINE_ASSERT(contents.size() == scene.nodes.size());
  PlacedSpaces p;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
    p.nodes.push_back(make_step(scene.nodes[n].transform, contents[n]));
  p.instances.resize(scene.nodes.size());
  // Of each node, from the world to its space: sizes grow by `grown` |o| + `base`; entering adds at most the numbers
  // that follow, in the node's units (see place_ray); `outward` takes errors back to the world.
  struct Way {
    glm::dmat3 grown{1.0}, outward{1.0}, entered{0.0};
    glm::dvec3 base{0.0}, entered_base{0.0};
  };
  std::vector<Way> ways(scene.nodes.size());
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    const NodeStep& s = p.nodes[n];
    const Way parent = node.parent == kNone ? Way{} : ways[node.parent];
    const glm::dvec3 size = glm::abs(s.translation);
    const glm::dmat3 rounding = 4.0 * u * s.abs_inverse + s.inverse_error;
    Way& way = ways[n];
    way.grown = s.abs_inverse * parent.grown;
    way.base = s.abs_inverse * (parent.base + size);
    way.entered = s.abs_inverse * parent.entered + rounding * parent.grown;
    way.entered_base =
        s.abs_inverse * parent.entered_base + rounding * (parent.base + size) + glm::dvec3(moved_error(s.content));
    way.outward = parent.outward * s.abs_linear;
    // Leaving this node by the inverse, told in the world.
    const glm::dmat3 leaving = 9.0 * u * s.abs_linear * s.abs_inverse + s.abs_linear * s.inverse_error;
    p.drift.scale = std::max(p.drift.scale, kRootOf3 * norm_of(parent.outward * leaving * parent.grown));
    p.drift.offset =
        std::max(p.drift.offset, kRootOf3 * glm::length(parent.outward * (leaving * (parent.base + size) + u * size)));
    if (node.part == kNone) continue;
    PlacedSpace& place = p.instances[n];
    place.to_world = to_world(scene, n);
    place.stretch = largest_stretch(place.to_world.linear);
    place.inverse_stretch = largest_stretch(inverse(place.to_world).linear);
    p.entering_scale = std::max(p.entering_scale, place.stretch * norm_of(way.entered));
    p.entering_offset = std::max(p.entering_offset, place.stretch * glm::length(way.entered_base));
    p.carried = std::max(p.carried, place.stretch * norm_of(way.grown));
  }
  return p;
}

double moved_error(const Ball& ball) { return 4.0 * u * (glm::length(ball.center) + 3.0 * ball.radius); }

namespace {

/// The tracer moves an origin that is farther than this many radii from the ball's centre.
constexpr double kNear = 1.999;  ///< it decides in floats: a ray that is near by a hair may have been moved

double square(double x) { return x * x; }

bool is_near(const PlacedRay& ray, const Ball& ball) {
  return glm::length(ray.origin - ball.center) + glm::length(ray.origin_error) <= kNear * ball.radius;
}

/// Moves the origin as the tracer does before it takes the ray into another space.
void approach(const Ball& ball, PlacedRay& r) {
  if (is_near(r, ball)) return;
  const double length = glm::length(r.direction);
  const double step = (glm::dot(ball.center - r.origin, r.direction) / length - 2.0 * ball.radius) / length;
  r.origin += step * r.direction;
  r.origin_error += std::abs(step) * r.direction_error + glm::dvec3(0.5 * moved_error(ball));
  r.t_origin += step;
  r.t_rounding += 3.0 * u * (std::abs(step) + std::abs(r.t_origin));
}

/// What becomes of the origin in the space where the ray has arrived.
void set_moved(const Ball& ball, PlacedRay& r) {
  r.length = glm::length(r.direction);
  const glm::dvec3 m = r.origin - ball.center;
  const bool near = r.is_exact ? glm::dot(m, m) <= square(kNear * ball.radius) : is_near(r, ball);
  if (near) return;
  r.moved_error = moved_error(ball);
  r.farthest = 4.0 * ball.radius;
}

void enter(const NodeStep& s, PlacedRay& r) {
  const glm::dvec3 m = r.origin - s.translation, size = glm::abs(m), d_size = glm::abs(r.direction);
  r.origin_error = kSlop * (s.abs_inverse * (r.origin_error + 4.0 * u * size) + s.inverse_error * size);
  r.direction_error = kSlop * (s.abs_inverse * (r.direction_error + 3.0 * u * d_size) + s.inverse_error * d_size);
  r.origin = s.inverse * m;
  r.direction = s.inverse * r.direction;
  const glm::dvec3 d = glm::abs(r.direction);
  r.origin_error += glm::dvec3(kDropped * s.content.radius);
  r.direction_error += glm::dvec3(kDropped * std::max({d.x, d.y, d.z}));
}

}  // namespace

PlacedRay place_ray(const PlacedSpaces& spaces, const Scene& scene, const Ball& world, const Ray& ray,
                    std::uint32_t instance, std::uint32_t left) {
  PlacedRay r;
  r.instance = instance;
  r.origin = glm::dvec3(ray.origin);
  r.direction = glm::dvec3(ray.direction);
  if (instance == kNone && left == 0) {
    set_moved(world, r);
    return r;
  }
  approach(world, r);
  r.is_exact = false;
  if (left > 0) {
    const double n = left;
    r.origin_error += glm::dvec3(n * (spaces.drift.scale * glm::length(r.origin) + spaces.drift.offset));
    r.direction_error += glm::dvec3(n * spaces.drift.scale * glm::length(r.direction));
  }
  std::array<std::uint32_t, kMostLevels> chain;
  std::size_t depth = 0;
  for (std::uint32_t n = instance; n != kNone; n = scene.nodes[n].parent) {
    PLUMBLINE_ASSERT(depth < kMostLevels);
    chain[depth++] = n;
  }
  while (depth > 0) {
    const NodeStep& s = spaces.nodes[chain[--depth]];
    enter(s, r);
    if (depth > 0) approach(s.content, r);
  }
  set_moved(instance == kNone ? world : spaces.nodes[instance].content, r);
  return r;
}

LeavingErrors leaving_errors(const PlacedSpaces& spaces, const Scene& scene, std::uint32_t instance,
                             const glm::dvec3& position, const glm::dvec3& normal) {
  LeavingErrors errors;
  glm::dvec3 p = position, n = normal, p_error(0.0), n_error(0.0);
  for (std::uint32_t node = instance; node != kNone; node = scene.nodes[node].parent) {
    const NodeStep& s = spaces.nodes[node];
    p_error = kSlop * (s.abs_linear * (p_error + 4.0 * u * glm::abs(p)) + u * glm::abs(s.translation));
    p = s.linear * p + s.translation;
    // v * M is the transpose of M times v.
    n_error = kSlop * ((n_error + 3.0 * u * glm::abs(n)) * s.abs_inverse + glm::abs(n) * s.inverse_error);
    n = n * s.inverse;
  }
  errors.position = glm::length(p_error);
  errors.normal = glm::length(n_error);
  errors.normal_world_length = glm::length(n);
  return errors;
}

}  // namespace plumbline
