// SPDX-License-Identifier: GPL-3.0-or-later
// From means and variances to channels and bytes.
#include "harness/render_reference.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "harness/progress.h"
#include "harness/version.h"
#include "reports/format.h"
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

void write_picture(const ReferencePicture& picture, const std::filesystem::path& output) {
  std::vector<std::uint8_t> bytes;
  for (const glm::dvec3& color : picture.mean)
    for (int channel = 0; channel < 3; ++channel) bytes.push_back(stored(color[channel]));
  write_png(output, picture.width, picture.height, bytes);
}

}  // namespace

Image reference_image(const ReferencePicture& picture, const ReferenceSettings& settings, const std::string& spec) {
  Image image;
  image.width = picture.width;
  image.height = picture.height;
  image.channels = {"R", "G", "B"};
  const bool has_variance = !picture.variance.empty();
  if (has_variance) image.channels.insert(image.channels.end(), {"variance.R", "variance.G", "variance.B"});
  image.channels.insert(image.channels.end(), {"depth", "normal.X", "normal.Y", "normal.Z", "primitive", "instance"});
  const auto add = [&](const glm::dvec3& v) {
    for (int axis = 0; axis < 3; ++axis) image.pixels.push_back(static_cast<float>(v[axis]));
  };
  for (std::size_t i = 0; i < picture.mean.size(); ++i) {
    add(picture.mean[i]);
    if (has_variance) add(picture.variance[i]);
    image.pixels.push_back(static_cast<float>(picture.depth[i]));
    add(picture.normal[i]);
    image.pixels.push_back(number_or_none(picture.primitive[i]));
    image.pixels.push_back(number_or_none(picture.instance[i]));
  }
  const Effects& effects = *settings.effects;
  image.attributes = {{"plumbline.engine", "reference"},
                      {"plumbline.version", version()},
                      {"plumbline.commit", commit()},
                      {"plumbline.scene", spec},
                      {"plumbline.frames", static_cast<int>(picture.frames)},
                      {"plumbline.seed", std::to_string(settings.seed)},
                      {"plumbline.time", static_cast<float>(settings.time)},
                      {"plumbline.model", effects.model == Effects::Model::physical ? "physical" : "paper"},
                      {"plumbline.antialias", effects.antialias ? 1 : 0},
                      {"plumbline.soft_shadows", effects.soft_shadows ? 1 : 0},
                      {"plumbline.depth_of_field", effects.depth_of_field ? 1 : 0},
                      {"plumbline.motion_blur", effects.motion_blur ? 1 : 0},
                      {"plumbline.glossy_reflections", effects.glossy_reflections ? 1 : 0},
                      {"plumbline.glossy", effects.glossy},
                      {"plumbline.depth", static_cast<int>(effects.depth)}};
  return image;
}

void render_reference(const Scene& scene, const ReferenceSettings& settings, const std::string& spec,
                      const std::filesystem::path& output) {
  const bool is_png = output.extension() == ".png";
  if (!is_png && output.extension() != ".exr")
    throw InputError(output.string() + ": a picture's name ends in .exr or .png");
  ReferenceRenderer renderer(scene, settings);
  if (renderer.lit_by_default())
    std::fprintf(stderr, "warning: the scene has no light; one beside the eye lights it\n");
  const auto start = std::chrono::steady_clock::now();
  Progress progress;
  const auto picture = renderer.render([&](double share) {
    progress.show(share, "rendering");
    return true;
  });
  progress.clear();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  PLUMBLINE_ASSERT(picture.has_value());
  const auto wrong = static_cast<std::uint64_t>(
      std::count_if(picture->mean.begin(), picture->mean.end(), [](const auto& color) { return !is_finite(color); }));
  if (wrong > 0) std::fprintf(stderr, "warning: %s not finite\n", counted(wrong, "pixel").c_str());
  if (is_png) {
    write_picture(*picture, output);
  } else {
    write_exr(output, reference_image(*picture, renderer.settings(), spec));
  }
  const double samples = static_cast<double>(picture->mean.size()) * picture->frames;
  std::printf("%s: %d x %d pixels, %u frames, %s, %s samples per second\n", output.c_str(), picture->width,
              picture->height, picture->frames, duration(seconds).c_str(),
              short_count(static_cast<std::uint64_t>(samples / seconds)).c_str());
}

}  // namespace plumbline
