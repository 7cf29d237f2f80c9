// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation_scenes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "harness/hit_cases.h"
#include "scenes/generate.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants");
constexpr std::size_t kRaysOfFamily = 48;

glm::vec3 cube_point(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.emplace_back().position = {first, first + 1, first + 2};
}

/// Triangles of three sizes and as many slivers, strewn around a closed mesh; spheres between them.
Scene strewn(std::uint32_t triangles, std::uint32_t spheres) {
  Scene scene = triangles > 0 ? generate_scene("icosphere", 1) : Scene{};
  scene.materials.resize(std::max<std::size_t>(scene.materials.size(), 1));
  Random random(kSeed, name_hash("strewn"), 0);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float size = std::array{0.8f, 0.2f, 0.02f, 0.5f}[i % 4];
    const glm::vec3 at = 1.6f * cube_point(random), a = at + size * cube_point(random);
    const glm::vec3 b = at + size * cube_point(random);
    const glm::vec3 c = i % 4 == 3 ? 0.5f * (a + b) + 1e-4f * cube_point(random) : at + size * cube_point(random);
    add_triangle(scene, a, b, c);
  }
  for (std::uint32_t i = 0; i < spheres; ++i) {
    const float radius = std::array{0.4f, 0.1f, 0.01f}[i % 3];
    scene.spheres.push_back({1.6f * cube_point(random), radius, 0});
  }
  scene.camera = {};
  frame_camera(scene);
  return scene;
}

/// Triangles and spheres to be placed more than once.
struct Pieces {
  std::vector<std::array<glm::vec3, 3>> triangles;
  std::vector<Sphere> spheres;
};

Pieces pieces(Random& random, float size, int spheres, float radius) {
  Pieces made;
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 at = cube_point(random);
    made.triangles.push_back(
        {at + size * cube_point(random), at + size * cube_point(random), at + size * cube_point(random)});
  }
  for (int i = 0; i < spheres; ++i) made.spheres.push_back({cube_point(random), radius, 0});
  return made;
}

void add_pieces(Scene& scene, const Pieces& pieces) {
  for (const auto& [a, b, c] : pieces.triangles) add_triangle(scene, a, b, c);
  scene.spheres.insert(scene.spheres.end(), pieces.spheres.begin(), pieces.spheres.end());
}

/// What stands in the world stands there twice, and in two instances at the same place as well; two more are at
/// another place, and two are nested.
Scene doubles(bool has_nodes) {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("doubles"), 0);
  const Pieces once = pieces(random, 0.6f, 3, 0.25f);
  for (int space = 0; space < (has_nodes ? 2 : 1); ++space) {
    Part part{"twice", static_cast<std::uint32_t>(scene.triangles.size()), 0,
              static_cast<std::uint32_t>(scene.spheres.size()), 0};
    for (int twice = 0; twice < 2; ++twice) add_pieces(scene, once);
    part.triangle_count = static_cast<std::uint32_t>(scene.triangles.size()) - part.first_triangle;
    part.sphere_count = static_cast<std::uint32_t>(scene.spheres.size()) - part.first_sphere;
    if (space > 0) scene.parts.push_back(part);
  }
  const auto node = [&](const char* name, std::uint32_t parent, std::uint32_t part, const Transform& transform) {
    scene.nodes.push_back({name, parent, part, transform, transform});
  };
  Transform aside, turned;
  aside.translation = {2.5f, 0.5f, -0.5f};
  turned.linear = glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.1f, -0.7f);
  turned.translation = {-2.5f, 0.25f, 1.0f};
  if (!has_nodes) {
    frame_camera(scene);
    return scene;
  }
  node("here", kNone, 0, {});
  node("here again", kNone, 0, {});
  node("aside", kNone, 0, aside);
  node("aside again", kNone, 0, aside);
  node("group", kNone, kNone, turned);
  node("inner", 4, 0, turned);
  node("inner again", 4, 0, turned);
  frame_camera(scene);
  return scene;
}

/// Triangles in a flat slab, which rays along it see edge-on, most of them several.
Scene slats() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("slats"), 0);
  const auto flat = [&] { return cube_point(random) * glm::vec3(1.0f, 1e-3f, 1.0f); };
  for (int i = 0; i < 12; ++i) {
    const glm::vec3 a = flat(), b = flat(), c = flat();
    add_triangle(scene, a, b, c);
  }
  frame_camera(scene);
  return scene;
}

/// Rays along the slab.
std::vector<Ray> rays_of_slats() {
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 512; ++i) {
    Random random(kSeed, name_hash("rays of slats"), i);
    const glm::vec3 thin(1.0f, 1e-3f, 1.0f), from = cube_point(random) * thin, to = cube_point(random) * thin;
    rays.push_back({from + (i % 2 == 0 ? 4.0f : 0.5f) * (from - to), to - from});
  }
  return rays;
}

/// `factor` is a power of two: all numbers stay exact. Then everything in the world is moved.
Scene scaled(Scene scene, float factor, const glm::vec3& by) {
  for (glm::vec3& p : scene.positions) p *= factor;
  for (Sphere& s : scene.spheres) s.center *= factor, s.radius *= factor;
  for (Node& n : scene.nodes) {
    n.transform.translation *= factor;
    if (n.parent == kNone) n.transform.translation += factor * by;
    n.rest = n.transform;
  }
  frame_camera(scene);
  return scene;
}

/// One part around the origin of instances of very different sizes, which all fill the world to some extent.
Scene apart() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("apart"), 0);
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 at = cube_point(random);
    add_triangle(scene, at + 0.7f * cube_point(random), at + 0.7f * cube_point(random), at + 0.7f * cube_point(random));
  }
  for (int i = 0; i < 3; ++i) scene.spheres.push_back({cube_point(random), 0.3f, 0});
  scene.spheres.push_back({glm::vec3(0.0f), 0.4f, 0});  // which rays through the origin of the world meet in `small`
  scene.parts.push_back({"piece", 0, 6, 0, 4});
  const auto node = [&](const char* name, std::uint32_t parent, std::uint32_t part, float scale, const glm::vec3& to) {
    Transform t;
    t.linear = scale * glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.1f, 1.1f);
    t.translation = to;
    scene.nodes.push_back({name, parent, part, t, t});
  };
  node("small", kNone, 0, 0x1p-20f, glm::vec3(0.0f));
  node("middle", kNone, 0, 1.0f, {3.0f, 0.5f, -0.5f});
  node("large", kNone, 0, 0x1p20f, {0x1p22f, 0.0f, 0x1p21f});
  node("large group", kNone, kNone, 0x1p40f, {-3.0f, 1.0f, 0.5f});
  node("small in large", 3, 0, 0x1p-40f, glm::vec3(0.0f));
  node("small group", kNone, kNone, 0x1p-45f, {0.5f, -3.0f, 1.0f});
  node("large in small", 5, 0, 0x1p45f, glm::vec3(0.0f));
  frame_camera(scene);
  return scene;
}

/// Pairs of instances that are small beside the way to them: there t is much coarser than what stands in them. The
/// second one of each has something more, on either side, so that half of the walks come to it first.
Scene pairs() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("pairs"), 0);
  const Pieces once = pieces(random, 0.7f, 8, 0.3f);
  scene.spheres.push_back({{0.0f, 0.0f, -2.0f}, 0.5f, 0});
  for (const float aside : {0.0f, 3.0f, -3.0f}) {
    Part part{"piece", static_cast<std::uint32_t>(scene.triangles.size()), 0,
              static_cast<std::uint32_t>(scene.spheres.size()), 0};
    add_pieces(scene, once);
    if (aside != 0.0f) scene.spheres.push_back({glm::vec3(aside), 0.1f, 0});
    part.triangle_count = static_cast<std::uint32_t>(scene.triangles.size()) - part.first_triangle;
    part.sphere_count = static_cast<std::uint32_t>(scene.spheres.size()) - part.first_sphere;
    scene.parts.push_back(part);
  }
  for (std::uint32_t i = 0; i < 12; ++i) {
    Transform t;
    t.linear = 0x1p-15f * glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.1f, 1.1f);
    t.translation = cube_point(random);
    scene.nodes.push_back({"piece", kNone, 0, t, t});
    scene.nodes.push_back({"more", kNone, 1 + i % 2, t, t});
  }
  frame_camera(scene);
  return scene;
}

/// Rays towards the pieces from as far as the world is large.
std::vector<Ray> rays_of_pairs(const Scene& scene) {
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 768; ++i) {
    Random random(kSeed, name_hash("rays of pairs"), i);
    const Transform& t = scene.nodes[i % scene.nodes.size()].transform;
    const glm::vec3 target = t.translation + t.linear * cube_point(random);
    const glm::vec3 origin = target + 2.0f * glm::vec3(random.direction());
    rays.push_back({origin, target - origin});
  }
  return rays;
}

/// Instances in a group that is so small that one step does not bring rays near it: neither on their way in, nor when
/// they leave an instance.
Scene heap() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("heap"), 0);
  scene.spheres.push_back({{0.0f, 4.0f, 0.0f}, 3.0f, 0});
  add_pieces(scene, pieces(random, 0.7f, 2, 0.2f));
  scene.parts.push_back({"piece", 0, 6, 1, 2});
  Transform small, turned;
  small.linear = glm::mat3(0x1p-45f);
  scene.nodes.push_back({"group", kNone, kNone, small, small});
  for (int i = 0; i < 8; ++i) {
    turned.linear = turned.linear * glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.1f, 1.1f);
    scene.nodes.push_back({"piece", 0, 0, turned, turned});
  }
  frame_camera(scene);
  return scene;
}

/// Through the origin, exactly: no other ray from afar can be aimed at the heap.
std::vector<Ray> rays_of_heap() {
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 512; ++i) {
    const glm::vec3 d(Random(kSeed, name_hash("rays of heap"), i).direction());
    rays.push_back({-2.0f * d, d});
  }
  return rays;
}

/// Rays that drift meet some small instances first, in another order in another octant, and then a large one. They
/// start so near to that one that it does not move their origins, which would undo their drift.
Scene border() {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, name_hash("border"), 0);
  scene.spheres.push_back({{0.0f, 0.0f, 90.0f}, 3.0f, 0});
  scene.parts.push_back({"large", 0, 0, 1, 1});
  scene.spheres.push_back({glm::vec3(0.0f), 30.0f, 0});
  scene.parts.push_back({"small", 0, 0, 2, 6});
  for (int i = 0; i < 6; ++i) scene.spheres.push_back({glm::vec3(random.direction()), 0.05f, 0});
  Transform t;
  for (int i = 0; i < 10; ++i) {
    const float angle = 0.5f + 0.05f * static_cast<float>(i), c = std::cos(angle), s = std::sin(angle);
    t.linear = glm::mat3(c, 0.3f, s, -0.4f, 0.8f, 0.5f, -s, -0.6f, 1.1f * c);
    t.translation = cube_point(random) * glm::vec3(1.0f, 0.4f, 0.4f);
    scene.nodes.push_back({"small", kNone, 1, t, t});
  }
  t.linear = glm::mat3(0.6f, 0.1f, 0.8f, -0.3f, 1.0f, 0.2f, -0.8f, 0.0f, 0.7f);
  t.translation = {0.0f, 0.0f, 40.0f};
  scene.nodes.push_back({"large", kNone, 0, t, t});
  frame_camera(scene);
  return scene;
}

/// Neighbours whose directions differ in the sign of a small component.
std::vector<Ray> rays_of_border() {
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 256; ++i) {
    Random random(kSeed, name_hash("rays of border"), i);
    const glm::vec3 target = 0.3f * cube_point(random);
    const glm::vec3 right = cube_point(random) * glm::vec3(0.02f, 0.02f, 0.0f) + glm::vec3(0.0f, 0.0f, 1.0f);
    const glm::vec3 left = right * glm::vec3(-1.0f, 1.0f, 1.0f);
    rays.push_back({target - 6.0f * right, right});
    rays.push_back({target - 6.0f * left, left});
  }
  return rays;
}

}  // namespace

Scene mutation_scene(MutationScene scene) {
  switch (scene) {
    case MutationScene::mixed:
      return strewn(48, 24);
    case MutationScene::spheres:
      return strewn(0, 40);
    case MutationScene::triangles:
      return strewn(64, 0);
    case MutationScene::nested:
      return load_scene("nested");
    case MutationScene::spheres_placed:
      return load_scene("ellipsoids");
    case MutationScene::doubles:
      return doubles(true);
    case MutationScene::twins:
      return doubles(false);
    case MutationScene::slats:
      return slats();
    case MutationScene::speck:
      return scaled(strewn(48, 24), 0x1p-70f, {});
    case MutationScene::giant:
      return scaled(load_scene("nested"), 0x1p60f, {40.0f, -30.0f, 20.0f});
    case MutationScene::apart:
      return apart();
    case MutationScene::pairs:
      return pairs();
    case MutationScene::heap:
      return heap();
    case MutationScene::border:
      return border();
    case MutationScene::scales:
      break;
  }
  return load_scene("scales");
}

std::vector<Ray> mutation_rays(MutationScene scene, const RaySource& source) {
  switch (scene) {
    case MutationScene::slats:
      return rays_of_slats();
    case MutationScene::pairs:
      return rays_of_pairs(*source.scene);
    case MutationScene::heap:
      return rays_of_heap();
    case MutationScene::border:
      return rays_of_border();
    default:
      return mixed_rays(source, kSeed, kRaysOfFamily);
  }
}

std::vector<Ray> odd_rays(const Ball& ball) {
  std::vector<Ray> rays;
  const auto size = static_cast<float>(ball.radius);
  const glm::vec3 center(ball.center);
  const int unit = std::ilogb(ball.radius);
  Random random(kSeed, name_hash("odd rays"), 0);
  const auto near_center = [&] { return center + 0.5f * size * cube_point(random); };
  const auto is_float = [](int exponent) { return exponent > -100 && exponent < 127; };
  for (int k = -18; k < 0; k += 2) {
    const glm::vec3 any(random.direction());
    rays.push_back({-std::ldexp(1.0f, k + unit) * any, any});
  }
  for (const int k : {3, 4, 6, 9, 12, 15, 16, 17, 18, 20, 25, 33, 45, 60, 80, 100, 118, 124}) {
    if (!is_float(k + unit)) continue;
    const float away = std::ldexp(1.0f, k + unit);
    for (int i = 0; i < 6; ++i) {
      const float sign = i % 2 == 0 ? 1.0f : -1.0f;
      glm::vec3 direction(0.0f), origin = near_center();
      direction[i / 2] = std::ldexp(sign, static_cast<int>(random.below(40)) - 20);
      origin[i / 2] = -sign * away;
      rays.push_back({origin, direction});
      const glm::vec3 any(random.direction());
      rays.push_back({-away * any, any});
      if (i == k % 6) rays.push_back({away * any, any}), rays.push_back({-origin, direction});
    }
  }
  for (int i = 0; i < 24; ++i) {
    const float sign = i % 2 == 0 ? 1.0f : -1.0f;
    glm::vec3 direction(0.0f);
    direction[i % 3] = sign;
    if (i >= 12) direction[(i + 1) % 3] = i % 4 < 2 ? 1.0f : -1.0f;
    if (i >= 18) direction[(i + 2) % 3] = sign;
    rays.push_back({near_center() - 1.5f * size * direction, direction});
    rays.push_back({near_center(), direction});
    const glm::vec3 any(random.direction()), from = near_center() - 2.0f * size * any;
    rays.push_back({from, std::ldexp(1.0f, i - 149) * any});
    // To or past the first thing, to the start, before it.
    rays.push_back({from, any, std::array{0.0f, -1.0f, size, 2.0f * size}[static_cast<std::size_t>(i % 4)]});
    glm::vec3 tiny = direction;
    tiny[(i + 1) % 3] += std::ldexp(sign, -20 - 5 * i), tiny[(i + 2) % 3] -= std::ldexp(1.0f, -140 + i);
    glm::vec3 start = near_center() - 2.0f * size * direction;
    if (center == glm::vec3(0.0f) || i % 2 == 0) start[(i + 1) % 3] = std::ldexp(sign, -130 + 2 * i);
    rays.push_back({start, tiny});
  }
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();
  const glm::vec3 along(0.0f, 0.0f, 1.0f);
  for (const float odd : {kNaN, kInfinite, -kInfinite, std::bit_cast<float>(0x7f800001u)}) {
    rays.push_back({glm::vec3(odd, 0.0f, 0.0f), along});
    rays.push_back({center, glm::vec3(0.0f, odd, 1.0f)});
    rays.push_back({center, along, odd});
  }
  for (const float least : {std::bit_cast<float>(1u), -std::bit_cast<float>(1u), 0.0f})
    rays.push_back({near_center(), glm::vec3(0.0f, least, 0.0f)});
  return rays;
}

const char* name_of(MutationScene scene) {
  static constexpr std::array<const char*, 15> kNames{"mixed",   "spheres", "triangles", "nested", "spheres_placed",
                                                      "doubles", "twins",   "slats",     "scales", "speck",
                                                      "giant",   "apart",   "pairs",     "heap",   "border"};
  return kNames[static_cast<std::size_t>(scene)];
}

}  // namespace plumbline
