// SPDX-License-Identifier: GPL-3.0-or-later
// Samples without effects, against optics worked out by hand.
#include "reference/sample.h"

#include <catch2/catch.hpp>

#include "reference/render_scenes_test.h"

using namespace plumbline;

namespace {

/// Positions on a ray err by a rounding of its direction to floats, some 2^-24; what is asked varies as slowly.
constexpr double kFloat = 1e-6;

/// A plane through the origin that faces +z, seen obliquely (45 degrees) from above or below along x.
Scene water(bool from_above, float index) {
  Scene scene = one_pixel_scene({-3, 0, from_above ? 3.0f : -3.0f}, {0, 0, 0});
  add_level(scene, -1, -1, 1, 1, 0,
            add_surface(scene, {.name = {}, .diffuse = 0, .transmittance = 0.5f, .refraction_index = index}));
  scene.materials.push_back({});
  return scene;
}

}  // namespace

TEST_CASE("A lit sphere has the brightness of Blinn and Phong") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, 0});
  scene.materials.push_back({.name = {}, .color = {1, 0.5f, 0.25f}, .diffuse = 0.5f, .specular = 0.25f, .shine = 8});
  scene.background = {0.125f, 0.25f, 0.5f};
  scene.lights.push_back({{0, 5, 5}});
  // At (0, 0, 1) towards (0, 5, 4); half way to the eye the cosine is that of half the angle. One light without a
  // colour has the intensity 1/2; the reflected ray sees the background.
  const double c = 4.0 / std::sqrt(41.0), highlight = std::pow((1.0 + c) / 2.0, 4.0);
  const auto expected = [&](double diffuse, double back) {
    return 0.5 * (0.5 * diffuse * c + 0.25 * highlight) + 0.25 * back;
  };
  SampleRecord record;
  const glm::dvec3 color = only_sample(scene, &record);
  CHECK(color.r == Approx(expected(1.0, 0.125)).epsilon(1e-12));
  CHECK(color.g == Approx(expected(0.5, 0.25)).epsilon(1e-12));
  CHECK(color.b == Approx(expected(0.25, 0.5)).epsilon(1e-12));
  REQUIRE(record.rays.size() == 2);
  CHECK(record.rays[0].primitive == 0);
  CHECK(record.rays[1].ray == 2);
  CHECK(record.rays[1].primitive == kNone);
  CHECK(record.lights == std::vector<LightOutcome>{LightOutcome::lit});

  scene.lights.push_back({{0, 5, 5}, {0.5f, 0, 0}, true});
  scene.lights[0].position = {0, 0, -5};
  const double coloured = 0.5 * (0.5 * c + 0.25 * highlight) + 0.25 * 0.125;
  CHECK(only_sample(scene, &record).r == Approx(coloured).epsilon(1e-12));
  CHECK(record.lights == std::vector<LightOutcome>{LightOutcome::below, LightOutcome::lit});
}

TEST_CASE("A thing between hides a light, one beyond it or beside it does not, glass does") {
  Scene scene = one_pixel_scene({0, -5, 1}, {0, 0, 0}, {0, 0, 1});
  scene.lights.push_back({{0, 0, 4}});
  add_level(scene, -1, -1, 1, 1, 0, add_surface(scene, {}));
  CHECK(only_sample(scene).r == Approx(0.5).epsilon(kFloat));
  scene.materials.push_back({.name = {}, .transmittance = 1.0f});
  for (const auto& [center, seen] :
       {std::pair(glm::vec3(0, 0, 2), 0.0), std::pair(glm::vec3(0, 0, 5), 0.5), std::pair(glm::vec3(1, 0, 2), 0.5)}) {
    scene.spheres = {{center, 0.75f, 1}};
    CHECK(only_sample(scene).r == Approx(seen).epsilon(kFloat));
  }
  scene.spheres.clear();
  scene.ground = {.center = {0, 0, 3}, .normal = {0, 0, 1}, .radius = 1, .material = 1};
  CHECK(only_sample(scene).r == 0.0);
}

TEST_CASE("The ground hides what lies behind it, and is hidden by what lies before it or in it") {
  for (const auto& [height, shown] : {std::pair(1.0f, true), std::pair(0.0f, false), std::pair(-1.0f, false)}) {
    CAPTURE(height);
    Scene scene = one_pixel_scene({-0.25f, 0.5f, 5}, {-0.25f, 0.5f, 0});
    scene.ground = {.center = {0, 0, height}, .normal = {0, 0, 1}, .radius = 2};
    scene.ground.material = add_surface(scene, {});
    add_level(scene, -1, -2, 1, 1, 0, scene.ground.material);
    SampleRecord record;
    only_sample(scene, &record);
    CHECK((record.rays[0].primitive == scene.primitive_count()) == shown);
    CHECK(record.rays[0].instance == kNone);
  }
}

TEST_CASE("A mirror shows what stands in the mirrored direction") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  const std::uint32_t mirror = add_surface(scene, {.name = {}, .diffuse = 0, .specular = 0.5f}),
                      wall = add_surface(scene, {});
  // y + z = 0 turns (0, 0, -1) into (0, 1, 0); the light stands below the mirror and before the wall.
  add_quad(scene, {glm::vec3{-0.5f, -0.5f, 0.5f}, {0.5f, -0.5f, 0.5f}, {0.5f, 0.5f, -0.5f}, {-0.5f, 0.5f, -0.5f}},
           mirror);
  add_quad(scene, {glm::vec3{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}, wall);
  scene.lights.push_back({{0, 1, -2}});
  SampleRecord record;
  // The mirrored ray starts delta = 2^-17 (0.71 + 1) off the mirror; the point that it meets moves by no more than
  // sqrt(2) delta, 2 away from its light.
  constexpr double kStart = 0x1p-17 * 1.71 * 1.42;
  CHECK(only_sample(scene, &record).r == Approx(0.5 * 0.5 * std::sqrt(0.5)).epsilon(kFloat + kStart));
  REQUIRE(record.rays.size() == 2);
  CHECK(record.rays[1].primitive >= 2);
  CHECK(record.lights == std::vector<LightOutcome>{LightOutcome::below, LightOutcome::lit});
}

TEST_CASE("A tilted normal neither sends rays below the surface nor takes light from behind itself") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  add_level(scene, -1, -1, 1, 1, 0, add_surface(scene, {.name = {}, .specular = 1}));
  const auto sine = static_cast<float>(std::sqrt(0.75));
  scene.normals = {{sine, 0, 0.5f}};  // 60 degrees from the vertical
  for (Triangle& triangle : scene.triangles) triangle.normal = {0, 0, 0};
  // (0, 0, -1) is mirrored to (sine, 0, -0.5), and from there, at the plane, to (sine, 0, 0.5).
  scene.materials.push_back({});
  scene.spheres.push_back({{4 * sine, 0, 2}, 1e-4f, 1});
  // The second light stands above the surface, but behind the tilted normal.
  scene.lights = {{{3, 0, 3}}, {{-3, 0, 1}}, {{3, 0, -1}}, {{0, 0, 0}}};
  SampleRecord record;
  only_sample(scene, &record);
  REQUIRE(record.rays.size() == 2);
  CHECK_FALSE(record.rays[0].reflected_above);
  CHECK(record.rays[1].primitive == 2);
  REQUIRE(record.lights.size() == 8);
  record.lights.resize(4);
  CHECK(record.lights == std::vector<LightOutcome>{LightOutcome::lit, LightOutcome::averted, LightOutcome::below,
                                                   LightOutcome::at_light});
}

TEST_CASE("Refraction goes where Snell says, into a body and out of it") {
  struct Way {
    bool from_above;
    double index, sine;  ///< of the refracted ray
  };
  for (const Way& way : {Way{true, 1.5, std::sqrt(0.5) / 1.5}, Way{false, 1.25, std::sqrt(0.5) * 1.25},
                         Way{true, 0.0, std::sqrt(0.5)}}) {
    CAPTURE(way.index);
    Scene scene = water(way.from_above, static_cast<float>(way.index));
    const double depth = way.from_above ? -2.0 : 2.0, x = 2.0 * way.sine / std::sqrt(1.0 - way.sine * way.sine);
    scene.spheres.push_back({glm::vec3(x, 0, depth), 1e-4f, 1});
    SampleRecord record;
    only_sample(scene, &record);
    REQUIRE(record.rays.size() == 2);
    CHECK(record.rays[0].from_outside == way.from_above);
    CHECK_FALSE(record.rays[0].totally_reflected);
    CHECK(record.rays[1].ray == 3);
    CHECK(record.rays[1].primitive == 2);
  }
}

TEST_CASE("Beyond the critical angle all is reflected, with the weight of transmission") {
  Scene scene = water(false, 1.5f);
  scene.spheres.push_back({{2, 0, -2}, 1e-4f, 1});
  scene.background = {1, 1, 1};
  SampleRecord record;
  only_sample(scene, &record);
  REQUIRE(record.rays.size() == 2);
  CHECK(record.rays[0].totally_reflected);
  CHECK(record.rays[1].ray == 3);
  CHECK(record.rays[1].primitive == 2);
  scene.spheres.clear();
  scene.materials[0].transmittance = 0.25f;
  CHECK(only_sample(scene).g == 0.25);
}

TEST_CASE("Between two mirrors there are as many rays as the depth allows") {
  Scene scene = one_pixel_scene({0, 0, 0.5f}, {0, 0, 0});
  const std::uint32_t mirror = add_surface(scene, {.name = {}, .diffuse = 0, .specular = 0.5f});
  add_level(scene, -1, -1, 1, 1, 0, mirror);
  add_level(scene, -1, -1, 1, 1, 1, mirror);
  scene.background = {1, 1, 1};
  scene.lights.push_back({{0, 0, -5}});
  for (const std::uint32_t depth : {0u, 1u, 3u, 5u}) {
    scene.effects.depth = depth;
    SampleRecord record;
    CHECK(only_sample(scene, &record).g == 0.0);
    CHECK(record.rays.size() == depth + 1);
    CHECK(record.rays.back().ray == 1u << depth);
  }
}

TEST_CASE("The record of a sample follows each reflected ray to its end before the refracted one") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, 0});
  scene.materials.push_back({.name = {}, .specular = 0.5f, .transmittance = 0.5f, .refraction_index = 1.5f});
  scene.effects.depth = 2;
  SampleRecord record;
  only_sample(scene, &record);
  std::vector<std::uint32_t> numbers;
  for (const RayEvent& event : record.rays) numbers.push_back(event.ray);
  CHECK(numbers == std::vector<std::uint32_t>{1, 2, 3, 6, 7});
  CHECK(record.rays[0].from_outside);
  CHECK_FALSE(record.rays[2].from_outside);
  CHECK(record.lights.size() == 3);  // rays 2 and 7 go into the open
}
