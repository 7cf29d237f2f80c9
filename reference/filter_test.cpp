// SPDX-License-Identifier: GPL-3.0-or-later
// That error bounds hold, that they are not slack, that the line is exact, and that slabs lose nothing.
#include "reference/filter.h"

#include <catch2/catch.hpp>

#include "reference/box_tree.h"
#include "reference/brute_force_test.h"
#include "reference/formulas.h"
#include "reference/lattice_test.h"

using namespace plumbline;
using brute::Real;

namespace {

/// The largest error over its bound, for one operation on random numbers that carry errors themselves.
template <class Operation, class Truth>
double worst_share(Operation&& operation, Truth&& truth) {
  double worst = 0.0;
  for (int i = 0; i < 20000; ++i) {
    Random random(1, 2, i);
    // Floats keep the bound's hardest case, exact operands, apart from the others.
    const double size = random.below(2) == 0 ? 0.0 : std::ldexp(random.uniform(), -static_cast<int>(random.below(60)));
    const auto number = [&] { return Bounded<double>(random.uniform(0.5, 2.0), 0.0); };
    Bounded<double> a = number(), b = number();
    const Real true_a = a.value + Real(size) * random.uniform(-1.0, 1.0),
               true_b = b.value + Real(size) * random.uniform(-1.0, 1.0);
    a.error = b.error = size;
    const Bounded<double> result = operation(a, b);
    const Real error = abs(Real(result.value) - truth(true_a, true_b));
    if (error > 0) worst = std::max(worst, static_cast<double>(Real(error / result.error)));
  }
  return worst;
}

}  // namespace

TEST_CASE("The bounds of single operations hold and are tight") {
  const auto check = [](double worst) {
    CHECK(worst <= 1.0);
    CHECK(worst > 0.5);
  };
  using B = Bounded<double>;
  check(worst_share([](B a, B b) { return a + b; }, [](Real a, Real b) { return Real(a + b); }));
  check(worst_share([](B a, B b) { return a - b; }, [](Real a, Real b) { return Real(a - b); }));
  check(worst_share([](B a, B b) { return a * b; }, [](Real a, Real b) { return Real(a * b); }));
  check(worst_share([](B a, B b) { return a / b; }, [](Real a, Real b) { return Real(a / b); }));
  check(
      worst_share([](B a, B) { return sqrt(a); }, [](Real a, Real) { return Real(a < 0 ? Real(0) : Real(sqrt(a))); }));
}

TEST_CASE("What overflows or is invalid is not known") {
  const Bounded<double> huge(1e300), zero(0.0);
  CHECK((huge * huge).sign() == 0);
  CHECK((huge / zero).sign() == 0);
  CHECK((zero / zero).sign() == 0);
  CHECK(!certainly_less(zero / zero, huge));
  CHECK(certainly_less(zero, huge));
}

TEST_CASE("The line near the scene is the ray's line exactly") {
  for (int i = 0; i < 5000; ++i) {
    Random random(3, 3, i);
    const auto scale = [&] { return std::ldexp(1.0, static_cast<int>(random.below(40)) - 20); };
    Ray ray{glm::vec3(scale() * random.direction()), glm::vec3(scale() * random.direction()), INFINITY};
    if (i % 3 == 0) ray.direction *= 0x1p-140f;  // denormal
    if (i % 3 == 1) ray.direction *= 0x1p100f;
    if (ray.direction == glm::vec3(0.0f)) continue;
    const Ball ball{random.direction(), random.uniform(1e-3, 1.0)};
    const Line line = line_near(ray, ball);
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      largest = std::max(largest, std::abs(line.direction[axis]));
      REQUIRE(line.direction[axis] == ray.direction[axis] * line.unit);
      REQUIRE(Real(line.point[axis]) + line.rest[axis] ==
              Real(ray.origin[axis]) + Real(line.shift) * line.direction[axis]);
    }
    REQUIRE(largest >= 1.0);
    REQUIRE(largest < 2.0);
    const double before = glm::length(glm::dvec3(ray.origin) - ball.center);
    if (before <= 3.0 * ball.radius) REQUIRE(line.shift == 0.0);
    // Two radii before the closest approach, as far as 29 bits of the way can tell.
    const glm::dvec3 d = glm::normalize(line.direction), to_center = ball.center - glm::dvec3(ray.origin);
    const double beside = glm::length(glm::cross(to_center, d));
    if (before > 3.0 * ball.radius) {
      const double after = glm::length(line.point - ball.center);
      REQUIRE(after <= std::hypot(beside, 2.0 * ball.radius) + 0x1p-27 * before);
    }
  }
}

TEST_CASE("Filtered decisions are the exact ones, and seldom need them") {
  std::uint64_t exact = 0;
  int decisions = 0;
  for (int i = 0; i < 20000; ++i) {
    Random random(4, 4, i);
    // Of one scale, lest the triangle's corners collapse in the last places of the origin.
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(80)) - 40);
    const Ray ray{glm::vec3(scale * random.direction()), glm::vec3(scale * random.direction()), INFINITY};
    Solid solid;
    solid.is_sphere = i % 2 == 0;
    for (glm::vec3& corner : solid.corners) {
      corner = ray.origin + static_cast<float>(random.uniform(0.5, 3.0)) * ray.direction +
               glm::vec3(0.1 * glm::length(glm::dvec3(ray.direction)) * random.direction());
    }
    solid.radius = static_cast<float>(0.1 * glm::length(glm::dvec3(ray.direction)));
    const Line line = line_near(ray, {glm::dvec3(solid.corners[0]), solid.radius});
    Filter filter(line);
    const brute::Answer truth = solid.is_sphere ? brute::sphere(ray, solid) : brute::triangle(ray, solid);
    if (solid.is_sphere) {
      REQUIRE((filter.sphere_side(solid) >= 0) == truth.meets);
    } else {
      REQUIRE(filter.pass_triangle(solid).meets == truth.meets);
      REQUIRE(filter.facing(solid) == truth.facing);
    }
    if (truth.meets) {
      for (const Root root : {Root::enter, Root::leave}) {
        const BoundedT t = filter.t_of(solid, root);
        const Real true_t = Real(root == Root::enter ? truth.enter : truth.leave);
        REQUIRE(abs(Real(t.value) - true_t) <= Real(t.error));
      }
    }
    ++decisions;
    exact += filter.exact_decisions();
  }
  CHECK(exact < static_cast<std::uint64_t>(decisions) / 100);
}

TEST_CASE("Exact comparisons of t are right without a filter before them") {
  const Scene scene = lattice::scene(8, 6, 14);
  int equal = 0;
  for (int i = 0; i < 150; ++i) {
    const Ray ray = lattice::ray(scene, 8, i);
    const ExactLine line(line_near(ray, {{0, 0, 0}, 8.0}));
    struct Meeting {
      Solid solid;
      Root root;
      Real t;
    };
    std::vector<Meeting> meetings;
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      const brute::Answer truth = brute::answer(scene, ray, p);
      if (!truth.meets) continue;
      meetings.push_back({solid_of(scene, p), Root::enter, truth.enter});
      meetings.push_back({solid_of(scene, p), Root::leave, truth.leave});
    }
    for (const Meeting& a : meetings) {
      REQUIRE(exact_compare_t(line, a.solid, a.root, 0.5) == brute::compare(a.t, Real(0.5)));
      for (const Meeting& b : meetings) {
        const int order = brute::compare(a.t, b.t);
        REQUIRE(exact_compare_t(line, a.solid, a.root, line, b.solid, b.root) == order);
        equal += order == 0 && &a != &b;
      }
    }
  }
  CHECK(equal > 1000);
}

TEST_CASE("Distances are right, also where they are tiny or zero") {
  int tiny = 0, zero = 0;
  for (int i = 0; i < 3000; ++i) {
    Random random(5, 5, i);
    const glm::vec3 from = lattice::point(random), to = lattice::point(random);
    Ray ray{lattice::point(random), {}, INFINITY};
    ray.direction = from + 0.5f * (to - from) - ray.origin;
    if (ray.direction == glm::vec3(0.0f)) continue;
    if (i % 2 == 0) ray = lattice::nudged(ray, 5, i);
    const Line line = line_near(ray, {{0, 0, 0}, 4.0});
    Filter filter(line);
    const double distance = filter.segment_distance(from, to);
    // In integers: distance to a line is |moment| / |d x edge|, to a corner |d x a| / |d|.
    using namespace brute;
    const IntVec d = integer(ray.direction), a = minus(integer(from), integer(ray.origin)),
                 b = minus(integer(to), integer(ray.origin)), edge = minus(b, a);
    const IntVec start = brute::cross(d, a), end = brute::cross(d, b), across = brute::cross(d, edge);
    const Int scale = Int(1) << 149;
    Real truth = sqrt(Real(brute::dot(start, start)) / Real(brute::dot(d, d))) / Real(scale);
    truth = std::min(truth, Real(sqrt(Real(brute::dot(end, end)) / Real(brute::dot(d, d))) / Real(scale)));
    if (brute::dot(start, across) < 0 && brute::dot(end, across) > 0) {
      truth = abs(Real(brute::dot(start, edge))) / sqrt(Real(brute::dot(across, across))) / Real(scale);
    }
    CAPTURE(i, distance);
    REQUIRE(abs(Real(distance) - truth) <= ldexp(truth, -18));
    tiny += distance < 1e-6 && distance > 0.0;
    zero += distance == 0.0;
  }
  CHECK(tiny > 100);
  CHECK(zero > 100);
}

TEST_CASE("A slab is not left out for a NaN") {
  const Box bounds{glm::vec3(-1.0f), glm::vec3(1.0f)};
  for (int axis = 0; axis < 3; ++axis) {
    Ray ray{{}, {}, INFINITY};
    ray.direction = glm::vec3(0.0f);
    ray.direction[(axis + 1) % 3] = 1.0f;
    ray.origin = -3.0f * ray.direction;
    SlabLine slabs(line_near(ray, {{0, 0, 0}, 2.0}), bounds, 0.0, 0.0, INFINITY);
    // As where the line runs along a padded face: (bound - before) * infinity = 0 * infinity.
    Box touched = bounds;
    touched.lower[axis] = 1.0f;
    slabs.before[axis] = 1.0;
    CHECK(slabs.enter(touched) <= 2.0 + 1e-9);
    touched = bounds;
    touched.upper[axis] = -1.0f;
    slabs.behind[axis] = -1.0;
    CHECK(slabs.enter(touched) <= 2.0 + 1e-9);
  }
}

TEST_CASE("The tree loses no box that the line comes near") {
  std::vector<Box> boxes;
  for (int i = 0; i < 300; ++i) {
    Random random(6, 6, i);
    Box box;
    for (int corner = 0; corner < 2; ++corner) {
      const glm::vec3 p = lattice::point(random) * (i % 3 == 0 ? 0.01f : 1.0f);
      box.lower = glm::min(box.lower, p), box.upper = glm::max(box.upper, p);
    }
    boxes.push_back(i % 5 == 4 ? boxes.back() : box);
  }
  const BoxTree tree = build_box_tree(boxes);
  std::vector<int> times(boxes.size());
  for (const std::uint32_t i : tree.order) ++times[i];
  CHECK(times == std::vector<int>(boxes.size(), 1));

  Scene corners;
  corners.positions.assign(12, glm::vec3(1.0f));
  for (int i = 0; i < 400; ++i) {
    Ray ray = lattice::ray(corners, 6, i);
    if (i % 4 == 0) ray.direction[i % 3] = i % 8 == 0 ? 0.0f : -0.0f;
    if (!is_defined(ray)) continue;
    if (i % 2 == 1) ray.origin -= 0x1p30f * ray.direction;
    const Line line = line_near(ray, {{0, 0, 0}, 4.0});
    SlabLine slabs(line, tree.bounds, 0.0, -INFINITY, INFINITY);
    std::vector<bool> visited(boxes.size());
    walk(tree, slabs, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t k = first; k < first + count; ++k) visited[tree.order[k]] = true;
    });
    // In plain rationals: the line meets the box where its three intervals overlap, faces included.
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      if (visited[b]) continue;
      Real enter = -1e30, leave = 1e30;
      for (int axis = 0; axis < 3; ++axis) {
        const Real o = ray.origin[axis], d = ray.direction[axis], lower = boxes[b].lower[axis],
                   upper = boxes[b].upper[axis];
        if (d == 0 && (o < lower || o > upper)) leave = -2e30;
        if (d == 0) continue;
        const Real s0 = (lower - o) / d, s1 = (upper - o) / d;
        enter = std::max(enter, std::min(s0, s1));
        leave = std::min(leave, std::max(s0, s1));
      }
      // Quotients are rounded to 4000 bits: what touches in a point counts as met only if it does so that closely.
      REQUIRE(leave < enter);
    }
  }
}
