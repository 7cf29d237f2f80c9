// SPDX-License-Identifier: MIT
// Scene files: what they mean, against closed forms, and what they say about each mistake.
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

const std::string kBall = R"("parts": {"ball": {"spheres": [{"center": [0, 0, 0], "radius": 1}]}})";

Scene read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("scene.json", text));
}

/// A scene of one node with this transform.
TransformD transform_of(const std::string& transform) {
  const Scene scene = read_text("{" + kBall + R"(, "nodes": [{"part": "ball", "transform": )" + transform + "}]}");
  REQUIRE(scene.nodes.size() == 1);
  return to_double(scene.nodes[0].transform);
}

void check_maps(const std::string& transform, const glm::dvec3& from, const glm::dvec3& to) {
  INFO(transform);
  const glm::dvec3 image = transform_point(transform_of(transform), from);
  CHECK(glm::length(image - to) <= 0x1p-21 * (1.0 + glm::length(to)));
}

/// The message without the folder of the file.
std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.write("scene.json", text);
  try {
    read_scene(path);
  } catch (const InputError& error) {
    std::string message = error.what();
    CHECK(message.find('\n') == std::string::npos);
    const std::string prefix = folder.path().string() + "/";
    for (std::size_t at = 0; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }
  return "";
}

void check_error(const std::string& text, const std::string& start) {
  INFO(text.substr(0, 300));
  const std::string message = error_of(text);
  CHECK(message.substr(0, start.size()) == start);
}

/// An error in the transform of line 3.
void check_transform_error(const std::string& transform, const std::string& start) {
  check_error("{" + kBall + ",\n\"nodes\": [{\"part\": \"ball\",\n\"transform\": " + transform + "}]}",
              "scene.json:3: nodes[0].transform" + start);
}

}  // namespace

TEST_CASE("Transforms of scene files map points as the documentation says") {
  check_maps(R"({"translate": [1, 2, 3]})", {4, 5, 6}, {5, 7, 9});
  check_maps(R"({"scale": 2})", {1, -1, 3}, {2, -2, 6});
  check_maps(R"({"scale": [2, 3, -4]})", {1, 1, 1}, {2, 3, -4});
  check_maps(R"({"rotate": {"axis": [0, 0, 5], "degrees": 90}})", {1, 0, 0}, {0, 1, 0});
  check_maps(R"({"rotate": {"axis": [1, 1, 1], "degrees": 120}})", {1, 2, 3}, {3, 1, 2});
  check_maps(R"({"rotate": {"quaternion": [0, 0, 1, 1]}})", {1, 0, 0}, {0, 1, 0});
  check_maps(R"({"rotate": {"euler": [90, 0, 0]}})", {0, 1, 0}, {0, 0, 1});
  check_maps(R"({"rotate": {"euler": [90, 90, 0]}})", {0, 1, 0}, {1, 0, 0});  // x first, then y
  check_maps(R"({"shear": {"xy": 0.5, "zx": 2}})", {1, 4, 1}, {3, 4, 3});
  check_maps(R"({"matrix": [[1, 2, 3, 10], [0, 1, 0, 20], [0, 0, 2, 30]]})", {1, 1, 1}, {16, 21, 32});
  check_maps(R"({"matrix": [[0, 2, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})", {1, 2, 3}, {4, 1, 3});
  // Scale, shear, rotate, translate, in whatever order they are written.
  check_maps(
      R"({"translate": [1, 0, 0], "rotate": {"axis": [0, 0, 1], "degrees": 90}, "shear": {"xy": 1}, "scale": 2})",
      {1, 1, 0}, {-1, 4, 0});
  // Steps of a list first to last.
  check_maps(R"([{"translate": [1, 0, 0]}, {"scale": 3}])", {1, 1, 1}, {6, 3, 3});
  check_maps(R"([{"scale": 3}, {"translate": [1, 0, 0]}])", {1, 1, 1}, {4, 3, 3});
  check_maps("[]", {1, 2, 3}, {1, 2, 3});
  check_maps("{}", {1, 2, 3}, {1, 2, 3});
}

TEST_CASE("Quarter turns about coordinate axes are exact, whatever the number of turns") {
  for (const char* const degrees : {"90", "-270", "450", "3690"}) {
    const TransformD t = transform_of(std::string(R"({"rotate": {"axis": [0, 1, 0], "degrees": )") + degrees + "}}");
    CHECK(transform_point(t, {1, 2, 3}) == glm::dvec3(3, 2, -1));
  }
  CHECK(transform_point(transform_of(R"({"rotate": {"euler": [180, 90, 270]}})"), {1, 2, 3}) ==
        transform_point(transform_of(R"([{"rotate": {"axis": [1, 0, 0], "degrees": 180}},
                                         {"rotate": {"axis": [0, 1, 0], "degrees": 90}},
                                         {"rotate": {"axis": [0, 0, 1], "degrees": 270}}])"),
                        {1, 2, 3}));
  // The three ways to write a rotation agree.
  const TransformD a = transform_of(R"({"rotate": {"axis": [0, 1, 0], "degrees": 50}})"),
                   b = transform_of(R"({"rotate": {"euler": [0, 50, 0]}})"),
                   c = transform_of(R"({"rotate": {"quaternion": [0, 0.42261826174, 0, 0.90630778704]}})");
  for (int i = 0; i < 3; ++i) {
    CHECK(glm::length(a.linear[i] - b.linear[i]) == 0.0);
    CHECK(glm::length(a.linear[i] - c.linear[i]) < 0x1p-22);
  }
}

TEST_CASE("Parts are shared, materials replaced, and world geometry stands before them") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "sub");
  folder.write("sub/tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Scene scene = read_scene(folder.write("scene.json", R"({
    // Comments are allowed, /* both kinds */
    "materials": {"red": {"color": [1, 0, 0], "shine": 7}},
    "parts": {
      "tri": "sub/tri.obj", "same": {"source": "sub/tri.obj"}, "red tri": {"source": "sub/tri.obj", "material": "red"},
      "flake": "sphereflake:1",
      "mixed": {"spheres": [{"center": [0, 0, 0], "radius": 2}], "discs": [{"radius": 1, "sides": 5, "normal": [0, 0, 2], "center": [1, 1, 1]}],
                "positions": [[0, 0, 0], [1, 0, 0], [0, 0, 1]], "triangles": [[0, 1, 2], [2, 1, 0]]}
    },
    "world": ["mixed", {"spheres": [{"center": [9, 9, 9], "radius": 3, "material": "red"}]}],
    "nodes": [
      {"name": "a", "part": "tri"}, {"name": "b", "part": "same"}, {"name": "c", "part": "red tri"}, {"part": "flake"},
      {"name": "both", "part": "tri", "children": [{"part": "red tri"}]}
    ]
  })"));
  CHECK(scene.world_triangle_count() == 7);
  CHECK(scene.world_sphere_count() == 2);
  REQUIRE(scene.parts.size() == 3);
  CHECK(scene.nodes[0].part == scene.nodes[1].part);
  CHECK(scene.nodes[2].part != scene.nodes[1].part);
  CHECK(scene.nodes[3].name == "flake.3");
  CHECK(scene.nodes[4].part == kNone);
  CHECK(scene.nodes[5].name == "both/geometry");
  CHECK(scene.nodes[5].parent == 4);
  CHECK(scene.nodes[5].part == scene.nodes[0].part);
  CHECK(scene.nodes[6].name == "both/red tri.0");
  const Part& red = scene.parts[scene.nodes[2].part];
  CHECK(scene.materials[scene.triangles[red.first_triangle].material].shine == 7.0f);
  CHECK(scene.materials[scene.spheres[1].material].name == "red");
  // The disc: a fan in its plane, facing its normal, of the area of a pentagon.
  double area = 0.0;
  for (std::uint32_t t = 0; t < 5; ++t) {
    const auto c = scene.corners(t);
    const glm::vec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
    CHECK(cross.z > 0.0f);
    CHECK(std::abs(c[1].z - 1.0f) < 1e-6f);
    area += 0.5 * static_cast<double>(glm::length(cross));
  }
  CHECK(area == Approx(2.5 * std::sin(2.0 * 3.141592653589793 / 5.0)).epsilon(1e-6));
  // Parts share no positions with one another or the world, and follow without gaps.
  std::vector<int> owner(scene.positions.size(), -1);
  const auto claim = [&](std::uint32_t first, std::uint32_t count, int who) {
    for (std::uint32_t t = first; t < first + count; ++t)
      for (const std::uint32_t p : scene.triangles[t].position) {
        CHECK((owner[p] == -1 || owner[p] == who));
        owner[p] = who;
      }
  };
  claim(0, scene.world_triangle_count(), 0);
  std::uint32_t triangles = scene.world_triangle_count(), spheres = scene.world_sphere_count();
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    CHECK(scene.parts[i].first_triangle == triangles);
    CHECK(scene.parts[i].first_sphere == spheres);
    triangles += scene.parts[i].triangle_count;
    spheres += scene.parts[i].sphere_count;
    claim(scene.parts[i].first_triangle, scene.parts[i].triangle_count, static_cast<int>(i) + 1);
  }
  CHECK(triangles == scene.triangles.size());
  CHECK(spheres == scene.spheres.size());
  CHECK(placed_count(scene) == 7 + 2 + 5 * 1 + (10 + 2));
}

TEST_CASE("A part that is a scene file is expanded below the node that places it, its geometry shared") {
  const TemporaryFolder folder;
  folder.write("leg.json", R"({"world": [{"spheres": [{"center": [0, 0, 0], "radius": 1}]}],
    "nodes": [{"name": "foot", "part": {"source": "cube"}, "transform": {"translate": [0, -1, 0]}}]})");
  folder.write("body.json", R"({"parts": {"leg": "leg.json"}, "background": [1, 1, 1],
    "camera": {"from": [0, 0, 1], "at": [0, 0, 0]}, "nodes": [
    {"name": "left", "part": "leg", "transform": {"translate": [-1, 0, 0]}},
    {"name": "right", "part": "leg", "transform": {"translate": [1, 0, 0]},
     "keyframes": [{"time": 0, "translate": [1, 0, 0]}, {"time": 1, "translate": [1, 1, 0]}]}]})");
  const Scene scene = read_scene(folder.write("scene.json", R"({"parts": {"body": "body.json", "leg": "leg.json"},
    "world": ["leg"],
    "nodes": [{"name": "A", "part": "body", "transform": {"scale": 2}}, {"name": "B", "part": "body"}]})"));
  CHECK(scene.parts.size() == 2);
  CHECK(scene.triangles.size() == 12);
  CHECK(scene.world_sphere_count() == 1);
  CHECK(scene.spheres.size() == 2);  // the world's own, and the part's
  std::vector<std::string> names;
  for (const Node& node : scene.nodes) names.push_back(node.name);
  CHECK(names == std::vector<std::string>{"foot", "A", "A/left", "A/left/geometry", "A/left/foot", "A/right",
                                          "A/right/geometry", "A/right/foot", "B", "B/left", "B/left/geometry",
                                          "B/left/foot", "B/right", "B/right/geometry", "B/right/foot"});
  CHECK(transform_point(to_world(scene, 7), {0, 0, 0}) == glm::dvec3(2, -2, 0));
  CHECK(scene.animation.size() == 2);
  CHECK(scene.animation[1].node == 12);
  // Camera and background are those of the outermost file.
  CHECK_FALSE(scene.has_camera);
  CHECK(scene.background == glm::vec3(0.0f));
}

TEST_CASE("Parts may be groups that hold other parts") {
  const Scene scene = read_text("{" + kBall.substr(0, kBall.size() - 1) + R"(,
    "pair": {"nodes": [{"name": "l", "part": "ball"}, {"name": "r", "part": "ball", "transform": {"translate": [3, 0, 0]}}]},
    "four": {"nodes": [{"name": "1", "part": "pair"}, {"name": "2", "part": "pair", "transform": {"translate": [0, 3, 0]}}]}},
    "nodes": [{"name": "x", "part": "four"}]})");
  CHECK(scene.spheres.size() == 1);
  CHECK(instances_of(scene).size() == 4);
  CHECK(scene.nodes.back().name == "x/2/r");
  CHECK(transform_point(to_world(scene, static_cast<std::uint32_t>(scene.nodes.size() - 1)), {0, 0, 0}) ==
        glm::dvec3(3, 3, 0));
}

TEST_CASE("repeat makes copies, the first of a list fastest, after the node's own transform") {
  const Scene grid =
      read_text("{" + kBall + R"(, "nodes": [{"name": "b", "part": "ball", "transform": {"translate": [10, 0, 0]},
    "repeat": [{"count": 3, "by": {"translate": [1, 0, 0]}}, {"count": 2, "by": {"translate": [0, 5, 0]}}]}]})");
  REQUIRE(grid.nodes.size() == 6);
  CHECK(grid.nodes[4].name == "b.4");
  CHECK(grid.nodes[4].transform.translation == glm::vec3(11, 5, 0));
  CHECK(grid.nodes[2].transform.translation == glm::vec3(12, 0, 0));
  const Scene ring = read_text("{" + kBall + R"(, "nodes": [{"part": "ball", "transform": {"translate": [2, 0, 0]},
    "repeat": {"count": 4, "by": {"rotate": {"axis": [0, 1, 0], "degrees": 90}}}}]})");
  REQUIRE(ring.nodes.size() == 4);
  CHECK(ring.nodes[1].transform.translation == glm::vec3(0, 0, -2));
  CHECK(ring.nodes[2].transform.translation == glm::vec3(-2, 0, 0));
  // Children are in every copy.
  const Scene deep = read_text("{" + kBall + R"(, "nodes": [{"name": "n", "repeat": {"count": 2, "by": {"scale": 2}},
    "children": [{"name": "c", "part": "ball"}]}]})");
  REQUIRE(deep.nodes.size() == 4);
  CHECK(deep.nodes[3].name == "n.1/c");
  CHECK(largest_stretch(to_world(deep, 3).linear) == Approx(2.0));
  // Parts that are written in place are shared by the copies too.
  const Scene shared = read_text(R"({"nodes": [{"name": "n", "repeat": {"count": 5, "by": {"scale": 2}},
    "children": [{"part": {"spheres": [{"center": [0, 0, 0], "radius": 1}]}}]}]})");
  CHECK(instances_of(shared).size() == 5);
  CHECK(shared.spheres.size() == 1);
}

TEST_CASE("Keyframes, camera, lights and effects arrive as they were written") {
  const Scene scene = read_text("{" + kBall + R"(,
    "background": [0.1, 0.2, 0.3],
    "camera": {"from": [1, 2, 3], "at": [0, 0, 0], "up": [0, 0, 1], "angle": 90, "width": 64, "height": 48,
               "hither": 0.5, "aperture": 0.25, "focus": 4, "shutter": [-0.5, 0.75]},
    "lights": [{"position": [1, 2, 3], "color": [4, 5, 6], "radius": 0.5}, {"position": [0, 9, 0]}],
    "effects": {"model": "physical", "antialias": false, "soft_shadows": false, "depth_of_field": false,
                "motion_blur": false, "glossy": 0.125, "depth": 2},
    "nodes": [{"part": "ball", "transform": {"translate": [7, 7, 7], "scale": 3},
      "keyframes": [{"time": -1, "rotate": {"euler": [0, 0, 0]}}, {"time": 1, "rotate": {"axis": [0, 0, 1], "degrees": 90}, "translate": [1, 1, 1]}]}]})");
  CHECK(scene.background == glm::vec3(0.1f, 0.2f, 0.3f));
  CHECK(scene.camera.from == glm::vec3(1, 2, 3));
  CHECK(scene.camera.up == glm::vec3(0, 0, 1));
  CHECK(scene.camera.angle_radians == Approx(1.5707963f));
  CHECK((scene.camera.width == 64 && scene.camera.height == 48));
  CHECK((scene.camera.hither == 0.5f && scene.camera.aperture == 0.25f && scene.camera.focus == 4.0f));
  CHECK((scene.camera.shutter_open == -0.5f && scene.camera.shutter_close == 0.75f));
  REQUIRE(scene.lights.size() == 2);
  CHECK((scene.lights[0].has_color && scene.lights[0].color == glm::vec3(4, 5, 6) && scene.lights[0].radius == 0.5f));
  CHECK_FALSE(scene.lights[1].has_color);
  CHECK(scene.effects.model == Effects::Model::physical);
  CHECK_FALSE((scene.effects.antialias || scene.effects.soft_shadows || scene.effects.depth_of_field ||
               scene.effects.motion_blur));
  CHECK((scene.effects.glossy == 0.125f && scene.effects.depth == 2));
  REQUIRE(scene.animation.size() == 1);
  const Animation& animation = scene.animation[0];
  CHECK(animation.rest_translation == glm::dvec3(7, 7, 7));
  CHECK(animation.rest_scale == glm::dvec3(3));
  CHECK((animation.rotation.size() == 2 && animation.translation.size() == 1 && animation.scale.empty()));
  // Read, it shows time 0: half of the turn, the one translation, the scale at rest.
  const glm::dvec3 x = transform_point(to_double(scene.nodes[0].transform), {1, 0, 0});
  CHECK(glm::length(x - (glm::dvec3(1) + 3.0 * glm::dvec3(std::sqrt(0.5), std::sqrt(0.5), 0))) < 1e-5);
  CHECK(scene.nodes[0].rest == scene.nodes[0].transform);
}

TEST_CASE("Mistakes of syntax are told with their line") {
  check_error("{\n\"nodes\": [\n}", "scene.json:3: not JSON: syntax error while parsing value - unexpected '}'");
  check_error("[1, 2", "scene.json:1: not JSON: syntax error");
  check_error("\n\nnul", "scene.json:3: not JSON: syntax error");
  check_error("{\"nodes\": 1e999}", "scene.json:1: not JSON: number overflow");
  check_error("{\"a\": 1,\n \"b\": 2,\n \"a\": 3}", "scene.json:3: the key 'a' stands twice in one object");
  check_error(std::string(600, '[') + std::string(600, ']'), "scene.json:1: nested deeper than 512 levels");
  check_error("", "scene.json:1: the file is empty");
  check_error("// nothing\n", "scene.json:");
  check_error("[]", "scene.json:1: expected an object, found an array");
  check_error("3\n", "scene.json:1: expected an object, found a number");
  check_error("{}", "scene.json:1: nothing to trace");
  check_error("{" + kBall + "}", "scene.json:1: nothing to trace");
  check_error("{\"nodes\": [{\"name\": \"a\"}]}", "scene.json:1: nothing to trace");
}

TEST_CASE("Keys that are unknown are told with what may have been meant, wrong types with the key") {
  check_error("{\n\"node\": []}", "scene.json:2: node: unknown key (did you mean 'nodes'?); known are $schema,");
  check_error("{\"nodes\": [{},\n{\"tranform\":\n{}}]}",
              "scene.json:2: nodes[1].tranform: unknown key (did you mean 'transform'?)");
  check_error("{\"colour of the sky\": 1}", "scene.json:1: ['colour of the sky']: unknown key; known are");
  check_error("{\"camera\": {\"fov\": 3}}", "scene.json:1: camera.fov: unknown key; known are from, at");
  check_error("{\"nodes\": {}}", "scene.json:1: nodes: expected an array, found an object");
  check_error("{\"nodes\": [3]}", "scene.json:1: nodes[0]: expected an object, found a number");
  check_error("{\"nodes\": [{\"name\": 3}]}", "scene.json:1: nodes[0].name: expected a string, found a number");
  check_error("{\"nodes\": [{\"name\": \"a/b\"}]}", "scene.json:1: nodes[0].name: a name must not be empty, nor hold");
  check_error("{\"background\": [1, 2]}", "scene.json:1: background: expected 3 items, found 2");
  check_error("{\"background\": [1, -2, 3]}", "scene.json:1: background: a colour must not be negative");
  check_error("{\"background\":\n[1,\n\"x\", 3]}", "scene.json:3: background[1]: expected a number, found a string");
  check_error("{\"background\": [1, 2, 1e39]}", "scene.json:1: background[2]: too large for a 32-bit number");
  check_error("{\"background\": [1,\n1e39\n,\n2]}", "scene.json:2: background[1]: too large");  // ends with its line
  check_error("{\"lights\": [{\"color\": [1, 1, 1]}]}", "scene.json:1: lights[0]: the key 'position' is missing");
  check_error("{\"lights\": [{\"position\": [1, 1, 1], \"radius\": -1}]}",
              "scene.json:1: lights[0].radius: expected a number from 0 to");
  check_error("{\"effects\": {\"antialias\": 1}}", "scene.json:1: effects.antialias: expected true or false, found");
  check_error("{\"effects\": {\"model\": \"Paper\"}}", "scene.json:1: effects.model: expected \"paper\" or");
  check_error("{\"effects\": {\"depth\": 2.5}}", "scene.json:1: effects.depth: expected a whole number from 0 to 5");
  check_error("{\"camera\": {\"from\": [0, 0, 0]}}", "scene.json:1: camera: the key 'at' is missing");
  check_error("{\"camera\": {\"from\": [0, 0, 0], \"at\": [0, 0, 0]}}",
              "scene.json:1: camera: 'from' and 'at' must be");
  check_error("{\"camera\": {\"from\": [0, 0, 0], \"at\": [0, 1, 0]}}", "scene.json:1: camera: 'up' must not be zero");
  check_error("{\"camera\": {\"from\": [0, 0, 0], \"at\": [1, 1, 0],\n\"angle\": 180}}",
              "scene.json:2: camera.angle: expected degrees");
  check_error("{\"camera\": {\"from\": [0, 0, 0], \"at\": [1, 1, 0], \"width\": 0}}",
              "scene.json:1: camera.width: expected a whole number from 1 to 16384, found 0");
  check_error("{\"camera\": {\"from\": [0, 0, 0], \"at\": [1, 1, 0], \"shutter\": [1, 0]}}",
              "scene.json:1: camera.shutter: the shutter must not close before it opens");
}

TEST_CASE("Parts that are missing, wrong, or hold themselves are told") {
  check_error("{\"nodes\": [{\n\"part\": \"bell\"}], " + kBall + "}",
              "scene.json:2: nodes[0].part: no part is called 'bell' (did you mean 'ball'?)");
  check_error("{\"world\": [\"x\"]}", "scene.json:1: world[0]: no part is called 'x'; name it in 'parts', or write");
  check_error("{\"parts\": {\n\"a\": \"missing.obj\"}}", "scene.json:2: parts.a: no such file: 'missing.obj'");
  check_error("{\"parts\": {\"a\": \"\"}}", "scene.json:1: parts.a: no such file");
  check_error("{\"parts\": {\"a\": \"sphereflake:99\"}}", "scene.json:1: parts.a: 'sphereflake:99': the size must be");
  check_error("{\"parts\": {\"a\": 3}}", "scene.json:1: parts.a: expected a source as a string, or an object");
  check_error("{\"parts\": {\"a\": {}}}", "scene.json:1: parts.a: a part has either 'source', or 'nodes', or shapes");
  check_error("{\"parts\": {\"a\": {\"source\": \"cube\", \"nodes\": []}}}",
              "scene.json:1: parts.a: a part has either");
  check_error("{\"parts\": {\"a\": {\"nodes\": []}}}", "scene.json:1: parts.a.nodes: a part must not be empty");
  check_error("{\"parts\": {\"a\": {\"source\": \"cube\", \"material\": \"red\"}}, \"materials\": {\"rod\": {}}}",
              "scene.json:1: parts.a.material: no material is called 'red' (did you mean 'rod'?)");
  check_error("{\"parts\": {\"a\": {\"spheres\": [{\"center\": [0, 0, 0], \"radius\": 0}]}}}",
              "scene.json:1: parts.a.spheres[0].radius: a radius must be above 0");
  check_error("{\"parts\": {\"a\": {\"spheres\": [{\"center\": [0, 0, 0], \"radius\": 1e-60}]}}}",
              "scene.json:1: parts.a.spheres[0].radius: a radius must be above 0");
  check_error("{\"parts\": {\"a\": {\"spheres\": []}}}",
              "scene.json:1: parts.a.spheres: expected at least 1 item, found 0");
  check_error("{\"parts\": {\"a\": {\"discs\": [{\"radius\": 1, \"normal\": [0, 0, 0]}]}}}",
              "scene.json:1: parts.a.discs[0].normal: a normal must not be zero");
  check_error("{\"parts\": {\"a\": {\"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}}",
              "scene.json:1: parts.a.positions: positions need 'triangles'");
  check_error("{\"parts\": {\"a\": {\"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], \"triangles\": [[0, 1, 3]]}}}",
              "scene.json:1: parts.a.triangles[0][2]: expected a whole number from 0 to 2, found 3");
  check_error("{\"materials\": {\"m\": {\"diffuse\": 2}}}",
              "scene.json:1: materials.m.diffuse: expected a number from 0 to 1, found 2");
  check_error("{\"materials\": {\"m\": {\"diffuse_texture\": \"no.png\"}}}",
              "scene.json:1: materials.m.diffuse_texture: no.png: no such file");
  // Cycles, of parts and of files.
  check_error("{\"parts\": {\n\"a\": {\"nodes\": [{\"part\": \"b\"}]},\n\"b\": {\"nodes\": [{\"part\": \"a\"}]}}}",
              "scene.json:2: parts.a: this part holds itself");
  check_error("{\"parts\": {\"a\": \"scene.json\"}}",
              "scene.json:1: parts.a: a cycle: this file is being read already");
  const TemporaryFolder folder;
  folder.write("b.json", "{\"parts\":\n{\"c\": \"c.json\"}, \"world\": [\"c\"]}");
  folder.write("c.json", "{\"parts\":\n\n{\"b\": \"./../" + folder.path().filename().string() +
                             "/b.json\"}, \"world\": [\"b\"]}");
  CHECK_THROWS_WITH(read_scene(folder.path() / "b.json"),
                    Catch::Contains("c.json:3: parts.b: a cycle: this file is being read already"));
  // What is wrong in another file is told there.
  folder.write("d.json", "{\n\"oops\": 1}");
  folder.write("e.nff", "s 0 0 0\n");
  CHECK_THROWS_WITH(read_scene(folder.write("f.json", R"({"parts": {"d": "d.json"}})")),
                    Catch::Contains("d.json:2: oops: unknown key"));
  CHECK_THROWS_WITH(read_scene(folder.write("f.json", R"({"parts": {"e": "e.nff"}})")),
                    Catch::Contains("e.nff:1: s (sphere)"));
  CHECK_THROWS_WITH(read_scene(folder.write("f.json", R"({"parts": {"g": "g.ply"}})")),
                    Catch::Contains("no such file"));
}

TEST_CASE("Transforms that cannot be used are told") {
  check_transform_error(R"({"scale": 0})", ".scale: a scale of 0 makes the matrix singular");
  check_transform_error(R"({"scale": [1, 0, 1]})", ".scale: a scale of 0 makes the matrix singular");
  check_transform_error(R"({"scale": 1e-60})", ": the matrix is singular in 32 bits");
  check_transform_error(R"([{"scale": 1e30}, {"scale": 1e30}])", ": the matrix holds a value that is not finite in 32");
  check_transform_error(R"([{"scale": 1e-30}, {"scale": 1e-30}])", ": the matrix is singular in 32 bits");
  check_transform_error(R"({"matrix": [[1, 2, 3, 0], [2, 4, 6, 0], [0, 0, 1, 0]]})",
                        ".matrix: the matrix is singular in 32 bits");
  check_transform_error(R"({"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]})", ".matrix[0]: expected 4 items, found 3");
  check_transform_error(R"({"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]})", ".matrix: expected at most 4 items");
  check_transform_error(R"({"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]})",
                        ".matrix[3]: the last row must be 0 0 0 1");
  check_transform_error(R"({"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": 2})",
                        ".scale: unknown key; known are matrix");
  check_transform_error(R"({"shear": {"xx": 1}})", ".shear.xx: unknown key");
  check_transform_error(R"({"shear": {"xy": 1, "yx": 1}})", ".shear: the matrix is singular in 32 bits");
  check_transform_error(R"({"rotate": {"axis": [0, 0, 0], "degrees": 3}})", ".rotate.axis: an axis must not be zero");
  check_transform_error(R"({"rotate": {"axis": [0, 0, 1]}})", ".rotate: the key 'degrees' is missing");
  check_transform_error(R"({"rotate": {"quaternion": [0, 0, 0, 0]}})", ".rotate.quaternion: a quaternion must not be");
  check_transform_error(R"({"rotate": {"quaternion": [0, 0, 0, 1], "degrees": 3}})", ".rotate.degrees: unknown key");
  check_transform_error(R"({"rotate": 90})", ".rotate: expected an object, found a number");
  check_transform_error(R"({"translate": [0, 0, 1e40]})", ".translate[2]: too large for a 32-bit number");
  check_transform_error(R"("none")", ": expected an object or a list of objects");
  // What only the product is.
  const std::string nested =
      "{" + kBall + ",\n\"nodes\": [{\"name\": \"a\", \"transform\": {\"scale\": 1e-25},\n" +
      "\"children\": [{\"name\": \"b\", \"part\": \"ball\",\n\"transform\": {\"scale\": 1e-25}}]}]}";
  check_error(nested, "scene.json:3: node 'a/b': with the transforms around it, its matrix is singular in 32 bits");
  check_error("{" + kBall +
                  ", \"nodes\": [{\"name\": \"a\", \"part\": \"ball\",\n\"transform\": {\"scale\": 3.4e38, "
                  "\"translate\": [3e38, 0, 0]}}]}",
              "scene.json:1: node 'a': its geometry is too far out for 32-bit numbers");
}

TEST_CASE("Nodes with one name, too many, and keyframes out of order are told") {
  check_error("{" + kBall + ",\n\"nodes\": [{\"name\": \"a\"},\n{\"name\": \"a\"}]}",
              "scene.json:3: nodes[1]: there is another node 'a'; give it a name of its own");
  check_error(
      "{" + kBall + ", \"nodes\": [{\"name\": \"a\", \"part\": \"ball\", \"children\": [{\"name\": \"geometry\"}]}]}",
      "scene.json:1: nodes[0].children[0]: there is another node 'a/geometry'");
  check_error("{" + kBall + ", \"nodes\": [{\"part\": \"ball\",\n\"repeat\": {\"count\": 2000000, \"by\": {}}}]}",
              "scene.json:2: nodes[0].repeat.count: expected a whole number from 1 to 1048576, found 2000000");
  check_error("{" + kBall +
                  ", \"nodes\": [{\"part\": \"ball\", \"repeat\": [{\"count\": 2000, \"by\": {}},\n{\"count\": 2000, "
                  "\"by\": {}}]}]}",
              "scene.json:2: nodes[0].repeat[1]: the scene has more than 1048576 nodes");
  check_error("{" + kBall + ", \"nodes\": [{\"part\": \"ball\", \"repeat\": {\"count\": 2}}]}",
              "scene.json:1: nodes[0].repeat: the key 'by' is missing");
  check_error("{" + kBall + ", \"nodes\": [{\"part\": \"ball\", \"jitter\": {}}]}",
              "scene.json:1: nodes[0].jitter: only copies are jittered");
  check_error("{" + kBall +
                  ", \"nodes\": [{\"part\": \"ball\", \"jitter\": {\"scale\": [2, 1]}, \"repeat\": {\"count\": 2, "
                  "\"by\": {}}}]}",
              "scene.json:1: nodes[0].jitter.scale: expected the least and the largest factor");
  const auto with_keyframes = [](const std::string& rest, const std::string& keyframes) {
    return "{" + kBall + ", \"nodes\": [{\"part\": \"ball\"" + rest + ",\n\"keyframes\": " + keyframes + "}]}";
  };
  const std::string at = "scene.json:2: nodes[0].keyframes";
  check_error(with_keyframes("", R"([{"time": 1, "scale": 1}, {"time": 1, "scale": 2}])"),
              at + "[1].time: the times of");
  check_error(with_keyframes("", R"([{"time": 1}])"), at + "[0]: a keyframe has at least one of translate, rotate");
  check_error(with_keyframes("", "[]"), at + ": expected at least 1 item, found 0");
  check_error(with_keyframes("", R"([{"scale": 1}])"), at + "[0]: the key 'time' is missing");
  check_error(with_keyframes("", R"([{"time": 1, "shear": 2}])"), at + "[0].shear: unknown key");
  check_error(with_keyframes("", R"([{"time": 1, "scale": 1}, {"time": 2, "scale": -1}])"),
              at + "[1].scale: a scale that changes its sign");
  check_error(with_keyframes("", R"([{"time": 1, "scale": 0}])"), at + "[0].scale: a scale of 0");
  check_error(with_keyframes("", R"([{"time": 1, "scale": 1e-45}])"), at + "[0]: the matrix is singular in 32 bits");
  check_error(with_keyframes(R"(, "transform": {"shear": {"xy": 1}})", R"([{"time": 1, "scale": 1}])"),
              at + ": a node with keyframes takes its transform as one object");
  check_error(with_keyframes(R"(, "repeat": {"count": 2, "by": {}})", R"([{"time": 1, "scale": 1}])"),
              at + ": a repeated node has no keyframes");
}

TEST_CASE("Parts that double at each level and nests of files end with an error, in time") {
  std::string parts = kBall.substr(0, kBall.size() - 1);
  for (int i = 0; i < 40; ++i) {
    const std::string below = i == 0 ? "ball" : "p" + std::to_string(i - 1);
    parts += ",\n\"p" + std::to_string(i) + "\": {\"nodes\": [{\"part\": \"" + below + "\"}, {\"part\": \"" + below +
             "\"}]}";
  }
  CHECK(error_of("{" + parts + "}, \"nodes\": [{\"part\": \"p39\"}]}").find("more than 1048576 nodes") !=
        std::string::npos);
  // Named from the innermost on, each part holds the one read before; from the outermost on, all are open at once.
  std::string chain = "{\"parts\": {";
  for (int i = 100; i-- > 0;)
    chain += "\"p" + std::to_string(i) + "\": {\"nodes\": [{\"part\": \"p" + std::to_string(i - 1) + "\"}]}, ";
  CHECK(error_of(chain + "\"p-1\": {\"spheres\": [{\"center\": [0, 0, 0], \"radius\": 1}]}}}")
            .find("parts within parts are deeper than 64 levels") != std::string::npos);
  const TemporaryFolder folder;
  for (int i = 0; i < 80; ++i) {
    folder.write(std::to_string(i) + ".json",
                 "{\"parts\": {\"a\": \"" + std::to_string(i + 1) + ".json\"}, \"world\": [\"a\"]}");
  }
  folder.write("80.json", "{" + kBall + ", \"world\": [\"ball\"]}");
  CHECK_THROWS_WITH(read_scene(folder.path() / "0.json"), Catch::Contains("deeper than 64 levels"));
  CHECK(read_scene(folder.path() / "40.json").world_sphere_count() == 1);
}

TEST_CASE("A scene file cut short anywhere, or with any byte changed, is read or refused in one line") {
  const std::string text = R"({"camera": {"from": [1, 2, 3], "at": [0, 0, 0]}, "lights": [{"position": [1, 1, 1]}],
 "parts": {"a": {"spheres": [{"center": [0, 0, 0], "radius": 1}]}, "b": "cube"}, "world": ["a"],
 "nodes": [{"name": "n", "part": "b", "transform": {"scale": [1, 2, 3], "rotate": {"euler": [1, 2, 3]}}, "repeat": {"count": 3, "by": {"translate": [1, 0, 0]}}},
 {"part": "a", "keyframes": [{"time": 0, "translate": [0, 0, 0]}, {"time": 1, "scale": 2}]}]})";
  CHECK(error_of(text).empty());
  const TemporaryFolder folder;
  const auto attempt = [&](const std::string& changed) {
    try {
      const Scene scene = read_scene(folder.write("scene.json", changed));
      CHECK(placed_count(scene) > 0);
      for (const Node& node : scene.nodes) CHECK(std::string(transform_error(node.transform)).empty());
      return true;
    } catch (const InputError& error) {
      const std::string message = error.what();
      CHECK(message.find("scene.json:") != std::string::npos);
      CHECK(message.find('\n') == std::string::npos);
      CHECK(message.size() < 2000);
      return false;
    }
  };
  for (std::size_t i = 0; i < text.size(); ++i) CHECK_FALSE(attempt(text.substr(0, i)));
  std::size_t read = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Random random(7, 8, i);
    std::string changed = text;
    const char* const likely = "0123456789 -.e,:[]{}\"ab";
    changed[random.below(static_cast<std::uint32_t>(text.size()))] =
        random.below(4) == 0 ? static_cast<char>(1 + random.below(255)) : likely[random.below(23)];
    read += attempt(changed) ? 1 : 0;
  }
  CHECK(read > 20);
}
