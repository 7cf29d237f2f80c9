// SPDX-License-Identifier: GPL-3.0-or-later
// That maps are the exact product of their chain, rounded; that lines in instances lie within their bounds, and that
// these are of use; that boxes and flattened geometry lie where the instances do.
#include "reference/instance_map.h"

#include <catch2/catch.hpp>

#include "reference/brute_instances_test.h"
#include "reference/geometry.h"
#include "reference/instanced_lattice_test.h"
#include "scenes/error.h"

using namespace plumbline;
using brute::Fraction;

namespace {

Fraction fraction(long double x) {
  const auto high = static_cast<double>(x);
  return Fraction(high) + Fraction(static_cast<double>(x - high));
}
Fraction fraction(double x) { return Fraction(x); }
double ratio(const Fraction& a, const Fraction& b) { return static_cast<double>(a) / static_cast<double>(b); }
Fraction size(const Fraction& x) { return x < 0 ? Fraction(-x) : x; }

/// A bound that holds, and is zero only where it may be.
void check_bounded(const BoundedT& x, const Fraction& truth) {
  REQUIRE(size(fraction(x.value) - truth) <= fraction(x.error));
  REQUIRE(fraction(x.error) <= Fraction(0x1p-62) * size(truth));
}

const Fraction& component(const brute::FractionVec& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }
const BoundedT& component(const Vec<BoundedT>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }
long double component(const Vec<long double>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

struct Largest {
  double of_point = 0.0, of_direction = 0.0;  ///< error over its bound
  double bound = 0.0;                         ///< of the point, over the ball's radius
};

/// That `local` is the ray's line in the instance's space.
void check_line(const LocalLine& local, const brute::FractionMap& map, const Ray& ray, const Ball& ball,
                Largest& largest) {
  const Line& line = local.line;
  const brute::FractionVec d = map.solve(brute::fractions(ray.direction)) * Fraction(line.unit),
                           o = map.solve(brute::fractions(ray.origin) - map.translation) + d * Fraction(line.shift);
  for (int i = 0; i < 3; ++i) {
    const Fraction point_off = size(fraction(line.point[i]) + fraction(line.rest[i]) - component(o, i)),
                   direction_off = size(fraction(line.direction[i]) - component(d, i));
    REQUIRE(point_off <= fraction(line.point_error));
    REQUIRE(direction_off <= fraction(line.direction_error));
    largest.of_point = std::max(largest.of_point, ratio(point_off, fraction(line.point_error)));
    largest.of_direction = std::max(largest.of_direction, ratio(direction_off, fraction(line.direction_error)));
    const BoundedT &p = component(local.wide.point, i), &w = component(local.wide.direction, i);
    REQUIRE(size(fraction(p.value) - component(o, i)) <= fraction(p.error));
    REQUIRE(size(fraction(w.value) - component(d, i)) <= fraction(w.error));
  }
  largest.bound = std::max(largest.bound, line.point_error / ball.radius);
}

}  // namespace

TEST_CASE("Maps are the chain's product, each number rounded once") {
  for (int n = 0; n < 20; ++n) {
    const Scene scene = lattice::instanced_scene(600 + n, n % 2 == 0);
    const auto maps = instance_maps(scene);
    const auto instances = instances_of(scene);
    REQUIRE(maps.size() == instances.size());
    for (std::size_t k = 0; k < maps.size(); ++k) {
      const InstanceMap& map = maps[k];
      REQUIRE(map.instance == instances[k]);
      REQUIRE(map.part == scene.nodes[instances[k]].part);
      const brute::FractionMap truth = brute::map_of(scene, instances[k]);
      const std::array<brute::FractionVec, 3> unit{brute::FractionVec{1, 0, 0}, brute::FractionVec{0, 1, 0},
                                                   brute::FractionVec{0, 0, 1}};
      for (int row = 0; row < 3; ++row) {
        const auto r = static_cast<std::size_t>(row);
        for (int column = 0; column < 3; ++column) {
          const Fraction inverse = component(truth.solve(unit[static_cast<std::size_t>(column)]), row);
          const BoundedT& entry = component(map.inverse_rows[r], column);
          check_bounded(entry, inverse);
          const Fraction both = fraction(entry.value) + fraction(component(map.inverse_rest[r], column));
          REQUIRE(size(both - inverse) <= size(inverse) * Fraction(0x1p-120));
          const Fraction linear = component(truth.linear(unit[static_cast<std::size_t>(column)]), row);
          REQUIRE(size(Fraction(map.to_world.linear[column][row]) - linear) <= size(linear) * Fraction(0x1p-52));
        }
        check_bounded(component(map.translation, row), component(truth.translation, row));
        REQUIRE(size(Fraction(map.to_world.translation[row]) - component(truth.translation, row)) <=
                size(component(truth.translation, row)) * Fraction(0x1p-52));
        // A translation of 24 bits is kept as it is.
        if (map.chain.size() == 1) REQUIRE(component(map.translation, row).error == 0.0L);
      }
    }
  }
}

TEST_CASE("Lines in instances lie within their bounds, and these are narrow") {
  Largest plain, fine;
  for (int n = 0; n < 30; ++n) {
    const Scene scene = lattice::instanced_scene(700 + n, false);
    for (const InstanceMap& map : instance_maps(scene)) {
      const brute::FractionMap truth = brute::map_of(scene, map.instance);
      const Ball ball = bounding_ball(scene, scene.parts[map.part]);
      for (int i = 0; i < 10; ++i) {
        Ray ray = lattice::instanced_ray(scene, 700 + n, i);
        if (i % 3 == 1) ray.origin -= 0x1p18f * ray.direction;
        if (i % 3 == 2) ray.direction *= 0x1p-130f;
        if (ray.direction == glm::vec3(0.0f)) continue;
        check_line(local_line(ray, map, ball), truth, ray, ball, plain);
        check_line(fine_local_line(ray, map, ball), truth, ray, ball, fine);
        // The line without bounds is the same line.
        const Line line = plain_local_line(ray, map, ball), bounded = local_line(ray, map, ball).line;
        REQUIRE(line.point == bounded.point);
        REQUIRE(line.direction == bounded.direction);
        REQUIRE(line.shift == bounded.shift);
        REQUIRE(line.unit == bounded.unit);
        REQUIRE(line.t_max == bounded.t_max);
      }
    }
  }
  // A bound that is never reached by a tenth would be slack.
  CHECK(plain.of_point > 0.1);
  CHECK(plain.of_direction > 0.5);
  CHECK(fine.of_direction > 0.5);
  // Origins are up to 2^18 directions away, in instances a thousand times smaller than the world in one direction and
  // as much larger in another.
  CHECK(plain.bound < 0x1p-20);
  CHECK(fine.bound < 0x1p-40);
}

TEST_CASE("A line beyond the range of doubles says so") {
  Scene scene = lattice::scene(1, 1, 0);
  scene.parts.push_back({"part", 0, 1, 0, 0});
  const Transform tiny = lattice::scale(1e-38f, 1e-38f, 1e-38f);
  scene.nodes.assign(9, {"", kNone, kNone, tiny, tiny});
  for (std::uint32_t i = 0; i < 9; ++i) scene.nodes[i].parent = i == 0 ? kNone : i - 1;
  scene.nodes.back().part = 0;
  const LocalLine beyond = local_line({{1, 0, 0}, {1, 1, 1}, INFINITY}, instance_map(scene, 8), {{0, 0, 0}, 1.0});
  CHECK(std::isinf(beyond.line.point_error));
  CHECK(!std::isfinite(beyond.wide.point.x.error));
}

TEST_CASE("World boxes hold what the instance shows") {
  for (int n = 0; n < 20; ++n) {
    const Scene scene = lattice::instanced_scene(800 + n, false);
    for (const InstanceMap& map : instance_maps(scene)) {
      const BoxD local = box_of(part_geometry(scene, scene.parts[map.part])), box = world_box(map, local);
      const brute::FractionMap truth = brute::map_of(scene, map.instance);
      double slack = INFINITY;
      for (int corner = 0; corner < 8; ++corner) {
        const brute::FractionVec p = truth.point({Fraction((corner & 1 ? local.upper : local.lower).x),
                                                  Fraction((corner & 2 ? local.upper : local.lower).y),
                                                  Fraction((corner & 4 ? local.upper : local.lower).z)});
        for (int axis = 0; axis < 3; ++axis) {
          REQUIRE(component(p, axis) >= Fraction(box.lower[axis]));
          REQUIRE(component(p, axis) <= Fraction(box.upper[axis]));
          const Fraction above = component(p, axis) - Fraction(box.lower[axis]);
          slack = std::min(slack, ratio(above, Fraction(box.upper[axis] - box.lower[axis])));
        }
      }
      CHECK(slack < 1e-6);
    }
  }
}

TEST_CASE("Flattened geometry lies where the instances show it") {
  int mirrored = 0, ellipsoids = 0, spheres = 0;
  for (int n = 0; n < 10; ++n) {
    const Scene scene = lattice::instanced_scene(900 + n, false);
    const Geometry flat = flattened_geometry(scene);
    REQUIRE(flat.triangles.size() + flat.rounds.size() == placed_count(scene));
    REQUIRE(flat.sources.size() == placed_count(scene));
    for (std::uint32_t i = 0; i < flat.triangles.size(); ++i) {
      const Geometry::Source source = flat.source_of_triangle(i);
      REQUIRE(scene.is_placed(source.instance, source.primitive));
      REQUIRE(scene.is_triangle(source.primitive));
      const brute::FractionMap truth = brute::map_of(scene, source.instance);
      REQUIRE(source.turned == (truth.determinant() < 0));
      mirrored += source.turned;
      const auto local = scene.corners(source.primitive);
      for (std::size_t c = 0; c < 3; ++c) {
        const brute::FractionVec p = truth.point(brute::fractions(local[c]));
        const Fraction largest = std::max({size(component(truth.translation, 0)), size(component(truth.translation, 1)),
                                           size(component(truth.translation, 2)), Fraction(4000)});
        for (int axis = 0; axis < 3; ++axis) {
          const Fraction off = size(component(p, axis) - Fraction(flat.corners(i)[c][axis]));
          // Chains go out as far as 2e5 and come back, or up to scales of 1e3 and back.
          REQUIRE(off <= Fraction(0x1p-46) * std::max(largest, Fraction(200000)));
        }
      }
    }
    for (std::uint32_t i = 0; i < flat.rounds.size(); ++i) {
      const Geometry::Source source = flat.source_of_sphere(i);
      REQUIRE(scene.is_placed(source.instance, source.primitive));
      ++(flat.image(i) != nullptr ? ellipsoids : spheres);
      if (flat.image(i) != nullptr) continue;
      // A sphere in the world: its map keeps angles.
      const brute::FractionMap truth = brute::map_of(scene, source.instance);
      const double stretch = static_cast<double>(dot(truth.a, truth.a));
      CHECK(static_cast<double>(dot(truth.b, truth.b)) == Approx(stretch).epsilon(1e-12));
      CHECK(std::abs(static_cast<double>(dot(truth.a, truth.b))) <= 1e-12 * stretch);
      CHECK(flat.rounds[i].radius == Approx(std::sqrt(stretch) * scene.sphere(source.primitive).radius));
    }
  }
  CHECK(mirrored > 50);
  CHECK(ellipsoids > 20);
  CHECK(spheres > 20);
}

TEST_CASE("A scene too large to be flattened is refused in one line") {
  Scene scene = lattice::scene(1, 4000, 0);
  scene.parts.push_back({"part", 0, 4000, 0, 0});
  for (int i = 0; i < 2001; ++i) scene.nodes.push_back({"n" + std::to_string(i), kNone, 0, {}, {}});
  CHECK_THROWS_AS(flattened_geometry(scene), InputError);
  CHECK_THROWS_WITH(flattened_geometry(scene),
                    Catch::Contains("8004000 primitives") && Catch::Contains("at most 8000000"));
}
