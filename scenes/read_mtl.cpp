// SPDX-License-Identifier: MIT
#include "scenes/read_mtl.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scenes/error.h"
#include "scenes/texture.h"

namespace plumbline {
namespace {

/// What tinyobjloader does not tell of a material: which statements it has, and where.
struct Entry {
  std::string name;
  std::size_t line = 0;
  bool has_color = false, has_filter = false;
  std::size_t diffuse_line = 0, bump_line = 0;  // of the texture statements, 0 where there are none
};

/// An MTL file reduced to the statements that are used, with every number checked.
struct Cleaned {
  std::string text;
  std::vector<Entry> entries;
};

class Cleaner {
 public:
  Cleaner(Scene& scene, const std::string& file) : scene_(scene), file_(file) {}

  Cleaned clean(const std::vector<TextLine>& lines) {
    for (const TextLine& line : lines) statement(line);
    homeless_.report(scene_.warnings, file_, "statements before the first newmtl with a name are not read");
    spectral_.report(scene_.warnings, file_, "spectral and xyz colours are not read");
    options_.report(scene_.warnings, file_, "texture options other than -bm are not used");
    for (const auto& [keyword, tally] : left_out_)
      tally.report(scene_.warnings, file_, "statements " + keyword + " are not used");
    return std::move(cleaned_);
  }

 private:
  void statement(const TextLine& line) {
    const std::string_view text = trimmed(line.text);
    if (text.empty() || text[0] == '#') return;
    check_text(file_, line);
    number_ = line.number;
    const std::vector<std::string_view> all = split_words(text);
    const std::string keyword(all[0]);
    // A comment may follow a statement of numbers.
    std::vector<std::string_view> words(all.begin() + 1,
                                        std::find_if(all.begin() + 1, all.end(), [](auto w) { return w[0] == '#'; }));

    if (keyword == "newmtl") {
      is_inside_ = all.size() > 1;
      if (!is_inside_) return homeless_.add(number_);
      const std::string name(trimmed(text.substr(keyword.size())));
      cleaned_.entries.push_back({name, number_});
      write("newmtl " + name);
      return;
    }
    if (!is_inside_) return homeless_.add(number_);
    Entry& entry = cleaned_.entries.back();
    if (keyword == "Kd" || keyword == "Ks" || keyword == "Tf") {
      if (!color(keyword, words)) return;
      entry.has_color |= keyword == "Kd";
      entry.has_filter |= keyword == "Tf";
    } else if (keyword == "Ns" || keyword == "Ni" || keyword == "d" || keyword == "Tr" || keyword == "illum") {
      if (!words.empty() && words[0] == "-halo") words.erase(words.begin());
      if (words.size() != 1) throw InputError(file_, number_, keyword + " takes one number");
      write(keyword + " " + checked(words[0]));
    } else if (keyword == "map_Kd") {
      texture(entry.diffuse_line, "map_Kd", text.substr(keyword.size()), all);
    } else if (keyword == "map_bump" || keyword == "map_Bump" || keyword == "bump") {
      texture(entry.bump_line, "bump", text.substr(keyword.size()), all);
    } else if (keyword != "Ka") {  // there is no ambient light
      left_out_[shown(keyword)].add(number_);
    }
  }

  std::string checked(std::string_view word) const {
    if (!parse_float(word)) throw InputError(file_, number_, "expected a finite number, found " + shown(word));
    return std::string(word);
  }

  bool color(const std::string& keyword, const std::vector<std::string_view>& words) {
    if (!words.empty() && (words[0] == "spectral" || words[0] == "xyz")) {
      spectral_.add(number_);
      return false;
    }
    if (words.size() != 1 && words.size() != 3) throw InputError(file_, number_, keyword + " takes 1 number or 3");
    // One number stands for three.
    std::string line = keyword;
    for (std::size_t i = 0; i < 3; ++i) line.append(" ").append(checked(words[words.size() == 3 ? i : 0]));
    write(line);
    return true;
  }

  void texture(std::size_t& line, const std::string& keyword, std::string_view rest,
               const std::vector<std::string_view>& words) {
    if (words.size() < 2) throw InputError(file_, number_, keyword + " names no image file");
    if (std::any_of(words.begin() + 1, words.end(), [](auto word) {
          return word.size() > 1 && word[0] == '-' && word != "-bm" && !parse_float(word);
        })) {
      options_.add(number_);
    }
    line = number_;
    write(keyword + " " + std::string(trimmed(rest)));
  }

  void write(const std::string& line) { cleaned_.text.append(line).append("\n"); }

  Scene& scene_;
  const std::string& file_;
  Cleaned cleaned_;
  std::size_t number_ = 0;
  bool is_inside_ = false;
  WarningTally homeless_, spectral_, options_;
  std::map<std::string, WarningTally> left_out_;
};

/// A factor moved into [0, 1], and counted where it had to be.
float factor(float value, std::size_t line, WarningTally& out_of_range) {
  if (value >= 0.0f && value <= 1.0f) return value;
  out_of_range.add(line);
  return std::clamp(value, 0.0f, 1.0f);
}

std::uint32_t texture_index(Scene& scene, const std::string& file, std::size_t line, const std::string& name,
                            TextureKind kind) {
  std::string slashed(trimmed(name)), problem;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  const auto found = find_texture(scene, std::filesystem::path(file).parent_path() / slashed, kind, problem);
  if (found) return *found;
  scene.warnings.push_back(file + ":" + std::to_string(line) + ": the texture " + shown(slashed) +
                           " is left out: " + problem);
  return kNone;
}

Material convert(Scene& scene, const std::string& file, const Entry& entry, const tinyobj::material_t& source,
                 WarningTally& out_of_range) {
  Material material;
  material.name = entry.name;
  // Without Kd a texture stands for itself; without either the surface is grey.
  material.color = entry.has_color          ? glm::vec3(source.diffuse[0], source.diffuse[1], source.diffuse[2])
                   : entry.diffuse_line > 0 ? glm::vec3(1.0f)
                                            : glm::vec3(0.8f);
  for (int i = 0; i < 3; ++i) material.color[i] = factor(material.color[i], entry.line, out_of_range);
  material.specular =
      factor(std::max({source.specular[0], source.specular[1], source.specular[2]}), entry.line, out_of_range);
  material.shine = std::max(source.shininess, 0.0f);
  material.transmittance = factor(1.0f - source.dissolve, entry.line, out_of_range);
  const bool refracts = source.illum == 4 || source.illum == 6 || source.illum == 7 || source.illum == 9;
  if (refracts && material.transmittance == 0.0f) {
    const float* const filter = source.transmittance;
    material.transmittance =
        entry.has_filter ? factor((filter[0] + filter[1] + filter[2]) / 3.0f, entry.line, out_of_range) : 1.0f;
  }
  material.refraction_index = source.ior > 0.0f ? source.ior : 1.0f;
  if (entry.diffuse_line > 0) {
    material.diffuse_texture =
        texture_index(scene, file, entry.diffuse_line, source.diffuse_texname, TextureKind::color);
  }
  if (entry.bump_line > 0) {
    material.bump_texture = texture_index(scene, file, entry.bump_line, source.bump_texname, TextureKind::height);
    material.bump_scale = source.bump_texopt.bump_multiplier;
  }
  return material;
}

void read_library(Scene& scene, const std::filesystem::path& path, std::map<std::string, std::uint32_t>& by_name) {
  const std::string file = path.string();
  std::string text = read_text_file(path);
  const Cleaned cleaned = Cleaner(scene, file).clean(split_lines(text, true));
  if (cleaned.entries.empty()) return;
  std::istringstream stream(cleaned.text);
  std::map<std::string, int> ignored_map;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  tinyobj::LoadMtl(&ignored_map, &materials, &stream, &warning, &error);
  PLUMBLINE_ASSERT(materials.size() == cleaned.entries.size());
  WarningTally out_of_range, twice;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Entry& entry = cleaned.entries[i];
    const auto [place, is_new] = by_name.try_emplace(entry.name, static_cast<std::uint32_t>(scene.materials.size()));
    if (!is_new) {
      twice.add(entry.line);
      continue;
    }
    scene.materials.push_back(convert(scene, file, entry, materials[i], out_of_range));
  }
  out_of_range.report(scene.warnings, file,
                      "a colour or factor of a material lies outside 0 to 1 and is moved to the nearer of them");
  twice.report(scene.warnings, file, "a material of a name that was there before is left out");
}

}  // namespace

std::map<std::string, std::uint32_t> read_materials(Scene& scene, const std::filesystem::path& obj_path,
                                                    const std::vector<NamedLine>& libraries) {
  constexpr std::size_t kMostNames = 4096;  // characters of a statement beyond which it is junk, not a list of names
  std::map<std::string, std::uint32_t> by_name;
  std::vector<std::filesystem::path> done;
  for (const NamedLine& library : libraries) {
    // One name may have blanks in it, or a blank may part two names: what exists decides.
    std::string slashed = library.name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    const auto beside = [&](std::string_view name) { return obj_path.parent_path() / name; };
    const auto is_file = [](const std::filesystem::path& path) {
      std::error_code failure;
      return std::filesystem::is_regular_file(path, failure) && std::filesystem::file_size(path, failure) > 0;
    };
    std::vector<std::string_view> names{slashed};
    if (!is_file(beside(slashed)) && slashed.size() < kMostNames) names = split_words(slashed);
    for (const std::string_view name : names) {
      const std::filesystem::path path = beside(name);
      if (std::find(done.begin(), done.end(), path) != done.end()) continue;
      done.push_back(path);
      if (is_file(path)) {
        read_library(scene, path, by_name);
      } else {
        scene.warnings.push_back(obj_path.string() + ":" + std::to_string(library.line) + ": the material file " +
                                 shown(name) + " is missing or empty: its materials are replaced by a white matte one");
      }
    }
  }
  return by_name;
}

}  // namespace plumbline
