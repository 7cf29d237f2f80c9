// SPDX-License-Identifier: MIT
#include "scenes/assemble.h"

#include <algorithm>
#include <limits>

#include "scenes/error.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

/// Numbers what a range of a scene uses of an array of vertices anew, in the order of use.
class Renumbering {
 public:
  explicit Renumbering(std::size_t count) : number_(count, kNone) {}

  std::uint32_t operator()(std::uint32_t old) {
    if (old == kNone) return kNone;
    if (number_[old] == kNone) {
      number_[old] = static_cast<std::uint32_t>(used_.size());
      used_.push_back(old);
    }
    return number_[old];
  }
  /// The values used, in their new order; forgets them.
  template <class T>
  std::vector<T> take(const std::vector<T>& values) {
    std::vector<T> taken;
    taken.reserve(used_.size());
    for (const std::uint32_t old : used_) {
      taken.push_back(values[old]);
      number_[old] = kNone;
    }
    used_.clear();
    return taken;
  }

 private:
  std::vector<std::uint32_t> number_, used_;
};

void append_mesh(Scene& target, const Scene& mesh) {
  const auto first_position = static_cast<std::uint32_t>(target.positions.size());
  const auto first_normal = static_cast<std::uint32_t>(target.normals.size());
  const auto first_texcoord = static_cast<std::uint32_t>(target.texcoords.size());
  target.positions.insert(target.positions.end(), mesh.positions.begin(), mesh.positions.end());
  target.normals.insert(target.normals.end(), mesh.normals.begin(), mesh.normals.end());
  target.texcoords.insert(target.texcoords.end(), mesh.texcoords.begin(), mesh.texcoords.end());
  for (Triangle triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.position[i] += first_position;
      if (triangle.normal[i] != kNone) triangle.normal[i] += first_normal;
      if (triangle.texcoord[i] != kNone) triangle.texcoord[i] += first_texcoord;
    }
    target.triangles.push_back(triangle);
  }
  target.spheres.insert(target.spheres.end(), mesh.spheres.begin(), mesh.spheres.end());
  target.source.polygons += mesh.source.polygons;
  target.source.patches += mesh.source.patches;
  target.source.spheres += mesh.source.spheres;
  target.source.cones += mesh.source.cones;
  target.source.cylinders += mesh.source.cylinders;
}

}  // namespace

std::uint32_t MeshPool::add_material(const Material& material) {
  materials_.push_back(material);
  return static_cast<std::uint32_t>(materials_.size() - 1);
}

std::uint32_t MeshPool::add_texture(Texture&& texture) {
  for (std::uint32_t i = 0; i < textures_.size(); ++i) {
    if (textures_[i].path == texture.path) return i;
  }
  textures_.push_back(std::move(texture));
  return static_cast<std::uint32_t>(textures_.size() - 1);
}

std::uint32_t MeshPool::add_mesh(Scene&& mesh) {
  PLUMBLINE_ASSERT(mesh.primitive_count() > 0 && mesh.parts.empty());
  meshes_.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(meshes_.size() - 1);
}

Assembly MeshPool::add_scene(Scene&& scene, std::vector<std::string>& warnings) {
  for (std::string& warning : scene.warnings) warnings.push_back(std::move(warning));
  scene.warnings.clear();
  std::vector<std::uint32_t> texture_number, material_number;
  for (Texture& texture : scene.textures) texture_number.push_back(add_texture(std::move(texture)));
  for (Material& material : scene.materials) {
    if (material.diffuse_texture != kNone) material.diffuse_texture = texture_number[material.diffuse_texture];
    if (material.bump_texture != kNone) material.bump_texture = texture_number[material.bump_texture];
    material_number.push_back(add_material(material));
  }
  for (Triangle& triangle : scene.triangles) triangle.material = material_number[triangle.material];
  for (Sphere& sphere : scene.spheres) sphere.material = material_number[sphere.material];

  Assembly assembly;
  Renumbering position(scene.positions.size()), normal(scene.normals.size()), texcoord(scene.texcoords.size());
  const auto extract = [&](const std::string& name, std::uint32_t first_triangle, std::uint32_t triangle_count,
                           std::uint32_t first_sphere, std::uint32_t sphere_count) {
    Scene mesh;
    mesh.name = name;
    mesh.triangles.assign(scene.triangles.begin() + first_triangle,
                          scene.triangles.begin() + first_triangle + triangle_count);
    mesh.spheres.assign(scene.spheres.begin() + first_sphere, scene.spheres.begin() + first_sphere + sphere_count);
    for (Triangle& triangle : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        triangle.position[i] = position(triangle.position[i]);
        triangle.normal[i] = normal(triangle.normal[i]);
        triangle.texcoord[i] = texcoord(triangle.texcoord[i]);
      }
    }
    mesh.positions = position.take(scene.positions);
    mesh.normals = normal.take(scene.normals);
    mesh.texcoords = texcoord.take(scene.texcoords);
    return add_mesh(std::move(mesh));
  };
  const std::size_t first_mesh = meshes_.size();
  if (scene.world_triangle_count() + scene.world_sphere_count() > 0)
    assembly.mesh = extract(scene.name, 0, scene.world_triangle_count(), 0, scene.world_sphere_count());
  std::vector<std::uint32_t> mesh_of_part;
  for (const Part& part : scene.parts)
    mesh_of_part.push_back(extract(part.name.empty() ? scene.name : part.name, part.first_triangle, part.triangle_count,
                                   part.first_sphere, part.sphere_count));
  // What was read is counted once, whatever it was divided into.
  if (first_mesh < meshes_.size()) meshes_[first_mesh].source = scene.source;
  assembly.nodes = std::move(scene.nodes);
  for (Node& node : assembly.nodes)
    if (node.part != kNone) node.part = mesh_of_part[node.part];
  assembly.animation = std::move(scene.animation);
  assembly.lines.assign(assembly.nodes.size(), 1);
  return assembly;
}

Assembly MeshPool::with_material(const Assembly& assembly, std::uint32_t material) {
  std::vector<std::uint32_t> copy_of(meshes_.size(), kNone);
  const auto copied = [&](std::uint32_t mesh) {
    if (mesh == kNone) return kNone;
    if (copy_of[mesh] == kNone) {
      Scene copy = meshes_[mesh];
      for (Triangle& triangle : copy.triangles) triangle.material = material;
      for (Sphere& sphere : copy.spheres) sphere.material = material;
      copy_of[mesh] = add_mesh(std::move(copy));
    }
    return copy_of[mesh];
  };
  Assembly result = assembly;
  result.mesh = copied(result.mesh);
  for (Node& node : result.nodes) node.part = copied(node.part);
  return result;
}

std::uint32_t MeshPool::joined(const std::vector<std::uint32_t>& meshes, const std::string& name) {
  if (meshes.empty()) return kNone;
  if (meshes.size() == 1) return meshes.front();
  Scene all;
  all.name = name;
  for (const std::uint32_t mesh : meshes) append_mesh(all, meshes_[mesh]);
  return add_mesh(std::move(all));
}

Scene MeshPool::finish(Assembly&& root) {
  Scene scene;
  if (root.mesh != kNone) append_mesh(scene, meshes_[root.mesh]);
  std::vector<std::uint32_t> part_of(meshes_.size(), kNone);
  for (const Node& node : root.nodes)
    if (node.part != kNone) part_of[node.part] = 0;
  for (std::uint32_t mesh = 0; mesh < meshes_.size(); ++mesh) {
    Scene& from = meshes_[mesh];
    if (part_of[mesh] != kNone) {
      part_of[mesh] = static_cast<std::uint32_t>(scene.parts.size());
      Part part;
      part.name = from.name;
      part.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
      part.triangle_count = static_cast<std::uint32_t>(from.triangles.size());
      part.first_sphere = static_cast<std::uint32_t>(scene.spheres.size());
      part.sphere_count = static_cast<std::uint32_t>(from.spheres.size());
      append_mesh(scene, from);
      scene.parts.push_back(std::move(part));
    }
    from = Scene{};
  }
  scene.nodes = std::move(root.nodes);
  for (Node& node : scene.nodes)
    if (node.part != kNone) node.part = part_of[node.part];
  scene.animation = std::move(root.animation);
  scene.materials = std::move(materials_);
  scene.textures = std::move(textures_);
  meshes_.clear();
  materials_.clear();
  textures_.clear();
  return scene;
}

void add_nodes(Assembly& target, std::uint32_t parent, const Assembly& part, std::size_t line) {
  const auto first = static_cast<std::uint32_t>(target.nodes.size());
  const std::string before = parent == kNone ? "" : target.nodes[parent].name + "/";
  for (const Node& node : part.nodes) {
    Node added = node;
    added.name = before + node.name;
    added.parent = node.parent == kNone ? parent : first + node.parent;
    target.nodes.push_back(std::move(added));
  }
  for (const Animation& animation : part.animation) {
    target.animation.push_back(animation);
    target.animation.back().node += first;
  }
  target.lines.insert(target.lines.end(), part.nodes.size(), line);
}

void check_composed(const std::string& file, const Scene& scene, const std::vector<std::size_t>& lines) {
  std::vector<Ball> of_parts;
  for (const Part& part : scene.parts) of_parts.push_back(bounding_ball(scene, part));
  std::vector<TransformD> composed(scene.nodes.size());
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    composed[n] = to_double(node.transform);
    if (node.parent != kNone) composed[n] = compose(composed[node.parent], composed[n]);
    const std::string problem = transform_error({glm::mat3(composed[n].linear), glm::vec3(composed[n].translation)});
    if (!problem.empty())
      throw InputError(
          file, lines[n],
          "node " + shown(node.name, 100) + ": with the transforms around it, its matrix " + problem + " in 32 bits");
    if (node.part == kNone) continue;
    const Ball& ball = of_parts[node.part];
    const glm::dvec3 center = glm::abs(transform_point(composed[n], ball.center));
    const double reach = std::max({center.x, center.y, center.z}) + largest_stretch(composed[n].linear) * ball.radius;
    if (!(reach <= static_cast<double>(std::numeric_limits<float>::max())))
      throw InputError(
          file, lines[n],
          "node " + shown(node.name, 100) + ": its geometry is too far out for 32-bit numbers; scale it down");
  }
}

}  // namespace plumbline
