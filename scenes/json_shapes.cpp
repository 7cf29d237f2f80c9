// SPDX-License-Identifier: MIT
#include "scenes/json_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/builder.h"
#include "scenes/error.h"
#include "scenes/generate_texture.h"
#include "scenes/text_file.h"
#include "scenes/texture.h"
#include "scenes/near_words.h"

namespace plumbline {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();

std::uint32_t read_texture(const JsonPlace& place, const std::filesystem::path& folder, TextureKind kind,
                           MeshPool& pool) {
  if (is_generated_texture(place.text())) {
    try {
      return pool.add_texture(generate_texture(place.text()));
    } catch (const InputError& error) {
      place.fail(error.what());
    }
  }
  Scene holder;
  std::string problem;
  if (!find_texture(holder, folder / place.text(), kind, problem)) place.fail(problem);
  return pool.add_texture(std::move(holder.textures.front()));
}

Material read_material(const JsonPlace& place, const std::filesystem::path& folder, MeshPool& pool) {
  place.allow({"color", "diffuse", "specular", "shine", "transmittance", "refraction_index", "diffuse_texture",
               "bump_texture", "bump_scale", "glossy"});
  Material material;
  const auto read_factor = [&](const char* key, float& value, double most) {
    if (const auto found = place.find(key)) value = static_cast<float>(found->number_between(0.0, most));
  };
  if (const auto color = place.find("color")) {
    material.color = glm::vec3(color->vector());
    if (glm::any(glm::lessThan(material.color, glm::vec3(0.0f)))) color->fail("a colour must not be negative");
  }
  read_factor("diffuse", material.diffuse, 1.0);
  read_factor("specular", material.specular, 1.0);
  read_factor("shine", material.shine, 1e6);
  read_factor("transmittance", material.transmittance, 1.0);
  read_factor("refraction_index", material.refraction_index, 100.0);
  if (const auto texture = place.find("diffuse_texture"))
    material.diffuse_texture = read_texture(*texture, folder, TextureKind::color, pool);
  if (const auto texture = place.find("bump_texture"))
    material.bump_texture = read_texture(*texture, folder, TextureKind::height, pool);
  if (const auto scale = place.find("bump_scale")) material.bump_scale = static_cast<float>(scale->number());
  read_factor("glossy", material.glossy, 1.0);
  return material;
}

/// A coordinate may be a double that rounds to infinity: number() has refused those beyond the largest float, so none
/// does.
glm::vec3 read_point(const JsonPlace& place) { return glm::vec3(place.vector()); }

/// Above 0 as a float too.
float read_radius(const JsonPlace& place) {
  const auto radius = static_cast<float>(place.number());
  if (!(radius > 0.0f)) place.fail("a radius must be above 0");
  return radius;
}

class ShapeReader {
 public:
  ShapeReader(const NamedMaterials& materials, std::uint32_t material, MeshPool& pool)
      : materials_(materials), material_(material), pool_(pool) {}

  void sphere(const JsonPlace& place) {
    place.allow({"center", "radius", "material"});
    add_sphere(scene_, read_point(place.need("center")), read_radius(place.need("radius")), material_of(place));
  }

  /// A fan of triangles around its centre, facing along the normal.
  void disc(const JsonPlace& place) {
    place.allow({"center", "normal", "radius", "sides", "material"});
    const auto center_place = place.find("center"), normal_place = place.find("normal"),
               sides_place = place.find("sides");
    const glm::dvec3 center = center_place ? center_place->vector() : glm::dvec3(0.0);
    glm::dvec3 normal = normal_place ? normal_place->vector() : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 size = glm::abs(normal);
    if (!(size.x + size.y + size.z > 0.0)) normal_place->fail("a normal must not be zero");
    normal = glm::normalize(normal / std::max({size.x, size.y, size.z}));
    const double radius = read_radius(place.need("radius"));
    const std::uint32_t sides = sides_place ? sides_place->integer(3, 1u << 20) : 64;

    const glm::dvec3 helper = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                              : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                   : glm::dvec3(0, 0, 1);
    const glm::dvec3 u = glm::normalize(glm::cross(normal, helper)), v = glm::cross(normal, u);
    const auto first = static_cast<std::uint32_t>(scene_.positions.size());
    const std::uint32_t material = material_of(place);
    scene_.positions.push_back(glm::vec3(center));
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2.0 * 3.141592653589793 * i / sides;
      const glm::dvec3 rim = center + radius * (std::cos(angle) * u + std::sin(angle) * v);
      const glm::dvec3 extent = glm::abs(rim);
      if (!(std::max({extent.x, extent.y, extent.z}) <= kLargest)) place.fail("too large for 32-bit numbers");
      scene_.positions.push_back(glm::vec3(rim));
      Triangle triangle;
      triangle.position = {first, first + 1 + i, first + 1 + (i + 1) % sides};
      triangle.material = material;
      scene_.triangles.push_back(triangle);
    }
    ++scene_.source.polygons;
  }

  /// A mesh of the keys of `part`; normals and texture coordinates belong to the positions of their numbers.
  void mesh(const JsonPlace& part, std::uint32_t material) {
    const JsonPlace positions = part.need("positions"), triangles = part.need("triangles");
    positions.check_array(3);
    triangles.check_array(1);
    const auto first = static_cast<std::uint32_t>(scene_.positions.size());
    const auto count = static_cast<std::uint32_t>(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) scene_.positions.push_back(read_point(positions.at(i)));
    const auto normals = part.find("normals"), texcoords = part.find("texcoords");
    if (normals) normals->check_array(count, count);
    if (texcoords) texcoords->check_array(count, count);
    for (std::uint32_t i = 0; normals && i < count; ++i) scene_.normals.push_back(read_point(normals->at(i)));
    for (std::uint32_t i = 0; texcoords && i < count; ++i) {
      const JsonPlace texcoord = texcoords->at(i);
      texcoord.check_array(2, 2);
      scene_.texcoords.push_back(glm::vec2(glm::dvec2(texcoord.at(0).number(), texcoord.at(1).number())));
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const JsonPlace corners = triangles.at(t);
      corners.check_array(3, 3);
      Triangle triangle;
      triangle.material = material;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t corner = corners.at(i).integer(0, count - 1);
        triangle.position[i] = first + corner;
        if (normals) triangle.normal[i] = corner;
        if (texcoords) triangle.texcoord[i] = corner;
      }
      scene_.triangles.push_back(triangle);
      ++scene_.source.polygons;
    }
  }

  std::uint32_t material_of(const JsonPlace& place) {
    if (const auto material = place.find("material")) return find_material(materials_, *material);
    if (material_ == kNone) material_ = pool_.add_material(Material{});
    return material_;
  }

  Scene take() { return std::move(scene_); }

 private:
  const NamedMaterials& materials_;
  std::uint32_t material_;
  MeshPool& pool_;
  Scene scene_;
};

}  // namespace

NamedMaterials read_materials(const JsonPlace& place, const std::filesystem::path& folder, MeshPool& pool) {
  place.check_object();
  NamedMaterials materials;
  for (std::size_t i = 0; i < place.size(); ++i) {
    Material material = read_material(place.at(i), folder, pool);
    material.name = place.key(i);
    materials.emplace(place.key(i), pool.add_material(material));
  }
  return materials;
}

std::uint32_t find_material(const NamedMaterials& materials, const JsonPlace& place) {
  const auto found = materials.find(place.text());
  if (found != materials.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, number] : materials) names.push_back(name);
  std::sort(names.begin(), names.end());
  place.fail("no material is called " + shown(place.text()) + did_you_mean(place.text(), names) +
             "; name it in 'materials'");
}

Scene read_shapes(const JsonPlace& part, const NamedMaterials& materials, std::uint32_t material, MeshPool& pool) {
  ShapeReader reader(materials, material, pool);
  if (const auto spheres = part.find("spheres")) {
    spheres->check_array(1);
    for (std::size_t i = 0; i < spheres->size(); ++i) reader.sphere(spheres->at(i));
  }
  if (const auto discs = part.find("discs")) {
    discs->check_array(1);
    for (std::size_t i = 0; i < discs->size(); ++i) reader.disc(discs->at(i));
  }
  const auto positions = part.find("positions"), triangles = part.find("triangles");
  if (positions && !triangles) positions->fail("positions need 'triangles', which name three of them each");
  if (triangles && !positions) triangles->fail("triangles need 'positions', which they name by number");
  for (const char* const key : {"normals", "texcoords"}) {
    if (const auto found = part.find(key); found && !positions) found->fail("these belong to 'positions'");
  }
  if (positions) reader.mesh(part, reader.material_of(part));
  return reader.take();
}

}  // namespace plumbline
