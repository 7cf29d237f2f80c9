// SPDX-License-Identifier: MIT
// Meshes and materials of a glTF 2.0 file, as they go into a Scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/gltf_data.h"
#include "scenes/scene.h"

namespace plumbline {

/// Reads what a glTF file shows into a scene, piece by piece.
class GltfMeshes {
 public:
  /// Adds all materials, and one for primitives without any, to the scene. Both must outlive this.
  GltfMeshes(const GltfData& data, Scene& scene);

  /// Adds a part of mesh `mesh`'s triangles; kNone where it has none (points and lines are no surfaces). The mesh must
  /// not have been added before.
  std::uint32_t add_part(const JsonPlace& mesh, const std::string& name);

  /// What was left out, once and counted.
  void report(const JsonPlace& root);

 private:
  void add_primitive(const JsonPlace& primitive);
  std::vector<std::uint32_t> read_indices(const JsonPlace& primitive, std::uint32_t vertex_count);

  const GltfData& data_;
  Scene& scene_;
  std::vector<std::uint32_t> material_texcoords_;  ///< the set of texture coordinates that each material's image takes
  std::size_t not_triangles_ = 0, morphed_ = 0, no_area_ = 0, partial_ = 0;
};

}  // namespace plumbline
