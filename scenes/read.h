// SPDX-License-Identifier: MIT
// From a scene file to a Scene: the reader is chosen by the file's ending.
#pragma once

#include <filesystem>
#include <string>

#include "scenes/scene.h"

namespace plumbline {

/// Reads a scene file: .nff (SPD's Neutral File Format), .obj (Wavefront, with its MTL files and textures), .json
/// (Plumbline's own: SCENE_FILES.md), .gltf or .glb (glTF 2.0).
/// What could be read but not used as it stands is in Scene::warnings.
/// Throws InputError, with file and line where there is one, for what cannot be read: a missing file, a folder, an
/// empty file, an unknown ending, a number that is none, an index out of range, a file without any triangle or sphere.
Scene read_scene(const std::filesystem::path& path);

/// The endings that read_scene knows, as a sentence for messages: ".nff, .obj, ...".
std::string known_endings();

}  // namespace plumbline
