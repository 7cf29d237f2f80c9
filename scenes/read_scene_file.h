// SPDX-License-Identifier: MIT
// The reader of Plumbline's own scene files (SCENE_FILES.md): parts, placed by nodes, with lights, camera and effects.
#pragma once

#include <filesystem>
#include <string>

#include "scenes/scene.h"

namespace plumbline {

/// Nodes that one scene may have.
inline constexpr std::uint32_t kMostNodes = 1u << 20;

/// Reads a scene file and all that it names, each file once. `text` is that of the file. Throws InputError with file,
/// line and key path, and as the readers of its parts do.
Scene read_scene_file(const std::filesystem::path& path, std::string&& text);

}  // namespace plumbline
