// SPDX-License-Identifier: MIT
// Single pixels whose colour can be worked out by hand from SEMANTICS 6.
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/camera.h"
#include "tracer/renderer.h"

namespace plumbline {
namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

// Hand-made values are exact but for the shader's floats: some thirty operations, each off by 2^-24.
constexpr double kFloat = 2e-6;

/// A scene of one pixel that is seen from `from` towards `at`, sharp.
Scene one_pixel(const glm::vec3& from, const glm::vec3& at) {
  Scene scene;
  scene.name = "pixel";
  scene.camera.from = from, scene.camera.at = at;
  scene.camera.up = std::abs(glm::normalize(at - from).y) > 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  scene.camera.width = scene.camera.height = 1;
  scene.has_camera = true;
  scene.background = {0.25f, 0.5f, 0.75f};
  return scene;
}

std::uint32_t add(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}
Material matt(float diffuse) {
  Material material;
  material.diffuse = diffuse;
  return material;
}
Material mirror(float specular) {
  Material material;
  material.diffuse = 0.0f, material.specular = specular, material.shine = 10.0f;
  return material;
}

/// The parallelogram of a corner and two sides, with texture coordinates from (0, 0) to (1, 1).
void add_quad(Scene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, std::uint32_t material) {
  const auto p = static_cast<std::uint32_t>(scene.positions.size()), t = static_cast<std::uint32_t>(scene.texcoords.size());
  scene.positions.insert(scene.positions.end(), {corner, corner + u, corner + u + v, corner + v});
  scene.texcoords.insert(scene.texcoords.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  Triangle triangle;
  triangle.material = material;
  triangle.position = {p, p + 1, p + 2}, triangle.texcoord = {t, t + 1, t + 2};
  scene.triangles.push_back(triangle);
  triangle.position = {p, p + 2, p + 3}, triangle.texcoord = {t, t + 2, t + 3};
  scene.triangles.push_back(triangle);
}

void add_light(Scene& scene, const glm::vec3& place) {
  Light light;
  light.position = place;
  light.color = glm::vec3(1.0f), light.has_color = true;
  scene.lights.push_back(light);
}

glm::dvec3 color_of(const Scene& scene, std::uint32_t depth = 5) {
  RenderSettings settings;
  settings.effects = scene.effects;
  settings.effects->antialias = false;
  settings.effects->depth = depth;
  Renderer renderer(context(), scene, settings);
  const auto picture = renderer.render();
  REQUIRE(picture->mean.size() == 1);
  return picture->mean[0];
}

}  // namespace

TEST_CASE("A pixel that sees nothing shows the background", "[render]") {
  Scene scene = one_pixel({0, 0, 5}, {0, 0, 0});
  add_quad(scene, {7, 7, 0}, {1, 0, 0}, {0, 1, 0}, add(scene, matt(1)));
  CHECK(color_of(scene) == glm::dvec3(scene.background));
}

TEST_CASE("A matt sphere is as bright as its angle to the light", "[render]") {
  Scene scene = one_pixel({0, 0, 5}, {0, 0, 0});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, add(scene, matt(0.8f))});
  scene.materials[0].color = {1.0f, 0.5f, 0.25f};
  add_light(scene, {3, 0, 5});  // from (0, 0, 1): the direction (3, 0, 4) / 5
  const glm::dvec3 color = color_of(scene);
  CHECK(color.r == Approx(0.8 * 0.8).epsilon(kFloat));
  CHECK(color.g == Approx(0.8 * 0.8 * 0.5).epsilon(kFloat));
  CHECK(color.b == Approx(0.8 * 0.8 * 0.25).epsilon(kFloat));
}

TEST_CASE("The highlight is Blinn's", "[render]") {
  Scene scene = one_pixel({0, 0, 5}, {0, 0, 0});
  Material shiny = mirror(0.5f);
  shiny.shine = 20.0f;
  scene.spheres.push_back({{0, 0, 0}, 1.0f, add(scene, shiny)});
  scene.background = glm::vec3(0.0f);
  add_light(scene, {3, 0, 5});
  const glm::dvec3 half = glm::normalize(glm::dvec3(0.6, 0, 0.8) + glm::dvec3(0, 0, 1));
  // The error of n.h is multiplied by the exponent.
  CHECK(color_of(scene).r == Approx(0.5 * std::pow(half.z, 20.0)).epsilon(20 * kFloat));
}

TEST_CASE("Lights without a colour share the brightness", "[render]") {
  Scene scene = one_pixel({0, 0, 5}, {0, 0, 0});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, add(scene, matt(1.0f))});
  for (int i = 0; i < 4; ++i) add_light(scene, {0, 0, 5 + i}), scene.lights.back().has_color = false;
  CHECK(color_of(scene).r == Approx(4.0 * std::sqrt(4.0) / 8.0).epsilon(kFloat));
}

TEST_CASE("What stands between a surface and its light takes the light away", "[render]") {
  for (const float height : {1.0f, 3.0f}) {  // below the light, above it
    Scene scene = one_pixel({0, 3, 5}, {0, 0, 0});
    const std::uint32_t material = add(scene, matt(1.0f));
    add_quad(scene, {-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, material);
    add_quad(scene, {-0.1f, height, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, material);
    add_light(scene, {0, 2, 0});
    CHECK(color_of(scene).r == Approx(height > 2.0f ? 1.0 : 0.0).epsilon(kFloat));
  }
}

TEST_CASE("A mirror shows what stands in the mirrored direction, to the depth that is asked", "[render]") {
  Scene scene = one_pixel({0, 1, 1}, {0, 0, 0});
  add_quad(scene, {-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, add(scene, mirror(0.5f)));
  add_light(scene, {0, -1, 0});
  CHECK(color_of(scene).g == Approx(0.5 * 0.5).epsilon(kFloat));
  CHECK(color_of(scene, 0).g == 0.0);
  // Two mirrors that face each other: five reflections from the first ray on, and nothing behind the last.
  Scene hall = one_pixel({0, 1, 0}, {0, 0, 0.1f});
  hall.materials = scene.materials;
  add_quad(hall, {-50, 0, -50}, {100, 0, 0}, {0, 0, 100}, 0);
  add_quad(hall, {-50, 2, -50}, {100, 0, 0}, {0, 0, 100}, 0);
  add_light(hall, {0, 9, 0});
  CHECK(color_of(hall) == glm::dvec3(0.0));
}

TEST_CASE("Light is bent by Snell's law, and stays inside beyond the critical angle", "[render]") {
  // A slab of glass seen at 45 degrees: what leaves it is parallel to what came in, moved aside.
  Material glass;
  glass.diffuse = 0.0f, glass.transmittance = 1.0f, glass.refraction_index = 1.5f;
  Scene scene = one_pixel({-1, 1, 0}, {0, 0, 0});
  const std::uint32_t material = add(scene, glass);
  add_quad(scene, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, material);    // N is up
  add_quad(scene, {-5, -1, -5}, {10, 0, 0}, {0, 0, 10}, material);   // N is down
  const double inside = std::asin(std::sin(std::acos(-1.0) / 4) / 1.5), shift = std::tan(inside);
  // A wall below with a step where the ray must arrive: just before it is bright, just behind it dark. Both rays start
  // delta = 2^-17 (1 + 10) = 8.4e-5 below the surfaces that they leave, which moves them no further than that.
  for (const double side : {-2e-4, 2e-4}) {
    Scene with_wall = scene;
    const std::uint32_t bright = add(with_wall, matt(1.0f));
    const auto x = static_cast<float>(shift + 1.0 + side);
    add_quad(with_wall, {x, -2, 5}, {10, 0, 0}, {0, 0, -10}, bright);  // from x on
    with_wall.background = glm::vec3(0.0f);
    add_light(with_wall, {static_cast<float>(shift + 1.0), -1.5f, 0});
    CAPTURE(side);
    CHECK((color_of(with_wall).r > 0.5) == (side < 0));
  }
  // From inside at 45 degrees, 1.5 sin 45 > 1: all of it comes back, to the background below.
  Scene within = one_pixel({-1, -1, 0}, {0, 0, 0});
  add_quad(within, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, add(within, glass));
  add_quad(within, {0.5f, -9, -5}, {0, 8.9f, 0}, {0, 0, 10}, add(within, matt(0.0f)));
  CHECK(color_of(within) == glm::dvec3(0.0));
}

TEST_CASE("Textures are filtered between the centres of their texels", "[render]") {
  Scene scene = one_pixel({0.375f, 0.75f, 5}, {0.375f, 0.75f, 0});
  Texture texture;
  texture.width = texture.height = 2;
  texture.texels = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // the top row first
  scene.textures.push_back(texture);
  Material material = matt(1.0f);
  material.diffuse_texture = 0;
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add(scene, material));
  add_light(scene, {0.375f, 0.75f, 3});
  // u = 0.375 is a quarter of the way from the first column's centre to the second's, v = 0.75 the upper row's centre.
  const glm::dvec3 color = color_of(scene);
  CHECK(color.r == Approx(0.25).epsilon(kFloat));
  CHECK(std::abs(color.g) + std::abs(color.b) < kFloat);
}

TEST_CASE("A bumped square is lit as the slope of its heights", "[render]") {
  Scene scene = one_pixel({0.5f, 0.5f, 5}, {0.5f, 0.5f, 0});
  Texture heights;
  heights.width = 4, heights.height = 1;
  heights.texels = {glm::vec3(0.0f), glm::vec3(0.25f), glm::vec3(0.5f), glm::vec3(0.75f)};
  scene.textures.push_back(heights);
  Material material = matt(1.0f);
  material.bump_texture = 0, material.bump_scale = 0.5f;
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add(scene, material));
  add_light(scene, {0.5f, 0.5f, 3});
  // Between the second texel and the third the heights rise by 1 over the square's side: slope 0.5 with the scale.
  CHECK(color_of(scene).r == Approx(1.0 / std::sqrt(1.25)).epsilon(kFloat));
}

TEST_CASE("The round ground is seen, and hides what it hides", "[render]") {
  Scene scene = one_pixel({0.5f, 5, 0}, {0.5f, 0, 0});
  scene.spheres.push_back({{0.5f, -2, 0}, 1.0f, add(scene, matt(0.0f))});
  scene.ground.radius = 1.0f;
  scene.ground.material = add(scene, matt(0.5f));
  add_light(scene, {0.5f, 3, 0});
  CHECK(color_of(scene).r == Approx(0.5).epsilon(kFloat));
  scene.ground.radius = 0.25f;
  CHECK(color_of(scene).r == 0.0);
}

TEST_CASE("A light within a surface, a mesh without area and sixty-four lights render", "[render]") {
  Scene scene = one_pixel({0, 0, 5}, {0, 0, 0});
  scene.spheres.push_back({{0, 0, 0}, 1.0f, add(scene, matt(1.0f))});
  add_light(scene, {0, 0, 0});
  CHECK(color_of(scene).r == 0.0);  // it lights the inside
  scene.lights.clear();
  for (int i = 0; i < 64; ++i) add_light(scene, {0, 0, 2 + i});
  CHECK(color_of(scene).r == Approx(64.0).epsilon(kFloat));
  scene.lights.clear();
  RenderSettings settings;
  settings.effects = scene.effects;
  settings.effects->antialias = false;
  Renderer by_default(context(), scene, settings);
  CHECK(by_default.lit_by_default());
  const glm::dvec3 l = glm::normalize(glm::dvec3(default_light(scene.camera).position) - glm::dvec3(0, 0, 1));
  CHECK(by_default.render()->mean[0].r == Approx(0.5 * l.z).epsilon(kFloat));
}

}  // namespace plumbline
