// SPDX-License-Identifier: GPL-3.0-or-later
// For tests of the renderer: small scenes whose pictures are known in closed form, and numbers given by hand.
#pragma once

#include <array>
#include <cmath>
#include <functional>

#include "reference/renderer.h"

namespace plumbline {

/// A scene of no primitives, seen by one pixel from `from` along the axis to `at`; all effects are off.
inline Scene one_pixel_scene(const glm::vec3& from, const glm::vec3& at, const glm::vec3& up = {0, 1, 0}) {
  Scene scene;
  scene.camera.from = from;
  scene.camera.at = at;
  scene.camera.up = up;
  scene.camera.width = scene.camera.height = 1;
  scene.effects.antialias = scene.effects.soft_shadows = scene.effects.depth_of_field = false;
  scene.effects.motion_blur = scene.effects.glossy_reflections = false;
  return scene;
}

inline std::uint32_t add_surface(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

/// Black, and reflects nothing.
inline Material black() { return {.name = {}, .color = glm::vec3(0.0f), .diffuse = 0.0f}; }

/// Two triangles; the first corner's texture coordinates are (0, 0), the third's (1, 1).
inline void add_quad(Scene& scene, const std::array<glm::vec3, 4>& corners, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  const auto uv = static_cast<std::uint32_t>(scene.texcoords.size());
  scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
  scene.texcoords.insert(scene.texcoords.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    scene.triangles.push_back(
        {.position = {first + a, first + b, first + c}, .texcoord = {uv + a, uv + b, uv + c}, .material = material});
  };
  add(0, 1, 2);
  add(0, 2, 3);
}

/// The rectangle from (x0, y0) to (x1, y1) in the plane at height z.
inline void add_level(Scene& scene, float x0, float y0, float x1, float y1, float z, std::uint32_t material) {
  add_quad(scene, {glm::vec3{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, material);
}

inline glm::dvec3 only_sample(const Scene& scene, SampleRecord* record = nullptr) {
  return ReferenceRenderer(scene, {}).sample(0, 0, 0, record);
}

/// Whether a share counted among n independent samples agrees with the expected one: within 4.5 of its standard
/// deviations, which a right share leaves once in 150,000 times.
inline bool share_agrees(double share, double expected, double n) {
  return std::fabs(share - expected) <= 4.5 * std::sqrt(expected * (1.0 - expected) / n);
}

}  // namespace plumbline
