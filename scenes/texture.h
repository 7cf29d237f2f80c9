// SPDX-License-Identifier: MIT
// Textures of scenes: image files become linear texels, each file once.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "scenes/scene.h"

namespace plumbline {

enum class TextureKind {
  color,   ///< integer images are decoded from sRGB, float images are linear already
  height,  ///< values as stored, the first channel in all three
};

/// The index in scene.textures of an image file, read at its first use. Where it cannot be read: nullopt, and `problem`
/// says why in one line.
std::optional<std::uint32_t> find_texture(Scene& scene, const std::filesystem::path& path, TextureKind kind,
                                          std::string& problem);
/// The same of an image within another file: `content` of a file of that name, which need not be there.
std::optional<std::uint32_t> find_texture(Scene& scene, const std::string& name, std::string_view content,
                                          TextureKind kind, std::string& problem);

}  // namespace plumbline
