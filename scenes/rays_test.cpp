// SPDX-License-Identifier: MIT
// The ray families: repeatable, defined where they should be, and each doing what its name says, against closed forms
// in double.
#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstring>
#include <set>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/rays.h"
#include "scenes/ulp.h"

using namespace plumbline;

namespace {

std::vector<Ray> rays_of(const RaySource& source, RayFamily family, std::size_t count, std::uint64_t seed = 1,
                         std::uint64_t first = 0) {
  std::vector<Ray> rays(count);
  generate_rays(source, family, seed, first, rays);
  return rays;
}

bool same_bits(const std::vector<Ray>& a, const std::vector<Ray>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Ray)) == 0;
}

Scene one_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  Scene scene;
  scene.positions = {a, b, c};
  scene.triangles.emplace_back();
  scene.triangles[0].position = {0, 1, 2};
  scene.materials.emplace_back();
  frame_camera(scene);
  return scene;
}

Scene one_sphere(const glm::vec3& center, float radius) {
  Scene scene;
  scene.spheres.push_back({center, radius, 0});
  scene.materials.emplace_back();
  frame_camera(scene);
  return scene;
}

/// Distance between a ray's line and a point, in double.
double distance_to(const Ray& ray, const glm::dvec3& point) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
  return glm::length(glm::cross(point - glm::dvec3(ray.origin), d));
}

/// What the rounding of a direction to 32 bits moves a line by at a point: half a unit of 2^-24 of each component's
/// size, over the way there; and of the origin, where that was rounded after aiming.
double aim_error(const Ray& ray, const glm::dvec3& point) {
  return 0x1p-23 *
         (glm::length(point - glm::dvec3(ray.origin)) + glm::length(point) + glm::length(glm::dvec3(ray.origin)));
}

/// Signed distance, as seen along the ray, by which its line passes inside the outline of a triangle (negative:
/// outside).
double margin_of(const Ray& ray, const std::array<glm::vec3, 3>& corner) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
  glm::dvec3 p[3];
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 offset = glm::dvec3(corner[static_cast<std::size_t>(i)]) - glm::dvec3(ray.origin);
    p[i] = offset - glm::dot(offset, d) * d;  // in the plane across the ray, which passes through zero
  }
  const double side = glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), d) < 0.0 ? -1.0 : 1.0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a = p[i], b = p[(i + 1) % 3];
    least = std::min(least, side * glm::dot(glm::cross(a, b), d) / glm::length(b - a));
  }
  return least;
}

constexpr std::size_t kCount = 4000;

}  // namespace

TEST_CASE("Every family gives the same rays whatever the batches, others for other seeds, and defined ones") {
  for (const char* spec : {"sphereflake:2", "creature", "mount:3", "gears:1", "rings:1"}) {
    const Scene scene = load_scene(spec);
    RaySource source(scene, {{0, 0, 0, 1}, {0.5f, 0, 0, 0.25f}});
    source.set_captured({{{0, 0, 0}, {1, 2, 3}}, {{1, 0, 0}, {0, 0, 0}}, {{0, 1, 0}, {3, 2, 1}, 2.0f}});
    CHECK(source.captured.size() == 2);
    for (const RayFamilyInfo& info : ray_families()) {
      INFO(spec << " " << info.name);
      const std::vector<Ray> rays = rays_of(source, info.family, 1000, 7);
      std::vector<Ray> parts(1000);
      for (std::size_t first : {700, 0, 300}) {
        const std::size_t end = first == 700 ? 1000 : first == 0 ? 300 : 700;
        generate_rays(source, info.family, 7, first, std::span(parts).subspan(first, end - first));
      }
      CHECK(same_bits(rays, parts));
      CHECK_FALSE(same_bits(rays, rays_of(source, info.family, 1000, 8)));
      std::size_t defined = 0;
      for (const Ray& ray : rays) defined += is_defined(ray) ? 1 : 0;
      CHECK(defined == (info.family == RayFamily::undefined ? 0 : 1000));
      std::set<std::array<std::uint32_t, 7>> different;
      for (const Ray& ray : rays) different.insert(std::bit_cast<std::array<std::uint32_t, 7>>(ray));
      CHECK(different.size() > 900);
    }
  }
}

TEST_CASE("Families of scenes of spheres alone, of one triangle, of nothing, of huge and tiny sizes are defined too") {
  std::vector<Scene> scenes{one_sphere({1, 2, 3}, 0.5f),
                            one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                            one_triangle({1e30f, 0, 0}, {2e30f, 0, 0}, {0, 3e30f, 0}),
                            one_triangle({1e-40f, 0, 0}, {2e-40f, 0, 0}, {0, 3e-40f, 0}),
                            one_triangle({1e6f, 1e6f, 1e6f}, {1e6f, 1e6f, 1e6f + 1}, {1e6f, 1e6f + 1, 1e6f}),
                            one_sphere({1e6f, 0, 0}, 1e-3f),
                            Scene{}};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const RaySource source(scenes[i]);
    for (const RayFamilyInfo& info : ray_families()) {
      INFO(i << " " << info.name);
      std::size_t defined = 0;
      for (const Ray& ray : rays_of(source, info.family, 500)) defined += is_defined(ray) ? 1 : 0;
      CHECK(defined == (info.family == RayFamily::undefined ? 0 : 500));
    }
  }
}

TEST_CASE("Family names are stable and unknown ones are refused with the list") {
  CHECK(ray_families().size() == 18);
  for (const RayFamilyInfo& info : ray_families()) {
    CHECK(find_ray_family(info.name) == info.family);
    CHECK(ray_family_info(info.family).name == info.name);
    CHECK_FALSE(info.description.empty());
  }
  try {
    find_ray_family("sideways");
    FAIL("an unknown family was found");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("aimed_edges") != std::string::npos);
  }
}

TEST_CASE("camera visits every pixel once a round, within the pixel, scattered over the picture") {
  Scene scene = generate_scene("cube");
  scene.camera.width = 64;
  scene.camera.height = 48;
  const RaySource source(scene);
  const CameraFrame frame = camera_frame(scene.camera);
  std::vector<int> visits(64 * 48, 0);
  int in_first_rows = 0;
  const auto pixel_of = [&](const Ray& ray) {
    const glm::dvec3 d(ray.direction);
    const double forward = glm::dot(d, frame.forward);
    return glm::ivec2(std::lround(glm::dot(d, frame.right) / forward / frame.pixel + frame.centre_x),
                      std::lround(frame.centre_y - glm::dot(d, frame.up) / forward / frame.pixel));
  };
  std::size_t index = 0;
  for (const Ray& ray : rays_of(source, RayFamily::camera, 2 * 64 * 48)) {
    const glm::ivec2 pixel = pixel_of(ray);
    REQUIRE((pixel.x >= 0 && pixel.x < 64 && pixel.y >= 0 && pixel.y < 48));
    ++visits[static_cast<std::size_t>(pixel.y * 64 + pixel.x)];
    if (index++ < 64 * 12 && pixel.y < 12) ++in_first_rows;
  }
  // A jitter within rounding of a pixel's border may land in its neighbour.
  int wrong = 0;
  for (const int count : visits) wrong += count == 2 ? 0 : 1;
  CHECK(wrong <= 4);
  CHECK(in_first_rows < 64 * 12 / 2);
}

TEST_CASE("chords begin and end on the ball") {
  const Scene scene = generate_scene("creature");
  const RaySource source(scene);
  for (const Ray& ray : rays_of(source, RayFamily::chords, kCount)) {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    CHECK(glm::length(o - source.ball.center) == Approx(source.ball.radius).epsilon(1e-6));
    CHECK(glm::length(o + d - source.ball.center) == Approx(source.ball.radius).epsilon(1e-6));
  }
}

TEST_CASE("aimed_vertices and aimed_edges pass by what they aim at within the rounding of the direction") {
  const glm::vec3 corner[3] = {{0.3f, 0.1f, -0.2f}, {1.7f, 0.4f, 0.3f}, {0.2f, 1.1f, 0.9f}};
  const Scene scene = one_triangle(corner[0], corner[1], corner[2]);
  const RaySource source(scene);
  std::size_t exact = 0;
  for (const Ray& ray : rays_of(source, RayFamily::aimed_vertices, kCount)) {
    double least = 1e9;
    for (const glm::vec3& c : corner)
      least = std::min(least, distance_to(ray, glm::dvec3(c)) / aim_error(ray, glm::dvec3(c)));
    CHECK(least <= 1.0);
    exact += least == 0.0 ? 1 : 0;
  }
  CHECK(exact > kCount / 8);  // along an axis through the vertex
  for (const Ray& ray : rays_of(source, RayFamily::aimed_edges, kCount)) {
    const double error = aim_error(ray, glm::dvec3(0.5));
    CHECK(std::abs(margin_of(ray, scene.corners(0))) <= 2.0 * error);
  }
}

TEST_CASE("aimed_inside hits and aimed_outside misses, mostly, and never by much") {
  const Scene scene = one_triangle({0, 0, 0}, {1, 0, 0.25f}, {0, 1, 0.5f});
  const RaySource source(scene);
  for (const RayFamily family : {RayFamily::aimed_inside, RayFamily::aimed_outside}) {
    const double sign = family == RayFamily::aimed_inside ? 1.0 : -1.0;
    std::size_t right = 0;
    for (const Ray& ray : rays_of(source, family, kCount)) {
      const double margin = sign * margin_of(ray, scene.corners(0));
      right += margin > 0.0 ? 1 : 0;
      // 64 units of numbers below 1, and what the aim errs by.
      CHECK(std::abs(margin) <= 64.0 * 0x1p-23 + 2.0 * aim_error(ray, glm::dvec3(0.5)));
    }
    CHECK(right > kCount / 2);
    CHECK(right < kCount);  // one unit is within the noise of the direction
  }
  const Scene ball = one_sphere({0.25f, 0.5f, 0.75f}, 0.5f);
  const RaySource ball_source(ball);
  for (const RayFamily family : {RayFamily::aimed_inside, RayFamily::aimed_outside, RayFamily::aimed_edges}) {
    for (const Ray& ray : rays_of(ball_source, family, kCount)) {
      if (glm::length(glm::dvec3(ray.origin) - glm::dvec3(ball.spheres[0].center)) <= 0.5)
        continue;  // no outline from within
      const double margin = 0.5 - distance_to(ray, glm::dvec3(ball.spheres[0].center));
      CHECK(std::abs(margin) <= 64.0 * 0x1p-23 + 2.0 * aim_error(ray, glm::dvec3(1.0)));
    }
  }
}

TEST_CASE("tangents touch node spheres and spheres") {
  const Scene scene = one_sphere({0.25f, 0.5f, 0.75f}, 0.5f);
  const RaySource source(scene, {{2, 0, 0, 1}});
  std::size_t nodes = 0;
  for (const Ray& ray : rays_of(source, RayFamily::tangents, kCount)) {
    const double to_node = std::abs(distance_to(ray, {2, 0, 0}) - 1.0);
    const double to_sphere = std::abs(distance_to(ray, glm::dvec3(scene.spheres[0].center)) - 0.5);
    CHECK(std::min(to_node, to_sphere) <= 64.0 * 0x1p-22 + 2.0 * aim_error(ray, glm::dvec3(2.0)));
    nodes += to_node < to_sphere ? 1 : 0;
  }
  CHECK(nodes > kCount / 3);
  CHECK(nodes < 2 * kCount / 3);
}

TEST_CASE("in_plane stays in the plane, through the triangle and past it") {
  // In a plane of constant y everything is exact.
  const Scene scene = one_triangle({0, 0.7f, 0}, {1, 0.7f, 0.25f}, {0.125f, 0.7f, 1});
  const RaySource source(scene);
  std::size_t through = 0;
  for (const Ray& ray : rays_of(source, RayFamily::in_plane, kCount)) {
    CHECK(ray.origin.y == 0.7f);
    CHECK(ray.direction.y == 0.0f);
    // Seen from above: on which sides of the line are the corners?
    int left = 0, right = 0;
    for (const glm::vec3& c : scene.positions) {
      const double cross = static_cast<double>(ray.direction.x) * (c.z - ray.origin.z) -
                           static_cast<double>(ray.direction.z) * (c.x - ray.origin.x);
      left += cross >= 0.0 ? 1 : 0;
      right += cross <= 0.0 ? 1 : 0;
    }
    through += left > 0 && right > 0 ? 1 : 0;
  }
  CHECK(through > kCount / 2);
  CHECK(through < kCount * 9 / 10);
}

TEST_CASE("axis has one component that is not zero, and zeros of both signs") {
  const Scene scene = generate_scene("mount", 3);
  const RaySource source(scene);
  std::size_t minus_zeros = 0, plus_zeros = 0, through_vertex = 0;
  for (const Ray& ray : rays_of(source, RayFamily::axis, kCount)) {
    int nonzero = 0;
    glm::length_t axis = 0;
    for (glm::length_t i = 0; i < 3; ++i) {
      if (ray.direction[i] != 0.0f) {
        ++nonzero;
        axis = i;
      } else {
        ++(std::signbit(ray.direction[i]) ? minus_zeros : plus_zeros);
      }
    }
    CHECK(nonzero == 1);
    for (const glm::vec3& p : scene.positions) {
      if (p[(axis + 1) % 3] == ray.origin[(axis + 1) % 3] && p[(axis + 2) % 3] == ray.origin[(axis + 2) % 3]) {
        ++through_vertex;
        break;
      }
    }
  }
  CHECK(minus_zeros > kCount / 2);
  CHECK(plus_zeros > kCount / 2);
  CHECK(through_vertex > kCount / 4);
}

TEST_CASE("inside starts in the ball, on_surface on a surface, far far away") {
  const Scene scene = generate_scene("sphereflake", 1);
  const RaySource source(scene);
  std::size_t within_spheres = 0, on_surface = 0, shadow = 0;
  for (const Ray& ray : rays_of(source, RayFamily::inside, kCount)) {
    CHECK(glm::length(glm::dvec3(ray.origin) - source.ball.center) <= 2.0 * source.ball.radius * (1.0 + 1e-6));
    for (const Sphere& s : scene.spheres)
      within_spheres +=
          glm::length(glm::dvec3(ray.origin) - glm::dvec3(s.center)) < static_cast<double>(s.radius) ? 1 : 0;
  }
  CHECK(within_spheres > kCount / 4);
  for (const Ray& ray : rays_of(source, RayFamily::on_surface, kCount)) {
    double least = std::abs(ray.origin.z + 0.5);
    for (const Sphere& s : scene.spheres)
      least = std::min(
          least, std::abs(glm::length(glm::dvec3(ray.origin) - glm::dvec3(s.center)) - static_cast<double>(s.radius)));
    on_surface += least <= 0x1p-21 ? 1 : 0;
    shadow += ray.t_max == 1.0f ? 1 : 0;
  }
  CHECK(on_surface == kCount);
  CHECK(shadow > kCount / 8);
  for (const Ray& ray : rays_of(source, RayFamily::far, kCount)) {
    const double distance = glm::length(glm::dvec3(ray.origin) - source.ball.center) / source.ball.radius;
    CHECK((distance > 999.0 && distance < 1.001e6));
    CHECK(distance_to(ray, source.ball.center) <= source.ball.radius + 4.0 * aim_error(ray, source.ball.center));
  }
}

TEST_CASE("scaled reaches from denormals to 1e37 in direction and has denormal origins") {
  const Scene scene = generate_scene("creature");
  const RaySource source(scene);
  double least = 1e99, most = 0.0;
  std::size_t denormal_origins = 0;
  for (const Ray& ray : rays_of(source, RayFamily::scaled, kCount)) {
    const double length = glm::length(glm::dvec3(ray.direction));
    least = std::min(least, length);
    most = std::max(most, length);
    for (int i = 0; i < 3; ++i) denormal_origins += std::fpclassify(ray.origin[i]) == FP_SUBNORMAL ? 1 : 0;
  }
  CHECK(least < 1e-41);
  CHECK(most > 1e36);
  CHECK(most <= 1.001e37);
  CHECK(denormal_origins > kCount / 8);
}

TEST_CASE("segments end up to 8 units in the last place around the hit aimed at") {
  const Scene scene = one_sphere({0, 0, 0}, 1.0f);
  const RaySource source(scene);
  std::size_t before = 0, after = 0, at = 0, negative = 0;
  for (const Ray& ray : rays_of(source, RayFamily::segments, kCount)) {
    if (!(ray.t_max > 0.0f)) {
      ++negative;
      continue;
    }
    if (!std::isfinite(ray.t_max)) continue;
    const glm::dvec3 o(ray.origin), d(ray.direction);
    const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1.0, root = std::sqrt(b * b - a * c);
    if (!(root * root > 1e-6 * a)) continue;  // grazing: the end was where the aim lay
    // Positive floats are in the order of their bits.
    const auto steps = [&](double t) {
      return static_cast<double>(std::bit_cast<std::int32_t>(ray.t_max)) -
             std::bit_cast<std::int32_t>(static_cast<float>(t));
    };
    const double near = steps((-b - root) / a), far = steps((-b + root) / a);
    const double offset = std::abs(near) < std::abs(far) ? near : far;
    CHECK(std::abs(offset) <= 9.0);  // both ends round once
    ++(offset < 0.0 ? before : offset > 0.0 ? after : at);
  }
  CHECK(before > kCount / 4);
  CHECK(after > kCount / 4);
  CHECK(at > kCount / 40);
  CHECK(negative > kCount / 200);
}

TEST_CASE("secondary repeats what was captured, and moves it by a few units from the second round on") {
  const Scene scene = generate_scene("cube");
  RaySource source(scene);
  const std::vector<Ray> captured{{{1, 2, 3}, {1, 0.5f, 0.25f}}, {{3, 2, 1}, {0.25f, 1, 2}, 1.0f}};
  source.set_captured(captured);
  const std::vector<Ray> rays = rays_of(source, RayFamily::secondary, 100);
  CHECK(same_bits({rays.begin(), rays.begin() + 2}, captured));
  for (std::size_t i = 2; i < 100; ++i) {
    CHECK(rays[i].t_max == captured[i % 2].t_max);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::abs(rays[i].origin[k] - captured[i % 2].origin[k]) <=
            4.0f * static_cast<float>(ulp(captured[i % 2].origin[k])));
      CHECK(std::abs(rays[i].direction[k] - captured[i % 2].direction[k]) <=
            4.0f * static_cast<float>(ulp(captured[i % 2].direction[k])));
    }
  }
}

TEST_CASE("undefined spoils every place of a ray with NaN and with both infinities") {
  const Scene scene = generate_scene("cube");
  const RaySource source(scene);
  std::array<int, 7> nan{}, plus{}, minus{};
  int zero = 0;
  for (const Ray& ray : rays_of(source, RayFamily::undefined, 370)) {
    const auto values = std::bit_cast<std::array<float, 7>>(ray);
    for (std::size_t i = 0; i < 7; ++i) {
      nan[i] += std::isnan(values[i]) ? 1 : 0;
      plus[i] += values[i] > 1e38f ? 1 : 0;
      minus[i] += values[i] < -1e38f ? 1 : 0;
    }
    zero += ray.direction == glm::vec3(0.0f) ? 1 : 0;
  }
  for (std::size_t i = 0; i < 7; ++i) {
    CHECK(nan[i] >= 20);
    if (i < 6) CHECK((plus[i] >= 10 && minus[i] >= 10));
  }
  CHECK(zero == 80);
}

TEST_CASE("Sources and rays are made fast enough to feed the tracers") {
  const Scene scene = generate_scene("grid", 70'000);
  const auto start = std::chrono::steady_clock::now();
  const RaySource source(scene);
  const double build = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(build < 2.0);  // 0.2 s on a quiet machine
  std::vector<Ray> rays(100'000);
  for (const RayFamilyInfo& info : ray_families()) {
    const auto begin = std::chrono::steady_clock::now();
    generate_rays(source, info.family, 1, 0, rays);
    const double rate = static_cast<double>(rays.size()) /
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    INFO(info.name);
    CHECK(rate > 1e5);  // far below what is usual, so that a loaded machine passes
    UNSCOPED_INFO(info.name << ": " << rate / 1e6 << " million rays per second");
  }
  SUCCEED("source in " << build << " s");
}
