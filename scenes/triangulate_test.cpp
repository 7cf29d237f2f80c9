// SPDX-License-Identifier: MIT
// Polygons into triangles: areas add up, winding stays, crossings are found, and areas of zero are told exactly.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>

#include "scenes/random.h"
#include "scenes/triangulate.h"

using namespace plumbline;

namespace {

/// The sum of the triangles' area vectors: equals the polygon's where it is covered once and the winding is kept.
glm::dvec3 area_vector(const std::vector<glm::vec3>& corners, const Triangulation& cut, double& absolute) {
  const auto at = [&](std::uint32_t i) {
    return glm::dvec3(i < corners.size() ? corners[i] : cut.blended[i - corners.size()].position);
  };
  glm::dvec3 sum(0.0);
  absolute = 0.0;
  for (const auto& t : cut.triangles) {
    const glm::dvec3 area = 0.5 * glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
    sum += area;
    absolute += glm::length(area);
  }
  return sum;
}

}  // namespace

TEST_CASE("A concave polygon is covered once and keeps its winding") {
  // A gear in a tilted plane: radii alternate.
  std::vector<glm::vec3> corners;
  constexpr int kCount = 144;
  double expected = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * 3.141592653589793 * i / kCount, radius = i % 4 < 2 ? 1.0 : 0.8;
    const double u = radius * std::cos(angle), v = radius * std::sin(angle);
    corners.push_back(glm::vec3(glm::dvec3(0.6 * u, v, 0.8 * u)));
  }
  for (int i = 0; i < kCount; ++i) {
    const double r0 = i % 4 < 2 ? 1.0 : 0.8, r1 = (i + 1) % 4 < 2 ? 1.0 : 0.8;
    expected += 0.5 * r0 * r1 * std::sin(2.0 * 3.141592653589793 / kCount);
  }
  const Triangulation cut = triangulate(corners);
  CHECK(cut.triangles.size() == kCount - 2);
  CHECK(cut.blended.empty());
  double absolute = 0.0;
  const glm::dvec3 area = area_vector(corners, cut, absolute);
  CHECK(absolute == Approx(expected).epsilon(1e-6));
  CHECK(glm::dot(area, glm::dvec3(-0.8, 0.0, 0.6)) == Approx(expected).epsilon(1e-6));
}

TEST_CASE("A concave quadrilateral is cut along the diagonal that lies in it") {
  const std::vector<glm::vec3> corners{{0, 0, 0}, {1, 0.25f, 0}, {2, 0, 0}, {1, 2, 0}};
  double absolute = 0.0;
  const glm::dvec3 area = area_vector(corners, triangulate(corners), absolute);
  CHECK(area.z == Approx(1.75));
  CHECK(absolute == Approx(1.75));
}

TEST_CASE("Crossing edges get a corner where they cross, blended from their ends") {
  const std::vector<glm::vec3> star = [] {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 5; ++i) points.emplace_back(std::cos(1.2566371 * 2 * i), std::sin(1.2566371 * 2 * i), 0.0);
    return points;
  }();
  const Triangulation cut = triangulate(star);
  REQUIRE(cut.blended.size() == 5);
  for (const BlendedCorner& corner : cut.blended) {
    CHECK(glm::length(corner.position) == Approx(0.381966).epsilon(1e-4));
    CHECK(corner.weight[0] + corner.weight[1] + corner.weight[2] + corner.weight[3] == Approx(1.0f));
  }
  double absolute = 0.0;
  area_vector(star, cut, absolute);
  CHECK(absolute == Approx(1.12257).epsilon(1e-4));  // of a pentagram of circumradius 1
  // The signed areas of a bow tie's halves cancel.
  const std::vector<glm::vec3> bow{{0, 0, 0}, {2, 2, 1}, {2, 0, 0}, {0, 2, 1}};
  const Triangulation halves = triangulate(bow);
  REQUIRE(halves.blended.size() == 1);
  CHECK(halves.blended[0].position == glm::vec3(1, 1, 0.5f));
  CHECK(halves.triangles.size() == 2);
}

TEST_CASE("Large polygons take bounded time") {
  std::vector<glm::vec3> round, zigzag;
  for (std::size_t i = 0; i < kMaxPolygonCorners; ++i) {
    const double angle = 2.0 * 3.141592653589793 * static_cast<double>(i) / kMaxPolygonCorners;
    const double radius = i % 2 == 0 ? 1.0 : 0.99;
    round.push_back(glm::vec3(glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 0.0)));
    Random random(1, 2, i);
    zigzag.push_back(glm::vec3(glm::dvec3(random.uniform(), random.uniform(), 0.0)));
  }
  const auto start = std::chrono::steady_clock::now();
  CHECK(triangulate(round).triangles.size() == kMaxPolygonCorners - 2);
  CHECK(triangulate(zigzag).too_complex);
  zigzag.resize(512);
  CHECK_FALSE(triangulate(zigzag).triangles.empty());
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
  round.push_back(round[0]);
  CHECK(triangulate(round).too_complex);
}

TEST_CASE("An area of zero is told from the smallest one") {
  CHECK_FALSE(has_area({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
  CHECK_FALSE(has_area({0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}, {5, 6, 7}));
  const float next = std::nextafter(3.0f, 4.0f);
  CHECK(has_area({0, 0, 0}, {1, 1, 1}, {3, 3, next}));
  // In double the differences lose the small number and the cross product comes out as zero.
  CHECK(has_area({1, 0, 0}, {1, 1e-30f, 0}, {2, 0, 0}));
  CHECK(has_area({1, 1, 0}, {2, 2, 0}, {1e-30f, 0, 0}));
  CHECK_FALSE(has_area({1e-40f, 0, 0}, {2e-40f, 0, 0}, {3e-40f, 0, 0}));
  CHECK(has_area({1e-40f, 0, 0}, {2e-40f, 0, 0}, {3e-40f, 1e-45f, 0}));
}
