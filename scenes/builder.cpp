// SPDX-License-Identifier: MIT
#include "scenes/builder.h"

#include <cmath>

#include "scenes/error.h"
#include "scenes/triangulate.h"

namespace plumbline {
namespace {

/// Appends the corners that a triangulation invented, blending what `values` holds for the others.
void append_blended(std::vector<glm::vec3>& values, std::size_t first, const Triangulation& triangulation) {
  for (const BlendedCorner& corner : triangulation.blended) {
    glm::vec3 value(0.0f);
    for (std::size_t i = 0; i < 4; ++i) value += corner.weight[i] * values[first + corner.source[i]];
    values.push_back(value);
  }
}

}  // namespace

Added add_polygon(Scene& scene, std::span<const glm::vec3> corners, std::span<const glm::vec3> normals,
                  std::uint32_t material) {
  PLUMBLINE_ASSERT(normals.empty() || normals.size() == corners.size());
  const Triangulation triangulation = triangulate(corners);
  if (triangulation.too_complex) return Added::too_complex;
  ++(normals.empty() ? scene.source.polygons : scene.source.patches);
  if (triangulation.triangles.empty()) return Added::no_area;

  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  const auto first_normal = static_cast<std::uint32_t>(scene.normals.size());
  scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
  for (const BlendedCorner& corner : triangulation.blended) scene.positions.push_back(corner.position);
  scene.normals.insert(scene.normals.end(), normals.begin(), normals.end());
  if (!normals.empty()) append_blended(scene.normals, first_normal, triangulation);

  for (const auto& corner : triangulation.triangles) {
    Triangle triangle;
    triangle.material = material;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.position[i] = first + corner[i];
      if (!normals.empty()) triangle.normal[i] = first_normal + corner[i];
    }
    scene.triangles.push_back(triangle);
  }
  return triangulation.blended.empty() ? Added::whole : Added::blended;
}

void add_sphere(Scene& scene, const glm::vec3& center, float radius, std::uint32_t material) {
  PLUMBLINE_ASSERT(radius > 0.0f);
  scene.spheres.push_back({center, radius, material});
  ++scene.source.spheres;
}

Added add_cone(Scene& scene, const glm::vec3& base, float base_radius, const glm::vec3& apex, float apex_radius,
               std::uint32_t material) {
  ++(base_radius == apex_radius ? scene.source.cylinders : scene.source.cones);
  const glm::dvec3 axis = glm::dvec3(apex) - glm::dvec3(base);
  const double height = glm::length(axis);
  if (!(height > 0.0) || (base_radius == 0.0f && apex_radius == 0.0f)) return Added::no_area;

  // Two vectors across the axis; the coordinate axis farthest from it gives the first.
  const glm::dvec3 along = axis / height, size = glm::abs(along);
  const glm::dvec3 helper = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(glm::cross(along, helper)), v = glm::cross(along, u);
  // The normal leans towards the narrow end by the slope of the side.
  const double lean = (static_cast<double>(base_radius) - static_cast<double>(apex_radius)) / height;

  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  const auto first_normal = static_cast<std::uint32_t>(scene.normals.size());
  for (int side = 0; side < kConeSides; ++side) {
    const double angle = 2.0 * 3.141592653589793 * side / kConeSides;
    const glm::dvec3 out = std::cos(angle) * u + std::sin(angle) * v;
    // A radius of zero gives one apex, bit for bit, to all sides.
    scene.positions.push_back(glm::vec3(glm::dvec3(base) + static_cast<double>(base_radius) * out));
    scene.positions.push_back(glm::vec3(glm::dvec3(apex) + static_cast<double>(apex_radius) * out));
    scene.normals.push_back(glm::vec3(glm::normalize(out + lean * along)));
  }
  std::size_t added = 0;
  const auto add = [&](int side_a, int end_a, int side_b, int end_b, int side_c, int end_c) {
    Triangle triangle;
    triangle.material = material;
    const int sides[3] = {side_a, side_b, side_c}, ends[3] = {end_a, end_b, end_c};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto side = static_cast<std::uint32_t>(sides[i] % kConeSides);
      triangle.position[i] = first + 2 * side + static_cast<std::uint32_t>(ends[i]);
      triangle.normal[i] = first_normal + side;
    }
    const auto& p = triangle.position;
    if (!has_area(scene.positions[p[0]], scene.positions[p[1]], scene.positions[p[2]])) return;
    scene.triangles.push_back(triangle);
    ++added;
  };
  for (int side = 0; side < kConeSides; ++side) {
    add(side, 0, side + 1, 0, side + 1, 1);
    add(side, 0, side + 1, 1, side, 1);
  }
  return added > 0 ? Added::whole : Added::no_area;
}

std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_smooth_normals(Scene& scene) {
  std::vector<glm::dvec3> sum(scene.positions.size(), glm::dvec3(0.0));
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const auto corner = scene.corners(t);
    const glm::dvec3 a(corner[0]);
    const glm::dvec3 normal = glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a);
    for (const std::uint32_t p : scene.triangles[t].position) sum[p] += normal;
  }
  scene.normals.clear();
  for (const glm::dvec3& normal : sum) {
    const double length = glm::length(normal);
    scene.normals.push_back(length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f, 0.0f, 1.0f));
  }
  for (Triangle& triangle : scene.triangles) triangle.normal = triangle.position;
}

}  // namespace plumbline
