// SPDX-License-Identifier: MIT
// Materials of OBJ files: the MTL files that a scene names, through tinyobjloader. Internal to the OBJ reader.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/obj_scan.h"
#include "scenes/scene.h"

namespace plumbline {

/// Reads the MTL files that an OBJ file names, relative to its folder, into scene.materials and scene.textures, and
/// returns the materials' indices by name. A missing file or texture is a warning with the line that names it. Throws
/// InputError with file and line for a number that is none.
///
/// Kd becomes the colour (with a diffuse factor of 1), the largest of Ks the specular factor, Ns the shine, 1 - d the
/// transmittance (where d is 1 but illum asks for refraction: the mean of Tf), Ni the refraction index, map_Kd and
/// map_bump (or bump) the textures; -bm the scale of the heights, in units of the OBJ file. Emission and all else is
/// left out with a warning.
std::map<std::string, std::uint32_t> read_materials(Scene& scene, const std::filesystem::path& obj_path,
                                                    const std::vector<NamedLine>& libraries);

}  // namespace plumbline
