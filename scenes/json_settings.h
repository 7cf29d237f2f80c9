// SPDX-License-Identifier: MIT
// What a scene file says beside its geometry: camera, lights, background, effects and the round ground.
#pragma once

#include <vector>

#include "scenes/json_document.h"
#include "scenes/json_shapes.h"
#include "scenes/scene.h"

namespace plumbline {

struct Settings {
  Camera camera;
  bool has_camera = false;
  std::vector<Light> lights;
  glm::vec3 background{0.0f};
  Effects effects;
  Ground ground;
};

/// Reads these keys of a scene file's outermost object.
void read_settings(const JsonPlace& root, Settings& settings);

/// The member "ground" of the outermost object, whose material is of the pool, or white and matte.
Ground read_ground(const JsonPlace& place, const NamedMaterials& materials, MeshPool& pool);

/// Gives a scene what was read; without a camera, one that frames it.
void apply(const Settings& settings, Scene& scene);

}  // namespace plumbline
