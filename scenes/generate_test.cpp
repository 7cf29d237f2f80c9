// SPDX-License-Identifier: MIT
// Generators against the SPD programs' own output, and the meshes' promises: counts, closedness, outward winding.
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/read.h"
#include "scenes/test_files.h"
#include "scenes/topology.h"

using namespace plumbline;

namespace {

/// SPD prints six significant digits: half a unit of the sixth, and the rounding of both numbers to floats.
double printed_error(double value) {
  const double size = std::abs(value);
  if (size == 0.0) return 1e-15;  // numbers that are zero but for rounding are printed as 1.11022e-16
  return 0.5 * std::pow(10.0, std::floor(std::log10(size)) - 5.0) * 1.0001 + size * 0x1p-23 + 1e-15;
}

bool same(double a, double b) { return std::abs(a - b) <= printed_error(std::max(std::abs(a), std::abs(b))); }
bool same(const glm::vec3& a, const glm::vec3& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

void check_same(const Scene& made, const Scene& read, bool compare_prisms = true) {
  CHECK(made.source.polygons == read.source.polygons);
  CHECK(made.source.spheres == read.source.spheres);
  CHECK(made.source.cylinders == read.source.cylinders);
  REQUIRE(made.spheres.size() == read.spheres.size());
  std::size_t wrong_spheres = 0, wrong_corners = 0, wrong_materials = 0;
  for (std::size_t i = 0; i < made.spheres.size(); ++i) {
    wrong_spheres +=
        same(made.spheres[i].center, read.spheres[i].center) && same(made.spheres[i].radius, read.spheres[i].radius)
            ? 0
            : 1;
  }
  CHECK(wrong_spheres == 0);
  REQUIRE(made.triangles.size() == read.triangles.size());
  for (std::uint32_t t = 0; t < made.triangles.size() && compare_prisms; ++t) {
    for (std::size_t i = 0; i < 3; ++i) wrong_corners += same(made.corners(t)[i], read.corners(t)[i]) ? 0 : 1;
  }
  CHECK(wrong_corners == 0);
  // Materials may be numbered otherwise (SPD repeats them): each primitive's counts.
  const auto same_material = [&](std::uint32_t a, std::uint32_t b) {
    const Material &m = made.materials[a], &r = read.materials[b];
    return same(m.color, r.color) && same(m.diffuse, r.diffuse) && same(m.specular, r.specular) &&
           same(m.shine, r.shine) && same(m.transmittance, r.transmittance) &&
           same(m.refraction_index, r.refraction_index);
  };
  for (std::size_t i = 0; i < made.spheres.size(); ++i)
    wrong_materials += same_material(made.spheres[i].material, read.spheres[i].material) ? 0 : 1;
  for (std::size_t i = 0; i < made.triangles.size(); ++i)
    wrong_materials += same_material(made.triangles[i].material, read.triangles[i].material) ? 0 : 1;
  CHECK(wrong_materials == 0);
  REQUIRE(made.lights.size() == read.lights.size());
  for (std::size_t i = 0; i < made.lights.size(); ++i) {
    CHECK(same(made.lights[i].position, read.lights[i].position));
    CHECK(made.lights[i].has_color == read.lights[i].has_color);
  }
  CHECK(same(made.camera.from, read.camera.from));
  CHECK(same(made.camera.at, read.camera.at));
  CHECK(same(made.camera.up, read.camera.up));
  CHECK(made.camera.angle_radians == read.camera.angle_radians);
  CHECK(made.camera.hither == read.camera.hither);
  CHECK(made.camera.width == read.camera.width);
  CHECK(made.background == read.background);
  CHECK(made.has_camera == read.has_camera);
}

/// Six times the volume inside a closed surface: positive where it is wound outwards.
double volume(const Scene& scene) {
  double sum = 0.0;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const auto c = scene.corners(t);
    sum += glm::dot(glm::dvec3(c[0]), glm::cross(glm::dvec3(c[1]), glm::dvec3(c[2])));
  }
  return sum;
}

}  // namespace

TEST_CASE("Generators equal the SPD programs' output") {
  PLUMBLINE_NEEDS_DATA();
  const auto spd = [](const char* name) { return read_scene(data_folder() / "spd" / (std::string(name) + ".nff")); };
  for (const int size : {1, 2, 3, 4}) {
    INFO("sphereflake " << size);
    check_same(generate_scene("sphereflake", size), spd(("balls_s" + std::to_string(size)).c_str()));
  }
  {
    INFO("mount");
    check_same(generate_scene("mount", 4), spd("mount_s4"));
  }
  {
    INFO("tetra");
    check_same(generate_scene("tetra", 4), spd("tetra_s4"));
  }
  {
    // The cylinders' ends are compared by the spheres upon them; where a prism's corners lie depends on the last
    // digits.
    INFO("rings");
    check_same(generate_scene("rings", 3), spd("rings_s3"), false);
  }
  {
    INFO("gears");
    check_same(generate_scene("gears", 2), spd("gears_s2"));
  }
}

TEST_CASE("The sphereflake's spheres touch their parents, whatever the size") {
  const Scene scene = generate_scene("sphereflake", 5);
  CHECK(scene.spheres.size() == 1 + 9 + 81 + 729 + 6561 + 59049);
  CHECK(scene.name == "sphereflake_5");
  // Depth first: the spheres of each radius in the order of their parents.
  std::vector<Sphere> parents;
  std::size_t wrong = 0;
  for (const Sphere& sphere : scene.spheres) {
    while (!parents.empty() && !(sphere.radius < 0.5f * parents.back().radius)) parents.pop_back();
    if (!parents.empty()) {
      const double gap = glm::length(glm::dvec3(sphere.center) - glm::dvec3(parents.back().center)) -
                         (static_cast<double>(sphere.radius) + static_cast<double>(parents.back().radius));
      wrong += std::abs(gap) <= 8.0 * 0x1p-24 ? 0 : 1;  // eight floats around 1, rounded
    }
    parents.push_back(sphere);
  }
  CHECK(wrong == 0);
}

TEST_CASE("The creature has 882 triangles and is closed, in one piece, wound outwards, smooth") {
  const Scene scene = generate_scene("creature");
  CHECK(scene.name == "creature");
  REQUIRE(scene.triangles.size() == 882);
  CHECK(scene.spheres.empty());
  const Topology topology = make_topology(scene);
  CHECK(topology.component_count == 1);
  CHECK(topology.component_closed[0] == 1);
  for (std::uint32_t t = 0; t < 882; ++t) {
    for (int i = 0; i < 3; ++i) CHECK(topology.sides(t, i).size() == 2);
  }
  CHECK(volume(scene) > 0.0);
  // Star-shaped: seen from the middle every triangle faces away, so the surface cannot cross itself.
  for (std::uint32_t t = 0; t < 882; ++t) {
    const auto c = scene.corners(t);
    CHECK(glm::dot(glm::dvec3(c[0]), glm::cross(glm::dvec3(c[1]), glm::dvec3(c[2]))) > 0.0);
    for (const std::uint32_t n : scene.triangles[t].normal) {
      REQUIRE(n < scene.normals.size());
      CHECK(glm::length(scene.normals[n]) == Approx(1.0f));
    }
  }
}

TEST_CASE("Meshes have the number of triangles asked for, closed where they say so") {
  for (const int count : {1, 2, 7, 8, 999, 1000, 50'001})
    CHECK(generate_scene("grid", count).triangles.size() == static_cast<std::size_t>(count));
  const Topology grid = make_topology(generate_scene("grid", 1000));
  CHECK(grid.component_count == 1);
  CHECK_FALSE(grid.is_closed(0));
  for (const int count : {18, 100, 10'000}) {
    const Scene torus = generate_scene("torus", count);
    CHECK(std::abs(static_cast<double>(torus.triangles.size()) - count) < 0.2 * count);
    CHECK(make_topology(torus).is_closed(0));
    CHECK(volume(torus) > 0.0);
  }
  const Scene ball = generate_scene("icosphere", 3);
  CHECK(ball.triangles.size() == 1280);
  CHECK(make_topology(ball).is_closed(0));
  CHECK(make_topology(ball).vertex_count == 642);
  CHECK(volume(ball) == Approx(6.0 * 4.0 / 3.0 * 3.14159).epsilon(0.02));
  const Scene cube = generate_scene("cube");
  CHECK(make_topology(cube).is_closed(11));
  CHECK(volume(cube) == 48.0);
}

TEST_CASE("Tetrahedra are closed one by one, and touch at corners only") {
  const Topology topology = make_topology(generate_scene("tetra", 3));
  CHECK(topology.component_count == 16);
  for (std::uint32_t t = 0; t < 64; ++t) CHECK(topology.is_closed(t));
}

TEST_CASE("Every generator makes its default scene, with a material for each primitive and a camera") {
  for (const Generator& generator : generators()) {
    INFO(generator.name);
    const Scene scene = load_scene(generator.name);
    CHECK(scene.primitive_count() > 0);
    CHECK(scene.has_camera);
    CHECK_FALSE(scene.lights.empty());
    CHECK(scene.warnings.empty());
    std::size_t wrong = 0;
    for (const Triangle& triangle : scene.triangles) wrong += triangle.material < scene.materials.size() ? 0 : 1;
    for (const Sphere& sphere : scene.spheres)
      wrong += sphere.material < scene.materials.size() && sphere.radius > 0.0f ? 0 : 1;
    CHECK(wrong == 0);
    CHECK(bounding_ball(scene).radius > 0.0);
  }
}

TEST_CASE("What load_scene does not know it says, with what it knows") {
  const auto message = [](std::string_view spec) -> std::string {
    try {
      load_scene(spec);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  CHECK(load_scene("tetra:2").name == "tetra_2");
  CHECK(message("sphereflake:99").find("from 1 to 6") != std::string::npos);
  CHECK(message("sphereflake:x").find("whole number") != std::string::npos);
  CHECK(message("sphereflake:-1").find("whole number") != std::string::npos);
  CHECK(message("grid:0").find("from 1 to") != std::string::npos);
  CHECK(message("teapott").find("neither a file nor a generator") != std::string::npos);
  CHECK(message("teapott").find("sphereflake") != std::string::npos);
  CHECK(message("teapott").find(".nff") != std::string::npos);
  CHECK_THROWS_AS(generate_scene("nothing"), InputError);
}
