// SPDX-License-Identifier: MIT
// The readers behind read_scene, one per format. Each takes the file's path (for messages and for files that it names)
// and content.
#pragma once

#include <filesystem>
#include <string>

#include "scenes/scene.h"

namespace plumbline {

Scene read_nff(const std::filesystem::path& path, std::string&& text);
Scene read_obj(const std::filesystem::path& path, std::string&& text);
/// glTF 2.0: text, or binary where the content starts with "glTF".
Scene read_gltf(const std::filesystem::path& path, std::string&& content);

}  // namespace plumbline
