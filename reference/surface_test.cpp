// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces at hits against values worked out by hand.
#include "reference/surface.h"

#include <catch2/catch.hpp>

#include "reference/render_scenes_test.h"
#include "reference/texture_lookup.h"

using namespace plumbline;

namespace {

constexpr double kDouble = 1e-12;  ///< of numbers about 1 after a handful of operations in double

bool near(const glm::dvec3& a, const glm::dvec3& b, double bound = kDouble) { return glm::length(a - b) <= bound; }

Surface seen(const Scene& scene, const Ray& ray) {
  const EmbreeScene hits(scene);
  const auto ground = ground_hit(scene, ray);
  const ReferenceHit hit = ground ? *ground : hits.first_hit(ray);
  REQUIRE(hit.kind == HitKind::hit);
  return surface_at(scene, instance_views(scene), hit, glm::normalize(glm::dvec3(ray.direction)));
}

/// Heights that rise by `rise` in all, left to right or from the bottom up.
Texture ramp(int size, float rise, bool upwards) {
  Texture texture{"", size, size, {}};
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      texture.texels.emplace_back(rise * static_cast<float>(upwards ? size - 1 - row : column) /
                                  static_cast<float>(size));
  return texture;
}

Scene bumped_square(bool upwards, float scale) {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  scene.textures.push_back(ramp(8, 1.0f, upwards));
  add_level(scene, 0, 0, 1, 1, 0, add_surface(scene, {.name = {}, .bump_texture = 0, .bump_scale = scale}));
  return scene;
}

}  // namespace

TEST_CASE("A texture is read bilinearly, repeats, and has (0, 0) at its lower left") {
  Texture texture{"", 2, 2, {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {8, 0, 0}}};
  const auto red = [&](double u, double v) { return texture_value(texture, {u, v}).r; };
  CHECK(red(0.25, 0.75) == 1.0);  // centres of the texels
  CHECK(red(0.75, 0.75) == 2.0);
  CHECK(red(0.25, 0.25) == 4.0);
  CHECK(red(0.75, 0.25) == 8.0);
  CHECK(red(0.5, 0.75) == 1.5);
  CHECK(red(0.25, 0.5) == 2.5);
  CHECK(red(0.3125, 0.25) == 4.5);  // an eighth of the way
  CHECK(red(0.0, 0.25) == 6.0);     // across the seam
  CHECK(red(0.0, 0.0) == 3.75);
  CHECK(red(-3.75, 7.75) == 1.0);
  CHECK(red(-1e-30, 0.25) == Approx(6.0));  // u - floor(u) rounds to 1
}

TEST_CASE("A bump map tilts the normal of a plane by its slope") {
  for (const bool upwards : {false, true}) {
    for (const float scale : {0.25f, -2.0f}) {
      CAPTURE(upwards, scale);
      const Scene scene = bumped_square(upwards, scale);
      // The surface z = scale * x (or y) has the normal (-scale, 0, 1).
      const glm::dvec3 tilted = glm::normalize(upwards ? glm::dvec3(0, -scale, 1) : glm::dvec3(-scale, 0, 1));
      const Surface above = seen(scene, {{0.4f, 0.55f, 3}, {0, 0, -1}});
      CHECK(near(above.shading, tilted));
      CHECK(above.facing == glm::dvec3(0, 0, 1));
      const Surface below = seen(scene, {{0.4f, 0.55f, -3}, {0, 0, 1}});
      CHECK(near(below.shading, -tilted));
      CHECK(below.outside == glm::dvec3(0, 0, 1));
      CHECK(below.facing == glm::dvec3(0, 0, -1));
    }
  }
}

TEST_CASE("A mirrored instance keeps its outside, and scales slopes with its geometry") {
  Scene scene = bumped_square(false, 0.5f);
  scene.parts.push_back({"square", 0, 2, 0, 0});
  Transform flip;
  flip.linear = glm::mat3(-1, 0, 0, 0, 1, 0, 0, 0, 3);
  flip.translation = {0, 0, 1};
  scene.nodes.push_back({"mirrored", kNone, 0, flip, flip});
  const Surface s = seen(scene, {{-0.4f, 0.55f, 5}, {0, 0, -1}});
  CHECK(near(s.position, {-0.4f, 0.55f, 1}));
  CHECK(near(s.outside, {0, 0, 1}));
  // z = 0.5 x becomes z = 1 - 1.5 x.
  CHECK(near(s.shading, glm::normalize(glm::dvec3(1.5, 0, 1))));
  // |L| |L^-1| is the identity here: E.z = 3 * 0 + 1. The square's side is 1, and z is stretched by 3: D = 3.
  CHECK(s.offset == Approx(0x1p-17 * (1.0 + 3.0)).epsilon(1e-12));
}

TEST_CASE("Vertex normals are interpolated, and turned to the side of the geometric one") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  scene.materials.resize(1);
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.normals = {{0, 0, -7}, {-1, 0, -1}, {0, -1, -1}};
  scene.triangles.push_back({.position = {0, 1, 2}, .normal = {0, 1, 2}});
  const Ray ray{{0.25f, 0.5f, 2}, {0, 0, -1}};
  const double tilted = std::sqrt(0.5);
  const glm::dvec3 sum(0.25 * tilted, 0.5 * tilted, 0.25 + 0.75 * tilted);
  CHECK(near(seen(scene, ray).shading, glm::normalize(sum)));
  scene.normals[1] = {0, 0, 0};
  CHECK(seen(scene, ray).shading == glm::dvec3(0, 0, 1));
}

TEST_CASE("Rays start off a sphere by 2^-17 of its numbers across the surface") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  scene.materials.resize(1);
  scene.spheres.push_back({{1, 2, -3}, 0.5f, 0});
  const Surface s = seen(scene, {{1, 2, 5}, {0, 0, -1}});
  CHECK(near(s.position, {1, 2, -2.5}));
  CHECK(s.offset == Approx(0x1p-17 * 3.5).epsilon(1e-12));
}

TEST_CASE("Rays start off an instance by what its map makes of its numbers") {
  Scene scene = one_pixel_scene({0, 0, 5}, {0, 0, 0});
  add_quad(scene, {glm::vec3{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}, add_surface(scene, {}));
  scene.parts.push_back({"wall", 0, 2, 0, 0});
  Transform shear;  // x' = x + y, y' = y + 5, z' = 2 z + 7
  shear.linear = glm::mat3(1, 0, 0, 1, 1, 0, 0, 0, 2);
  shear.translation = {0, 5, 7};
  scene.nodes.push_back({"sheared", kNone, 0, shear, shear});
  const Surface s = seen(scene, {{5, 5.25f, 7.25f}, {-1, 0, 0}});
  CHECK(near(s.position, {1.25, 5.25, 7.25}));
  CHECK(near(s.facing, glm::normalize(glm::dvec3(1, -1, 0))));
  // |L| e + |T| = (2, 6, 9), and |L| |L^-1| has the rows (1, 2, 0), (0, 1, 0), (0, 0, 1): E = (14, 6, 9).
  // D = 2 in the part, and the largest row of |L| sums to 2.
  CHECK(s.offset == Approx(0x1p-17 * (std::sqrt(0.5) * 20.0 + 4.0)).epsilon(1e-12));
}

TEST_CASE("The ground is a disc with texture coordinates around its centre") {
  Scene scene = one_pixel_scene({0, 5, 0}, {0, 0, 0}, {0, 0, 1});
  scene.textures.push_back({"", 2, 2, {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {8, 0, 0}}});
  scene.ground = {.center = {1, 2, 3}, .radius = 4, .texture_size = 2};
  scene.ground.material = add_surface(scene, {.name = {}, .diffuse_texture = 0});
  const auto down = [](float x, float z) { return Ray{{x, 4, z}, {0, -0.5f, 0}}; };
  const auto hit = ground_hit(scene, down(1.5f, 2.5f));
  REQUIRE(hit);
  CHECK(hit->t == 4.0);
  CHECK(hit->primitive == scene.primitive_count());
  const Surface s = seen(scene, down(1.5f, 2.5f));  // u = 0.25, and v = 0.25 as v runs along -z
  CHECK(s.position == glm::dvec3(1.5, 2, 2.5));
  CHECK(s.color.r == 4.0);
  CHECK(ground_hit(scene, down(5, 3)));  // the rim belongs to it
  CHECK_FALSE(ground_hit(scene, down(5.001f, 3)));
  CHECK_FALSE(ground_hit(scene, {{1, 4, 3}, {0, -1, 0}, 1.999f}));
  CHECK(ground_hit(scene, {{1, 4, 3}, {0, -1, 0}, 2.0f}));
  CHECK_FALSE(ground_hit(scene, {{1, 4, 3}, {1, 0, 0}}));
  CHECK_FALSE(ground_hit(scene, {{1, 2, 3}, {0, -1, 0}}));  // t = 0 is no hit
}
