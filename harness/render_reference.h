// SPDX-License-Identifier: GPL-3.0-or-later
// A picture by the reference renderer, as a file: EXR with the channels of SEMANTICS 6.9, or PNG.
#pragma once

#include <filesystem>

#include "reference/renderer.h"
#include "scenes/image_file.h"

namespace plumbline {

/// The channels and attributes of a picture, as EXR holds them. `spec` is what the user called the scene.
Image reference_image(const ReferencePicture& picture, const ReferenceSettings& settings, const std::string& spec);

/// Renders with progress on a terminal and writes `output`, by its ending .exr or .png; tells what the user should know
/// (a scene without lights, pixels that are not finite) and the speed. Throws InputError for another ending, before
/// anything is rendered.
void render_reference(const Scene& scene, const ReferenceSettings& settings, const std::string& spec,
                      const std::filesystem::path& output);

}  // namespace plumbline
