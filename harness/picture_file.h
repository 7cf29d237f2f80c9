// SPDX-License-Identifier: GPL-3.0-or-later
// A rendered picture as a file, whoever rendered it: EXR with the channels of SEMANTICS 6.9, or PNG; with all that is
// needed to render it again.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/image_file.h"
#include "scenes/rendered_picture.h"

namespace plumbline {

/// "plumbline.seed" and the like, as they stand in the file.
using PictureAttributes = std::map<std::string, ImageAttribute>;

/// What both engines tell of how a picture was made.
PictureAttributes picture_attributes(const std::string& engine, const std::string& scene, std::uint32_t first_frame,
                                     std::uint32_t frames, std::uint64_t seed, double time, const Effects& effects);

/// Names of the effects that are switched on, "aa,dof,..."; "none".
std::string effect_names(const Effects& effects);
/// Switches on the effects that a list names, and no others. Throws InputError for other names.
void set_effects(const std::string& list, Effects& effects);

/// Throws InputError for a name that ends in neither .exr nor .png, and for a folder that is not there: before anything
/// is rendered.
void require_picture_name(const std::filesystem::path& path);

Image picture_image(const RenderedPicture& picture, const PictureAttributes& attributes);

/// Pixels with a NaN or an infinity.
std::uint64_t count_not_finite(const RenderedPicture& picture);

/// Writes `output`, by its ending.
void write_picture(const RenderedPicture& picture, const PictureAttributes& attributes,
                   const std::filesystem::path& output);

}  // namespace plumbline
