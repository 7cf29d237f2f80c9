// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "reference/embree.h"
using namespace plumbline;
TEST_CASE("a triangle") {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.push_back({{0, 1, 2}});
  EmbreeScene e(scene);
  Ray r{{0.25f, 0.25f, 1}, {0, 0, -1}};
  ReferenceHit h;
  e.intersect({&r, 1}, {&h, 1});
  CHECK(h.t == 1.0);
}
