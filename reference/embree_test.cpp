// SPDX-License-Identifier: GPL-3.0-or-later
// Embree's answers against SEMANTICS.md, closed forms and the arbiter; and proofs that Embree errs where it is known
// to.
#include "reference/embree.h"

#include <immintrin.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cfenv>

#include "reference/arbiter.h"
#include "reference/exact_values.h"
#include "reference/small_scenes_test.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/rays.h"
#include "scenes/ulp.h"

using namespace plumbline;

namespace {

/// How far Embree was from being right: the least lateral distance that would have to be forgiven, on the primitive
/// that it named wrongly or on the one that it overlooked; or the distance in depth of the two.
double error_of(const Arbiter& arbiter, const Ray& ray, const ReferenceHit& hit, double radius) {
  double least = std::numeric_limits<double>::infinity();
  const Crossing *named = nullptr, *nearest = nullptr;
  const auto crossings = arbiter.crossings(ray, 1e-2 * radius, 0.0);
  for (const Crossing& c : crossings) {
    if (c.primitive == hit.primitive) named = &c;
    if (c.nearest) nearest = &c;
  }
  const double length = glm::length(glm::dvec3(ray.direction));
  if (nearest != nullptr) least = std::min(least, nearest->margin);
  if (named != nullptr) least = std::min(least, std::abs(named->margin));
  if (named != nullptr && nearest != nullptr) least = std::min(least, std::abs(named->t - nearest->t) * length);
  return least;
}

}  // namespace

TEST_CASE("Embree's hits mean what SEMANTICS says") {
  const Scene scene = triangle_below_sphere();
  for (const SphereMode mode : {SphereMode::exact_user, SphereMode::embree}) {
    const EmbreeScene embree(scene, mode);
    const glm::vec3 up{0, 0, 2}, origin{0.25f, 0.25f, -3};
    ReferenceHit hit = trace(embree, {origin, up, kInfinity});
    CHECK(hit.kind == HitKind::hit);
    CHECK(hit.primitive == 0);
    CHECK(hit.t == 1.5);
    CHECK(hit.position == glm::dvec3(0.25, 0.25, 0));
    CHECK(hit.normal == glm::dvec3(0, 0, 1));
    CHECK(hit.barycentrics == glm::dvec2(0.25, 0.25));
    // Closed at t_max, open at zero, nothing where t_max <= 0.
    CHECK(trace(embree, {origin, up, 1.5f}).kind == HitKind::hit);
    CHECK(trace(embree, {origin, up, step_ulps(1.5f, -1)}).kind == HitKind::miss);
    CHECK(trace(embree, {origin, up, 0.0f}).kind == HitKind::miss);
    CHECK(trace(embree, {origin, up, -1.0f}).kind == HitKind::miss);
    hit = trace(embree, {{0.25f, 0.25f, 0}, up, kInfinity});
    CHECK(hit.primitive == 1);
    // In the plane of the triangle, with zeros of both signs.
    CHECK(trace(embree, {{-1, 0.25f, 0}, {1, 0.0f, -0.0f}, kInfinity}).kind == HitKind::miss);
    // From inside the sphere; the normal is not turned.
    hit = trace(embree, {{0, 0, 5}, {0, 0, 4}, kInfinity});
    CHECK(hit.primitive == 1);
    CHECK(hit.t == 0.25);
    CHECK(hit.normal == glm::dvec3(0, 0, 1));
    CHECK(hit.barycentrics == glm::dvec2(0.0));
    CHECK(trace(embree, {{0, 0, 9}, {-0.0f, 0.0f, -4}, kInfinity}).t == 0.75);
  }
  // A tangent ray hits: in double precision this one is exact.
  CHECK(trace(EmbreeScene(scene), {{1, -3, 5}, {0, 1, 0}, kInfinity}).t == 3.0);
  CHECK(trace(EmbreeScene(scene), {{step_ulps(1.0f, 1), -3, 5}, {0, 1, 0}, kInfinity}).kind == HitKind::miss);
}

TEST_CASE("Undefined rays are told from misses, and hurt no neighbour") {
  const EmbreeScene embree(triangle_below_sphere());
  std::vector<Ray> rays(100, {{0.25f, 0.25f, -1}, {0, 0, 1}, kInfinity});
  rays[3].origin.x = std::nanf("");
  rays[4].direction.z = 0.0f;
  rays[5].t_max = std::nanf("");
  rays[6].direction.y = kInfinity;
  const auto hits = trace(embree, rays);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    CHECK(hits[i].kind == (i >= 3 && i <= 6 ? HitKind::undefined : HitKind::hit));
    CHECK((hits[i].primitive == kNone) == (i >= 3 && i <= 6));
  }
}

TEST_CASE("An empty scene is missed") {
  const EmbreeScene embree{Scene{}};
  CHECK(trace(embree, Ray{}).kind == HitKind::miss);
  const Ray ray;
  CHECK(embree.intersect_only({&ray, 1}) == 0);
}

TEST_CASE("Embree differs from the arbiter only within rounding") {
  for (const char* name : {"creature", "sphereflake:3", "mount:4"}) {
    const Scene scene = load_scene(name);
    const EmbreeScene embree(scene);
    const Arbiter arbiter(scene);
    const RaySource source(scene);
    for (const RayFamily family : {RayFamily::camera, RayFamily::chords, RayFamily::aimed_edges, RayFamily::far}) {
      std::vector<Ray> rays(family == RayFamily::chords ? 100'000 : 10'000);
      generate_rays(source, family, 3, 0, rays);
      const auto hits = trace(embree, rays);
      int wrong = 0;
      double worst = 0.0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (is_right(hits[i], arbiter.nearest(rays[i]))) continue;
        ++wrong;
        worst = std::max(worst, error_of(arbiter, rays[i], hits[i], source.ball.radius));
      }
      const std::string_view family_name = ray_family_info(family).name;
      std::printf("embree: %-14s %-12s %zu rays, %d wrong, by at most %.2g of the radius\n", name, family_name.data(),
                  rays.size(), wrong, worst / source.ball.radius);
      CAPTURE(name, family_name);
      // Embree computes in 32 bits with an origin at most some five radii away (the camera's, and moved ones). A side
      // product's error, a dozen roundings of 5 R times an edge, over the edge's projected length is 60 * 2^-24 R;
      // where the edge is foreshortened to a tenth, ten times that.
      CHECK(worst <= 600.0 * 0x1p-24 * source.ball.radius);
      CHECK(wrong <= static_cast<int>(rays.size()) / (family == RayFamily::aimed_edges ? 3 : 1000));
    }
  }
}

TEST_CASE("Embree's values are those of exact arithmetic") {
  for (const char* name : {"creature", "sphereflake:3"}) {
    const Scene scene = load_scene(name);
    const EmbreeScene embree(scene);
    const RaySource source(scene);
    for (const RayFamily family : {RayFamily::chords, RayFamily::far}) {
      std::vector<Ray> rays(5000);
      generate_rays(source, family, 4, 0, rays);
      const auto hits = trace(embree, rays);
      int compared = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].kind != HitKind::hit) continue;
        const ReferenceHit truth = exact_hit(scene, rays[i], hits[i].primitive);
        if (truth.kind != HitKind::hit) continue;
        ++compared;
        // A few roundings of numbers of the scene's size, worse by the obliquity; rays seen more edge-on are left out.
        const double cosine = std::abs(glm::dot(glm::normalize(glm::dvec3(rays[i].direction)), truth.normal));
        if (cosine < 1e-2) continue;
        const double tolerance = 50.0 * 0x1p-53 * source.ball.radius / (cosine * cosine);
        const double length = glm::length(glm::dvec3(rays[i].direction));
        CAPTURE(name, i, cosine);
        CHECK(std::abs(hits[i].t - truth.t) * length <= tolerance + 0x1p-52 * truth.t * length);
        CHECK(glm::length(hits[i].position - truth.position) <= tolerance);
        CHECK(glm::length(hits[i].normal - truth.normal) <= (scene.is_triangle(hits[i].primitive) ? 1e-14 : 1e-9));
        CHECK(glm::length(hits[i].barycentrics - truth.barycentrics) <= 1e-9);
      }
      CHECK(compared > (family == RayFamily::far ? 50 : 1000));
    }
  }
}

TEST_CASE("Both kinds of spheres agree but for grazing rays") {
  const Scene scene = generate_scene("sphereflake", 2);
  const Arbiter arbiter(scene);
  const RaySource source(scene);
  for (const RayFamily family : {RayFamily::chords, RayFamily::aimed_edges}) {
    std::vector<Ray> rays(20'000);
    generate_rays(source, family, 5, 0, rays);
    const auto exact = trace(EmbreeScene(scene), rays),
               cross_check = trace(EmbreeScene(scene, SphereMode::embree), rays);
    int differ = 0, exact_wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // The square is met by Embree's own triangle test in both modes.
      const auto nearest = arbiter.nearest(rays[i]);
      const bool on_spheres =
          std::all_of(nearest.begin(), nearest.end(), [&](auto p) { return !scene.is_triangle(p.primitive); });
      exact_wrong += on_spheres && exact[i].kind == HitKind::hit && !scene.is_triangle(exact[i].primitive) &&
                     !is_right(exact[i], nearest);
      if (exact[i].kind == cross_check[i].kind && exact[i].primitive == cross_check[i].primitive) continue;
      ++differ;
      CHECK(error_of(arbiter, rays[i], cross_check[i], source.ball.radius) <= 600.0 * 0x1p-24 * source.ball.radius);
    }
    std::printf("embree: sphere modes differ on %d of %zu rays, %s; double precision is wrong on %d\n", differ,
                rays.size(), ray_family_info(family).name.data(), exact_wrong);
    CHECK(differ < 2000);
    if (family == RayFamily::aimed_edges) CHECK(differ > 0);
    CHECK(exact_wrong == 0);
  }
}

TEST_CASE("Directions of any length give the same hits") {
  const Scene scene = generate_scene("creature");
  const EmbreeScene embree(scene);
  const RaySource source(scene);
  std::vector<Ray> rays(2000);
  generate_rays(source, RayFamily::chords, 6, 0, rays);
  for (Ray& ray : rays)
    ray.direction = glm::vec3(glm::ivec3(glm::dvec3(ray.direction) / source.ball.radius * 512.0));  // 10 bits
  std::erase_if(rays, [](const Ray& ray) { return !is_defined(ray); });
  const auto expected = trace(embree, rays);
  CHECK(std::count_if(expected.begin(), expected.end(), [](const auto& h) { return h.kind == HitKind::hit; }) > 200);
  for (const int exponent : {-149, -140, -126, 100, 116}) {
    std::vector<Ray> other = rays;
    const double factor = std::ldexp(1.0, exponent);
    for (Ray& ray : other) ray.direction = glm::vec3(glm::dvec3(ray.direction) * factor);
    const auto hits = trace(embree, other);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      CAPTURE(exponent, i);
      REQUIRE(hits[i].kind == expected[i].kind);
      REQUIRE(hits[i].primitive == expected[i].primitive);
      if (expected[i].kind == HitKind::hit) REQUIRE(hits[i].t == expected[i].t / factor);
    }
  }
}

TEST_CASE("Scenes of any size give the same hits") {
  const Scene scene = generate_scene("sphereflake", 2);
  const RaySource source(scene);
  std::vector<Ray> rays(2000);
  generate_rays(source, RayFamily::chords, 7, 0, rays);
  const auto expected = trace(EmbreeScene(scene), rays);
  for (const float factor : {0x1p-100f, 0x1p100f}) {
    Scene other = scene;
    for (glm::vec3& p : other.positions) p *= factor;
    for (Sphere& s : other.spheres) s.center *= factor, s.radius *= factor;
    std::vector<Ray> moved = rays;
    for (Ray& ray : moved) ray.origin *= factor;
    const auto hits = trace(EmbreeScene(other), moved);
    int same = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) same += hits[i].primitive == expected[i].primitive;
    CHECK(same >= static_cast<int>(rays.size()) - 1);  // rounding on an edge may fall otherwise
  }
}

TEST_CASE("Building a scene leaves denormals alone, in every thread") {
  const unsigned before = _mm_getcsr() & ~0x3fu;
  const EmbreeScene embree(generate_scene("creature"));
  CHECK((_mm_getcsr() & ~0x3fu) == before);
  std::atomic<int> changed = 0;
  tbb::parallel_for(0, 10'000, [&](int) { changed += (_mm_getcsr() & 0x8040u) != 0; });
  CHECK(changed == 0);
}

TEST_CASE("Counting hits and the floating-point environment") {
  const Scene scene = generate_scene("creature");
  const EmbreeScene embree(scene);
  const RaySource source(scene);
  std::vector<Ray> rays(5000);
  generate_rays(source, RayFamily::chords, 8, 0, rays);
  const unsigned before = _mm_getcsr() & ~0x3fu;  // without the sticky exception flags
  const auto hits = trace(embree, rays);
  CHECK((_mm_getcsr() & ~0x3fu) == before);
  const auto count = static_cast<std::size_t>(
      std::count_if(hits.begin(), hits.end(), [](const auto& h) { return h.kind == HitKind::hit; }));
  // Chords start on the ball, within two radii, so both calls give Embree the same rays up to a power of two.
  CHECK(embree.intersect_only(rays) == count);
  CHECK((_mm_getcsr() & ~0x3fu) == before);
  CHECK(std::fegetround() == FE_TONEAREST);
}

// Expected failures of Embree 3.13.5. Which rays fail hangs on the processor's instruction set, so batches are asked.
// Should one of these tests fail, Embree has been mended there: record that, and drop the case.

TEST_CASE("Embree slips through corners of closed surfaces: issues 174 and 181") {
  const Scene scene = generate_scene("creature");
  const EmbreeScene embree(scene);
  const Arbiter arbiter(scene);
  const double radius = bounding_ball(scene).radius;
  int rays = 0, wrong = 0, missed = 0;
  for (std::size_t v = 0; v < scene.positions.size(); ++v) {
    for (int i = 0; i < 100; ++i) {
      Random random(1, v, i);
      const glm::vec3 corner = scene.positions[v];
      Ray ray{corner - glm::vec3(2.0 * radius * random.direction()), {}, kInfinity};
      ray.direction = corner - ray.origin;
      if (glm::dvec3(ray.origin) + glm::dvec3(ray.direction) != glm::dvec3(corner)) continue;  // not exactly through it
      const auto nearest = arbiter.nearest(ray);
      const ReferenceHit hit = trace(embree, ray);
      ++rays;
      wrong += !is_right(hit, nearest);
      missed += !nearest.empty() && hit.kind == HitKind::miss;
    }
  }
  std::printf("embree: %d rays through corners, %d wrong, %d of them missed everything\n", rays, wrong, missed);
  CHECK(rays > 1000);
  CHECK(wrong > 0);
}

TEST_CASE("Embree hits triangles that it passes, far from them: issue 387") {
  // Thin triangles seen nearly edge-on from a distance of hundreds of units.
  Scene scene;
  scene.materials.resize(1);
  std::vector<Ray> rays;
  for (int k = 0; k < 300; ++k) {
    Random random(9, name_hash("thin"), k);
    const glm::dvec3 corner = random.direction() * random.uniform(10.0, 600.0), long_edge = random.direction() * 11.0;
    const glm::dvec3 other_edge = long_edge * random.uniform(0.3, 0.95) + random.direction() * random.uniform(0.1, 1.4);
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const glm::dvec3& p : {corner, corner + long_edge, corner + other_edge}) scene.positions.emplace_back(p);
    scene.triangles.push_back({.position = {first, first + 1, first + 2}});
    const glm::dvec3 normal = glm::normalize(glm::cross(long_edge, other_edge));
    for (int i = 0; i < 60; ++i) {
      const glm::dvec3 along = glm::normalize(long_edge + (other_edge - long_edge) * random.uniform(-0.5, 1.5));
      const glm::dvec3 direction = glm::normalize(along + normal * std::exp(random.uniform(-14.0, -5.0)));
      const glm::dvec3 target = corner + long_edge * random.uniform() + along * random.uniform(-300.0, 300.0);
      rays.push_back({glm::vec3(target - direction * random.uniform(100.0, 600.0)), glm::vec3(direction), kInfinity});
    }
  }
  const EmbreeScene embree(scene);
  const Arbiter arbiter(scene);
  const auto hits = trace(embree, rays);
  int wrong = 0, far_off = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].kind != HitKind::hit || is_right(hits[i], arbiter.nearest(rays[i]))) continue;
    ++wrong;
    for (const Crossing& c : arbiter.crossings(rays[i], 1.0, 1e4)) {
      const bool elsewhere = hits[i].t < c.t_enter - 1.0 || hits[i].t > c.t_leave + 1.0;
      if (c.primitive == hits[i].primitive && !c.on_line && elsewhere) ++far_off;
    }
  }
  std::printf("embree: %zu edge-on rays, %d wrong hits, %d of them more than a unit beyond the triangle\n", rays.size(),
              wrong, far_off);
  CHECK(wrong > 0);
  CHECK(far_off > 0);
}
