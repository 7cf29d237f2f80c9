// SPDX-License-Identifier: MIT
#include "tracer/shading_image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 30;

/// Of unit length, in double, rounded once; zero for what has no direction.
glm::vec3 unit(const glm::vec3& v) {
  const glm::dvec3 d(v);
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  if (!(largest > 0.0)) return glm::vec3(0.0f);
  return glm::vec3(glm::normalize(d / largest));
}

float number_or_zero(std::uint32_t index) { return index == kNone ? 0.0f : static_cast<float>(index + 1); }

void add_material(const Material& m, std::vector<glm::vec4>& texels) {
  texels.emplace_back(m.color, m.diffuse);
  texels.emplace_back(m.specular, std::max(m.shine, 0.0f), m.transmittance, m.refraction_index);
  texels.emplace_back(number_or_zero(m.diffuse_texture), number_or_zero(m.bump_texture), m.bump_scale, m.glossy);
}

void add_triangle(const Scene& scene, std::uint32_t k, std::vector<glm::vec4>& texels) {
  const Triangle& triangle = scene.triangles[k];
  const auto corners = scene.corners(k);
  std::array<glm::vec3, 3> normals{};
  bool has_normals = triangle.normal[0] != kNone;
  const bool has_texcoords = triangle.texcoord[0] != kNone;
  std::array<glm::vec2, 3> uv{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (triangle.normal[0] != kNone) {
      normals[i] = unit(scene.normals[triangle.normal[i]]);
      has_normals = has_normals && normals[i] != glm::vec3(0.0f);
    }
    if (has_texcoords) uv[i] = scene.texcoords[triangle.texcoord[i]];
  }
  texels.emplace_back(corners[0], static_cast<float>(triangle.material));
  texels.emplace_back(corners[1], has_normals ? 1.0f : 0.0f);
  texels.emplace_back(corners[2], has_texcoords ? 1.0f : 0.0f);
  texels.emplace_back(normals[0], uv[0].x);
  texels.emplace_back(normals[1], uv[0].y);
  texels.emplace_back(normals[2], uv[1].x);
  texels.emplace_back(uv[1].y, uv[2].x, uv[2].y, 0.0f);
}

std::uint32_t position(const std::vector<glm::vec4>& texels) { return static_cast<std::uint32_t>(texels.size()); }

}  // namespace

std::vector<glm::vec4> instance_texels(const Scene& scene) {
  std::vector<glm::vec4> texels;
  texels.reserve(std::size_t{kInstanceTexels} * scene.nodes.size());
  std::vector<TransformD> composed;
  composed.reserve(scene.nodes.size());
  for (const Node& node : scene.nodes) {  // parents stand before their children
    const TransformD own = to_double(node.transform);
    composed.push_back(node.parent == kNone ? own : compose(composed[node.parent], own));
    const glm::dmat3& linear = composed.back().linear;
    const glm::dmat3 back = inverse(composed.back()).linear;
    for (int row = 0; row < 3; ++row)
      texels.emplace_back(glm::vec3(linear[0][row], linear[1][row], linear[2][row]),
                          static_cast<float>(composed.back().translation[row]));
    for (int row = 0; row < 3; ++row)
      texels.emplace_back(glm::vec3(back[0][row], back[1][row], back[2][row]), 0.0f);
  }
  return texels;
}

ShadingImage shading_image(const Scene& scene) {
  std::uint64_t texture_texels = 0;
  for (const Texture& texture : scene.textures) texture_texels += texture.texels.size();
  const std::uint64_t others = std::uint64_t{kShadingTriangleTexels} * scene.triangles.size() +
                               std::uint64_t{kShadingSphereTexels} * scene.spheres.size() +
                               std::uint64_t{kInstanceTexels} * scene.nodes.size() +
                               std::uint64_t{kMaterialTexels} * scene.materials.size();
  if (texture_texels > kMostTexels || others > kMostTexels) {
    throw InputError(scene.name + ": shading it takes more than 2^30 texels; use smaller textures or less geometry");
  }
  ShadingImage image;
  std::vector<glm::vec4>& texels = image.texels;
  texels.reserve(others + kGroundTexels + scene.textures.size());
  const Ground& ground = scene.ground;
  texels.emplace_back(ground.center, ground.radius);
  texels.emplace_back(ground.normal, ground.texture_size);
  texels.emplace_back(ground.u_axis, static_cast<float>(ground.material));
  texels.emplace_back(ground.v_axis, 0.0f);
  image.material_start = position(texels);
  for (const Material& material : scene.materials) add_material(material, texels);
  image.texture_start = position(texels);
  image.texture_texels.reserve(texture_texels + 1);
  for (const Texture& texture : scene.textures) {
    const std::uint32_t start = position(image.texture_texels);
    texels.emplace_back(start / kTextureBlock, start % kTextureBlock, texture.width, texture.height);
    for (const glm::vec3& texel : texture.texels) image.texture_texels.emplace_back(texel, 0.0f);
  }
  if (image.texture_texels.empty()) image.texture_texels.emplace_back(0.0f);
  image.triangle_start = position(texels);
  for (std::uint32_t k = 0; k < scene.triangles.size(); ++k) add_triangle(scene, k, texels);
  image.sphere_start = position(texels);
  for (const Sphere& sphere : scene.spheres) {
    texels.emplace_back(sphere.center, sphere.radius);
    texels.emplace_back(static_cast<float>(sphere.material), 0.0f, 0.0f, 0.0f);
  }
  image.instance_start = position(texels);
  const std::vector<glm::vec4> instances = instance_texels(scene);
  texels.insert(texels.end(), instances.begin(), instances.end());
  return image;
}

}  // namespace plumbline
