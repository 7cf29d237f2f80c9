// SPDX-License-Identifier: MIT
// Small scenes for the tests of the sphere tree: ordinary ones, and those that break builders.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "scenes/random.h"
#include "scenes/scene.h"

namespace plumbline {

inline void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const std::uint32_t first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  Triangle triangle;
  triangle.position = {first, first + 1, first + 2};
  scene.triangles.push_back(triangle);
}

/// A point of the cube [-1, 1]^3.
inline glm::vec3 cube_point(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

/// Triangles and spheres of about `size` strewn in the cube [-1, 1]^3.
inline Scene random_scene(std::uint64_t seed, std::uint32_t triangles, std::uint32_t spheres, float size = 0.05f) {
  Scene scene;
  scene.name = "random";
  scene.materials.resize(1);
  Random random(seed, name_hash("tree scene"), 0);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 corner = cube_point(random);
    const glm::vec3 a = cube_point(random), b = cube_point(random), c = cube_point(random);
    add_triangle(scene, corner + size * a, corner + size * b, corner + size * c);
  }
  for (std::uint32_t i = 0; i < spheres; ++i) {
    const glm::vec3 center = cube_point(random);
    scene.spheres.push_back({center, static_cast<float>(random.uniform(0.02, 1.0)) * size, 0});
  }
  return scene;
}

/// Scenes on which a careless build recurses for ever, grows a chain, overflows or loses a corner.
inline std::vector<Scene> nasty_scenes() {
  std::vector<Scene> scenes;
  const auto make = [&](const std::string& name, const std::function<void(Scene&, Random&)>& fill) {
    Scene scene;
    scene.name = name;
    scene.materials.resize(1);
    Random random(1, name_hash(name), 0);
    fill(scene, random);
    scenes.push_back(std::move(scene));
  };
  const auto strewn = [](Scene& scene, Random& random, int count, const glm::vec3& offset, float scale) {
    for (int i = 0; i < count; ++i) {
      const glm::vec3 a = cube_point(random), b = cube_point(random), c = cube_point(random);
      add_triangle(scene, offset + scale * a, offset + scale * b, offset + scale * c);
      scene.spheres.push_back({offset + scale * cube_point(random), 0.1f * scale, 0});
    }
  };
  make("one triangle", [&](Scene& s, Random& r) { add_triangle(s, cube_point(r), cube_point(r), cube_point(r)); });
  make("one sphere", [&](Scene& s, Random& r) { s.spheres.push_back({cube_point(r), 0.3f, 0}); });
  make("identical triangles", [&](Scene& s, Random& r) {
    const glm::vec3 a = cube_point(r), b = cube_point(r), c = cube_point(r);
    for (int i = 0; i < 3000; ++i) add_triangle(s, a, b, c);
  });
  make("concentric spheres", [&](Scene& s, Random&) {
    for (int i = 0; i < 3000; ++i)
      s.spheres.push_back({glm::vec3(0.3f), std::exp2(0.03f * static_cast<float>(i - 1500)), 0});
  });
  make("a spiral of growing triangles", [&](Scene& s, Random& r) {
    for (int i = 0; i < 2000; ++i) {
      const float size = std::exp2(0.09f * static_cast<float>(i - 1000));
      add_triangle(s, size * cube_point(r), size * cube_point(r), size * cube_point(r));
    }
  });
  make("a row in which each triangle is twice the last", [&](Scene& s, Random& r) {
    for (int i = -120; i < 120; ++i) {
      const float size = std::exp2(static_cast<float>(i));
      const glm::vec3 at(3.0f * size, 0.0f, 0.0f);
      for (int k = 0; k < 5; ++k)
        add_triangle(s, at + size * cube_point(r), at + size * cube_point(r), at + size * cube_point(r));
    }
  });
  make("a heap at one point, another far away", [&](Scene& s, Random& r) {
    strewn(s, r, 500, glm::vec3(1e30f), 1e24f);
    strewn(s, r, 500, glm::vec3(0.0f), 1e-30f);
  });
  make("far from the origin", [&](Scene& s, Random& r) { strewn(s, r, 500, glm::vec3(1e6f, -3e6f, 2e5f), 1.0f); });
  make("huge", [&](Scene& s, Random& r) { strewn(s, r, 500, glm::vec3(0.0f), 1e38f); });
  make("denormal", [&](Scene& s, Random& r) { strewn(s, r, 500, glm::vec3(0.0f), 1e-42f); });
  make("flat", [&](Scene& s, Random& r) {
    for (int i = 0; i < 1000; ++i) {
      glm::vec3 a = cube_point(r), b = cube_point(r), c = cube_point(r);
      a.y = b.y = c.y = 0.7f;
      add_triangle(s, a, b, c);
    }
  });
  make("needles", [&](Scene& s, Random& r) {
    for (int i = 0; i < 500; ++i) {
      const glm::vec3 a = cube_point(r), b = cube_point(r), c = cube_point(r);
      add_triangle(s, a, b, b + 1e-6f * c);
    }
  });
  return scenes;
}

}  // namespace plumbline
