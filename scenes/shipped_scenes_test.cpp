// SPDX-License-Identifier: MIT
// The scene files that come with Plumbline: they load by name and by path, hold what they promise, and keep to the
// schema's keys.

// gcc 12 takes valijson's use of std::regex for reading uninitialized memory where sanitizers are on (gcc bug 105562).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "scenes/camera.h"
#include "scenes/generate.h"
#include "scenes/read.h"
#include "scenes/test_files.h"
#include "scenes/text_file.h"

using namespace plumbline;

namespace {

struct Promise {
  std::size_t nodes, instances, parts, animated;
  std::uint64_t placed;
};

double determinant(const Scene& scene, std::uint32_t instance) {
  return glm::determinant(to_world(scene, instance).linear);
}

/// Largest by least singular value.
double anisotropy(const glm::dmat3& m) { return largest_stretch(m) * largest_stretch(glm::inverse(m)); }

}  // namespace

TEST_CASE("Every shipped scene loads, by name and by path, and holds what it promises") {
  const std::map<std::string, Promise> promises = {
      {"around_eye", {38, 34, 4, 0, 12689}}, {"crowd", {10000, 10000, 1, 0, 8820000}},
      {"ellipsoids", {13, 9, 3, 0, 13}},     {"far_away", {7, 5, 3, 0, 910}},
      {"figure_1", {29, 23, 3, 1, 1767}},    {"mirror", {14, 11, 3, 0, 2700}},
      {"nested", {36, 24, 4, 0, 3852}},      {"overlap", {30, 29, 3, 0, 2861}},
      {"scales", {23, 16, 3, 0, 6016}},      {"shear", {8, 7, 4, 0, 1000}},
      {"walk", {39, 21, 4, 19, 2524}}};
  std::vector<std::string> names;
  for (const auto& [name, promise] : promises) names.push_back(name);
  CHECK(shipped_scenes() == names);
  for (const auto& [name, promise] : promises) {
    INFO(name);
    const Scene scene = load_scene(name);
    CHECK(scene.name == name);
    CHECK(scene.warnings.empty());
    CHECK(scene.nodes.size() == promise.nodes);
    CHECK(instances_of(scene).size() == promise.instances);
    CHECK(scene.parts.size() == promise.parts);
    CHECK(scene.animation.size() == promise.animated);
    CHECK(placed_count(scene) == promise.placed);
    CHECK(scene.has_camera);
    CHECK(scene.lights.size() >= 1);
    CHECK_NOTHROW(camera_frame(scene.camera));
    CHECK(load_scene("scenes/" + name + ".json").nodes.size() == promise.nodes);
    for (const Node& node : scene.nodes) CHECK(node.transform == node.rest);
    for (const Animation& animation : scene.animation)
      CHECK(scene.nodes[animation.node].transform == transform_at(animation, 0.0));
  }
}

TEST_CASE("Shipped scenes are what their names say") {
  const Scene mirror = load_scene("mirror");
  std::size_t mirrored = 0, straight = 0;
  for (const std::uint32_t i : instances_of(mirror)) ++(determinant(mirror, i) < 0.0 ? mirrored : straight);
  CHECK((mirrored >= 4 && straight >= 4));

  const Scene scales = load_scene("scales");
  double least = 1e9, most = 0.0;
  for (const std::uint32_t i : instances_of(scales)) {
    const double stretch = largest_stretch(to_world(scales, i).linear);
    least = std::min(least, stretch);
    most = std::max(most, stretch);
  }
  CHECK(least == Approx(2e-3).epsilon(0.01));
  CHECK(most == Approx(2e3).epsilon(0.01));

  const Scene far_away = load_scene("far_away");
  const Ball ball = bounding_ball(far_away);
  CHECK(glm::length(ball.center) > 1e5 * 2.0 * ball.radius);
  CHECK(glm::length(glm::dvec3(far_away.camera.from) - ball.center) < 4.0 * ball.radius);

  const Scene shear = load_scene("shear");
  std::size_t sheared = 0;
  for (const std::uint32_t i : instances_of(shear)) {
    const glm::dmat3 m = to_world(shear, i).linear;
    const double skew = std::abs(glm::dot(glm::normalize(m[0]), glm::normalize(m[1])));
    sheared += skew > 0.1 ? 1 : 0;
  }
  CHECK(sheared >= 4);

  const Scene ellipsoids = load_scene("ellipsoids");
  CHECK(ellipsoids.triangles.empty());
  double flattest = 1.0;
  for (const std::uint32_t i : instances_of(ellipsoids))
    flattest = std::max(flattest, anisotropy(to_world(ellipsoids, i).linear));
  CHECK(flattest > 50.0);

  // One pair of boxes of "overlap" is coincident bit for bit, whatever way each took there.
  const Scene overlap = load_scene("overlap");
  const auto find = [&](const std::string& name) {
    for (std::uint32_t n = 0; n < overlap.nodes.size(); ++n)
      if (overlap.nodes[n].name == name) return n;
    FAIL("no node " << name);
    return kNone;
  };
  const TransformD box = to_world(overlap, find("box"));
  for (const char* const same : {"same", "same, in steps/box"}) {
    const TransformD other = to_world(overlap, find(same));
    CHECK(other.linear == box.linear);
    CHECK(other.translation == box.translation);
  }
  // A quarter turn is exact: every corner of the box falls on one of the box.
  const TransformD turned = to_world(overlap, find("same, turned"));
  for (const glm::vec3& corner : load_scene("cube").positions) {
    const glm::dvec3 p = transform_point(turned, glm::dvec3(corner)) - box.translation;
    CHECK(glm::abs(p) == glm::dvec3(0.5));
  }

  // Instances before and behind the eye, and one around it.
  const Scene around = load_scene("around_eye");
  std::size_t behind = 0, before = 0;
  for (const std::uint32_t i : instances_of(around)) {
    const Ball of_part = bounding_ball(around, around.parts[around.nodes[i].part]);
    const glm::dvec3 center = transform_point(to_world(around, i), of_part.center);
    ++(center.z > 0.0 ? behind : before);
  }
  CHECK((behind >= 5 && before >= 5));

  // Parts are shared: one creature, whatever the crowd.
  CHECK(load_scene("crowd").triangles.size() == 882);
  const Scene figure = load_scene("figure_1");
  CHECK(figure.camera.width == 640);
  CHECK(figure.camera.aperture > 0.0f);
  CHECK(figure.camera.shutter_close > figure.camera.shutter_open);
  CHECK(figure.effects.glossy > 0.0f);
}

TEST_CASE("The crowd stands in a square, row by row, within its jitter") {
  const Scene crowd = load_scene("crowd");
  CHECK(crowd.nodes[0].name == "creature.0");
  CHECK(crowd.nodes[9999].name == "creature.9999");
  std::set<double> scales;
  for (std::uint32_t n = 0; n < crowd.nodes.size(); ++n) {
    const double column = n % 100, row = n / 100;  // the first repetition runs fastest
    const glm::dvec3 t(crowd.nodes[n].transform.translation);
    CHECK(std::abs(t.x - (-148.5 + 3.0 * column)) <= 0.5001);
    CHECK(std::abs(t.z - (-148.5 + 3.0 * row)) <= 0.5001);
    const double scale = std::cbrt(glm::determinant(glm::dmat3(crowd.nodes[n].transform.linear)));
    CHECK((scale > 0.5999 && scale < 1.1001));
    scales.insert(scale);
  }
  CHECK(scales.size() > 9'900);  // no two alike
}

TEST_CASE("Shipped scenes and the documentation's example keep to the schema, and the example reads") {
  std::ifstream schema_file("scenes/scene.schema.json");
  valijson::Schema schema;
  valijson::SchemaParser parser;
  const nlohmann::json schema_json = nlohmann::json::parse(schema_file);
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
  const auto keeps_to_schema = [&](const std::string& text) {
    const nlohmann::json json = nlohmann::json::parse(text, nullptr, true, true);
    const valijson::adapters::NlohmannJsonAdapter adapter(json);
    return valijson::Validator().validate(schema, adapter, nullptr);
  };
  for (const std::string& name : shipped_scenes()) {
    INFO(name);
    const std::string text = read_text_file("scenes/" + name + ".json");
    CHECK(keeps_to_schema(text));
    std::string misspelt = text;
    misspelt.replace(misspelt.find("\"nodes\""), 7, "\"nodez\"");
    CHECK_FALSE(keeps_to_schema(misspelt));
  }
  for (const std::string& name : picture_scenes()) {
    INFO(name);
    CHECK(keeps_to_schema(read_text_file("scenes/pictures/" + name + ".json")));
  }
  const std::string page = read_text_file("scenes/SCENE_FILES.md");
  const std::size_t start = page.find("```jsonc\n") + 9, end = page.find("```", start);
  const std::string example = page.substr(start, end - start);
  CHECK(keeps_to_schema(example));
  const TemporaryFolder folder;
  folder.write("bunny.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("car.json", R"({"world": [{"source": "cube"}]})");
  const Scene scene = read_scene(folder.write("example.json", example));
  CHECK(instances_of(scene).size() == 1 + 2 + 10'000);
  CHECK(scene.animation.size() == 1);
}

TEST_CASE("Shipped scenes are found from anywhere, and files go before them") {
  const std::filesystem::path before = std::filesystem::current_path();
  const TemporaryFolder folder;
  std::filesystem::current_path(folder.path());
  const std::size_t nodes = load_scene("nested").nodes.size();
  std::filesystem::current_path(before);
  CHECK(nodes == 36);
  CHECK_THROWS_WITH(load_scene("nestet"), Catch::Contains("scenes are around_eye, crowd, "));
}
