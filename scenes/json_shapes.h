// SPDX-License-Identifier: MIT
// Geometry and materials that are written in a scene file itself.
#pragma once

#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include "scenes/assemble.h"
#include "scenes/json_document.h"
#include "scenes/scene.h"

namespace plumbline {

/// Numbers of the pool by the names of one file.
using NamedMaterials = std::unordered_map<std::string, std::uint32_t>;

/// The member "materials": adds them, and their textures, to the pool.
NamedMaterials read_materials(const JsonPlace& place, const std::filesystem::path& folder, MeshPool& pool);

/// The material that a string names.
std::uint32_t find_material(const NamedMaterials& materials, const JsonPlace& place);

/// The shapes of a part; those without a material of their own have `material`, or a white matte one where it is kNone.
/// Not empty: throws for a part without any.
Scene read_shapes(const JsonPlace& part, const NamedMaterials& materials, std::uint32_t material, MeshPool& pool);

}  // namespace plumbline
