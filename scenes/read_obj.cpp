// SPDX-License-Identifier: MIT
// The reader of Wavefront OBJ files: tinyobjloader reads what obj_scan has found to be sound; polygons are cut by our
// own triangulation, for tinyobjloader's fails on many concave ones and may take cubic time.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <istream>
#include <map>
#include <streambuf>

#include "scenes/builder.h"
#include "scenes/error.h"
#include "scenes/obj_scan.h"
#include "scenes/read_formats.h"
#include "scenes/read_mtl.h"
#include "scenes/triangulate.h"

namespace plumbline {
namespace {

/// A stream over text in place.
struct TextStream : private std::streambuf, public std::istream {
  explicit TextStream(std::string& text) : std::istream(static_cast<std::streambuf*>(this)) {
    setg(text.data(), text.data(), text.data() + text.size());
  }
};

class ObjBuilder {
 public:
  ObjBuilder(const std::string& file, Scene& scene, const ObjScan& scan, std::map<std::string, std::uint32_t> materials)
      : file_(file), scene_(scene), scan_(scan), materials_(std::move(materials)) {}

  void vertex(const glm::vec3& position) { scene_.positions.push_back(position), ++vertex_count_; }
  void normal(const glm::vec3& normal) { scene_.normals.push_back(normal), ++normal_count_; }
  void texcoord(const glm::vec2& texcoord) { scene_.texcoords.push_back(texcoord), ++texcoord_count_; }

  void use_material(std::string_view name) {
    if (trimmed(name).empty()) return;  // the scan has warned of it
    PLUMBLINE_ASSERT(usemtl_count_ < scan_.usemtl_lines.size());
    const std::size_t line = scan_.usemtl_lines[usemtl_count_++];
    const auto found = materials_.find(std::string(trimmed(name)));
    material_ = found == materials_.end() ? kNone : found->second;
    if (material_ == kNone) unknown_material_.add(line);
  }

  void face(const tinyobj::index_t* indices, std::size_t count) {
    PLUMBLINE_ASSERT(face_count_ < scan_.face_lines.size());
    faces_.push_back({scan_.face_lines[face_count_++], static_cast<std::uint32_t>(corners_.size()),
                      static_cast<std::uint32_t>(count), material_});
    for (std::size_t i = 0; i < count; ++i) {
      corners_.push_back({resolve(indices[i].vertex_index, vertex_count_),
                          resolve(indices[i].texcoord_index, texcoord_count_),
                          resolve(indices[i].normal_index, normal_count_)});
    }
  }

  /// Cuts the faces, once all vertices are there: a face may name later ones.
  void finish() {
    PLUMBLINE_ASSERT(face_count_ == scan_.face_lines.size() && usemtl_count_ == scan_.usemtl_lines.size());
    scene_.triangles.reserve(faces_.size());
    for (const Face& face : faces_) add_face(face);
    auto& warnings = scene_.warnings;
    unknown_material_.report(warnings, file_, "a material that no MTL file has: a white matte one stands for it");
    few_corners_.report(warnings, file_, "a face with fewer than 3 corners is left out");
    no_area_.report(warnings, file_, "a face without area is left out");
    crossing_.report(warnings, file_, "a face crosses itself: all that it winds around is filled");
    partial_.report(warnings, file_,
                    "a face has normals or texture coordinates at some corners only: they are left out");
  }

 private:
  /// Indices of a corner, from 0; kNone where absent.
  struct Corner {
    std::uint32_t position = kNone, texcoord = kNone, normal = kNone;
  };
  struct Face {
    std::size_t line;
    std::uint32_t first, count, material;
  };

  // The scan has made sure that indices are in range; counts are those at the time of the face, as negative ones need.
  static std::uint32_t resolve(int index, std::uint32_t count) {
    if (index == 0) return kNone;
    return index > 0 ? static_cast<std::uint32_t>(index - 1) : count - static_cast<std::uint32_t>(-index);
  }

  std::uint32_t material_or_default(std::uint32_t material) {
    if (material != kNone) return material;
    if (default_material_ == kNone) default_material_ = add_material(scene_, Material{});
    return default_material_;
  }

  void add_face(const Face& face) {
    if (face.count < 3) return few_corners_.add(face.line);
    std::vector<Corner>& corner = face_corners_;
    corner.assign(corners_.begin() + face.first, corners_.begin() + face.first + face.count);
    std::size_t with_normal = 0, with_texcoord = 0;
    points_.clear();
    for (const Corner& c : corner) {
      PLUMBLINE_ASSERT(c.position < scene_.positions.size());
      points_.push_back(scene_.positions[c.position]);
      with_normal += c.normal != kNone ? 1 : 0;
      with_texcoord += c.texcoord != kNone ? 1 : 0;
    }
    const bool has_normals = with_normal == corner.size(), has_texcoords = with_texcoord == corner.size();
    if ((with_normal > 0 && !has_normals) || (with_texcoord > 0 && !has_texcoords)) partial_.add(face.line);
    ++(has_normals ? scene_.source.patches : scene_.source.polygons);

    const Triangulation cut = triangulate(points_);
    if (cut.too_complex) {
      throw InputError(file_, face.line,
                       "a face of " + std::to_string(face.count) +
                           " corners is too large, or its edges cross too often to be cut into triangles; split it");
    }
    if (cut.triangles.empty()) return no_area_.add(face.line);
    if (!cut.blended.empty()) crossing_.add(face.line);
    for (const BlendedCorner& blended : cut.blended)
      corner.push_back(blend(corner, blended, has_normals, has_texcoords));
    const std::uint32_t material = material_or_default(face.material);
    for (const auto& index : cut.triangles) {
      Triangle triangle;
      triangle.material = material;
      for (std::size_t i = 0; i < 3; ++i) {
        triangle.position[i] = corner[index[i]].position;
        if (has_normals) triangle.normal[i] = corner[index[i]].normal;
        if (has_texcoords) triangle.texcoord[i] = corner[index[i]].texcoord;
      }
      scene_.triangles.push_back(triangle);
    }
  }

  /// A new corner where edges cross, with the weighted mean of what its sources have.
  Corner blend(const std::vector<Corner>& corner, const BlendedCorner& blended, bool has_normals, bool has_texcoords) {
    Corner added;
    added.position = static_cast<std::uint32_t>(scene_.positions.size());
    scene_.positions.push_back(blended.position);
    if (has_normals) {
      glm::vec3 mean(0.0f);
      for (std::size_t i = 0; i < 4; ++i) mean += blended.weight[i] * scene_.normals[corner[blended.source[i]].normal];
      added.normal = static_cast<std::uint32_t>(scene_.normals.size());
      scene_.normals.push_back(mean);
    }
    if (has_texcoords) {
      glm::vec2 mean(0.0f);
      for (std::size_t i = 0; i < 4; ++i)
        mean += blended.weight[i] * scene_.texcoords[corner[blended.source[i]].texcoord];
      added.texcoord = static_cast<std::uint32_t>(scene_.texcoords.size());
      scene_.texcoords.push_back(mean);
    }
    return added;
  }

  const std::string& file_;
  Scene& scene_;
  const ObjScan& scan_;
  const std::map<std::string, std::uint32_t> materials_;
  std::uint32_t vertex_count_ = 0, normal_count_ = 0, texcoord_count_ = 0, material_ = kNone, default_material_ = kNone;
  std::size_t face_count_ = 0, usemtl_count_ = 0;
  std::vector<Face> faces_;
  std::vector<Corner> corners_, face_corners_;
  std::vector<glm::vec3> points_;
  WarningTally unknown_material_, few_corners_, no_area_, crossing_, partial_;
};

/// Overwrites comments behind numbers with blanks: tinyobjloader would take them for numbers. Names may have a # in
/// them.
void blank_comments(std::string& text, const std::vector<TextLine>& lines) {
  for (const TextLine& line : lines) {
    const std::string_view statement = trimmed(line.text);
    if (!statement.starts_with('v') && !statement.starts_with('f')) continue;
    const std::size_t comment = line.text.find('#');
    if (comment == line.text.npos) continue;
    const auto start = text.begin() + (line.text.data() - text.data()) + static_cast<std::ptrdiff_t>(comment);
    std::fill(start, start + static_cast<std::ptrdiff_t>(line.text.size() - comment), ' ');
  }
}

ObjBuilder& builder(void* user) { return *static_cast<ObjBuilder*>(user); }

}  // namespace

Scene read_obj(const std::filesystem::path& path, std::string&& text) {
  const std::string file = path.string();
  Scene scene;
  const std::vector<TextLine> lines = split_lines(text, true);
  blank_comments(text, lines);
  ObjScan scan = scan_obj(file, lines);
  scene.warnings = std::move(scan.warnings);
  auto materials = read_materials(scene, path, scan.libraries);
  ObjBuilder target(file, scene, scan, std::move(materials));

  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = [](void* user, float x, float y, float z, float) { builder(user).vertex({x, y, z}); };
  callbacks.normal_cb = [](void* user, float x, float y, float z) { builder(user).normal({x, y, z}); };
  callbacks.texcoord_cb = [](void* user, float u, float v, float) { builder(user).texcoord({u, v}); };
  callbacks.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
    builder(user).face(indices, static_cast<std::size_t>(count));
  };
  callbacks.usemtl_cb = [](void* user, const char* name, int) { builder(user).use_material(name); };
  TextStream stream(text);
  std::string warning, error;
  if (!tinyobj::LoadObjWithCallback(stream, callbacks, &target, nullptr, &warning, &error)) {
    throw InputError(file + ": tinyobjloader cannot read it: " + error);
  }
  target.finish();
  frame_camera(scene);
  return scene;
}

}  // namespace plumbline
