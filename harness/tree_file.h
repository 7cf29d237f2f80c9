// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry images that a user names: a file that should be of a scene, or a variant by its name.
#pragma once

#include <filesystem>
#include <string>

#include "tracer/geometry_image.h"

namespace plumbline {

/// Reads a geometry image. Throws InputError where it is no image of this scene: it may be broken, but most of what it
/// stores must be the scene's. `spec` is the scene's name in messages.
GeometryImage read_tree_of(const Scene& scene, const std::string& spec, const std::filesystem::path& file);

/// The options of a variant, "paper_sphere_threaded", "leaf_1", "default"; throws InputError that lists them.
BakeOptions variant_options(const std::string& name);

}  // namespace plumbline
