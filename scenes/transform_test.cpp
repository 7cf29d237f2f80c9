// SPDX-License-Identifier: MIT
// Transforms, keyframes and the balls around what nodes place, against closed forms and brute sampling.
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/scene.h"

using namespace plumbline;

namespace {

glm::dmat3 random_matrix(Random& random) {
  glm::dmat3 m;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) m[column][row] = random.uniform(-1.0, 1.0) * std::exp2(random.uniform(-9.0, 9.0));
  return m;
}

/// The largest singular value by power iteration on L^T L from many starts: never above the true one but by rounding.
double stretch_by_iteration(const glm::dmat3& m, Random& random) {
  double largest = 0.0;
  for (int start = 0; start < 8; ++start) {
    glm::dvec3 v = random.direction();
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 next = glm::transpose(m) * (m * v);
      const double length = glm::length(next);
      if (!(length > 0.0)) break;
      v = next / length;
    }
    largest = std::max(largest, glm::length(m * v));
  }
  return largest;
}

Transform transform_of(const glm::mat3& linear, const glm::vec3& translation = glm::vec3(0.0f)) {
  return {linear, translation};
}

bool same_values(const glm::dmat3& a, const glm::dmat3& b, double error) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(a[column][row] - b[column][row]) <= error)) return false;
  return true;
}

}  // namespace

TEST_CASE("largest_stretch is the largest singular value, and never below it") {
  for (std::uint64_t i = 0; i < 300; ++i) {
    Random random(1, 2, i);
    const glm::dmat3 m = random_matrix(random);
    const double stretch = largest_stretch(m), iterated = stretch_by_iteration(m, random);
    CHECK(stretch >= iterated * (1.0 - 0x1p-50));
    CHECK(stretch <= iterated * (1.0 + 0x1p-30));  // the iteration may not have converged
    // Brute sampling: no direction grows by more.
    for (int k = 0; k < 200; ++k) CHECK(glm::length(m * random.direction()) <= stretch);
  }
  const auto scaling = [](double x, double y, double z) {
    return glm::dmat3(glm::dvec3(x, 0, 0), glm::dvec3(0, y, 0), glm::dvec3(0, 0, z));
  };
  for (const glm::dvec3& s :
       {glm::dvec3(1), glm::dvec3(2, 2, 2), glm::dvec3(-3, 1, 1), glm::dvec3(1e-30, 1e30, 1), glm::dvec3(1, 1, 1e-20),
        glm::dvec3(5, 5, 1), glm::dvec3(5, 1, 1), glm::dvec3(1, 1 - 0x1p-45, 0.5)}) {
    const double largest = std::max({std::abs(s.x), std::abs(s.y), std::abs(s.z)});
    CHECK(largest_stretch(scaling(s.x, s.y, s.z)) >= largest);
    CHECK(largest_stretch(scaling(s.x, s.y, s.z)) <= largest * (1.0 + 0x1p-39));
  }
  CHECK(largest_stretch(glm::dmat3(0.0)) == 0.0);
  // A shear by s stretches by (s + sqrt(s^2 + 4)) / 2 at most.
  glm::dmat3 shear(1.0);
  shear[1][0] = 3.0;
  CHECK(largest_stretch(shear) == Approx(0.5 * (3.0 + std::sqrt(13.0))).epsilon(1e-11));
}

TEST_CASE("transform_error refuses what is singular or not finite, and nothing else") {
  CHECK(std::string(transform_error({})).empty());
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int i = 0; i < 12; ++i) {
      Transform transform;
      (i < 9 ? transform.linear[i / 3][i % 3] : transform.translation[i - 9]) = bad;
      CHECK(std::string(transform_error(transform)) == "holds a value that is not finite");
    }
  }
  const auto is_singular = [](const glm::mat3& m) {
    return std::string(transform_error(transform_of(m))) == "is singular";
  };
  CHECK(is_singular(glm::mat3(0.0f)));
  CHECK(is_singular(glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0, 0, 0), glm::vec3(0, 0, 1))));
  CHECK(is_singular(glm::mat3(glm::vec3(1, 2, 3), glm::vec3(2, 4, 6), glm::vec3(0, 0, 1))));
  CHECK(is_singular(glm::mat3(glm::vec3(1, 1, 0), glm::vec3(0, 1, 1), glm::vec3(1, 2, 1))));
  // The third column is the exact sum of the others, of numbers whose products round in double and in long double.
  const glm::vec3 a(1234567, 7654321, 2345678), b(3456789, 987654, 5432109);
  CHECK(is_singular(glm::mat3(a, b, a + b)));
  CHECK(is_singular(glm::transpose(glm::mat3(a, b, a - b))));
  CHECK_FALSE(is_singular(glm::mat3(a, b, a + b + glm::vec3(1, 0, 0))));
  // One unit in the last place away from singular is regular.
  CHECK_FALSE(
      is_singular(glm::mat3(glm::vec3(1, 1, 0), glm::vec3(0, 1, 1), glm::vec3(1, std::nextafter(2.0f, 3.0f), 1))));
  CHECK_FALSE(is_singular(glm::mat3(1e-30f)));
  CHECK_FALSE(is_singular(glm::mat3(1e30f)));
  CHECK_FALSE(is_singular(glm::mat3(glm::vec3(1e-18f, 0, 0), glm::vec3(0, 1e18f, 0), glm::vec3(0, 0, -1))));
  // The inverse would not be finite.
  CHECK(is_singular(glm::mat3(1e-39f)));
}

TEST_CASE("compose and inverse undo one another") {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random(3, 4, i);
    TransformD a{random_matrix(random), 10.0 * random.direction()}, b{random_matrix(random), random.direction()};
    const glm::dvec3 p = random.direction();
    const glm::dvec3 one = transform_point(compose(a, b), p), two = transform_point(a, transform_point(b, p));
    CHECK(glm::length(one - two) <=
          0x1p-45 * (glm::length(one) + largest_stretch(a.linear) * (largest_stretch(b.linear) + 2.0) + 10.0));
    const TransformD round = compose(inverse(a), a);
    const double condition = largest_stretch(a.linear) * largest_stretch(inverse(a).linear);
    CHECK(same_values(round.linear, glm::dmat3(1.0), 0x1p-45 * condition));
  }
}

TEST_CASE("Keyframes: values at them, between them, before the first and after the last") {
  Animation animation;
  animation.rest_translation = {9, 9, 9};
  animation.rest_scale = {2, 3, 4};
  Transform at = transform_at(animation, 5.0);
  CHECK(at.translation == glm::vec3(9, 9, 9));
  CHECK(at.linear == glm::mat3(glm::vec3(2, 0, 0), glm::vec3(0, 3, 0), glm::vec3(0, 0, 4)));

  animation.translation = {{1.0, {0, 0, 0}}, {3.0, {4, -8, 2}}, {4.0, {4, 0, 0}}};
  CHECK(transform_at(animation, -7.0).translation == glm::vec3(0, 0, 0));
  CHECK(transform_at(animation, 1.0).translation == glm::vec3(0, 0, 0));
  CHECK(transform_at(animation, 1.5).translation == glm::vec3(1, -2, 0.5f));
  CHECK(transform_at(animation, 3.0).translation == glm::vec3(4, -8, 2));
  CHECK(transform_at(animation, 3.75).translation == glm::vec3(4, -2, 0.5f));
  CHECK(transform_at(animation, 1e9).translation == glm::vec3(4, 0, 0));
  animation.scale = {{2.0, {1, 1, 1}}};
  CHECK(transform_at(animation, 0.0).linear == glm::mat3(1.0f));
  CHECK(transform_at(animation, 9.0).linear == glm::mat3(1.0f));
}

TEST_CASE("Rotations are slerped the short way, at constant speed") {
  const auto about = [](const glm::dvec3& axis, double radians) {
    return glm::angleAxis(radians, glm::normalize(axis));
  };
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, -2));
  Animation animation;
  animation.rotation = {{0.0, about(axis, 0.3)}, {2.0, about(axis, 2.3)}};
  for (const double t : {0.0, 0.25, 0.7, 1.0, 1.9, 2.0}) {
    const glm::dmat3 expected = glm::mat3_cast(about(axis, 0.3 + t));
    CHECK(same_values(glm::dmat3(transform_at(animation, t).linear), expected, 0x1p-23));
  }
  // -q is the same rotation as q, and the way between them has no length.
  animation.rotation[1].value = -animation.rotation[1].value;
  CHECK(same_values(glm::dmat3(transform_at(animation, 1.0).linear), glm::mat3_cast(about(axis, 1.3)), 0x1p-23));
  // From 10 to 350 degrees backwards through 0.
  animation.rotation = {{0.0, about(axis, glm::radians(10.0))}, {1.0, about(axis, glm::radians(350.0))}};
  CHECK(same_values(glm::dmat3(transform_at(animation, 0.5).linear), glm::dmat3(1.0), 0x1p-23));
  // translate * rotate * scale.
  animation.rest_translation = {1, 2, 3};
  animation.rest_scale = {2, 1, 1};
  animation.rotation = {{0.0, about({0, 0, 1}, glm::radians(90.0))}};
  const Transform at = transform_at(animation, 0.0);
  const glm::dvec3 moved = transform_point(to_double(at), {1, 0, 0});
  CHECK(glm::length(moved - glm::dvec3(1, 4, 3)) < 1e-6);
}

TEST_CASE("set_time moves the animated nodes and leaves rest where it is, and the range covers all channels") {
  Scene scene = load_scene("walk");
  const Scene before = scene;
  const TimeRange range = time_range(scene);
  CHECK(range.first == 0.0);
  CHECK(range.last == 4.0);
  const std::vector<std::uint32_t> moved = set_time(scene, 0.6);
  CHECK(moved.size() == scene.animation.size());
  std::size_t changed = 0;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    CHECK(scene.nodes[n].rest == before.nodes[n].rest);
    const bool is_moved = std::find(moved.begin(), moved.end(), n) != moved.end();
    if (!is_moved) CHECK(scene.nodes[n].transform == before.nodes[n].transform);
    changed += scene.nodes[n].transform == before.nodes[n].transform ? 0 : 1;
  }
  CHECK(changed == moved.size());
  set_time(scene, 0.0);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) CHECK(scene.nodes[n].transform == before.nodes[n].transform);
  CHECK(time_range(Scene{}).last == 0.0);
}

TEST_CASE("The bounding ball holds everything that instances show") {
  for (const std::string& name : shipped_scenes()) {
    INFO(name);
    Scene scene = load_scene(name);
    if (!scene.animation.empty()) set_time(scene, 0.35);
    const Ball ball = bounding_ball(scene);
    double farthest = 0.0;
    std::vector<std::uint32_t> instances = instances_of(scene);
    if (instances.size() > 200) instances.resize(200);
    for (const std::uint32_t instance : instances) {
      const TransformD map = to_world(scene, instance);
      const Part& part = scene.parts[scene.nodes[instance].part];
      for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
        for (const glm::vec3& corner : scene.corners(t))
          farthest = std::max(farthest, glm::length(transform_point(map, glm::dvec3(corner)) - ball.center));
      }
      Random random(1, 1, instance);
      for (std::uint32_t i = part.first_sphere; i < part.first_sphere + part.sphere_count; ++i) {
        const Sphere& sphere = scene.spheres[i];
        for (int k = 0; k < 50; ++k) {
          const glm::dvec3 point = glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * random.direction();
          farthest = std::max(farthest, glm::length(transform_point(map, point) - ball.center));
        }
      }
    }
    CHECK(farthest <= ball.radius);
    if (instances.size() < 200) CHECK(farthest >= 0.2 * ball.radius);
  }
}

TEST_CASE("Chains, instances and placed pairs of a scene") {
  const Scene scene = load_scene("nested");
  std::uint64_t placed = 0;
  std::size_t deepest = 0;
  for (const std::uint32_t instance : instances_of(scene)) {
    const std::vector<std::uint32_t> chain = chain_of(scene, instance);
    REQUIRE(chain.back() == instance);
    CHECK(scene.nodes[chain.front()].parent == kNone);
    for (std::size_t i = 1; i < chain.size(); ++i) CHECK(scene.nodes[chain[i]].parent == chain[i - 1]);
    deepest = std::max(deepest, chain.size());
    TransformD composed;
    for (const std::uint32_t n : chain) composed = compose(composed, to_double(scene.nodes[n].transform));
    CHECK(same_values(composed.linear, to_world(scene, instance).linear, 1e-12));
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) placed += scene.is_placed(instance, p) ? 1 : 0;
  }
  CHECK(deepest == 4);
  CHECK(placed == placed_count(scene));
  CHECK(chain_of(scene, kNone).empty());
  CHECK_FALSE(scene.is_placed(kNone, 0));
  CHECK_FALSE(scene.is_placed(0, scene.primitive_count()));
  CHECK_FALSE(scene.is_placed(static_cast<std::uint32_t>(scene.nodes.size()), 0));
  const Scene plain = load_scene("cube");
  CHECK(plain.is_placed(kNone, 11));
  CHECK_FALSE(plain.is_placed(0, 0));
  CHECK(placed_count(plain) == 12);
}
