// SPDX-License-Identifier: GPL-3.0-or-later
// Which scenes a run examines: the project's own generators, and where it is present a folder of real scenes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace plumbline {

struct ListedScene {
  std::string name;          ///< as it stands in case names: "sphereflake_3", "bunny"
  std::string spec;          ///< what load_scene takes
  bool closed = false;       ///< known to be one closed mesh
  bool has_spheres = false;  ///< known to hold sphere primitives
  bool has_nodes = false;    ///< geometry is placed by transforms
  bool moves = false;        ///< transforms are animated
};

/// Where real scenes are: PLUMBLINE_DATA if set, else ../shared/data beside the working directory. May not exist.
std::filesystem::path data_folder();

/// The generators' scenes, always there.
std::vector<ListedScene> own_scenes();

/// The scene files that come with Plumbline, all of them with instances.
std::vector<ListedScene> placed_scenes();

/// The scene files that come with Plumbline for renderers: effects, textures, a round ground.
std::vector<ListedScene> effect_scenes();

/// The scenes of the data folder that are present.
std::vector<ListedScene> real_scenes();

}  // namespace plumbline
