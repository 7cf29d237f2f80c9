// SPDX-License-Identifier: MIT
// The generators of Haines's Standard Procedural Databases (IEEE CG&A 7(11), 1987), from their published descriptions.
// At equal sizes each gives the primitives, camera, lights and materials of the SPD program's own output, in its order.
#pragma once

#include "scenes/scene.h"

namespace plumbline {

Scene make_sphereflake(int size);  ///< SPD "balls": 1 + 9 + ... + 9^size spheres over a square
Scene make_mount(int size);        ///< 2 * 4^size triangles of a fractal mountain, four glass spheres
Scene make_tetra(int size);        ///< 4^size triangles: a Sierpinski pyramid
Scene make_rings(int size);  ///< 30 cylinders and 30 spheres for each of 1 + 4 + ... + size^2 knots, before a wall
Scene make_gears(int size);  ///< size^3 gears of 36 teeth over a square

}  // namespace plumbline
