// SPDX-License-Identifier: MIT
// Shared edges and closed surfaces, on meshes small enough to count.
#include <catch2/catch.hpp>
#include <chrono>

#include "scenes/generate.h"
#include "scenes/topology.h"

using namespace plumbline;

namespace {

Scene mesh(std::vector<glm::vec3> positions, std::vector<std::array<std::uint32_t, 3>> triangles) {
  Scene scene;
  scene.positions = std::move(positions);
  for (const auto& t : triangles) {
    scene.triangles.emplace_back();
    scene.triangles.back().position = t;
  }
  return scene;
}

}  // namespace

TEST_CASE("A cube: 8 vertices, 18 edges, each with two sides, one closed component") {
  const Topology topology = make_topology(generate_scene("cube"));
  CHECK(topology.vertex_count == 8);
  CHECK(topology.edge_count == 18);
  CHECK(topology.component_count == 1);
  CHECK(topology.is_closed(0));
  for (std::uint32_t t = 0; t < 12; ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto sides = topology.sides(t, i);
      REQUIRE(sides.size() == 2);
      CHECK(sides[0] < sides[1]);
      CHECK((sides[0] == 3 * t + static_cast<std::uint32_t>(i) || sides[1] == 3 * t + static_cast<std::uint32_t>(i)));
      CHECK(topology.share_an_edge(sides[0] / 3, sides[1] / 3));
    }
  }
  CHECK_FALSE(topology.is_closed(12));
  CHECK_FALSE(topology.is_closed(kNone));
}

TEST_CASE("A missing triangle opens a surface, one too many does too") {
  Scene scene = generate_scene("icosphere", 2);
  scene.triangles.pop_back();
  Topology topology = make_topology(scene);
  CHECK(topology.component_count == 1);
  CHECK_FALSE(topology.is_closed(0));
  std::size_t borders = 0;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) borders += topology.sides(t, i).size() == 1 ? 1 : 0;
  }
  CHECK(borders == 3);

  scene = generate_scene("icosphere", 2);
  const auto p = scene.triangles[0].position;
  scene.positions.emplace_back(9, 9, 9);
  scene.triangles.emplace_back();
  scene.triangles.back().position = {p[0], p[1], static_cast<std::uint32_t>(scene.positions.size() - 1)};
  topology = make_topology(scene);
  CHECK(topology.sides(0, 0).size() == 3);
  CHECK_FALSE(topology.is_closed(0));
}

TEST_CASE("Vertices are told by their numbers, not by their indices: +0 is -0, neighbouring floats are not one") {
  const float next = std::nextafter(1.0f, 2.0f);
  const Scene scene = mesh({{0.0f, 0, 0},
                            {1, 0, 0},
                            {0, 1, 0},
                            {-0.0f, 0, -0.0f},
                            {1, -0.0f, 0},
                            {0, 0, 1},
                            {0, 0, 0},
                            {next, 0, 0},
                            {0, 0, 2}},
                           {{0, 1, 2}, {4, 3, 5}, {6, 7, 8}});
  const Topology topology = make_topology(scene);
  CHECK(topology.share_an_edge(0, 1));
  CHECK_FALSE(topology.share_an_edge(0, 2));
  CHECK(topology.share_a_corner(0, 2));
  CHECK(topology.component_count == 2);
  CHECK(topology.vertex_count == 6);
}

TEST_CASE("Triangles with a corner twice, isolated ones and none at all") {
  const Topology topology = make_topology(mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 2}, {0, 1, 2}}));
  CHECK(topology.sides(0, 0).empty());
  CHECK(topology.sides(0, 1).size() == 4);
  CHECK_FALSE(topology.is_closed(0));
  CHECK(topology.sides(1, 1).size() == 2);
  CHECK(make_topology(Scene{}).component_count == 0);
}

TEST_CASE("A million triangles take about a second") {
  const Scene scene = generate_scene("torus", 1'000'000);
  const auto start = std::chrono::steady_clock::now();
  const Topology topology = make_topology(scene);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  CHECK(topology.is_closed(0));
  CHECK(topology.edge_count == scene.triangles.size() * 3 / 2);
}

TEST_CASE("A closed surface with one triangle turned over is oriented again") {
  Scene scene = generate_scene("icosphere");
  CHECK(make_topology(scene).turned == std::vector<std::uint8_t>(scene.triangles.size(), 0));
  std::swap(scene.triangles[5].position[1], scene.triangles[5].position[2]);
  const Topology topology = make_topology(scene);
  REQUIRE(topology.component_orientable == std::vector<std::uint8_t>{1});
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) CHECK(topology.turned[t] == (t == 5 ? 1 : 0));
}

TEST_CASE("A closed surface with one side only cannot be oriented") {
  // The real projective plane with six corners: the hemi-icosahedron.
  Scene scene;
  scene.materials.emplace_back();
  for (int i = 0; i < 6; ++i)
    scene.positions.emplace_back(static_cast<float>(i), static_cast<float>(i * i), static_cast<float>(i * i * i));
  for (const std::array<std::uint32_t, 3> f : {std::array<std::uint32_t, 3>{0, 1, 2},
                                               {0, 2, 3},
                                               {0, 3, 4},
                                               {0, 4, 5},
                                               {0, 5, 1},
                                               {1, 2, 4},
                                               {2, 3, 5},
                                               {3, 4, 1},
                                               {4, 5, 2},
                                               {5, 1, 3}})
    scene.triangles.push_back({f});
  const Topology topology = make_topology(scene);
  CHECK(topology.component_closed == std::vector<std::uint8_t>{1});
  CHECK(topology.component_orientable == std::vector<std::uint8_t>{0});
}

TEST_CASE("Parts are surfaces of their own, though their corners have the same numbers") {
  // Two cubes at the same numbers, one of the world and one a part, and half of a third.
  Scene scene = generate_scene("cube");
  const Scene cube = scene;
  for (const std::uint32_t count : {12u, 6u}) {
    Part part;
    part.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
    part.triangle_count = count;
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), cube.positions.begin(), cube.positions.end());
    for (std::uint32_t t = 0; t < count; ++t) {
      scene.triangles.push_back(cube.triangles[t]);
      for (std::uint32_t& p : scene.triangles.back().position) p += first;
    }
    scene.parts.push_back(part);
  }
  const Topology topology = make_topology(scene);
  CHECK(topology.vertex_count == 24);
  CHECK(topology.component_count >= 3);
  for (std::uint32_t t = 0; t < 24; ++t) CHECK(topology.is_closed(t));
  for (std::uint32_t t = 24; t < 30; ++t) CHECK_FALSE(topology.is_closed(t));
  CHECK_FALSE(topology.share_a_corner(0, 12));
  CHECK_FALSE(topology.share_an_edge(12, 24));
  CHECK(topology.sides(12, 0).size() == 2);
}
