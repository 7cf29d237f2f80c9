// SPDX-License-Identifier: MIT
// The ray families in scenes with nodes: rays meet what they were aimed at where the instance shows it.
#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstring>
#include <set>

#include "scenes/generate.h"
#include "scenes/ray_sampler.h"
#include "scenes/rays.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

std::vector<Ray> rays_of(const RaySource& source, RayFamily family, std::size_t count, std::uint64_t seed = 1) {
  std::vector<Ray> rays(count);
  generate_rays(source, family, seed, 0, rays);
  return rays;
}

double distance_to(const Ray& ray, const glm::dvec3& point) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
  return glm::length(glm::cross(point - glm::dvec3(ray.origin), d));
}

/// As in rays_test.cpp: what rounding origin, direction and target to 32 bits moves a line by at a point.
double aim_error(const Ray& ray, const glm::dvec3& point) {
  return 0x1p-22 *
         (glm::length(point - glm::dvec3(ray.origin)) + glm::length(point) + glm::length(glm::dvec3(ray.origin)));
}

struct LocalLine {
  glm::dvec3 origin, direction;
};

LocalLine in_space(const PlacedGeometry& place, const Ray& ray) {
  return {transform_point(place.to_local, glm::dvec3(ray.origin)),
          transform_vector(place.to_local, glm::dvec3(ray.direction))};
}

/// The two t at which a line meets a sphere of a place; NaN where it does not.
std::array<double, 2> meets(const LocalLine& line, const Sphere& sphere) {
  const glm::dvec3 m = line.origin - glm::dvec3(sphere.center);
  const double a = glm::dot(line.direction, line.direction), b = glm::dot(m, line.direction);
  const double root =
      std::sqrt(b * b - a * (glm::dot(m, m) - static_cast<double>(sphere.radius) * static_cast<double>(sphere.radius)));
  return {(-b - root) / a, (-b + root) / a};
}

/// Whether a point of the world lies within a ball around an instance.
bool is_near(const PlacedGeometry& place, const glm::dvec3& point, double scale = 1.0) {
  return glm::length(point - place.ball.center) <= scale * place.ball.radius * (1.0 + 1e-5) + 1e-5 * glm::length(point);
}

Scene of_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.json", text));
}

constexpr std::size_t kCount = 4000;

}  // namespace

TEST_CASE("Every family gives defined rays for every shipped scene, the same whatever the batches") {
  for (const std::string& name : shipped_scenes()) {
    const Scene scene = load_scene(name);
    const RaySource source(scene);
    for (const RayFamilyInfo& info : ray_families()) {
      INFO(name << " " << info.name);
      const std::vector<Ray> rays = rays_of(source, info.family, 300);
      std::size_t defined = 0;
      for (const Ray& ray : rays) defined += is_defined(ray) ? 1 : 0;
      CHECK(defined == (info.family == RayFamily::undefined ? 0 : 300));
      std::vector<Ray> tail(100);
      generate_rays(source, info.family, 1, 200, tail);
      CHECK(std::memcmp(tail.data(), &rays[200], 100 * sizeof(Ray)) == 0);
      std::set<std::array<std::uint32_t, 7>> different;
      for (const Ray& ray : rays) different.insert(std::bit_cast<std::array<std::uint32_t, 7>>(ray));
      CHECK(different.size() > 250);
    }
  }
}

TEST_CASE("Vertices and edges are aimed at where the instance shows them, in every instance") {
  const Scene scene = of_text(
      R"({"parts": {"t": {"positions": [[0.3, 0.1, -0.2], [1.7, 0.4, 0.3], [0.2, 1.1, 0.9]], "triangles": [[0, 1, 2]]}},
    "nodes": [{"part": "t"}, {"part": "t", "transform": {"scale": [-2, 0.5, 1], "shear": {"xy": 2}, "rotate": {"euler": [10, 20, 30]}, "translate": [9, 0, 0]}},
              {"part": "t", "transform": {"scale": 0.01, "translate": [0, 9, 0]}}]})");
  const RaySource source(scene);
  REQUIRE(source.placed.size() == 3);
  std::array<std::size_t, 3> hits{};
  for (const Ray& ray : rays_of(source, RayFamily::aimed_vertices, kCount)) {
    double least = 1e300;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (const glm::vec3& corner : scene.corners(0)) {
        const glm::dvec3 point = transform_point(source.placed[i].to_world, glm::dvec3(corner));
        const double errors = distance_to(ray, point) / aim_error(ray, point);
        if (errors < least) least = errors, nearest = i;
      }
    }
    CHECK(least <= 1.0);
    ++hits[nearest];
  }
  for (const std::size_t count : hits) CHECK(count > kCount / 20);
  for (const Ray& ray : rays_of(source, RayFamily::aimed_edges, kCount)) {
    double least = 1e300;
    for (const PlacedGeometry& place : source.placed) {
      const auto local = scene.corners(0);
      const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction)), o(ray.origin);
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 a = transform_point(place.to_world, glm::dvec3(local[i])),
                         b = transform_point(place.to_world, glm::dvec3(local[(i + 1) % 3]));
        // Between the line of the ray and the edge, as long as the nearest point lies on the edge.
        const glm::dvec3 e = b - a, n = glm::cross(d, e);
        const double along = glm::dot(glm::cross(o - a, d), n) / glm::dot(n, n);
        const glm::dvec3 nearest = a + std::clamp(-along, 0.0, 1.0) * e;
        least = std::min(least, distance_to(ray, nearest) / aim_error(ray, nearest));
      }
    }
    CHECK(least <= 2.0);
  }
}

TEST_CASE("Outlines, tangents and poles of ellipsoids: the line in the part's space touches its sphere") {
  const Scene scene = of_text(R"({"parts": {"s": {"spheres": [{"center": [0.25, 0.5, -0.5], "radius": 0.75}]}},
    "nodes": [{"part": "s", "transform": {"scale": [3, 0.5, 1], "rotate": {"euler": [10, 20, 30]}, "translate": [1, 2, 3]}}]})");
  const RaySource source(scene);
  const PlacedGeometry& place = source.placed.front();
  const Sphere& sphere = scene.spheres[0];
  // Errors grow by at most the stretch of the inverse on the way in.
  const double inward = largest_stretch(place.to_local.linear);
  std::size_t inside = 0, outside = 0;
  for (const RayFamily family :
       {RayFamily::aimed_edges, RayFamily::tangents, RayFamily::aimed_inside, RayFamily::aimed_outside}) {
    for (const Ray& ray : rays_of(source, family, kCount)) {
      const LocalLine line = in_space(place, ray);
      const glm::dvec3 center(sphere.center), d = glm::normalize(line.direction);
      if (glm::length(line.origin - center) <= 0.75) continue;  // no outline from within
      const double past = glm::length(glm::cross(center - line.origin, d)) - 0.75;
      const double error =
          inward * (4.0 * aim_error(ray, place.ball.center + glm::dvec3(place.ball.radius)) + 64.0 * 0x1p-21);
      CHECK(std::abs(past) <= error);
      if (family == RayFamily::aimed_inside) inside += past < 0.0 ? 1 : 0;
      if (family == RayFamily::aimed_outside) outside += past > 0.0 ? 1 : 0;
    }
  }
  CHECK(inside > kCount / 2);
  CHECK(outside > kCount / 2);
  // Poles: images of the ends of the sphere's axes.
  for (const Ray& ray : rays_of(source, RayFamily::aimed_vertices, kCount)) {
    double least = 1e300;
    for (int i = 0; i < 6; ++i) {
      glm::dvec3 pole(sphere.center);
      pole[i % 3] += i < 3 ? 0.75 : -0.75;
      const glm::dvec3 point = transform_point(place.to_world, pole);
      least = std::min(least, distance_to(ray, point) / aim_error(ray, point));
    }
    CHECK(least <= 1.0);
  }
}

TEST_CASE("Segments end at the hit aimed at, in units that every space shares") {
  const Scene scene = of_text(R"({"parts": {"s": {"spheres": [{"center": [0, 0, 0], "radius": 1}]}},
    "nodes": [{"part": "s", "transform": {"scale": [30, 5, 10], "translate": [1, 2, 3]}}]})");
  const RaySource source(scene);
  std::size_t close = 0, judged = 0;
  for (const Ray& ray : rays_of(source, RayFamily::segments, kCount)) {
    if (!(ray.t_max > 0.0f) || !std::isfinite(ray.t_max)) continue;
    const auto [near, far] = meets(in_space(source.placed.front(), ray), scene.spheres[0]);
    if (!(far - near > 1e-3 * std::abs(far))) continue;  // grazing
    ++judged;
    const double t = static_cast<double>(ray.t_max);
    const double off = std::min(std::abs(t - near), std::abs(t - far)) / std::abs(t);
    close += off <= 9.5 * 0x1p-23 ? 1 : 0;
  }
  CHECK(judged > kCount * 3 / 4);
  CHECK(close == judged);
}

TEST_CASE("on_surface starts on what instances show, with their own normals") {
  const Scene scene = of_text(R"({"parts": {"s": {"spheres": [{"center": [0, 0, 0], "radius": 1}]}},
    "nodes": [{"part": "s", "transform": {"scale": [3, 0.5, 1], "translate": [1, 2, 3]}}]})");
  const RaySource source(scene);
  const PlacedGeometry& place = source.placed.front();
  for (const Ray& ray : rays_of(source, RayFamily::on_surface, kCount)) {
    const glm::dvec3 local = transform_point(place.to_local, glm::dvec3(ray.origin));
    CHECK(std::abs(glm::length(local) - 1.0) <= 0x1p-20);
  }
}

TEST_CASE("Normals of what instances show are at right angles to it, not the matrix's images of normals") {
  const Scene scene = of_text(R"({"parts": {"t": {"spheres": [{"center": [1, 0, 0], "radius": 2}],
      "positions": [[0.3, 0.1, -0.2], [1.7, 0.4, 0.3], [0.2, 1.1, 0.9]], "triangles": [[0, 1, 2]]}},
    "nodes": [{"part": "t", "transform": {"scale": [-2, 0.5, 1], "shear": {"xy": 2, "zx": 1}, "rotate": {"euler": [10, 20, 30]}}}]})");
  const RaySource source(scene);
  const PlacedGeometry& place = source.placed.front();
  for (std::uint64_t i = 0; i < 300; ++i) {
    RaySampler sampler(source, 1, 2, i);
    const SurfacePoint point = sampler.surface_point();
    CHECK(glm::length(point.normal) == Approx(1.0));
    if (scene.is_triangle(point.primitive)) {
      const auto corner = sampler.corners(point.primitive);
      for (int k = 0; k < 2; ++k) CHECK(std::abs(glm::dot(point.normal, corner[1 + k] - corner[0])) < 1e-12);
    } else {
      // A step along the surface from there, both ways: the chord is at right angles to the normal.
      const glm::dvec3 center(scene.sphere(point.primitive).center);
      const glm::dvec3 out = transform_point(place.to_local, point.position) - center;
      const glm::dvec3 side = sampler.across(glm::normalize(out));
      for (const double sign : {1.0, -1.0}) {
        const glm::dvec3 beside =
            transform_point(place.to_world, center + glm::length(out) * glm::normalize(out + sign * 1e-5 * side));
        const glm::dvec3 step = beside - point.position;
        CHECK(std::abs(glm::dot(point.normal, step)) < 1e-3 * glm::length(step));
      }
      CHECK(glm::dot(point.normal, transform_vector(place.to_world, out)) > 0.0);
    }
  }
}

TEST_CASE("into_instances leaves one instance and between_instances goes from one to another") {
  const Scene scene = load_scene("nested");
  const RaySource source(scene);
  const auto near_any = [&](const glm::dvec3& point, double scale) {
    std::size_t count = 0;
    for (const PlacedGeometry& place : source.placed) count += is_near(place, point, scale) ? 1 : 0;
    return count > 0;
  };
  std::size_t starts_near = 0, different = 0, ends = 0;
  for (const Ray& ray : rays_of(source, RayFamily::into_instances, kCount))
    starts_near += near_any(glm::dvec3(ray.origin), 2.0) ? 1 : 0;
  CHECK(starts_near == kCount);
  for (const Ray& ray : rays_of(source, RayFamily::between_instances, kCount)) {
    std::size_t met = 0;
    for (const PlacedGeometry& place : source.placed)
      met += distance_to(ray, place.ball.center) <= place.ball.radius * (1.0 + 1e-5) ? 1 : 0;
    different += met >= 2 ? 1 : 0;
    if (ray.t_max == 1.0f) {
      ++ends;
      CHECK(near_any(glm::dvec3(ray.origin) + glm::dvec3(ray.direction), 1.0));
    }
  }
  CHECK(different == kCount);
  CHECK(ends > kCount / 8);
  // Without nodes they are inside and chords.
  const Scene plain = load_scene("cube");
  const RaySource of_plain(plain);
  std::size_t from_ball = 0;
  for (const Ray& ray : rays_of(of_plain, RayFamily::between_instances, 500))
    from_ball +=
        std::abs(glm::length(glm::dvec3(ray.origin) - of_plain.ball.center) / of_plain.ball.radius - 1.0) < 1e-6 ? 1
                                                                                                                 : 0;
  CHECK(from_ball == 500);
  for (const RayFamilyInfo& info : ray_families())
    CHECK(info.needs_instances == (info.name.find("instances") != info.name.npos));
}

TEST_CASE("Small instances are seen from near, large ones from far") {
  const Scene scene = load_scene("scales");
  const RaySource source(scene);
  std::size_t near_small = 0;
  for (const Ray& ray : rays_of(source, RayFamily::aimed_vertices, kCount)) {
    for (const PlacedGeometry& place : source.placed) {
      if (place.ball.radius < 0.01 && is_near(place, glm::dvec3(ray.origin), 4.0)) {
        ++near_small;
        break;
      }
    }
  }
  CHECK(near_small > kCount / 50);
}

TEST_CASE("Ten thousand instances of seventy thousand triangles make rays at the usual speed") {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write("scene.json", R"({"parts": {"big": "torus:70000"},
    "nodes": [{"part": "big", "repeat": [{"count": 100, "by": {"translate": [3, 0, 0]}}, {"count": 100, "by": {"translate": [0, 3, 0]}}]}]})"));
  CHECK(placed_count(scene) > 690'000'000);
  const auto start = std::chrono::steady_clock::now();
  const RaySource source(scene);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
  std::vector<Ray> rays(20'000);
  for (const RayFamilyInfo& info : ray_families()) {
    const auto begin = std::chrono::steady_clock::now();
    generate_rays(source, info.family, 1, 0, rays);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    INFO(info.name);
    CHECK(static_cast<double>(rays.size()) / seconds > 2e4);  // a loaded machine passes
  }
  CHECK(source.placed.size() == 10'000);
  // Origins on surfaces are all over the field.
  std::set<std::pair<long, long>> cells;
  for (const Ray& ray : rays_of(source, RayFamily::on_surface, 20'000))
    cells.insert({std::lround(ray.origin.x / 3.0f), std::lround(ray.origin.y / 3.0f)});
  CHECK(cells.size() > 8000);
}
