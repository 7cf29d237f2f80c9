// SPDX-License-Identifier: MIT
// The smallest enclosing ball against brute force, and the radius against exact arithmetic.
#include "tracer/miniball.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "scenes/random.h"
#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

double reach(const std::vector<FloatBall>& balls, const glm::dvec3& center) {
  double farthest = 0.0;
  for (const FloatBall& ball : balls)
    farthest = std::max(farthest, glm::length(glm::dvec3(ball.center) - center) + ball.radius);
  return farthest;
}

/// The least reach over all centres: a convex function, so three nested ternary searches find its minimum.
double least_reach(const std::vector<FloatBall>& balls, glm::dvec3 center, int axis, double size) {
  if (axis == 3) return reach(balls, center);
  double low = -size, high = size;
  for (int i = 0; i < 50; ++i) {
    glm::dvec3 a = center, b = center;
    a[axis] = low + (high - low) * 0.45, b[axis] = low + (high - low) * 0.55;
    if (least_reach(balls, a, axis + 1, size) < least_reach(balls, b, axis + 1, size))
      high = b[axis];
    else
      low = a[axis];
  }
  center[axis] = 0.5 * (low + high);
  return least_reach(balls, center, axis + 1, size);
}

/// The smallest ball through two, three or four of the points that holds all: the centre solves 2 (p_i - p_0).q = |p_i
/// - p_0|^2 in the flat through them, by Cramer's rule.
double smallest_by_subsets(const std::vector<FloatBall>& points) {
  double best = std::numeric_limits<double>::infinity();
  const auto offer = [&](const glm::dvec3& center) { best = std::min(best, reach(points, center)); };
  const auto at = [&](std::size_t i) { return glm::dvec3(points[i].center); };
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      offer(0.5 * (at(i) + at(j)));
      for (std::size_t k = j + 1; k < n; ++k) {
        const glm::dvec3 a = at(j) - at(i), b = at(k) - at(i), normal = glm::cross(a, b);
        const double nn = glm::dot(normal, normal), aa = glm::dot(a, a), bb = glm::dot(b, b);
        if (nn > 0) offer(at(i) + (aa * glm::cross(b, normal) + bb * glm::cross(normal, a)) / (2.0 * nn));
        for (std::size_t l = k + 1; l < n; ++l) {
          const glm::dvec3 c = at(l) - at(i);
          const double det = glm::dot(normal, c), cc = glm::dot(c, c);
          if (det != 0)
            offer(at(i) + (aa * glm::cross(b, c) + bb * glm::cross(c, a) + cc * glm::cross(a, b)) / (2.0 * det));
        }
      }
    }
  return best;
}

float fitted_radius(const std::vector<FloatBall>& balls) {
  BallSupport support;
  return enclosing_radius(balls, glm::vec3(smallest_ball_center(balls, {}, support)));
}

TEST_CASE("the ball around points is as small as the best of all pairs, triples and quadruples", "[tree]") {
  for (int i = 0; i < 400; ++i) {
    Random random(3, name_hash("miniball points"), i);
    std::vector<FloatBall> points(2 + random.below(8));
    for (FloatBall& point : points) {
      point.center = glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (i % 4 == 1) point.center.z = 0.5f;                                  // all in a plane
      if (i % 4 == 2) point.center = glm::vec3(point.center.x);               // all on a line
      if (i % 4 == 3) point.center = glm::round(point.center * 2.0f) * 0.5f;  // doubles, and many on one sphere
    }
    const double best = smallest_by_subsets(points);
    INFO("set " << i << " of " << points.size());
    // 2^-24 where the walk ends, 2^-24 of the coordinates (1.8 at most, the ball no smaller than 0.01) for the centre
    REQUIRE(fitted_radius(points) <= best * (1.0 + 0x1p-22) + 0x1p-23);
    REQUIRE(fitted_radius(points) >= best * (1.0 - 0x1p-24));
  }
}

TEST_CASE("the ball around balls is the smallest", "[tree]") {
  for (int i = 0; i < 12; ++i) {
    Random random(4, name_hash("miniball balls"), i);
    std::vector<FloatBall> balls(2 + random.below(5));
    for (FloatBall& ball : balls) {
      ball.center = glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      ball.radius = static_cast<float>(random.uniform(0, i % 3 == 0 ? 2.0 : 0.5));  // some hold others
    }
    const double best = least_reach(balls, glm::dvec3(0.0), 0, 2.0);
    INFO("set " << i << " of " << balls.size());
    REQUIRE(fitted_radius(balls) <= best * (1.0 + 0x1p-22));
    REQUIRE(fitted_radius(balls) >= best * (1.0 - 0x1p-22));
  }
}

TEST_CASE("the ball around many points is no larger than that around the few which hold it in place", "[tree]") {
  for (int i = 0; i < 300; ++i) {
    Random random(7, name_hash("miniball many"), i);
    std::vector<FloatBall> points(50 + random.below(500)), holding;
    for (FloatBall& point : points)  // near a sphere: many almost hold the ball
      point.center =
          glm::vec3(random.direction() * glm::dvec3(1.0, 1.0, i % 2 ? 1.0 : 0.999) * random.uniform(0.99, 1.0));
    BallSupport support;
    const double radius = reach(points, smallest_ball_center(points, {}, support));
    for (int k = 0; k < support.count; ++k) holding.push_back(points[support.ball[k]]);
    REQUIRE(radius <= smallest_by_subsets(holding) * (1.0 + 0x1p-22));
  }
}

TEST_CASE("where the walk starts does not matter, and it ends on what holds the ball in place", "[tree]") {
  Random random(5, name_hash("miniball start"), 0);
  std::vector<FloatBall> balls(500);
  for (FloatBall& ball : balls) {
    ball.center = glm::vec3(random.direction() * random.uniform());
    ball.radius = static_cast<float>(random.uniform(0, 0.1));
  }
  BallSupport support;
  const double radius = reach(balls, smallest_ball_center(balls, {}, support));
  REQUIRE(support.count >= 2);
  std::vector<FloatBall> holding;
  for (int i = 0; i < support.count; ++i) holding.push_back(balls[support.ball[i]]);
  BallSupport ignored;
  REQUIRE(reach(holding, smallest_ball_center(holding, {}, ignored)) == Approx(radius).epsilon(1e-6));
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<std::uint32_t> start;
    for (int k = 0; k < 8; ++k) start.push_back(random.below(500));
    REQUIRE(reach(balls, smallest_ball_center(balls, start, ignored)) == Approx(radius).epsilon(1e-6));
  }
}

/// |p - center| <= radius, exactly.
bool holds_point(const glm::vec3& center, float radius, const glm::vec3& p) {
  std::vector<double> terms;
  for (int i = 0; i < 3; ++i) {
    const double c = center[i], x = p[i];
    terms.insert(terms.end(), {x * x, -2.0 * (x * c), c * c});
  }
  terms.push_back(-(static_cast<double>(radius) * radius));
  return exact_sign(terms) <= 0;
}

TEST_CASE("the radius holds every point exactly and is at most one float too large", "[tree]") {
  for (int i = 0; i < 2000; ++i) {
    Random random(6, name_hash("enclosing radius"), i);
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(230)) - 115);
    const glm::vec3 center(random.direction() * random.uniform() * scale);
    std::vector<FloatBall> points(1 + random.below(4));
    for (FloatBall& point : points) point.center = glm::vec3(random.direction() * random.uniform() * scale);
    const float radius = enclosing_radius(points, center);
    bool all = true, all_in_smaller = true;
    const float smaller = std::nextafter(std::nextafter(radius, 0.0f), 0.0f);
    for (const FloatBall& point : points) {
      all = all && holds_point(center, radius, point.center);
      all_in_smaller = all_in_smaller && holds_point(center, smaller, point.center);
    }
    REQUIRE(all);
    REQUIRE_FALSE(all_in_smaller);
  }
}

TEST_CASE("a single sphere is its own ball, bit for bit", "[tree]") {
  const std::vector<FloatBall> one{{glm::vec3(0.1f, -7.3f, 1e6f), 0.3f}};
  BallSupport support;
  const glm::vec3 center(smallest_ball_center(one, {}, support));
  REQUIRE(center == one[0].center);
  REQUIRE(enclosing_radius(one, center) == 0.3f);
}

}  // namespace
}  // namespace plumbline
