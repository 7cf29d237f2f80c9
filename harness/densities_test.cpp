// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's perturbations are as they should be, and each fault of a density or of independence is seen.
#include "harness/densities.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "harness/compare_pictures.h"
#include "reference/perturbation.h"
#include "reference/random_source.h"

using namespace plumbline;

namespace {

constexpr int kWidth = 32, kHeight = 16;
constexpr std::uint32_t kFrames = 80;

/// Perturbations made of the numbers of a draw.
PerturbationGrid grid_of(const std::function<glm::dvec3(const PhiloxSource&, Draw)>& place) {
  const PhiloxSource numbers(20261123);
  PerturbationGrid grid{kWidth, kHeight, kFrames, {}};
  for (std::uint32_t f = 0; f < kFrames; ++f)
    for (std::uint32_t y = 0; y < kHeight; ++y)
      for (std::uint32_t x = 0; x < kWidth; ++x) grid.values.push_back(place(numbers, {x, y, f, 1, 8}));
  return grid;
}
glm::dvec3 drawn(const PhiloxSource& numbers, const Draw& draw) {
  std::array<double, 3> u{};
  numbers.fill(draw, u);
  return {u[0], u[1], u[2]};
}
double p_of(Body body, const std::function<glm::dvec3(const PhiloxSource&, Draw)>& place) {
  return test_density(body, grid_of(place), 0x1p-50, kCaseLevel).p();
}

}  // namespace

TEST_CASE("The formulas of cube, disc and ball give places that are uniform there", "[statistics]") {
  CHECK(p_of(Body::cube, [](const auto& n, Draw d) { return in_cube(drawn(n, d)); }) > 1e-3);
  CHECK(p_of(Body::disc, [](const auto& n, Draw d) { return on_disc(drawn(n, d)); }) > 1e-3);
  CHECK(p_of(Body::ball, [](const auto& n, Draw d) { return in_ball(drawn(n, d)); }) > 1e-3);
}

TEST_CASE("A place that is taken back gives the numbers that made it", "[statistics]") {
  const PhiloxSource numbers(1);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const glm::dvec3 u = drawn(numbers, {i, 0, 0, 1, 8});
    CHECK(glm::length(uniform_numbers(Body::ball, in_ball(u), 1e-15) - u) < 1e-9);
    CHECK(glm::length(uniform_numbers(Body::disc, on_disc(u), 1e-15) - glm::dvec3(u.x, u.y, 0.0)) < 1e-12);
    CHECK(glm::length(uniform_numbers(Body::cube, in_cube(u), 1e-15) - u) < 1e-15);
  }
  CHECK(std::isnan(uniform_numbers(Body::ball, {1.0, 0.1, 0.0}, 1e-6).x));
  CHECK(std::isnan(uniform_numbers(Body::disc, {0.1, 0.1, 0.1}, 1e-6).x));
  CHECK(std::isnan(uniform_numbers(Body::cube, {0.0, 1.01, 0.0}, 1e-6).y));
}

TEST_CASE("Each wrong density is seen", "[statistics]") {
  const auto seen = [](Body body, const std::function<glm::dvec3(const PhiloxSource&, Draw)>& place) {
    return p_of(body, place) <= kCaseLevel;
  };
  // Too small and too large by 3 %, cube for ball, ball for cube, surface for volume, no square root, no cube root.
  CHECK(seen(Body::ball, [](const auto& n, Draw d) { return 0.97 * in_ball(drawn(n, d)); }));
  CHECK(seen(Body::ball, [](const auto& n, Draw d) { return 1.03 * in_ball(drawn(n, d)); }));
  CHECK(seen(Body::cube, [](const auto& n, Draw d) { return 0.97 * in_cube(drawn(n, d)); }));
  CHECK(seen(Body::ball, [](const auto& n, Draw d) { return in_cube(drawn(n, d)); }));
  CHECK(seen(Body::cube, [](const auto& n, Draw d) { return in_ball(drawn(n, d)); }));
  CHECK(seen(Body::ball, [](const auto& n, Draw d) { return glm::normalize(in_ball(drawn(n, d))); }));
  CHECK(seen(Body::disc, [](const auto& n, Draw d) {
    const glm::dvec3 u = drawn(n, d);
    return on_disc({u.x * u.x, u.y, 0.0});
  }));
  CHECK(seen(Body::ball, [](const auto& n, Draw d) {
    const glm::dvec3 u = drawn(n, d);
    return in_ball({u.x, u.y, u.z * u.z * u.z});
  }));
}

TEST_CASE("Each dependence is seen", "[statistics]") {
  const auto seen = [](const std::function<glm::dvec3(const PhiloxSource&, Draw)>& place) {
    return p_of(Body::cube, place) <= kCaseLevel;
  };
  CHECK(seen([](const auto& n, Draw d) {  // two dimensions read one number
    const glm::dvec3 u = drawn(n, d);
    return in_cube({u.x, u.x, u.z});
  }));
  CHECK(seen([](const auto& n, Draw d) { return d.x &= ~1u, in_cube(drawn(n, d)); }));             // pairs of columns
  CHECK(seen([](const auto& n, Draw d) { return d.x = (d.x + 1) & ~1u, in_cube(drawn(n, d)); }));  // the other pairs
  CHECK(seen([](const auto& n, Draw d) { return d.y &= ~1u, in_cube(drawn(n, d)); }));
  CHECK(seen([](const auto& n, Draw d) { return d.frame &= ~1u, in_cube(drawn(n, d)); }));
  CHECK(seen([](const auto& n, Draw d) { return d.frame %= 64, in_cube(drawn(n, d)); }));  // noise that comes again
  CHECK(seen([](const auto& n, Draw d) {  // a weak one: a twentieth of the pairs share their number
    if (d.x % 2 == 1 && d.y == 3) --d.x;
    return in_cube(drawn(n, d));
  }));
}
