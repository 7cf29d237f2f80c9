// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation_rooms.h"

#include <array>

#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants in rooms");

glm::vec3 cube_point(Random& random, float side) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return side * glm::vec3(x, y, z);
}

/// Texels of any values in [0, 1). The sides are no powers of two, and differ.
void add_texture(Scene& scene, int width, int height) {
  Random random(kSeed, name_hash("texture"), scene.textures.size());
  Texture& texture = scene.textures.emplace_back();
  texture.width = width, texture.height = height;
  for (int i = 0; i < width * height; ++i) {
    const double r = random.uniform(), g = random.uniform(), b = random.uniform();
    texture.texels.emplace_back(r, g, b);
  }
}

/// Materials that shade each in a way of its own; those with textures come last.
void add_materials(Scene& scene, bool has_textures) {
  const auto add = [&](const glm::vec3& color, float diffuse, float specular, float shine) -> Material& {
    Material& m = scene.materials.emplace_back();
    m.color = color, m.diffuse = diffuse, m.specular = specular, m.shine = shine;
    return m;
  };
  add({0.9f, 0.5f, 0.2f}, 0.9f, 0.0f, 1.0f);
  add({0.3f, 0.8f, 0.9f}, 0.4f, 0.5f, 0.0f);              // a highlight everywhere
  add({0.7f, 0.9f, 0.4f}, 0.2f, 0.7f, 31.5f).glossy = 0;  // a mirror in a scene of glossy ones
  Material& glass = add({1.0f, 0.9f, 0.8f}, 0.1f, 0.2f, 90.0f);
  glass.transmittance = 0.8f, glass.refraction_index = 1.5f, glass.glossy = 0.2f;
  Material& thin = add({0.6f, 0.6f, 1.0f}, 0.3f, 0.0f, 2.0f);
  thin.transmittance = 0.6f, thin.refraction_index = 0.0f;  // counts as 1
  Material& bubble = add({0.9f, 0.6f, 0.6f}, 0.2f, 0.3f, 7.0f);
  bubble.transmittance = 0.7f, bubble.refraction_index = 0.625f;  // reflects totally from outside
  if (!has_textures) return;
  add_texture(scene, 71, 67);  // more than kTextureBlock texels: the others begin in another block
  add_texture(scene, 3, 5);
  add_texture(scene, 7, 4);
  add({0.8f, 0.8f, 0.7f}, 0.8f, 0.1f, 12.0f).diffuse_texture = 0;
  Material& relief = add({0.7f, 0.5f, 0.9f}, 0.7f, 0.4f, 9.0f);
  relief.diffuse_texture = 1, relief.bump_texture = 2, relief.bump_scale = 0.07f;
  Material& dents = add({0.5f, 0.9f, 0.6f}, 0.6f, 0.3f, 40.0f);
  dents.bump_texture = 0, dents.bump_scale = -0.11f, dents.glossy = 0.1f;
  Material& pane = add({0.9f, 0.9f, 1.0f}, 0.1f, 0.1f, 60.0f);
  pane.transmittance = 0.7f, pane.refraction_index = 1.25f, pane.bump_texture = 2, pane.bump_scale = 0.2f;
  // Stands before the textures: what is read there in place of one.
  Material& last = add({0.5f, 0.4f, 0.3f}, 0.8f, 0.0f, 3.0f);
  last.bump_scale = 3.0f, last.glossy = 5.0f;
}

/// Every other triangle has normals of its own, on either side of it, now and then one of no length; two of three have
/// texture coordinates, well beyond [0, 1], of either hand, now and then such as span nothing, or the unit triangle.
void add_triangles(Scene& scene, std::uint32_t count, float side) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(scene.triangles.size());
    Random random(kSeed, name_hash("triangle"), first);
    const glm::vec3 at = cube_point(random, side);
    Triangle t;
    t.material = first % static_cast<std::uint32_t>(scene.materials.size());
    glm::vec3 normal;
    for (std::size_t k = 0; k < 3; ++k) {
      t.position[k] = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.push_back(at + cube_point(random, 0.6f * side));
    }
    const glm::vec3* corner = &scene.positions[t.position[0]];
    normal = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    for (std::size_t k = 0; k < 3 && i % 2 == 0; ++k) {
      t.normal[k] = static_cast<std::uint32_t>(scene.normals.size());
      const float length = i % 8 == 2 && k == 1 ? 0.0f : i % 4 == 0 ? 2.0f : -0.5f;
      scene.normals.push_back(length * (normal + cube_point(random, 0.9f)));
    }
    for (std::size_t k = 0; k < 3 && i % 3 != 0; ++k) {
      t.texcoord[k] = static_cast<std::uint32_t>(scene.texcoords.size());
      const glm::vec3 uv = cube_point(random, 3.0f);
      if (i % 5 == 4) {
        scene.texcoords.emplace_back(k == 1, k == 2);
      } else {
        scene.texcoords.emplace_back(uv.x, i % 7 == 1 ? uv.x : uv.y);
      }
    }
    scene.triangles.push_back(t);
  }
}

void add_spheres(Scene& scene, std::uint32_t count, float side) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::uint32_t>(scene.spheres.size());
    Random random(kSeed, name_hash("sphere"), number);
    scene.spheres.push_back({cube_point(random, side), side * static_cast<float>(random.uniform(0.15, 0.35)),
                             number % static_cast<std::uint32_t>(scene.materials.size())});
  }
}

/// A part of both kinds, four times: sheared, turned inside out, within another node, and hidden below the ground.
void add_nodes(Scene& scene) {
  Part part{"piece", static_cast<std::uint32_t>(scene.triangles.size()), 0,
            static_cast<std::uint32_t>(scene.spheres.size()), 0};
  add_triangles(scene, 10, 0.7f);
  add_spheres(scene, 3, 0.7f);
  part.triangle_count = static_cast<std::uint32_t>(scene.triangles.size()) - part.first_triangle;
  part.sphere_count = static_cast<std::uint32_t>(scene.spheres.size()) - part.first_sphere;
  scene.parts.push_back(part);
  const auto node = [&](const char* name, std::uint32_t parent, std::uint32_t of, const Transform& transform) {
    scene.nodes.push_back({name, parent, of, transform, transform});
  };
  Transform sheared, mirrored, turned;
  sheared.linear = glm::mat3(2.4f, 0.1f, 0.0f, 0.2f, 0.4f, 0.1f, -0.1f, 0.05f, 0.4f);
  sheared.translation = {-0.6f, 0.4f, 2.5f};
  mirrored.linear = glm::mat3(-0.3f, 0.1f, 0.5f, 0.1f, 0.4f, -0.9f, 0.1f, 0.2f, 1.1f);
  mirrored.translation = {0.8f, 0.9f, 2.3f};
  turned.linear = glm::mat3(0.5f, 0.1f, 0.0f, 0.0f, 0.2f, 0.5f, 0.1f, 0.9f, 0.1f);
  turned.translation = {0.4f, 1.1f, -0.3f};
  node("sheared", kNone, 0, sheared);
  node("mirrored", kNone, 0, mirrored);
  node("group", kNone, kNone, turned);
  node("inner", 2, 0, mirrored);
  Transform below;
  below.linear = glm::mat3(0.6f, 0.0f, -0.8f, 0.3f, 2.0f, 0.3f, 0.8f, 0.0f, 0.6f);  // most along y
  below.translation = {0.4f, -3.4f, 0.2f};
  node("below", kNone, 0, below);
}

}  // namespace

const char* name_of(MutationRoom room) {
  static constexpr std::array<const char*, 3> kNames{"furnished", "papered", "balls"};
  return kNames[static_cast<std::size_t>(room)];
}

Scene mutation_room(MutationRoom room) {
  Scene scene;
  scene.name = name_of(room);
  const bool has_textures = room != MutationRoom::balls;
  add_materials(scene, has_textures);
  if (room != MutationRoom::balls) add_triangles(scene, room == MutationRoom::papered ? 40 : 24, 1.8f);
  if (room != MutationRoom::papered) {
    scene.spheres.push_back({{0.9f, -0.5f, 2.6f}, 0.35f, 2});
    add_spheres(scene, 12, 1.8f);
  }
  if (room == MutationRoom::furnished) add_nodes(scene);
  // Off the axes, with its rim in sight, above what it hides from the light below.
  Ground& ground = scene.ground;
  ground.center = {0.3f, -1.7f, -0.4f};
  ground.normal = glm::normalize(glm::vec3(0.2f, 1.0f, 0.3f));
  ground.u_axis = glm::normalize(glm::cross(ground.normal, glm::vec3(0.3f, 0.1f, 1.0f)));
  ground.v_axis = glm::cross(ground.normal, ground.u_axis);
  ground.radius = 3.1f;
  ground.texture_size = 0.7f;
  ground.material = has_textures ? 7 : 2;
  scene.background = {0.2f, 0.3f, 0.5f};
  scene.camera.from = {0.6f, 0.9f, 5.2f};
  scene.camera.at = {0.1f, -0.2f, 0.0f};
  scene.camera.up = {0.1f, 1.0f, 0.0f};
  scene.camera.angle_radians = 1.0f;
  scene.camera.aperture = 0.05f;
  scene.camera.focus = 4.5f;
  scene.has_camera = true;
  scene.lights = {{{3.0f, 4.0f, 5.0f}, {0.8f, 0.7f, 0.0f}, true, 0.4f},
                  {{-4.0f, 2.0f, 3.5f}, {}, false, 0.2f},
                  {{0.5f, -6.0f, -2.0f}, {0.2f, 0.5f, 0.4f}, true, 0.3f}};
  scene.effects.glossy = 0.05f;
  scene.effects.depth = 3;
  return scene;
}

}  // namespace plumbline
