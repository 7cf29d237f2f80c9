// SPDX-License-Identifier: MIT
#include "scenes/read.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "scenes/error.h"
#include "scenes/read_formats.h"
#include "scenes/read_scene_file.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

struct Format {
  std::string_view ending;
  Scene (*read)(const std::filesystem::path&, std::string&& content);
  bool is_text = true;
};
constexpr std::array<Format, 5> kFormats = {{{".nff", read_nff},
                                             {".obj", read_obj},
                                             {".json", read_scene_file},
                                             {".gltf", read_gltf},
                                             {".glb", read_gltf, false}}};

/// A number may be a float and what is built from it too large for one.
void check_extent(const Scene& scene, const std::string& file) {
  const auto is_finite = [](const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  if (!std::all_of(scene.positions.begin(), scene.positions.end(), is_finite)) {
    throw InputError(file + ": coordinates are too large for 32-bit numbers; scale the scene down");
  }
}

}  // namespace

std::string known_endings() {
  std::string endings;
  for (const Format& format : kFormats) {
    if (!endings.empty()) endings += ", ";
    endings += format.ending;
  }
  return endings;
}

Scene read_scene(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Format& format : kFormats) {
    if (format.ending != ending) continue;
    Scene scene = format.read(path, format.is_text ? read_text_file(path) : read_file(path));
    scene.name = path.stem().string();
    check_extent(scene, path.string());
    if (placed_count(scene) == 0) {
      std::string message = path.string() + ": nothing to trace: no triangle or sphere was found";
      for (const std::string& warning : scene.warnings) message.append("; ").append(warning);
      throw InputError(message);
    }
    return scene;
  }
  std::error_code failure;
  if (std::filesystem::is_directory(path, failure))
    throw InputError(path.string() + ": this is a folder; name a file in it");
  throw InputError(path.string() + ": no reader for the ending " + shown(ending) + "; there are readers for " +
                   known_endings());
}

}  // namespace plumbline
