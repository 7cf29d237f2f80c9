// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes in which shading does all that it knows: what pictures by mutants show.
#pragma once

#include "scenes/scene.h"

namespace plumbline {

enum class MutationRoom {
  furnished,  ///< triangles and spheres in the world and in sheared, stretched and mirrored instances; the ground
  papered,    ///< triangles and the ground: textures and bump maps of odd sizes, normals of either side
  balls,      ///< spheres alone, and the ground
};
const char* name_of(MutationRoom room);

/// Every material, texture and light is used by something that the camera sees, or sees reflected.
Scene mutation_room(MutationRoom room);

}  // namespace plumbline
