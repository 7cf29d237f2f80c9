// SPDX-License-Identifier: MIT
// Containment at its limits, where the answer is known without arithmetic.
#include "tracer/exact_containment.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "scenes/random.h"

namespace plumbline {
namespace {

float above(float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); }
float below(float x) { return std::nextafter(x, -std::numeric_limits<float>::infinity()); }

}  // namespace

TEST_CASE("a ball holds points up to its surface and not one unit beyond", "[verify]") {
  // 3-4-12-13 and its multiples: distances that are whole.
  for (const int exponent : {-60, -20, 0, 20, 55}) {
    const float unit = std::ldexp(1.0f, exponent);
    const glm::vec3 center(7.0f * unit, -5.0f * unit, 1.0f * unit);
    const glm::vec3 point = center + glm::vec3(3.0f, 4.0f, -12.0f) * unit;
    const float radius2 = 169.0f * unit * unit;
    CHECK(ball_holds_point(center, radius2, point));
    CHECK_FALSE(ball_holds_point(center, below(radius2), point));
    CHECK(ball_holds_point(center, above(radius2), point));
    CHECK_FALSE(ball_holds_point(center, radius2, {point.x, point.y, below(point.z)}));
    CHECK(ball_holds_point(center, radius2, {point.x, point.y, above(point.z)}));
  }
  CHECK_FALSE(ball_holds_point(glm::vec3(0.0f), -1.0, glm::vec3(0.0f)));
  // Far below what a difference in double sees.
  CHECK_FALSE(ball_holds_point(glm::vec3(1.0f, 0.0f, 0.0f), 1.0, glm::vec3(-0x1p-120f, 0.0f, 0.0f)));
  CHECK(ball_holds_point(glm::vec3(1.0f, 0.0f, 0.0f), 1.0, glm::vec3(0x1p-120f, 0.0f, 0.0f)));
}

TEST_CASE("a ball holds balls that touch it from inside and none that is a unit larger", "[verify]") {
  const glm::vec3 center(1.0f, 2.0f, 3.0f), inner = center + glm::vec3(2.0f, 3.0f, 6.0f);  // 7 away
  CHECK(ball_holds_ball(center, 100.0, inner, 3.0f));
  CHECK_FALSE(ball_holds_ball(center, 100.0, inner, above(3.0f)));
  CHECK_FALSE(ball_holds_ball(center, below(100.0f), inner, 3.0f));
  CHECK(ball_holds_ball(center, 100.0, center, 10.0f));
  CHECK_FALSE(ball_holds_ball(center, 100.0, center, above(10.0f)));
  CHECK_FALSE(ball_holds_ball(center, 100.0, inner, 20.0f));  // (R - r)^2 is above d^2 here too
  // A root that is not rational: |d| = sqrt(2), r = 1, so R^2 = 3 + 2 sqrt(2).
  const double limit = 3.0 + 2.0 * std::sqrt(2.0);
  const auto nearest = static_cast<float>(limit);
  const float just_more = nearest > limit ? nearest : above(nearest), just_less = below(just_more);
  CHECK(ball_holds_ball(glm::vec3(0.0f), just_more, glm::vec3(1.0f, 1.0f, 0.0f), 1.0f));
  CHECK(just_less < limit);
  CHECK_FALSE(ball_holds_ball(glm::vec3(0.0f), just_less, glm::vec3(1.0f, 1.0f, 0.0f), 1.0f));
}

TEST_CASE("exact containment agrees with long arithmetic where that is sure", "[verify]") {
  std::size_t sure = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Random random(5, 0, i);
    const auto draw = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)); };
    const glm::vec3 center(draw(), draw(), draw()), inner(draw(), draw(), draw());
    const float radius = i % 4 == 0 ? 0.0f : std::fabs(draw());
    const long double dx = static_cast<long double>(inner.x) - center.x,
                      dy = static_cast<long double>(inner.y) - center.y,
                      dz = static_cast<long double>(inner.z) - center.z;
    const long double reach = std::sqrt(dx * dx + dy * dy + dz * dz) + radius;
    const auto radius2 = static_cast<float>(reach * reach);
    for (const float r2 : {below(radius2), radius2, above(radius2)}) {
      const long double rest = std::sqrt(static_cast<long double>(r2)) - reach;
      if (std::fabs(rest) < 0x1p-58L) continue;
      ++sure;
      REQUIRE(ball_holds_ball(center, r2, inner, radius) == (rest > 0));
    }
  }
  CHECK(sure > 59000);
}

TEST_CASE("a box holds balls up to its sides", "[verify]") {
  const glm::vec3 lower(-1.0f, -2.0f, -3.0f), upper(1.0f, 2.0f, 3.0f);
  CHECK(box_holds_ball(lower, upper, {0.0f, 0.0f, 0.0f}, 1.0f));
  CHECK_FALSE(box_holds_ball(lower, upper, {0.0f, 0.0f, 0.0f}, above(1.0f)));
  CHECK_FALSE(box_holds_ball(lower, upper, {0x1p-100f, 0.0f, 0.0f}, 1.0f));
  CHECK(box_holds_ball(lower, upper, upper, 0.0f));
  CHECK_FALSE(box_holds_ball(lower, upper, {1.0f, 2.0f, above(3.0f)}, 0.0f));
}

}  // namespace plumbline
