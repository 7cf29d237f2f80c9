// SPDX-License-Identifier: MIT
// The geometry image: a sphere tree and its primitives baked into one RGBA32F texture that a shader walks without a stack.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "tracer/sphere_tree.h"

namespace plumbline {

enum class Layout { paper, compact };
enum class Bounds { sphere, aabb };
enum class Links { threaded, octant };

struct BakeOptions {
  Layout layout = Layout::compact;
  Bounds bounds = Bounds::sphere;
  Links links = Links::octant;
  int width = 512;  ///< texels, a power of two; grows to what the tree needs
  TreeOptions tree;
};

struct GeometryImage {
  BakeOptions options;
  int width = 0, height = 0;        ///< texels, powers of two
  std::vector<glm::vec4> texels;    ///< width * height, row by row, row 0 first
  std::uint32_t cell_count = 0;     ///< the longest walk: the cap of the traversal loop
  glm::vec3 center{0.0f};           ///< of the scene's ball; far rays are moved near it before they walk
  float radius = 0.0f;
  // (more metadata as the layouts need: where each octant's copy starts, bits of the packed word, primitive count, scene name)
};

}  // namespace plumbline
