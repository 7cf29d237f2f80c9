// SPDX-License-Identifier: GPL-3.0-or-later
// A rendered picture as a file, whoever rendered it: EXR with the channels of SEMANTICS 6.9, or PNG; with all that is
// needed to render it again.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/image_file.h"
#include "scenes/scene.h"

namespace plumbline {

/// A picture, row by row from the top.
struct PictureFile {
  int width = 0, height = 0;
  std::uint32_t frames = 0;
  std::vector<glm::dvec3> mean;                    ///< linear colour
  std::vector<glm::dvec3> variance;                ///< of one sample, unbiased; empty for one frame
  std::vector<float> depth;                        ///< infinite where nothing is hit
  std::vector<glm::vec3> normal;                   ///< zero where nothing is hit
  std::vector<std::uint32_t> primitive, instance;  ///< kNone for none
  std::vector<std::uint32_t> steps;                ///< nodes visited; empty where the engine has none
};

/// "plumbline.seed" and the like, as they stand in the file.
using PictureAttributes = std::map<std::string, ImageAttribute>;

/// What both engines tell of how a picture was made.
PictureAttributes picture_attributes(const std::string& engine, const std::string& scene, std::uint32_t first_frame,
                                     std::uint32_t frames, std::uint64_t seed, double time, const Effects& effects);

/// Names of the effects that are switched on, "aa,dof,..."; "none".
std::string effect_names(const Effects& effects);
/// Switches on the effects that a list names, and no others. Throws InputError for other names.
void set_effects(const std::string& list, Effects& effects);

/// Throws InputError for a name that ends in neither .exr nor .png, and for a folder that is not there: before anything is
/// rendered.
void require_picture_name(const std::filesystem::path& path);

Image picture_image(const PictureFile& picture, const PictureAttributes& attributes);

/// Pixels with a NaN or an infinity.
std::uint64_t count_not_finite(const PictureFile& picture);

/// Writes `output`, by its ending.
void write_picture(const PictureFile& picture, const PictureAttributes& attributes, const std::filesystem::path& output);

}  // namespace plumbline
