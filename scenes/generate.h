// SPDX-License-Identifier: MIT
// Scenes made by a program: the Standard Procedural Databases (Haines 1987) and meshes for scaling and leak tests.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

struct Generator {
  std::string_view name;         ///< stable: "sphereflake"
  std::string_view description;  ///< one sentence, with what the size means
  int default_size = 1;
  int min_size = 1, max_size = 1;
  Scene (*make)(int size) = nullptr;
};

/// All generators, in a fixed order.
std::span<const Generator> generators();

/// The scene `name` of a size; 0 stands for the generator's default. Its name is "sphereflake_4", without the number
/// where there is only one size. The same on every machine up to the C library's sine and logarithm. Throws InputError
/// for an unknown name or a size out of range, listing what is known.
Scene generate_scene(std::string_view name, int size = 0);

/// A scene from what a user types: a generator "sphereflake" or "sphereflake:4", else the path of a file, else one of
/// the shipped scenes by name: "nested" is scenes/nested.json, wherever the program is started.
/// Throws InputError as read_scene and generate_scene do.
Scene load_scene(std::string_view spec);

/// The names of the scene files that come with Plumbline, in alphabetical order; none where the folder that it was
/// built from is gone.
std::vector<std::string> shipped_scenes();

/// The same of those in the folder pictures: scenes for renderers, which would tell a comparison of hits nothing new.
std::vector<std::string> picture_scenes();

}  // namespace plumbline
