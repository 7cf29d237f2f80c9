// SPDX-License-Identifier: MIT
// The NFF reader: counts of the SPD files, every statement, and what it says of files that are wrong.
#include <catch2/catch.hpp>

#include "scenes/builder.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

constexpr const char* kView = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 0.1\nresolution 64 32\n";

Scene read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("test.nff", text));
}

/// What the reader throws, without the folder in front; empty where it throws nothing.
std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  try {
    read_scene(folder.write("test.nff", text));
  } catch (const InputError& error) {
    const std::string message = error.what();
    return message.substr(message.find("test.nff"));
  }
  return {};
}

bool has_warning(const Scene& scene, const std::string& part) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(part) != warning.npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("SPD files have the published numbers of primitives and lights") {
  PLUMBLINE_NEEDS_DATA();
  struct Expected {
    const char* name;
    SourceCounts counts;
    std::size_t lights;
  };
  const Expected expected[] = {
      {"balls_s1", {.polygons = 1, .spheres = 10}, 3},
      {"balls_s2", {.polygons = 1, .spheres = 91}, 3},
      {"balls_s3", {.polygons = 1, .spheres = 820}, 3},
      {"balls_s4", {.polygons = 1, .spheres = 7381}, 3},
      {"balls_s2_t", {.polygons = 1, .patches = 9828}, 3},
      {"gears_s2", {.polygons = 1169}, 5},
      {"mount_s4", {.polygons = 512, .spheres = 4}, 1},
      {"rings_s3", {.polygons = 1, .spheres = 420, .cylinders = 420}, 3},
      {"tetra_s4", {.polygons = 256}, 1},
      {"teapot_s4", {.polygons = 16, .patches = 992}, 2},
      {"tree_s5", {.polygons = 1, .spheres = 63, .cones = 63}, 7},
      {"lattice_s3", {.spheres = 64, .cylinders = 144}, 6},
  };
  for (const Expected& e : expected) {
    INFO(e.name);
    const Scene scene = read_scene(data_folder() / "spd" / (std::string(e.name) + ".nff"));
    CHECK(scene.name == e.name);
    CHECK(scene.source.polygons == e.counts.polygons);
    CHECK(scene.source.patches == e.counts.patches);
    CHECK(scene.source.spheres == e.counts.spheres);
    CHECK(scene.source.cones == e.counts.cones);
    CHECK(scene.source.cylinders == e.counts.cylinders);
    CHECK(scene.source.total() == e.counts.total());
    CHECK(scene.lights.size() == e.lights);
    CHECK(scene.has_camera);
    CHECK(scene.camera.width == 512);
    CHECK(scene.background == glm::vec3(0.078f, 0.361f, 0.753f));
    const std::size_t prisms = scene.source.cones + scene.source.cylinders;
    CHECK(scene.warnings.size() == (prisms > 0 ? 1 : 0));
    if (prisms > 1) CHECK(has_warning(scene, std::to_string(prisms) + " in all)"));
  }
}

TEST_CASE("gears_s2: 16 concave polygons of 144 corners become 142 triangles each") {
  PLUMBLINE_NEEDS_DATA();
  const Scene scene = read_scene(data_folder() / "spd" / "gears_s2.nff");
  CHECK(scene.triangles.size() == 16 * 142 + (1169 - 16) * 2);
}

TEST_CASE("Every NFF statement is read, wherever its line breaks are") {
  const Scene scene = read_text(
      "# a comment\nb 0.1 0.2\n 0.3 # another\nl 1 2 3\nl 4 5 6 0.5 0.25 1\n"
      "f 1 0.5 0.25 0.8 0.2 10 0.5 1.5\ns 1 2 3 4 c\n0 0 0 1\n0 0 2 1\r\nc 0 0 0 1 0 0 2 0\n"
      "p 4 0 0 0 1 0 0 1 1 0 0 1 0\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 2\n" +
      std::string(kView));
  CHECK(scene.background == glm::vec3(0.1f, 0.2f, 0.3f));
  REQUIRE(scene.lights.size() == 2);
  CHECK_FALSE(scene.lights[0].has_color);
  CHECK(scene.lights[1].has_color);
  CHECK(scene.lights[1].color == glm::vec3(0.5f, 0.25f, 1.0f));
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].diffuse == 0.8f);
  CHECK(scene.materials[0].specular == 0.2f);
  CHECK(scene.materials[0].shine == 10.0f);
  CHECK(scene.materials[0].transmittance == 0.5f);
  CHECK(scene.materials[0].refraction_index == 1.5f);
  REQUIRE(scene.spheres.size() == 1);
  CHECK(scene.spheres[0].center == glm::vec3(1, 2, 3));
  CHECK(scene.spheres[0].radius == 4.0f);
  CHECK(scene.source.cylinders == 1);
  CHECK(scene.source.cones == 1);
  CHECK(scene.source.polygons == 1);
  CHECK(scene.source.patches == 1);
  // A cylinder's strips have two triangles; those of a cone that comes to a point have one.
  CHECK(scene.triangles.size() == 2 * kConeSides + kConeSides + 2 + 1);
  CHECK(scene.normals.back() == glm::vec3(0, 0, 2));
  CHECK(scene.camera.width == 64);
  CHECK(scene.camera.height == 32);
  CHECK(scene.camera.hither == 0.1f);
  CHECK(scene.camera.angle_radians == Approx(0.785398163));
}

TEST_CASE("Prisms lie on the cone and their normals point away from the axis") {
  const Scene scene = read_text(std::string("f 1 1 1 1 0 1 0 1\nc 1 2 3 0.5 1 2 7 0.25\n") + kView);
  REQUIRE(scene.triangles.size() == 2 * kConeSides);
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const auto corner = scene.corners(t);
    const glm::vec3 geometric = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const double radius = glm::length(glm::dvec2(corner[i].x - 1.0, corner[i].y - 2.0));
      CHECK(radius == Approx(corner[i].z == 3.0f ? 0.5 : 0.25).epsilon(1e-6));
      const glm::vec3 normal = scene.normals[scene.triangles[t].normal[i]];
      CHECK(glm::dot(normal, geometric) > 0.0f);
      // Along the side the surface does not change: the normal is at right angles to (outwards * -0.25, 4).
      const glm::vec2 outwards = glm::normalize(glm::vec2(normal));
      CHECK(std::abs(glm::dot(normal, glm::vec3(-0.25f * outwards, 4.0f))) < 4e-6f);
    }
  }
}

TEST_CASE("NFF that is wrong is refused with file and line") {
  const std::string material = "f 1 1 1 1 0 1 0 1\n";
  CHECK(error_of("s 0 0 0 1\ntess 4\n") == "test.nff:2: unknown keyword 'tess'; known are v b l f s c p pp");
  CHECK(error_of(material + "s 0 0 0 1 2 2\n") ==
        "test.nff:2: a stray number '2' where a keyword should be; known are v b l f s c p pp");
  CHECK(error_of("f 1 0 0\nhex 0 0 0 5\n").find("test.nff:2: f: Kd: expected a finite number, found 'hex'") == 0);
  CHECK(error_of(material + "s nan 0 0 1\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "s 0 inf 0 1\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "s 0 1e39 0 1\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "s 0 0 0").find("test.nff:2: s (sphere): the file ends before") == 0);
  CHECK(error_of(material + "p 999999999\n0 0 0\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "p 2\n0 0 0\n1 1 1\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "p 3.5\n0 0 0\n1 1 1\n").find("test.nff:2:") == 0);
  CHECK(error_of(material + "s 3e38 0 0 1\nc 0 0 3.4e38 3.4e38 0 0 1 3.4e38\nc 3.4e38 0 0 3.4e38 3.4e38 0 9 3.4e38")
            .find("too large") != std::string::npos);
  CHECK(
      error_of("v\nfrom 0 0 0\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\n").find("test.nff:1: camera:") ==
      0);
  CHECK(
      error_of("v\nfrom 0 1 0\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\n").find("test.nff:1: camera:") ==
      0);
  CHECK(
      error_of("v\nfrom 0 1 0\nat 0 0 0\nup 1 1 0\nangle 180\nhither 1\nresolution 4 4\n").find("test.nff:1: angle") ==
      0);
  CHECK(error_of("v\nfrom 0 1 0\nat 0 0 0\nup 1 1 0\nangle 45\nhither 1\nresolution 0 4\n")
            .find("test.nff:7: resolution") == 0);
  CHECK(error_of("v\nform 0 1 0\n").find("test.nff:2: v (viewpoint): expected 'from'") == 0);
  CHECK(error_of("b 0 0 0\n").find("nothing to trace") != std::string::npos);
}

TEST_CASE("NFF that can be mended is read with a warning") {
  const std::string material = "f 1 1 1 1 0 1 0 1\n";
  Scene scene = read_text("s 0 0 0 1\n" + std::string(kView));
  CHECK(has_warning(scene, "test.nff:1: no f statement"));
  CHECK(scene.materials.size() == 1);

  scene = read_text(material + "s 0 0 0 -2\ns 0 0 0 0\n" + kView);
  CHECK(scene.spheres.size() == 1);
  CHECK(scene.spheres[0].radius == 2.0f);
  CHECK(has_warning(scene, "test.nff:2: a negative radius"));
  CHECK(has_warning(scene, "test.nff:3: a sphere of radius 0"));

  scene = read_text(material + "s 0 0 0 1\np 3\n0 0 0\n1 1 1\n2 2 2\np 4 0 0 0 0 0 0 1 1 1 1 1 1\n" + kView);
  CHECK(scene.source.polygons == 2);
  CHECK(scene.triangles.empty());
  CHECK(has_warning(scene, "test.nff:3: a polygon without area is left out (2 in all)"));

  scene = read_text("f 1 1 1 2 -1 1 0 1 nothere.png\ns 0 0 0 1\n");
  CHECK(has_warning(scene, "test.nff:1: the texture 'nothere.png' is left out"));
  CHECK(has_warning(scene, "outside 0 to 1"));
  CHECK(has_warning(scene, "no viewpoint"));
  CHECK_FALSE(scene.has_camera);

  // Two edges of a bow tie cross at the middle: two triangles that share it.
  scene = read_text(material + "p 4\n0 0 0\n2 2 0\n2 0 0\n0 2 0\n" + kView);
  CHECK(has_warning(scene, "crosses itself"));
  CHECK(scene.triangles.size() == 2);
}
