// SPDX-License-Identifier: MIT
// What a scene file says beside its geometry: camera, lights, background and effects.
#pragma once

#include <vector>

#include "scenes/json_document.h"
#include "scenes/scene.h"

namespace plumbline {

struct Settings {
  Camera camera;
  bool has_camera = false;
  std::vector<Light> lights;
  glm::vec3 background{0.0f};
  Effects effects;
};

/// Reads these keys of a scene file's outermost object.
void read_settings(const JsonPlace& root, Settings& settings);

/// Gives a scene what was read; without a camera, one that frames it.
void apply(const Settings& settings, Scene& scene);

}  // namespace plumbline
