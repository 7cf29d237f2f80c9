// SPDX-License-Identifier: GPL-3.0-or-later
// The arbiter and exact values in scenes with instances, against a loop over all pairs in fractions.
#include <tbb/parallel_for.h>

#include <catch2/catch.hpp>
#include <map>

#include "reference/arbiter.h"
#include "reference/brute_instances_test.h"
#include "reference/exact_values.h"
#include "reference/filter.h"
#include "reference/instanced_lattice_test.h"

using namespace plumbline;
using brute::Wide;

namespace {

bool close(double a, const Wide& exact) { return abs(Wide(a) - exact) <= ldexp(abs(exact), -52); }

struct Counts {
  int hits = 0, ties = 0, of_world_and_instance = 0, of_instances = 0, touches = 0, tangents = 0, in_plane = 0;
};

/// Everything that the arbiter says of a ray, against the loop.
void compare_with_loop(const Scene& scene, const std::vector<brute::FractionMap>& maps, const Arbiter& arbiter,
                       const Ray& ray, Counts& counts) {
  CAPTURE(ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max);
  const std::vector<brute::Shown> all = brute::all_answers(scene, maps, ray);
  const std::vector<Placed> expected = brute::nearest(all);
  REQUIRE(arbiter.nearest(ray) == expected);
  counts.hits += !expected.empty();
  counts.ties += expected.size() > 1;
  if (expected.size() > 1 && expected.front().instance != expected.back().instance)
    ++(expected.front().instance == kNone ? counts.of_world_and_instance : counts.of_instances);

  std::map<Placed, const brute::PlacedAnswer*> truths;
  for (const brute::Shown& one : all) truths[one.placed] = &one.answer;
  const Placed* before = nullptr;
  const std::vector<Crossing> crossings = arbiter.crossings(ray, 0.0, 0.0);
  std::vector<Placed> seen;
  seen.reserve(crossings.size());
  for (const Crossing& c : crossings) {
    const Placed placed{c.instance, c.primitive};
    CAPTURE(c.instance, c.primitive, c.t, c.margin);
    REQUIRE(std::find(seen.begin(), seen.end(), placed) == seen.end());
    seen.push_back(placed);
    const brute::PlacedAnswer& truth = *truths.at(placed);
    REQUIRE(c.on_line == truth.meets);
    REQUIRE(c.hit == truth.hit);
    REQUIRE(c.facing == truth.facing);
    REQUIRE(c.nearest == std::binary_search(expected.begin(), expected.end(), placed));
    counts.in_plane += c.in_plane;
    if (!c.on_line) {
      REQUIRE(c.margin == 0.0);  // reach is zero
      continue;
    }
    REQUIRE(close(c.t, truth.t));
    REQUIRE(close(c.t_enter, truth.enter));
    REQUIRE(close(c.t_leave, truth.leave));
    REQUIRE(c.margin >= 0.0);
    REQUIRE((c.margin == 0.0) == truth.touches);
    if (scene.is_triangle(c.primitive)) REQUIRE((c.near_edges != 0) == truth.touches);
    counts.touches += truth.touches;
    counts.tangents += truth.touches && !scene.is_triangle(c.primitive) && c.instance != kNone;
    if (before != nullptr) {
      const int order = brute::compare(truths.at(*before)->t, truth.t);
      REQUIRE((order < 0 || (order == 0 && *before < placed)));
    }
    before = &seen.back();
  }
  for (const brute::Shown& one : all) {
    if (std::find(seen.begin(), seen.end(), one.placed) == seen.end()) REQUIRE(!one.answer.hit);
  }
}

}  // namespace

TEST_CASE("The arbiter agrees with fractions where instances keep coincidences") {
  Counts counts;
  for (int n = 0; n < 10; ++n) {
    const Scene scene = lattice::instanced_scene(100 + n, true);
    const auto maps = brute::all_maps(scene);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 60; ++i) {
      const Ray ray = lattice::instanced_ray(scene, 100 + n, i);
      compare_with_loop(scene, maps, arbiter, i % 4 == 3 ? lattice::nudged(ray, n, i) : ray, counts);
    }
  }
  CHECK(counts.hits > 300);
  CHECK(counts.ties > 60);
  CHECK(counts.of_world_and_instance > 3);
  CHECK(counts.of_instances > 20);
  CHECK(counts.touches > 200);
  CHECK(counts.tangents > 5);
  CHECK(counts.in_plane > 10);
}

TEST_CASE("The arbiter agrees with fractions under any transforms") {
  Counts counts;
  for (int n = 0; n < 16; ++n) {
    const Scene scene = lattice::instanced_scene(200 + n, false);
    const auto maps = brute::all_maps(scene);
    const Arbiter arbiter(scene);
    for (int i = 0; i < 40; ++i) {
      Ray ray = lattice::instanced_ray(scene, 200 + n, i);
      if (i % 5 == 4) {  // from afar
        ray.origin -= 0x1p16f * ray.direction;
        ray.t_max = std::numeric_limits<float>::infinity();
      }
      compare_with_loop(scene, maps, arbiter, ray, counts);
    }
  }
  CHECK(counts.hits > 200);
  CHECK(counts.touches > 50);
}

TEST_CASE("An instance whose map is lost to rounding is still decided exactly") {
  // The two scales are far beyond what 64 bits can bridge, and their product is near the identity.
  Scene scene = lattice::scene(7, 0, 0);
  scene.positions.resize(12);
  scene.parts.push_back(lattice::add_part(lattice::scene(8, 6, 3), scene));
  const auto add = [&](std::uint32_t parent, std::uint32_t part, const Transform& t) {
    scene.nodes.push_back({"n" + std::to_string(scene.nodes.size()), parent, part, t, t});
  };
  Transform skewed = lattice::scale(0x1p60f, 0x1p-60f, 1.0f), back = lattice::scale(0x1p-60f, 0x1p60f, 1.0f);
  skewed.linear[1][0] = 0x1p20f;
  add(kNone, kNone, skewed);
  add(0, 0, back);
  Counts counts;
  const auto maps = brute::all_maps(scene);
  const Arbiter arbiter(scene);
  for (int i = 0; i < 60; ++i) {
    Ray ray = lattice::instanced_ray(scene, 300, i);
    compare_with_loop(scene, maps, arbiter, ray, counts);
  }
  CHECK(arbiter.exact_decisions() > 60);
}

TEST_CASE("Margins and reach are in an instance's own units") {
  // The triangle (0,0,0) (1,0,0) (0,1,0), four times as large, mirrored in x, at z = 8; a sphere stretched in y.
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.push_back({.position = {0, 1, 2}});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, 0});
  scene.parts = {{"triangle", 0, 1, 0, 0}, {"sphere", 1, 0, 0, 1}};
  Transform large = lattice::scale(-4, 4, 4), stretched = lattice::scale(1, 3, 1);
  large.translation = {0, 0, 8};
  stretched.translation = {20, 0, 0};
  scene.nodes = {{"a", kNone, 0, large, large}, {"b", kNone, 1, stretched, stretched}};
  const Arbiter arbiter(scene);
  std::vector<std::uint32_t> asked;
  Reach reach{1.0, [&](std::uint32_t instance) {
                asked.push_back(instance);
                return 0.07;
              }};
  const Ray inside{{-0.25f, 1, 0}, {0, 0, 2}, INFINITY};
  auto found = arbiter.crossings(inside, reach, 0.0);
  REQUIRE(found.size() == 1);
  CHECK(found[0].instance == 0);
  CHECK(found[0].hit);
  CHECK(found[0].t == 4.0);
  CHECK(found[0].margin == Approx(0.0625));  // a quarter in the world
  CHECK(found[0].near_edges == 4);
  CHECK(found[0].facing == 1);  // the part's normal is +z, and stays so
  CHECK(asked == std::vector<std::uint32_t>{0});
  const Ray beside{{0.25f, 1, 0}, {0, 0, 2}, INFINITY};
  found = arbiter.crossings(beside, reach, 0.0);
  REQUIRE(found.size() == 1);
  CHECK(!found[0].on_line);
  CHECK(found[0].margin == Approx(-0.0625));
  CHECK(found[0].t == Approx(4.0));
  reach.local = [](std::uint32_t) { return 0.05; };
  CHECK(arbiter.crossings(beside, reach, 0.0).empty());
  // Above the ellipsoid's top at y = 3 by 0.15 in the world, by 0.05 in the instance's space.
  const Ray above{{20, 3.15f, -4}, {0, 0, 1}, INFINITY};
  reach.local = [](std::uint32_t) { return 0.051; };
  found = arbiter.crossings(above, reach, 0.0);
  REQUIRE(found.size() == 1);
  CHECK(found[0].instance == 1);
  CHECK(found[0].margin == Approx(-0.05).epsilon(1e-6));
  CHECK(found[0].t == Approx(4.0));
}

TEST_CASE("Threads asking for instances get the same answers") {
  const Scene scene = lattice::instanced_scene(400, false);
  const Arbiter arbiter(scene);
  constexpr int kRays = 2000;
  std::vector<std::vector<Placed>> alone(kRays), together(kRays);
  for (int i = 0; i < kRays; ++i) alone[i] = arbiter.nearest(lattice::instanced_ray(scene, 400, i));
  tbb::parallel_for(0, kRays, [&](int i) { together[i] = arbiter.nearest(lattice::instanced_ray(scene, 400, i)); });
  CHECK(alone == together);
}

namespace {

struct WideVec {
  Wide x, y, z;
};
WideVec wide(const brute::FractionVec& v) { return {brute::wide(v.x), brute::wide(v.y), brute::wide(v.z)}; }
WideVec along(const brute::FractionVec& from, const brute::FractionVec& d, const Wide& t) {
  const WideVec a = wide(from), b = wide(d);
  return {a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}

/// The largest error in units of 2^-53 of the largest component.
double error(const glm::dvec3& v, const WideVec& truth) {
  const Wide scale = std::max({Wide(abs(truth.x)), Wide(abs(truth.y)), Wide(abs(truth.z))});
  const Wide worst = std::max({Wide(abs(v.x - truth.x)), Wide(abs(v.y - truth.y)), Wide(abs(v.z - truth.z))});
  return scale == 0 ? (worst == 0 ? 0.0 : 1e300) : static_cast<double>(Wide(ldexp(worst / scale, 53)));
}

WideVec unit(const WideVec& v) {
  const Wide length = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / length, v.y / length, v.z / length};
}

/// L^-T n, which is where cross products of images of vectors point, but for the sign of a mirror.
WideVec normal_in_world(const brute::FractionMap& map, const WideVec& n) {
  const WideVec a = wide(cross(map.b, map.c)), b = wide(cross(map.c, map.a)), c = wide(cross(map.a, map.b));
  const int turn = brute::sign(map.determinant());
  const auto sum = [&](const Wide& x, const Wide& y, const Wide& z) {
    return Wide(turn * (x * n.x + y * n.y + z * n.z));
  };
  return unit({sum(a.x, b.x, c.x), sum(a.y, b.y, c.y), sum(a.z, b.z, c.z)});
}

}  // namespace

TEST_CASE("Exact values of instances are those of fractions") {
  int compared = 0, mirrored = 0;
  for (int n = 0; n < 8; ++n) {
    const Scene scene = lattice::instanced_scene(500 + n, n % 2 == 0);
    const auto maps = brute::all_maps(scene);
    const auto instances = instances_of(scene);
    for (int i = 0; i < 25; ++i) {
      Ray ray = lattice::instanced_ray(scene, 500 + n, i);
      if (i % 2 == 0) ray = lattice::nudged(ray, n, i);
      const brute::FractionVec o = brute::fractions(ray.origin), d = brute::fractions(ray.direction);
      for (std::size_t k = 0; k < instances.size(); ++k) {
        const brute::FractionMap& map = maps[k + 1];
        for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
          if (!scene.is_placed(instances[k], p)) continue;
          const brute::PlacedAnswer truth = brute::placed_answer(scene, map, ray, p);
          if (!truth.meets) continue;
          CAPTURE(n, i, k, p);
          const ReferenceHit hit = exact_hit(scene, ray, instances[k], p);
          REQUIRE(hit.instance == instances[k]);
          REQUIRE(hit.primitive == p);
          REQUIRE((hit.kind == HitKind::hit) == truth.hit);
          REQUIRE(close(hit.t, truth.t));
          REQUIRE(error(hit.position, along(o, d, truth.t)) <= 1.01);
          const Solid solid = solid_of(scene, p);
          if (solid.is_sphere) {
            const WideVec outwards =
                along(map.solve(o - map.translation) - brute::fractions(solid.corners[0]), map.solve(d), truth.t);
            REQUIRE(error(hit.normal, normal_in_world(map, outwards)) <= 1.01);
          } else {
            // The cross product of the images of the corners, turned where the map mirrors.
            const brute::FractionVec v0 = map.point(brute::fractions(solid.corners[0])),
                                     e1 = map.point(brute::fractions(solid.corners[1])) - v0,
                                     e2 = map.point(brute::fractions(solid.corners[2])) - v0,
                                     normal = cross(e1, e2) * brute::Fraction(brute::sign(map.determinant()));
            REQUIRE(error(hit.normal, unit(wide(normal))) <= 1.01);
            const WideVec point = along(o - v0, d, truth.t);
            const WideVec n_wide = wide(cross(e1, e2)), a = wide(cross(e2, cross(e1, e2))),
                          b = wide(cross(cross(e1, e2), e1));
            const Wide nn = n_wide.x * n_wide.x + n_wide.y * n_wide.y + n_wide.z * n_wide.z;
            const Wide u = (point.x * a.x + point.y * a.y + point.z * a.z) / nn,
                       v = (point.x * b.x + point.y * b.y + point.z * b.z) / nn;
            REQUIRE(abs(Wide(hit.barycentrics.x) - u) <= ldexp(Wide(1.01), -53));
            REQUIRE(abs(Wide(hit.barycentrics.y) - v) <= ldexp(Wide(1.01), -53));
          }
          ++compared;
          mirrored += map.determinant() < 0;
        }
      }
    }
  }
  CHECK(compared > 500);
  CHECK(mirrored > 50);
}

TEST_CASE("A line that is off by what it says is decided as the true one") {
  int exact = 0;
  for (int i = 0; i < 4000; ++i) {
    Random random(41, 41, i);
    const Ray ray{glm::vec3(3.0 * random.direction()), glm::vec3(random.direction()), INFINITY};
    Solid solid;
    solid.is_sphere = i % 4 == 0;
    for (glm::vec3& corner : solid.corners) {
      corner = ray.origin + static_cast<float>(random.uniform(1.0, 4.0)) * ray.direction +
               glm::vec3(0.3 * random.direction());
    }
    solid.radius = 0.3f;
    // Near misses and near hits: the line passes an edge, or the sphere, by a few of its errors.
    const double point_error = 0x1p-24, direction_error = 0x1p-26;
    Ray aimed = ray;
    const glm::dvec3 edge = glm::mix(glm::dvec3(solid.corners[0]), glm::dvec3(solid.corners[1]), random.uniform());
    aimed.direction = glm::vec3(edge - glm::dvec3(ray.origin));
    if (solid.is_sphere) {
      const glm::dvec3 outwards =
          glm::normalize(glm::cross(glm::dvec3(solid.corners[0]) - glm::dvec3(ray.origin), random.direction()));
      aimed.direction = glm::vec3(glm::dvec3(solid.corners[0]) + 0.3 * outwards - glm::dvec3(ray.origin));
    }
    const Line world = line_near(aimed, {glm::dvec3(solid.corners[0]), 1.0});
    LocalLine local{world, {}};
    local.line.point_error = point_error;
    local.line.direction_error = direction_error;
    for (int axis = 0; axis < 3; ++axis) {
      local.line.point[axis] += point_error * (random.below(2) == 0 ? -0.999 : 0.999);
      local.line.direction[axis] += direction_error * (random.below(2) == 0 ? -0.999 : 0.999);
    }
    local.wide = bounded_line<long double>(local.line);
    // Where it stands is the world itself.
    InstanceMap map;
    map.chain = {Transform{}};
    Filter filter(local, world, map), truth(world);
    if (solid.is_sphere) {
      REQUIRE(filter.sphere_side(solid) == truth.sphere_side(solid));
      REQUIRE(filter.sphere_distance(solid) == Approx(truth.sphere_distance(solid)).epsilon(0x1p-17).margin(0.0));
    } else {
      REQUIRE(filter.pass_triangle(solid).meets == truth.pass_triangle(solid).meets);
      REQUIRE(filter.facing(solid) == truth.facing(solid));
      for (int e = 0; e < 3; ++e) {
        const glm::vec3 from = solid.corners[e], to = solid.corners[(e + 1) % 3];
        REQUIRE(filter.segment_distance(from, to) ==
                Approx(truth.segment_distance(from, to)).epsilon(0x1p-17).margin(0.0));
      }
    }
    if (!solid.is_sphere || truth.sphere_side(solid) >= 0) {
      for (const Root root : {Root::enter, Root::leave}) {
        const BoundedT t = filter.t_of(solid, root), true_t = truth.t_of(solid, root);
        REQUIRE(!(std::fabs(t.value - true_t.value) > t.error + true_t.error));
      }
    }
    exact += filter.exact_decisions() > truth.exact_decisions();
  }
  CHECK(exact > 500);
}

TEST_CASE("Distances in an instance's space are right, also where they are tiny or zero") {
  int tiny = 0, zero = 0, compared = 0;
  for (int n = 0; n < 10; ++n) {
    const Scene scene = lattice::instanced_scene(1000 + n, n % 2 == 0);
    for (const InstanceMap& map : instance_maps(scene)) {
      const brute::FractionMap truth = brute::map_of(scene, map.instance);
      const Part& part = scene.parts[map.part];
      for (int i = 0; i < 20; ++i) {
        Ray ray = lattice::instanced_ray(scene, 1000 + n, i);
        if (i % 2 == 0) ray = lattice::nudged(ray, 1000, i);
        const Line world = line_near(ray, bounding_ball(scene));
        const LocalLine local = local_line(ray, map, bounding_ball(scene, part));
        Filter filter(local, world, map);
        const brute::FractionVec d = truth.solve(brute::fractions(ray.direction)),
                                 o = truth.solve(brute::fractions(ray.origin) - truth.translation);
        const auto length = [](const brute::FractionVec& v) { return Wide(sqrt(brute::wide(dot(v, v)))); };
        const auto check = [&](double distance, const Wide& expected) {
          CAPTURE(n, map.instance, i, distance);
          REQUIRE(abs(Wide(distance) - expected) <= ldexp(expected, -18));
          tiny += distance < 1e-6 && distance > 0.0;
          zero += distance == 0.0;
          ++compared;
        };
        const auto corners = scene.corners(part.first_triangle + static_cast<std::uint32_t>(i) % part.triangle_count);
        for (std::size_t e = 0; e < 3; ++e) {
          const brute::FractionVec a = brute::fractions(corners[e]) - o, b = brute::fractions(corners[(e + 1) % 3]) - o;
          const brute::FractionVec start = cross(d, a), end = cross(d, b), across = end - start;
          Wide expected = std::min(length(start), length(end)) / length(d);
          if (dot(start, across) < 0 && dot(end, across) > 0)
            expected = abs(brute::wide(dot(start, b - a))) / length(across);
          check(filter.segment_distance(corners[e], corners[(e + 1) % 3]), expected);
          check(exact_segment_distance(filter.exact(), corners[e], corners[(e + 1) % 3]), expected);
        }
        const std::uint32_t sphere = static_cast<std::uint32_t>(scene.triangles.size()) + part.first_sphere +
                                     static_cast<std::uint32_t>(i) % part.sphere_count;
        const Solid solid = solid_of(scene, sphere);
        const Wide from_center = length(cross(d, brute::fractions(solid.corners[0]) - o)) / length(d);
        const Wide expected = abs(from_center - Wide(solid.radius));
        const bool touches = brute::placed_answer(scene, truth, ray, sphere).touches;
        check(filter.sphere_distance(solid), touches ? Wide(0) : expected);
        check(exact_sphere_distance(filter.exact(), solid), touches ? Wide(0) : expected);
      }
    }
  }
  CHECK(compared > 5000);
  CHECK(tiny > 50);
  CHECK(zero > 20);
}
