// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/scene_list.h"

#include <cstdlib>

#include "scenes/error.h"
#include "scenes/generate.h"

namespace plumbline {

std::filesystem::path data_folder() {
  if (const char* set = std::getenv("PLUMBLINE_DATA"); set && *set) return set;
  return "../shared/data";
}

std::vector<ListedScene> own_scenes() {
  return {
      {"sphereflake_3", "sphereflake:3", false, true},
      {"sphereflake_4", "sphereflake:4", false, true},
      {"mount_4", "mount:4", false, true},
      {"tetra_4", "tetra:4"},
      {"rings_3", "rings:3", false, true},
      {"gears_2", "gears:2"},
      {"creature", "creature", true},
  };
}

std::vector<ListedScene> placed_scenes() {
  std::vector<ListedScene> scenes;
  for (const std::string& name : shipped_scenes()) scenes.push_back({name, name, false, false, true, name == "walk"});
  return scenes;
}

std::vector<ListedScene> effect_scenes() {
  std::vector<ListedScene> scenes;
  for (const std::string& name : picture_scenes())
    scenes.push_back({name, name, false, false, false, name == "motion"});
  return scenes;
}

std::vector<ListedScene> real_scenes() {
  const std::vector<std::pair<ListedScene, const char*>> known{
      {{"bunny", ""}, "obj/bunny/stanford-bunny.obj"},
      {{"spot", "", true}, "obj/spot_mtl/spot.obj"},
      {{"medieval", ""}, "obj/medieval/Medieval_building.obj"},
      {{"cornell_original", ""}, "obj/cornell_mcguire_akuna/CornellBox-Original.obj"},
      {{"cornell_sphere", ""}, "obj/cornell_wallisc/CornellBox-Sphere.obj"},
      {{"cornell_water", ""}, "obj/cornell_wallisc/CornellBox-Water.obj"},
      {{"banana", ""}, "obj/bullet/banana.obj"},
      {{"balls_s1", "", false, true}, "spd/balls_s1.nff"},
      {{"balls_s2", "", false, true}, "spd/balls_s2.nff"},
      {{"balls_s2_t", ""}, "spd/balls_s2_t.nff"},
      {{"balls_s3", "", false, true}, "spd/balls_s3.nff"},
      {{"balls_s4", "", false, true}, "spd/balls_s4.nff"},
      {{"gears_s2", ""}, "spd/gears_s2.nff"},
      {{"lattice_s3", "", false, true}, "spd/lattice_s3.nff"},
      {{"mount_s4", "", false, true}, "spd/mount_s4.nff"},
      {{"rings_s3", "", false, true}, "spd/rings_s3.nff"},
      {{"teapot_s4", ""}, "spd/teapot_s4.nff"},
      {{"tetra_s4", ""}, "spd/tetra_s4.nff"},
      {{"tree_s5", "", false, true}, "spd/tree_s5.nff"},
  };
  std::vector<ListedScene> scenes;
  const std::filesystem::path folder = data_folder();
  if (const char* set = std::getenv("PLUMBLINE_DATA"); set && *set && !std::filesystem::is_directory(folder))
    throw InputError("PLUMBLINE_DATA names " + folder.string() + ", which is no folder; mend or unset it");
  for (auto [scene, file] : known) {
    const auto path = folder / file;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) continue;
    scene.spec = path.string();
    scenes.push_back(scene);
  }
  return scenes;
}

}  // namespace plumbline
