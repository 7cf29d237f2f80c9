// SPDX-License-Identifier: GPL-3.0-or-later
// Gathers parts, and brings instances into the world in plain double precision: a truth that shares nothing with the
// exact maps of instance_map.h.
#include "reference/geometry.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "scenes/error.h"

namespace plumbline {

namespace {

/// Triangles [first, first + count), with the positions that they use and no others.
void gather_triangles(const Scene& scene, std::uint32_t first, std::uint32_t count, Geometry& geometry) {
  geometry.first_triangle = first;
  geometry.triangles.reserve(count);
  std::vector<std::uint32_t> used;
  for (std::uint32_t i = first; i < first + count; ++i) {
    geometry.triangles.push_back(scene.triangles[i].position);
    used.insert(used.end(), geometry.triangles.back().begin(), geometry.triangles.back().end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  geometry.positions.reserve(used.size());
  for (const std::uint32_t position : used) geometry.positions.push_back(scene.positions[position]);
  for (auto& triangle : geometry.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
    }
  }
}

void gather_spheres(const Scene& scene, std::uint32_t first, std::uint32_t count, Geometry& geometry) {
  geometry.first_sphere = static_cast<std::uint32_t>(scene.triangles.size()) + first;
  geometry.rounds.reserve(count);
  for (std::uint32_t i = first; i < first + count; ++i)
    geometry.rounds.push_back({glm::dvec3(scene.spheres[i].center), scene.spheres[i].radius});
}

/// The factor of a map that keeps angles, 0 for others.
double similarity_factor(const glm::dmat3& linear) {
  const glm::dmat3 squares = glm::transpose(linear) * linear;
  const double size = squares[0][0];
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      // A few roundings of products of the size of the diagonal.
      const double expected = row == column ? size : 0.0;
      if (!(std::fabs(squares[column][row] - expected) <= 0x1p-49 * size)) return 0.0;
    }
  }
  return std::sqrt(size);
}

/// Adds `part`, brought into the world by `map`.
void add_instance(const Geometry& part, const TransformD& map, std::uint32_t instance, Geometry& flat,
                  std::vector<Geometry::Source>& sphere_sources) {
  const auto first = static_cast<std::uint32_t>(flat.fine_positions.size());
  for (const glm::vec3& p : part.positions) flat.fine_positions.push_back(transform_point(map, glm::dvec3(p)));
  const bool turned = glm::determinant(map.linear) < 0.0;
  for (std::uint32_t i = 0; i < part.triangles.size(); ++i) {
    const auto& [a, b, c] = part.triangles[i];
    flat.triangles.push_back({first + a, first + b, first + c});
    flat.sources.push_back({instance, part.first_triangle + i, turned});
  }
  const double factor = similarity_factor(map.linear);
  const std::uint32_t image = factor > 0.0 ? kNone : static_cast<std::uint32_t>(flat.images.size());
  if (image != kNone) flat.images.push_back({map, inverse(map)});
  for (std::uint32_t i = 0; i < part.rounds.size(); ++i) {
    const Round& round = part.rounds[i];
    flat.rounds.push_back(image == kNone ? Round{transform_point(map, round.center), factor * round.radius} : round);
    flat.image_of.push_back(image);
    sphere_sources.push_back({instance, part.first_sphere + i, false});
  }
}

}  // namespace

Geometry world_geometry(const Scene& scene) {
  Geometry geometry;
  if (scene.parts.empty()) {  // as it stands
    geometry.positions = scene.positions;
    geometry.triangles.reserve(scene.triangles.size());
    for (const Triangle& triangle : scene.triangles) geometry.triangles.push_back(triangle.position);
  } else {
    gather_triangles(scene, 0, scene.world_triangle_count(), geometry);
  }
  gather_spheres(scene, 0, scene.world_sphere_count(), geometry);
  return geometry;
}

Geometry part_geometry(const Scene& scene, const Part& part) {
  Geometry geometry;
  gather_triangles(scene, part.first_triangle, part.triangle_count, geometry);
  gather_spheres(scene, part.first_sphere, part.sphere_count, geometry);
  return geometry;
}

Geometry flattened_geometry(const Scene& scene) {
  const std::uint64_t count = placed_count(scene);
  if (count > kMostFlattened) {
    throw InputError("scene " + scene.name + " shows " + std::to_string(count) +
                     " primitives, too many to be flattened into one space (at most " + std::to_string(kMostFlattened) +
                     "): place fewer instances, or trace it with instances");
  }
  Geometry flat;
  std::vector<Geometry::Source> sphere_sources;
  const Geometry world = world_geometry(scene);
  add_instance(world, {}, kNone, flat, sphere_sources);
  std::vector<Geometry> parts;
  for (const Part& part : scene.parts) parts.push_back(part_geometry(scene, part));
  for (const std::uint32_t instance : instances_of(scene))
    add_instance(parts[scene.nodes[instance].part], to_world(scene, instance), instance, flat, sphere_sources);
  flat.sources.insert(flat.sources.end(), sphere_sources.begin(), sphere_sources.end());
  return flat;
}

BoxD box_of_round(const Geometry& geometry, std::size_t i) {
  const Round& round = geometry.rounds[i];
  const Image* const image = geometry.image(i);
  if (image == nullptr) return {round.center - round.radius, round.center + round.radius};
  const TransformD& map = image->to_here;
  const glm::dvec3 center = transform_point(map, round.center);
  const glm::dmat3 rows = glm::transpose(map.linear);
  // The farthest points of an ellipsoid along an axis: the length of the matrix's row there.
  const glm::dvec3 half = round.radius * glm::dvec3(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
  return {center - half, center + half};
}

BoxD box_of(const Geometry& geometry) {
  BoxD box;
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    for (const glm::dvec3& corner : geometry.corners(i)) {
      box.lower = glm::min(box.lower, corner);
      box.upper = glm::max(box.upper, corner);
    }
  }
  for (std::size_t i = 0; i < geometry.rounds.size(); ++i) {
    const BoxD one = box_of_round(geometry, i);
    box.lower = glm::min(box.lower, one.lower);
    box.upper = glm::max(box.upper, one.upper);
  }
  return box;
}

}  // namespace plumbline
