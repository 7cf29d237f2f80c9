// SPDX-License-Identifier: MIT
#include "scenes/generate.h"

#include <algorithm>
#include <array>
#include <string>

#include "scenes/error.h"
#include "scenes/generate_mesh.h"
#include "scenes/generate_spd.h"
#include "scenes/read.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

constexpr std::array<Generator, 10> kGenerators = {{
    {"sphereflake", "SPD \"balls\": a sphere that bears nine of a third of its size, SIZE times over, above a square",
     4, 1, 6, make_sphereflake},
    {"mount", "SPD: a fractal mountain of 2 * 4^SIZE triangles and four glass spheres", 4, 1, 7, make_mount},
    {"tetra", "SPD: a Sierpinski pyramid of 4^SIZE triangles", 4, 1, 10, make_tetra},
    {"rings", "SPD: a pyramid of SIZE layers of knots, each of 30 cylinders and 30 spheres", 3, 1, 12, make_rings},
    {"gears", "SPD: SIZE^3 gears whose faces are concave polygons of 144 corners", 2, 1, 8, make_gears},
    {"creature", "a closed animal of exactly 882 triangles with smooth normals", 1, 1, 1, make_creature},
    {"grid", "a height field of exactly SIZE triangles, open at its border", 100'000, 1, 20'000'000, make_grid},
    {"torus", "a bumpy closed ring of SIZE triangles, rounded to what a grid of quadrilaterals gives", 100'000, 18,
     20'000'000, make_torus},
    {"icosphere", "a ball of 20 * 4^SIZE triangles with smooth normals, closed", 4, 1, 10, make_icosphere},
    {"cube", "a cube of 12 triangles whose corners, edges and planes are exact in floats, closed", 1, 1, 1, make_cube},
}};

std::string known_generators() {
  std::string names;
  for (const Generator& generator : kGenerators) {
    if (!names.empty()) names += ", ";
    names += generator.name;
  }
  return names;
}

const Generator* find_generator(std::string_view name) {
  for (const Generator& generator : kGenerators) {
    if (generator.name == name) return &generator;
  }
  return nullptr;
}

/// The scene files of a folder, by name.
std::vector<std::string> scenes_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    const std::filesystem::path& path = entry.path();
    // The schema is no scene.
    if (path.extension() == ".json" && path.stem().extension().empty()) names.push_back(path.stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::span<const Generator> generators() { return kGenerators; }

Scene generate_scene(std::string_view name, int size) {
  const Generator* const generator = find_generator(name);
  if (generator == nullptr) {
    throw InputError("no generator is called " + shown(name) + "; there are " + known_generators());
  }
  if (size == 0) size = generator->default_size;
  if (size < generator->min_size || size > generator->max_size) {
    throw InputError(std::string(name) + ": size " + std::to_string(size) + " is out of range; it takes " +
                     std::to_string(generator->min_size) + " to " + std::to_string(generator->max_size));
  }
  Scene scene = generator->make(size);
  scene.name = std::string(name);
  if (generator->min_size < generator->max_size) scene.name.append("_").append(std::to_string(size));
  return scene;
}

Scene load_scene(std::string_view spec) {
  const std::size_t colon = spec.find(':');
  const std::string_view name = spec.substr(0, colon);
  if (find_generator(name) != nullptr) {
    if (colon == spec.npos) return generate_scene(name);
    const auto size = parse_integer(spec.substr(colon + 1));
    const Generator& generator = *find_generator(name);
    if (!size || *size < generator.min_size || *size > generator.max_size) {
      throw InputError(shown(spec) + ": the size must be a whole number from " + std::to_string(generator.min_size) +
                       " to " + std::to_string(generator.max_size) + ", as in \"" + std::string(name) + ":" +
                       std::to_string(generator.default_size) + "\"");
    }
    return generate_scene(name, static_cast<int>(*size));
  }
  const std::filesystem::path path{std::string(spec)};
  std::error_code failure;
  if (std::filesystem::exists(path, failure)) return read_scene(path);
  const std::vector<std::string> shipped = shipped_scenes();
  if (std::find(shipped.begin(), shipped.end(), spec) != shipped.end())
    return read_scene(std::filesystem::path(PLUMBLINE_SCENE_FOLDER) / (std::string(spec) + ".json"));
  const std::filesystem::path picture =
      std::filesystem::path(PLUMBLINE_SCENE_FOLDER) / "pictures" / (std::string(spec) + ".json");
  const std::vector<std::string> pictures = picture_scenes();
  if (std::find(pictures.begin(), pictures.end(), spec) != pictures.end()) return read_scene(picture);
  std::string known;
  for (const std::string& scene : shipped) known += (known.empty() ? "" : ", ") + scene;
  for (const std::string& scene : pictures) known += ", " + scene;
  throw InputError(shown(spec) + ": neither a file nor a generator nor a scene of ours; files end in " +
                   known_endings() + ", generators are " + known_generators() + ", scenes are " + known);
}

std::vector<std::string> shipped_scenes() { return scenes_in(PLUMBLINE_SCENE_FOLDER); }

std::vector<std::string> picture_scenes() {
  return scenes_in(std::filesystem::path(PLUMBLINE_SCENE_FOLDER) / "pictures");
}

}  // namespace plumbline
