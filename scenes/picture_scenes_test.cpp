// SPDX-License-Identifier: MIT
// What a scene says to renderers alone: the round ground, generated textures, bump maps, the light of a scene without
// lights, and the scenes for pictures.
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/generate_texture.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

Scene read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.json", text));
}

const std::string kWorld = R"("world": [{"spheres": [{"center": [0, 0, 0], "radius": 1}]}])";

}  // namespace

TEST_CASE("The round ground arrives as it was written, with a frame for its texture, and is no primitive") {
  const Scene scene = read_text("{" + kWorld + R"(, "materials": {"a": {}, "stone": {"bump_texture": "cobbles:4",
    "bump_scale": 0.25, "glossy": 0.5}}, "ground": {"center": [1, 2, 3], "normal": [0, 0, 5], "radius": 50,
    "texture_size": 4, "material": "stone"}})");
  CHECK((scene.ground.radius == 50.0f && scene.ground.texture_size == 4.0f));
  CHECK(scene.ground.center == glm::vec3(1, 2, 3));
  CHECK(scene.ground.normal == glm::vec3(0, 0, 1));
  CHECK(scene.ground.u_axis == glm::vec3(1, 0, 0));
  CHECK(scene.ground.v_axis == glm::vec3(0, 1, 0));
  const Material& stone = scene.materials.at(scene.ground.material);
  CHECK(stone.name == "stone");
  CHECK((stone.bump_scale == 0.25f && stone.glossy == 0.5f));
  CHECK(scene.textures.at(stone.bump_texture).width == 64);
  CHECK(placed_count(scene) == 1);
  CHECK(bounding_ball(scene).radius < 1.001);
  CHECK(scene.materials.at(scene.spheres[0].material).glossy < 0.0f);  // that of the scene
  CHECK(read_text("{" + kWorld + "}").ground.radius == 0.0f);

  // Whatever the normal, the frame is orthonormal and right-handed: v x u points against the normal.
  for (const char* normal : {"[0, 1, 0]", "[-3, 0, 0]", "[1, 1, 1]", "[1e-30, -2e-30, 0]"}) {
    INFO(normal);
    const Ground ground =
        read_text("{" + kWorld + R"(, "ground": {"radius": 1, "normal": )" + std::string(normal) + "}}").ground;
    const glm::vec3 n = ground.normal;
    CHECK(glm::length(glm::cross(ground.u_axis, ground.v_axis) - n) < 4e-7f);
    CHECK(std::abs(glm::length(n) - 1.0f) < 2e-7f);
    CHECK(std::abs(glm::length(ground.u_axis) - 1.0f) < 2e-7f);
  }
}

TEST_CASE("A ground, a lens or a material that cannot be is refused with its key") {
  const auto error_of = [](const std::string& text) -> std::string {
    try {
      read_text("{" + kWorld + ", " + text + "}");
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.substr(message.find("scene.json"));
    }
    return {};
  };
  CHECK(error_of(R"("ground": {"radius": 0})") == "scene.json:1: ground.radius: expected a number above 0");
  CHECK(error_of(R"("ground": {"radius": 1e-50})") == "scene.json:1: ground.radius: expected a number above 0");
  CHECK(error_of(R"("ground": {})").find("radius") != std::string::npos);
  CHECK(error_of(R"("ground": {"radius": 1, "normal": [0, 0, 0]})") ==
        "scene.json:1: ground.normal: a normal must not be zero");
  CHECK(error_of(R"("ground": {"radius": 1, "material": "x"})").find("no material is called") != std::string::npos);
  CHECK(error_of(R"("camera": {"from": [0, 0, 2], "at": [0, 0, 0], "aperture": 2})") ==
        "scene.json:1: camera.aperture: the lens must be smaller than the distance of what is sharp");
  CHECK(error_of(R"("camera": {"from": [0, 0, 2], "at": [0, 0, 0], "aperture": 2, "focus": 2.5})").empty());
  CHECK(error_of(R"("materials": {"m": {"glossy": -1}})").find("materials.m.glossy") != std::string::npos);
  CHECK(error_of(R"("materials": {"m": {"bump_texture": "checker:3"}})").find("must be even") != std::string::npos);
  CHECK(error_of(R"("materials": {"m": {"bump_texture": "waves:65"}})").find("1 to 64") != std::string::npos);
}

TEST_CASE("Generated textures repeat without a seam and keep to [0, 1]") {
  CHECK(is_generated_texture("checker"));
  CHECK(is_generated_texture("waves:3"));
  CHECK_FALSE(is_generated_texture("checker.png"));
  for (const char* name : {"checker", "stripes:2", "waves:3", "cobbles:5"}) {
    INFO(name);
    const Texture texture = generate_texture(name);
    REQUIRE(texture.width > 0);
    REQUIRE(texture.texels.size() == static_cast<std::size_t>(texture.width * texture.height));
    float least = 1.0f, most = 0.0f;
    for (const glm::vec3& texel : texture.texels) {
      CHECK((texel.r == texel.g && texel.g == texel.b));
      least = std::min(least, texel.r);
      most = std::max(most, texel.r);
    }
    CHECK((least >= 0.0f && least <= 0.25f && most <= 1.0f && most > 0.7f));
  }
  // Over the edge the pattern goes on: the last piece differs from the first in a checker, and is the same in waves.
  const Texture checker = generate_texture("checker:4"), waves = generate_texture("waves:4");
  CHECK(checker.texels[0] != checker.texels[63]);
  for (std::size_t x = 0; x < 16; ++x) CHECK(std::abs(waves.texels[x].r - waves.texels[63 - x].r) < 1e-6f);
}

TEST_CASE("Meshes of a scene file may have normals and texture coordinates, one for each position") {
  const std::string mesh = R"({"world": [{"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]],
    "triangles": [[0, 1, 2], [1, 3, 2]])";
  const Scene scene = read_text(mesh + R"(, "normals": [[0, 0, 1], [0, 0, 1], [0, 1, 1], [0, 0, 1]],
    "texcoords": [[0, 0], [2, 0], [0, 2], [2, 2]]}]})");
  REQUIRE(scene.triangles.size() == 2);
  CHECK(scene.texcoords.at(scene.triangles[1].texcoord[1]) == glm::vec2(2, 2));
  CHECK(scene.normals.at(scene.triangles[1].normal[2]) == glm::vec3(0, 1, 1));
  CHECK_THROWS_AS(read_text(mesh + R"(, "normals": [[0, 0, 1]]}]})"), InputError);
  CHECK_THROWS_AS(read_text(mesh + R"(, "texcoords": [[0, 0], [2, 0], [0, 2], [2]]}]})"), InputError);
  CHECK_THROWS_AS(read_text(R"({"world": [{"normals": [[0, 0, 1]]}]})"), InputError);
}

TEST_CASE("A scene without lights has one above the eye and to its right") {
  Camera camera;
  camera.from = {0, 0, 4};
  camera.at = {0, 0, 0};
  const Light light = default_light(camera);
  CHECK(glm::length(light.position - glm::vec3(2, 2, 4)) < 1e-5f);
  CHECK((!light.has_color && light.radius == 0.0f));
  CHECK(focus_distance(camera) == 4.0);
  camera.focus = 1.5f;
  CHECK(focus_distance(camera) == 1.5);
}

TEST_CASE("Scenes for pictures load by name and have what their effect needs") {
  for (const std::string& name : picture_scenes()) {
    INFO(name);
    const Scene scene = load_scene(name);
    CHECK(scene.warnings.empty());
    CHECK(scene.has_camera);
    CHECK(placed_count(scene) > 0);
  }
  CHECK(load_scene("dof").camera.aperture > 0.0f);
  const Scene motion = load_scene("motion");
  CHECK(motion.animation.size() == 2);
  CHECK(motion.camera.shutter_close > motion.camera.shutter_open);
  // The umbra of the ball ends above the ground, so the ground sees the antumbra.
  const Scene shadow = load_scene("soft_shadow");
  const Light& light = shadow.lights.at(0);
  const Sphere& ball = shadow.spheres.at(0);
  const double distance = glm::length(light.position - ball.center);
  const double umbra = distance * ball.radius / (light.radius - ball.radius);
  const double to_ground = distance * ball.center.y / (light.position.y - ball.center.y);
  CHECK((umbra > 0.0 && umbra < to_ground));
  const Scene bumped = load_scene("bumped_ground");
  CHECK(bumped.materials.at(bumped.ground.material).bump_texture != kNone);
  CHECK(load_scene("glossy").materials.size() >= 5);
}
