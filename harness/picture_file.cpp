// SPDX-License-Identifier: GPL-3.0-or-later
// From means and variances to channels and bytes.
#include "harness/picture_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "harness/version.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

float number_or_none(std::uint32_t number) { return number == kNone ? -1.0f : static_cast<float>(number); }

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// round(255 srgb(clamp(value, 0, 1))); a NaN is black.
std::uint8_t stored(double value) {
  const double linear = value > 0.0 ? std::min(value, 1.0) : 0.0;
  return static_cast<std::uint8_t>(std::lround(255.0f * to_srgb(static_cast<float>(linear))));
}

/// The shortest text that reads back as the same double.
std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

struct EffectSwitch {
  const char* name;
  bool Effects::*on;
};
constexpr std::array<EffectSwitch, 5> kSwitches{{{"aa", &Effects::antialias},
                                                 {"dof", &Effects::depth_of_field},
                                                 {"soft_shadow", &Effects::soft_shadows},
                                                 {"glossy", &Effects::glossy_reflections},
                                                 {"motion_blur", &Effects::motion_blur}}};

}  // namespace

std::string effect_names(const Effects& effects) {
  std::string names;
  for (const EffectSwitch& one : kSwitches)
    if (effects.*one.on) names += (names.empty() ? "" : ",") + std::string(one.name);
  return names.empty() ? "none" : names;
}

void set_effects(const std::string& list, Effects& effects) {
  const bool all = list == "all";
  for (const EffectSwitch& one : kSwitches) effects.*one.on = all;
  if (all || list == "none") return;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    const auto found =
        std::find_if(kSwitches.begin(), kSwitches.end(), [&](const EffectSwitch& one) { return word == one.name; });
    if (found == kSwitches.end())
      throw InputError("--effects takes all, none, or a list of aa, dof, soft_shadow, glossy, motion_blur; '" + word +
                       "' is none of them");
    effects.*found->on = true;
  }
}

PictureAttributes picture_attributes(const std::string& engine, const std::string& scene, std::uint32_t first_frame,
                                     std::uint32_t frames, std::uint64_t seed, double time, const Effects& effects) {
  return {{"plumbline.engine", engine},
          {"plumbline.version", version()},
          {"plumbline.commit", commit()},
          {"plumbline.scene", scene},
          {"plumbline.first_frame", static_cast<int>(first_frame)},
          {"plumbline.frames", static_cast<int>(frames)},
          {"plumbline.seed", std::to_string(seed)},
          {"plumbline.time", shortest(time)},
          {"plumbline.model", effects.model == Effects::Model::physical ? "physical" : "paper"},
          {"plumbline.effects", effect_names(effects)},
          {"plumbline.glossy", effects.glossy},
          {"plumbline.depth", static_cast<int>(effects.depth)}};
}

void require_picture_name(const std::filesystem::path& path) {
  if (path.extension() != ".png" && path.extension() != ".exr")
    throw InputError(path.string() + ": a picture's name ends in .exr or .png");
  std::error_code failure;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, failure))
    throw InputError(path.string() + ": there is no folder " + folder.string() + "; make it first");
}

Image picture_image(const RenderedPicture& picture, const PictureAttributes& attributes) {
  Image image;
  image.width = picture.width;
  image.height = picture.height;
  image.channels = {"R", "G", "B"};
  const bool has_variance = !picture.variance.empty(), has_steps = !picture.steps.empty();
  if (has_variance) image.channels.insert(image.channels.end(), {"variance.R", "variance.G", "variance.B"});
  image.channels.insert(image.channels.end(), {"depth", "normal.X", "normal.Y", "normal.Z", "primitive", "instance"});
  if (has_steps) image.channels.emplace_back("steps");
  image.pixels.reserve(picture.mean.size() * image.channels.size());
  const auto add = [&](const auto& v) {
    for (int axis = 0; axis < 3; ++axis) image.pixels.push_back(static_cast<float>(v[axis]));
  };
  for (std::size_t i = 0; i < picture.mean.size(); ++i) {
    add(picture.mean[i]);
    if (has_variance) add(picture.variance[i]);
    image.pixels.push_back(static_cast<float>(picture.depth[i]));
    add(picture.normal[i]);
    image.pixels.push_back(number_or_none(picture.primitive[i]));
    image.pixels.push_back(number_or_none(picture.instance[i]));
    if (has_steps) image.pixels.push_back(static_cast<float>(picture.steps[i]));
  }
  image.attributes = attributes;
  return image;
}

std::uint64_t count_not_finite(const RenderedPicture& picture) {
  return static_cast<std::uint64_t>(
      std::count_if(picture.mean.begin(), picture.mean.end(), [](const auto& color) { return !is_finite(color); }));
}

void write_picture(const RenderedPicture& picture, const PictureAttributes& attributes,
                   const std::filesystem::path& output) {
  if (output.extension() == ".exr") {
    write_exr(output, picture_image(picture, attributes));
    return;
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(picture.mean.size() * 3);
  for (const glm::dvec3& color : picture.mean)
    for (int channel = 0; channel < 3; ++channel) bytes.push_back(stored(color[channel]));
  write_png(output, picture.width, picture.height, bytes, attributes);
}

}  // namespace plumbline
