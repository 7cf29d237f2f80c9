// SPDX-License-Identifier: GPL-3.0-or-later
// SEMANTICS.md point by point, the arbiter's measures against closed forms, and its behaviour under threads.
#include "reference/arbiter.h"

#include <tbb/parallel_for.h>

#include <catch2/catch.hpp>
#include <cfenv>
#include <chrono>

#include "reference/lattice_test.h"
#include "reference/small_scenes_test.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/rays.h"

using namespace plumbline;
using Primitives = std::vector<std::uint32_t>;

namespace {

constexpr std::uint32_t kTriangle = 0, kSphere = 1;

}  // namespace

TEST_CASE("A ray is open at zero and closed at t_max") {
  const Scene scene = triangle_below_sphere();
  const Arbiter arbiter(scene);
  const glm::vec3 up{0, 0, 2}, origin{0.25f, 0.25f, -3};
  CHECK(nearest_in_world(arbiter, {origin, up, kInfinity}) == Primitives{kTriangle});
  CHECK(nearest_in_world(arbiter, {origin, up, 1.5f}) == Primitives{kTriangle});
  CHECK(nearest_in_world(arbiter, {origin, up, step_ulps(1.5f, -1)}).empty());
  CHECK(nearest_in_world(arbiter, {origin, up, 0.0f}).empty());
  CHECK(nearest_in_world(arbiter, {origin, up, -1.0f}).empty());
  CHECK(nearest_in_world(arbiter, {origin, up, -kInfinity}).empty());
  CHECK(arbiter.crossings({origin, up, -kInfinity}, 1.0, 1e9).empty());
  CHECK(arbiter.crossings({origin, up, 0.0f}, 0.0, 1.5).size() == 1);  // with slack
  // From the surface the triangle itself is not met, the sphere behind it is.
  CHECK(nearest_in_world(arbiter, {{0.25f, 0.25f, 0}, up, kInfinity}) == Primitives{kSphere});
  CHECK(nearest_in_world(arbiter, {{0.25f, 0.25f, -0x1p-149f}, up, kInfinity}) == Primitives{kTriangle});
  // A sphere's pole at t = 4 exactly.
  CHECK(nearest_in_world(arbiter, {{0, 0, 4}, -up, kInfinity}) == Primitives{kTriangle});
  CHECK(nearest_in_world(arbiter, {{0, 0, 4}, up, 1.0f}) == Primitives{kSphere});
  CHECK(nearest_in_world(arbiter, {{0, 0, 4}, up, step_ulps(1.0f, -1)}).empty());
}

TEST_CASE("Triangles are closed, have two sides, and are not met in their plane") {
  Scene scene = triangle_below_sphere();
  scene.triangles.push_back({.position = {0, 1, 1}});  // no area
  const Arbiter arbiter(scene);
  for (const float side : {-1.0f, 1.0f}) {
    const glm::vec3 direction{0, 0, side};
    const auto through = [&](float x, float y) {
      return nearest_in_world(arbiter, {{x, y, -side}, direction, kInfinity});
    };
    CHECK(through(0, 0) == Primitives{kTriangle});
    CHECK(through(1, 0) == Primitives{kTriangle});
    CHECK(through(0.5f, 0) == Primitives{kTriangle});
    CHECK(through(0.5f, 0.5f) == Primitives{kTriangle});
    CHECK(through(0.25f, -0x1p-149f) != Primitives{kTriangle});
    CHECK(through(0.5f, step_ulps(0.5f, 1)) != Primitives{kTriangle});
  }
  CHECK(nearest_in_world(arbiter, {{-1, 0.25f, 0}, {1, 0, 0}, kInfinity}).empty());
  CHECK(nearest_in_world(arbiter, {{-1, 0, 0}, {1, 0, 0}, kInfinity}).empty());
  const auto in_plane = arbiter.crossings({{-1, 0.25f, 0}, {1, 0, 0}, kInfinity}, 0.5, 0.0);
  REQUIRE(in_plane.size() == 2);
  for (const Crossing& c : in_plane) {
    CHECK(c.in_plane);
    CHECK(!c.on_line);
    CHECK(c.facing == 0);
  }
  // Parallel to the plane, above it by a quarter.
  const auto above = arbiter.crossings({{-1, 0.25f, 0.25f}, {1, 0, 0}, kInfinity}, 0.5, 0.0);
  REQUIRE(above.size() == 2);
  for (const Crossing& c : above) {
    CHECK(c.facing == 0);
    CHECK(c.in_plane == (c.primitive != kTriangle));  // the other has no area
    CHECK(c.margin == Approx(c.primitive == kTriangle ? -0.25 : -std::sqrt(0.125)));
  }
}

TEST_CASE("Spheres are surfaces, and a tangent hits") {
  const Scene scene = triangle_below_sphere();
  const Arbiter arbiter(scene);
  const auto inside = arbiter.crossings({{0, 0, 5}, {0, 0, 4}, kInfinity}, 0.0, 0.0);
  REQUIRE(inside.size() == 1);
  CHECK(inside[0].t == 0.25);
  CHECK(inside[0].t_enter == -0.25);
  CHECK(inside[0].margin == Approx(1.0));
  const auto tangent = arbiter.crossings({{1, -3, 5}, {0, 1, 0}, kInfinity}, 0.0, 0.0);
  REQUIRE(tangent.size() == 1);
  CHECK(tangent[0].nearest);
  CHECK(tangent[0].t == 3.0);
  CHECK(tangent[0].t_enter == tangent[0].t_leave);
  CHECK(tangent[0].margin == 0.0);
  CHECK(nearest_in_world(arbiter, {{step_ulps(1.0f, 1), -3, 5}, {0, 1, 0}, kInfinity}).empty());
  const auto beside = arbiter.crossings({{1.25f, -3, 5}, {0, 1, 0}, kInfinity}, 0.5, 0.0);
  REQUIRE(beside.size() == 1);
  CHECK(beside[0].margin == Approx(-0.25));
  CHECK(beside[0].t == Approx(3.0));
  CHECK(beside[0].t_enter == Approx(2.0));
}

TEST_CASE("All that share the least t are nearest") {
  Scene scene = triangle_below_sphere();
  scene.positions.push_back({0, -1, 0});
  scene.positions.push_back({1, 1, 0});
  scene.triangles.push_back({.position = {1, 0, 3}});                                  // shares the edge y = 0
  scene.triangles.push_back({.position = {1, 4, 2}});                                  // shares the edge x + y = 1
  scene.spheres = {{{0, 0, 1}, 1.0f, 0}, {{0, 0, 1}, 1.0f, 0}, {{0, 0, 2}, 2.0f, 0}};  // touch the plane in the origin
  const Arbiter arbiter(scene);
  CHECK(nearest_in_world(arbiter, {{0.5f, 0, -1}, {0, 0, 1}, kInfinity}) == Primitives{0, 1});
  CHECK(nearest_in_world(arbiter, {{1, 0, -1}, {0, 0, 1}, kInfinity}) == Primitives{0, 1, 2});
  CHECK(nearest_in_world(arbiter, {{0, 0, -1}, {0, 0, 1}, kInfinity}) == Primitives{0, 1, 3, 4, 5});
  CHECK(nearest_in_world(arbiter, {{0, 0, 0.5f}, {0, 0, 1}, kInfinity}) == Primitives{3, 4});
}

TEST_CASE("Margins and near edges are distances in space") {
  const Scene scene = triangle_below_sphere();
  const Arbiter arbiter(scene);
  // Obliquely, so that space and the picture seen along the ray differ: the direction (1, 0, -1) halves x at 45
  // degrees.
  const auto at = [&](float x, float y, double reach) {
    return arbiter.crossings({{x - 1, y, 1}, {1, 0, -1}, 1.5f}, reach, 0.0);
  };
  auto c = at(0.0625f, 0.5f, 0.05);
  REQUIRE(c.size() == 1);
  CHECK(c[0].hit);
  CHECK(c[0].margin == Approx(0.0625 * std::sqrt(0.5)));
  CHECK(c[0].near_edges == 4);  // the edge from corner 2 to corner 0
  CHECK(c[0].facing == -1);
  c = at(0.0625f, 0.5f, 0.03);
  CHECK(c.at(0).near_edges == 0);
  c = at(-0.0625f, 0.5f, 0.05);
  REQUIRE(c.size() == 1);
  CHECK(!c[0].hit);
  CHECK(c[0].margin == Approx(-0.0625 * std::sqrt(0.5)));
  CHECK(c[0].t == Approx(1.0 + 0.03125));
  CHECK(at(-0.0625f, 0.5f, 0.04).empty());
  // Past the corner (0, 1): edges 1 and 2 are both near.
  c = at(0, 1.0625f, 0.07);
  REQUIRE(c.size() == 1);
  CHECK(c[0].margin == Approx(-0.0625));
  CHECK(c[0].near_edges == 6);
}

TEST_CASE("An empty scene and a single primitive have answers") {
  const Arbiter nothing{Scene{}};
  CHECK(nearest_in_world(nothing, {}).empty());
  CHECK(nothing.crossings({}, 1.0, 1.0).empty());
  Scene one = triangle_below_sphere();
  one.spheres.clear();
  CHECK(nearest_in_world(Arbiter(one), {{0.25f, 0.25f, 1}, {-0.0f, 0.0f, -1}, kInfinity}) == Primitives{0});
}

TEST_CASE("Far origins and directions of any length change nothing but t") {
  const Scene scene = generate_scene("creature");
  const Ball ball = bounding_ball(scene);
  const Arbiter arbiter(scene);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Random random(7, 7, i);
    // Few bits, so that the origin far away is exact.
    const auto few_bits = [](glm::dvec3 v) { return glm::vec3(glm::round(v * 256.0) / 256.0); };
    const glm::vec3 target = few_bits(ball.center + 0.5 * ball.radius * random.direction());
    const glm::vec3 direction = few_bits(random.direction());
    if (direction == glm::vec3(0.0f)) continue;
    const float steps = 0x1p13f;
    const Ray near{target - 8.0f * direction, direction, kInfinity},
        far{target - steps * direction, direction, kInfinity};
    if (glm::dvec3(far.origin) + static_cast<double>(steps) * glm::dvec3(direction) != glm::dvec3(target)) continue;
    if (glm::dvec3(near.origin) + 8.0 * glm::dvec3(direction) != glm::dvec3(target)) continue;
    const Primitives expected = nearest_in_world(arbiter, near);
    hits += !expected.empty();
    CHECK(nearest_in_world(arbiter, far) == expected);
    CHECK(nearest_in_world(arbiter, {near.origin, near.direction * 0x1p-120f, kInfinity}) == expected);
    CHECK(nearest_in_world(arbiter, {near.origin, near.direction * 0x1p120f, kInfinity}) == expected);
    if (expected.empty()) continue;
    const auto t_of = [&](const Ray& ray) { return arbiter.crossings(ray, 0.0, 0.0).at(0).t; };
    CHECK(t_of(far) == Approx(t_of(near) + steps - 8.0).epsilon(1e-14));
    CHECK(t_of({near.origin, near.direction * 0x1p120f, kInfinity}) == t_of(near) * 0x1p-120);
  }
  CHECK(hits > 200);
}

TEST_CASE("Threads and queries leave each other and the rounding mode alone") {
  const Scene scene = lattice::scene(50, 200, 50);
  const Arbiter arbiter(scene);
  constexpr int kRays = 4000;
  std::vector<Primitives> alone(kRays), together(kRays);
  REQUIRE(std::fegetround() == FE_TONEAREST);
  for (int i = 0; i < kRays; ++i) alone[i] = nearest_in_world(arbiter, lattice::ray(scene, 50, i));
  CHECK(std::fegetround() == FE_TONEAREST);
  CHECK(arbiter.exact_decisions() > 1000);
  std::atomic<int> wrong_modes{0};
  tbb::parallel_for(0, kRays, [&](int i) {
    together[i] = nearest_in_world(arbiter, lattice::ray(scene, 50, i));
    wrong_modes += std::fegetround() != FE_TONEAREST;
  });
  CHECK(wrong_modes == 0);
  CHECK(alone == together);
}

TEST_CASE("Both queries agree on every family of rays") {
  for (const char* name : {"creature", "sphereflake:2", "gears:1"}) {
    const Scene scene = load_scene(name);
    const Arbiter arbiter(scene);
    const RaySource source(scene);
    const double reach = 1e-6 * source.ball.radius;
    for (const RayFamilyInfo& family : ray_families()) {
      if (family.family == RayFamily::undefined) continue;
      std::vector<Ray> rays(300);
      generate_rays(source, family.family, 11, 0, rays);
      for (const Ray& ray : rays) {
        Primitives marked;
        double last = -std::numeric_limits<double>::infinity();
        for (const Crossing& c : arbiter.crossings(ray, reach, 0.0)) {
          if (c.nearest) marked.push_back(c.primitive);
          if (!c.on_line) continue;
          CHECK(c.t >= last);
          last = c.t;
        }
        CAPTURE(name, family.name, ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                ray.direction.z);
        CHECK(nearest_in_world(arbiter, ray) == marked);
      }
    }
  }
}

TEST_CASE("The arbiter's tree is built in time") {
  const Scene scene = generate_scene("grid", 200'000);
  const auto start = std::chrono::steady_clock::now();
  const Arbiter arbiter(scene);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("arbiter: %u triangles built in %.3f s\n", scene.primitive_count(), seconds.count());
  CHECK(seconds.count() < 3.0);  // 0.08 s alone on two cores; other programs may run beside the test
}
