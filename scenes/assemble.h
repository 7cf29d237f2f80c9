// SPDX-License-Identifier: MIT
// Puts scenes together from parts: geometry is taken over once, nodes place it as often as they like, and the result
// is one Scene. What readers of scene files share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

/// What stands in one space as a whole: a mesh of the pool, and nodes that place others. `part` of a node is a mesh of
/// the pool; `parent` kNone is the assembly's own space.
struct Assembly {
  std::uint32_t mesh = kNone;
  std::vector<Node> nodes;
  std::vector<Animation> animation;
  std::vector<std::size_t> lines;  ///< of each node in the file that is being read, for messages
  bool is_empty() const { return mesh == kNone && nodes.empty(); }
};

/// The geometry and the materials of all parts. A mesh is a Scene of triangles and spheres without parts, whose
/// materials are numbers of the pool.
class MeshPool {
 public:
  std::uint32_t add_material(const Material& material);
  /// Takes over a texture that has been read; those of one path become one.
  std::uint32_t add_texture(Texture&& texture);
  /// Takes over a mesh whose materials are of the pool already; it must not be empty.
  std::uint32_t add_mesh(Scene&& mesh);
  /// Takes over all that a scene holds but camera, lights and background. Its warnings are added to `warnings`.
  Assembly add_scene(Scene&& scene, std::vector<std::string>& warnings);
  /// The same with one material throughout; its meshes are copies.
  Assembly with_material(const Assembly& assembly, std::uint32_t material);
  /// One mesh of several; kNone of none.
  std::uint32_t joined(const std::vector<std::uint32_t>& meshes, const std::string& name);
  std::uint32_t primitive_count(std::uint32_t mesh) const { return meshes_[mesh].primitive_count(); }
  const std::string& name(std::uint32_t mesh) const { return meshes_[mesh].name; }

  /// The scene in which `root` is the world. Meshes that are placed nowhere are left out. Empties the pool.
  Scene finish(Assembly&& root);

 private:
  std::vector<Scene> meshes_;
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
};

/// Adds the nodes of `part` to `target`, below node `parent`, whose name goes before theirs; kNone: the target's own
/// space.
void add_nodes(Assembly& target, std::uint32_t parent, const Assembly& part, std::size_t line);

/// Throws InputError naming `file`, line and node where what a node composes with those around it cannot be used in 32
/// bits. `lines` is as long as scene.nodes.
void check_composed(const std::string& file, const Scene& scene, const std::vector<std::size_t>& lines);

}  // namespace plumbline
