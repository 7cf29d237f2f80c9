// SPDX-License-Identifier: MIT
#include "scenes/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/builder.h"
#include "scenes/text_file.h"
#include "scenes/texture.h"
#include "scenes/triangulate.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostVertices = std::size_t{1} << 27;

double factor(const std::optional<JsonPlace>& object, const char* key, double otherwise) {
  const auto place = object ? object->find(key) : std::nullopt;
  return place ? place->number_between(0.0, 1.0) : otherwise;
}

/// A metallic-roughness surface as the Blinn-Phong one that is nearest in kind. What is mirrored (Ks) grows from 4 %
/// for dielectrics to all for metals, and less of it the rougher the surface; the rest is diffuse. The exponent is the
/// usual 2 / a^2 - 2 for a = roughness^2 (Walter et al. 2007, as in glTF's appendix B).
Material surface(const JsonPlace& place) {
  Material material;
  if (const auto name = place.find("name")) material.name = name->text();
  const auto pbr = place.find("pbrMetallicRoughness");
  if (pbr) pbr->check_object();
  const double metallic = factor(pbr, "metallicFactor", 1.0), roughness = factor(pbr, "roughnessFactor", 1.0);
  double alpha = 1.0;
  if (const auto color = pbr ? pbr->find("baseColorFactor") : std::nullopt) {
    color->check_array(4, 4);
    for (std::size_t i = 0; i < 3; ++i)
      material.color[static_cast<glm::length_t>(i)] = static_cast<float>(color->at(i).number_between(0.0, 1.0));
    alpha = color->at(3).number_between(0.0, 1.0);
  }
  material.specular = static_cast<float>((0.04 + 0.96 * metallic) * (1.0 - roughness));
  material.diffuse = 1.0f - material.specular;
  const double a = roughness * roughness;
  material.shine = static_cast<float>(std::clamp(2.0 / std::max(a * a, 1e-6) - 2.0, 1.0, 100000.0));
  const auto mode = place.find("alphaMode");
  if (mode && mode->text() == "BLEND") material.transmittance = static_cast<float>(1.0 - alpha);
  return material;
}

}  // namespace

GltfMeshes::GltfMeshes(const GltfData& data, Scene& scene) : data_(data), scene_(scene) {
  const JsonPlace root(data.document);
  const auto materials = root.find("materials"), textures = root.find("textures");
  for (std::size_t i = 0; materials && i < materials->size(); ++i) {
    const JsonPlace place = materials->at(i);
    Material material = surface(place);
    std::uint32_t texcoords = 0;
    const auto pbr = place.find("pbrMetallicRoughness");
    if (const auto info = pbr ? pbr->find("baseColorTexture") : std::nullopt) {
      if (!textures) info->fail("the file has no textures");
      const std::uint32_t texture = gltf_index(info->need("index"), textures->size(), "textures");
      if (const auto set = info->find("texCoord")) texcoords = set->integer(0, 1000);
      const auto source = textures->at(texture).find("source");
      if (!source) {
        scene.warnings.push_back(info->message("a texture without an image that can be read is left out"));
      } else {
        const GltfImage& image = data.images[gltf_index(*source, data.images.size(), "images")];
        std::string problem;
        const auto found = image.path.empty()
                               ? find_texture(scene, image.name, image.content, TextureKind::color, problem)
                               : find_texture(scene, image.path, TextureKind::color, problem);
        if (found) {
          material.diffuse_texture = *found;
        } else {
          scene.warnings.push_back(info->message("the texture is left out: " + problem));
        }
      }
    }
    add_material(scene, material);
    material_texcoords_.push_back(texcoords);
  }
  add_material(scene, Material{});  // of primitives without one
  material_texcoords_.push_back(0);
}

std::uint32_t GltfMeshes::add_part(const JsonPlace& mesh, const std::string& name) {
  Part part;
  part.name = name;
  part.first_triangle = static_cast<std::uint32_t>(scene_.triangles.size());
  const JsonPlace primitives = mesh.need("primitives");
  primitives.check_array(1);
  for (std::size_t i = 0; i < primitives.size(); ++i) add_primitive(primitives.at(i));
  part.triangle_count = static_cast<std::uint32_t>(scene_.triangles.size()) - part.first_triangle;
  if (part.triangle_count == 0) return kNone;
  scene_.parts.push_back(std::move(part));
  return static_cast<std::uint32_t>(scene_.parts.size() - 1);
}

void GltfMeshes::add_primitive(const JsonPlace& primitive) {
  primitive.check_object();
  constexpr std::uint32_t kTriangles = 4, kStrip = 5, kFan = 6;
  const auto mode_place = primitive.find("mode");
  const std::uint32_t mode = mode_place ? mode_place->integer(0, 6) : kTriangles;
  if (mode < kTriangles) {
    ++not_triangles_;
    return;
  }
  if (primitive.find("targets")) ++morphed_;
  const JsonPlace attributes = primitive.need("attributes");
  const JsonPlace position_place = attributes.need("POSITION");
  const GltfValues positions = read_accessor(data_, position_place, "VEC3");
  const auto count = static_cast<std::uint32_t>(positions.count);
  if (scene_.positions.size() + positions.count > kMostVertices)
    position_place.fail("more than " + std::to_string(kMostVertices) + " vertices");
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  for (std::size_t i = 0; i < positions.count; ++i)
    scene_.positions.push_back(glm::vec3(positions.at(i, 0), positions.at(i, 1), positions.at(i, 2)));

  // Vertices have all attributes or the primitive goes without.
  const auto read_attribute = [&](const char* key, const char* type) -> std::optional<GltfValues> {
    const auto place = attributes.find(key);
    if (!place) return std::nullopt;
    GltfValues values = read_accessor(data_, *place, type);
    if (values.count == positions.count) return values;
    ++partial_;
    return std::nullopt;
  };
  const auto first_normal = static_cast<std::uint32_t>(scene_.normals.size());
  const auto normals = read_attribute("NORMAL", "VEC3");
  for (std::size_t i = 0; normals && i < normals->count; ++i)
    scene_.normals.push_back(glm::vec3(normals->at(i, 0), normals->at(i, 1), normals->at(i, 2)));
  std::uint32_t material = static_cast<std::uint32_t>(material_texcoords_.size() - 1);
  if (const auto place = primitive.find("material"))
    material = gltf_index(*place, material_texcoords_.size() - 1, "materials");
  const std::string set = "TEXCOORD_" + std::to_string(material_texcoords_[material]);
  const auto first_texcoord = static_cast<std::uint32_t>(scene_.texcoords.size());
  const auto texcoords = read_attribute(set.c_str(), "VEC2");
  // In glTF (0, 0) is the top left corner of an image, in a Scene the bottom left one.
  for (std::size_t i = 0; texcoords && i < texcoords->count; ++i)
    scene_.texcoords.push_back(glm::vec2(texcoords->at(i, 0), 1.0 - texcoords->at(i, 1)));

  const std::vector<std::uint32_t> corners = read_indices(primitive, count);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Triangle triangle;
    triangle.material = material;
    const std::uint32_t corner[3] = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.position[i] = first + corner[i];
      if (normals) triangle.normal[i] = first_normal + corner[i];
      if (texcoords) triangle.texcoord[i] = first_texcoord + corner[i];
    }
    const auto& p = triangle.position;
    if (!has_area(scene_.positions[p[0]], scene_.positions[p[1]], scene_.positions[p[2]])) {
      // Strips have such triangles on purpose.
      if (mode != kStrip) ++no_area_;
      return;
    }
    scene_.triangles.push_back(triangle);
    ++(normals ? scene_.source.patches : scene_.source.polygons);
  };
  if (mode == kTriangles) {
    if (corners.size() % 3 != 0)
      primitive.fail("triangles need a multiple of 3 corners, found " + std::to_string(corners.size()));
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) add(corners[i], corners[i + 1], corners[i + 2]);
  } else if (mode == kStrip) {
    // Every other triangle of a strip is turned over.
    for (std::size_t i = 0; i + 2 < corners.size(); ++i)
      add(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
  } else {
    static_assert(kFan == 6);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) add(corners[i], corners[i + 1], corners[0]);
  }
}

std::vector<std::uint32_t> GltfMeshes::read_indices(const JsonPlace& primitive, std::uint32_t vertex_count) {
  std::vector<std::uint32_t> corners;
  const auto place = primitive.find("indices");
  if (!place) {
    for (std::uint32_t i = 0; i < vertex_count; ++i) corners.push_back(i);
    return corners;
  }
  const GltfValues values = read_accessor(data_, *place, "SCALAR");
  for (std::size_t i = 0; i < values.count; ++i) {
    const double index = values.at(i);
    if (!(index >= 0.0 && index < vertex_count && index == std::floor(index)))
      place->fail("index " + std::to_string(i) + " is out of range: there are " + std::to_string(vertex_count) +
                  " vertices");
    corners.push_back(static_cast<std::uint32_t>(index));
  }
  return corners;
}

void GltfMeshes::report(const JsonPlace& root) {
  const auto tell = [&](std::size_t count, const std::string& message) {
    if (count > 0) scene_.warnings.push_back(root.message(message + " (" + std::to_string(count) + " in all)"));
  };
  tell(not_triangles_, "points and lines are no surfaces: primitives of them are left out");
  tell(morphed_, "morph targets are not read: primitives stand as they are without them");
  tell(no_area_, "triangles without area are left out");
  tell(partial_, "normals or texture coordinates of another number than the positions are left out");
}

}  // namespace plumbline
