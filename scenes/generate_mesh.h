// SPDX-License-Identifier: MIT
// Generated triangle meshes: for leaks (closed ones), for scaling (any number of triangles), for exact ties.
#pragma once

#include "scenes/scene.h"

namespace plumbline {

Scene make_creature(int size);        ///< 882 triangles, closed; the size is ignored
Scene make_grid(int triangles);       ///< a height field of exactly that many triangles
Scene make_torus(int triangles);      ///< about that many triangles, closed
Scene make_icosphere(int divisions);  ///< 20 * 4^divisions triangles, closed
Scene make_cube(int size);            ///< [-1, 1]^3 in 12 triangles, closed; the size is ignored

}  // namespace plumbline
