// SPDX-License-Identifier: MIT
#include "scenes/texture.h"

#include <cmath>

#include "scenes/error.h"
#include "scenes/image_file.h"

namespace plumbline {

namespace {

/// `read` gives the image of a file of that name.
template <class Read>
std::optional<std::uint32_t> find_named(Scene& scene, const std::string& file, TextureKind kind, std::string& problem,
                                        Read read) {
  // One file may serve as a colour and as a height: those differ in their texels, and in the fragment of the name.
  const std::string name = file + (kind == TextureKind::height ? "#height" : "");
  for (std::uint32_t i = 0; i < scene.textures.size(); ++i) {
    if (scene.textures[i].path == name) return i;
  }
  Texture texture;
  texture.path = name;
  try {
    const Image image = read();
    texture.width = image.width;
    texture.height = image.height;
    const std::size_t count = image.pixels.size() / image.channel_count(), channels = image.channel_count();
    texture.texels.reserve(count);
    const bool is_color = kind == TextureKind::color, is_grey = !is_color || channels < 3;
    const bool is_encoded = is_color && image.is_integer;
    for (std::size_t i = 0; i < count; ++i) {
      const float* const pixel = &image.pixels[i * channels];
      glm::vec3 texel = is_grey ? glm::vec3(pixel[0]) : glm::vec3(pixel[0], pixel[1], pixel[2]);
      if (is_encoded) texel = {from_srgb(texel.r), from_srgb(texel.g), from_srgb(texel.b)};
      if (!std::isfinite(texel.r) || !std::isfinite(texel.g) || !std::isfinite(texel.b)) {
        problem = file + ": texel " + std::to_string(i) + " is not a finite number";
        return std::nullopt;
      }
      texture.texels.push_back(texel);
    }
  } catch (const InputError& error) {
    problem = error.what();
    return std::nullopt;
  }
  scene.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

}  // namespace

std::optional<std::uint32_t> find_texture(Scene& scene, const std::filesystem::path& path, TextureKind kind,
                                          std::string& problem) {
  return find_named(scene, path.lexically_normal().string(), kind, problem, [&] { return read_image(path); });
}

std::optional<std::uint32_t> find_texture(Scene& scene, const std::string& name, std::string_view content,
                                          TextureKind kind, std::string& problem) {
  return find_named(scene, name, kind, problem, [&] { return read_image(content, name); });
}

}  // namespace plumbline
