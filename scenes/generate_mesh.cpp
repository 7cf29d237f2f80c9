// SPDX-License-Identifier: MIT
#include "scenes/generate_mesh.h"

#include <array>
#include <cmath>
#include <unordered_map>

#include "scenes/builder.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr double kTwoPi = 6.283185307179586;

void add_triangle(Scene& scene, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Triangle triangle;
  triangle.position = {a, b, c};
  scene.triangles.push_back(triangle);
}

/// Normals, counts, a view that frames the mesh, two lights and one material.
void finish(Scene& scene, const glm::vec3& color, bool is_smooth) {
  if (is_smooth) add_smooth_normals(scene);
  (is_smooth ? scene.source.patches : scene.source.polygons) = scene.triangles.size();
  Material material;
  material.color = color;
  material.diffuse = 0.8f;
  material.specular = 0.2f;
  material.shine = 30.0f;
  add_material(scene, material);
  frame_camera(scene);
  scene.has_camera = true;
  const Ball ball = bounding_ball(scene);
  for (const glm::dvec3& towards : {glm::dvec3(2.0, 3.0, 4.0), glm::dvec3(-4.0, 2.0, 1.0)}) {
    Light light;
    light.position = glm::vec3(ball.center + ball.radius * towards);
    scene.lights.push_back(light);
  }
  scene.background = {0.078f, 0.361f, 0.753f};
}

/// How far the creature's skin is from its middle in a direction: a body, and limbs as smooth lobes around their
/// directions.
double creature_radius(const glm::dvec3& direction) {
  struct Lobe {
    glm::dvec3 towards;
    double length, sharpness;
  };
  static const std::array<Lobe, 11> kLobes = {{
      {{0.0, 0.35, 1.0}, 0.75, 9.0},     // head
      {{0.0, 0.05, 1.0}, 0.30, 30.0},    // snout
      {{0.45, 1.0, 0.95}, 0.35, 60.0},   // ears
      {{-0.45, 1.0, 0.95}, 0.35, 60.0},  //
      {{0.0, 0.30, -1.0}, 0.90, 25.0},   // tail
      {{0.75, -0.9, 0.55}, 0.70, 28.0},  // legs
      {{-0.75, -0.9, 0.55}, 0.70, 28.0},
      {{0.75, -0.9, -0.55}, 0.70, 28.0},
      {{-0.75, -0.9, -0.55}, 0.70, 28.0},
      {{0.0, 1.0, -0.15}, 0.15, 20.0},  // hump
      {{0.0, -1.0, 0.0}, 0.10, 6.0},    // belly
  }};
  double radius = 0.5;
  for (const Lobe& lobe : kLobes) {
    radius += lobe.length * std::exp(lobe.sharpness * (glm::dot(direction, glm::normalize(lobe.towards)) - 1.0));
  }
  return radius;
}

}  // namespace

Scene make_creature(int) {
  // Circles of latitude around the axis from tail to snout: two caps and 20 bands of 21 sides are 2 * 21 * 21 = 882
  // triangles. Along each direction from the middle lies one point of the skin, so it cannot cross itself.
  constexpr int kSides = 21, kCircles = 21;
  Scene scene;
  const auto add = [&](const glm::dvec3& direction) {
    scene.positions.push_back(glm::vec3(direction * creature_radius(direction)));
  };
  add({0, 0, 1});
  for (int circle = 0; circle < kCircles; ++circle) {
    const double polar = 0.5 * kTwoPi * (circle + 1) / (kCircles + 1);
    for (int side = 0; side < kSides; ++side) {
      const double angle = kTwoPi * side / kSides;
      add({std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)});
    }
  }
  add({0, 0, -1});
  const auto at = [&](int circle, int side) { return static_cast<std::uint32_t>(1 + circle * kSides + side % kSides); };
  const auto last = static_cast<std::uint32_t>(scene.positions.size() - 1);
  for (int side = 0; side < kSides; ++side) add_triangle(scene, 0, at(0, side), at(0, side + 1));
  for (int circle = 0; circle + 1 < kCircles; ++circle) {
    for (int side = 0; side < kSides; ++side) {
      add_triangle(scene, at(circle, side), at(circle + 1, side), at(circle + 1, side + 1));
      add_triangle(scene, at(circle, side), at(circle + 1, side + 1), at(circle, side + 1));
    }
  }
  for (int side = 0; side < kSides; ++side)
    add_triangle(scene, at(kCircles - 1, side), last, at(kCircles - 1, side + 1));
  finish(scene, {0.55f, 0.68f, 0.35f}, true);
  return scene;
}

Scene make_grid(int triangles) {
  Scene scene;
  const int cells = (triangles + 1) / 2;
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(cells))));
  const int rows = (cells + columns - 1) / columns;
  scene.positions.reserve(static_cast<std::size_t>(columns + 1) * static_cast<std::size_t>(rows + 1));
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double x = 2.0 * column / columns - 1.0, y = 2.0 * row / columns - 1.0;
      // Hills, and roughness of about a cell's width so that neighbouring triangles are never in one plane.
      Random random(0, name_hash("grid"), scene.positions.size());
      const double z = 0.15 * std::sin(5.0 * x + 1.0) * std::cos(4.0 * y) + 0.05 * std::sin(17.0 * x * y + 3.0 * y) +
                       random.uniform(-0.3, 0.3) / columns;
      scene.positions.push_back(glm::vec3(glm::dvec3(x, y, z)));
    }
  }
  scene.triangles.reserve(static_cast<std::size_t>(triangles));
  for (int i = 0; i < triangles; ++i) {
    const int cell = i / 2;
    const auto a = static_cast<std::uint32_t>(cell / columns * (columns + 1) + cell % columns);
    const std::uint32_t above = a + static_cast<std::uint32_t>(columns) + 1;
    if (i % 2 == 0) {
      add_triangle(scene, a, a + 1, above + 1);
    } else {
      add_triangle(scene, a, above + 1, above);
    }
  }
  finish(scene, {0.6f, 0.55f, 0.45f}, false);
  return scene;
}

Scene make_torus(int triangles) {
  Scene scene;
  // Three sides at least around the tube and along the ring; twice as many along it, so that cells are about square.
  const int around = std::max(3, static_cast<int>(std::lround(std::sqrt(triangles / 4.0))));
  const int along = std::max(3, static_cast<int>(std::lround(triangles / 2.0 / around)));
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      const double u = kTwoPi * i / along, v = kTwoPi * j / around;
      Random random(0, name_hash("torus"), scene.positions.size());
      const double tube = 0.35 + 0.05 * std::sin(7.0 * u) * std::cos(3.0 * v) + random.uniform(-0.2, 0.2) / around;
      const double ring = 1.0 + tube * std::cos(v);
      scene.positions.push_back(glm::vec3(glm::dvec3(ring * std::cos(u), ring * std::sin(u), tube * std::sin(v))));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i % along * around + j % around); };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      add_triangle(scene, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(scene, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  finish(scene, {0.7f, 0.4f, 0.35f}, false);
  return scene;
}

Scene make_icosphere(int divisions) {
  Scene scene;
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  const auto add = [&](const glm::dvec3& p) { scene.positions.push_back(glm::vec3(glm::normalize(p))); };
  for (const double y : {golden, -golden}) {
    for (const double x : {-1.0, 1.0}) add({x, y, 0.0});
  }
  for (const double z : {golden, -golden}) {
    for (const double y : {-1.0, 1.0}) add({0.0, y, z});
  }
  for (const double x : {golden, -golden}) {
    for (const double z : {-1.0, 1.0}) add({x, 0.0, z});
  }
  constexpr std::array<std::array<std::uint32_t, 3>, 20> kFaces = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (const auto& face : kFaces) add_triangle(scene, face[0], face[1], face[2]);
  for (int step = 0; step < divisions; ++step) {
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
      const auto [entry, is_new] = middles.try_emplace(key, static_cast<std::uint32_t>(scene.positions.size()));
      if (is_new) add(glm::dvec3(scene.positions[a]) + glm::dvec3(scene.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> coarse;
    coarse.swap(scene.triangles);
    for (const Triangle& triangle : coarse) {
      const auto [a, b, c] = triangle.position;
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      add_triangle(scene, a, ab, ca);
      add_triangle(scene, b, bc, ab);
      add_triangle(scene, c, ca, bc);
      add_triangle(scene, ab, bc, ca);
    }
  }
  finish(scene, {0.8f, 0.8f, 0.85f}, true);
  return scene;
}

Scene make_cube(int) {
  Scene scene;
  for (int i = 0; i < 8; ++i) {
    scene.positions.push_back(glm::vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kSides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& side : kSides) {
    add_triangle(scene, side[0], side[1], side[2]);
    add_triangle(scene, side[0], side[2], side[3]);
  }
  finish(scene, {0.8f, 0.6f, 0.3f}, false);
  return scene;
}

}  // namespace plumbline
