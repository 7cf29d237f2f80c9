// SPDX-License-Identifier: MIT
// What any user of a sphere tree relies on: it holds every primitive exactly, walks end, and the same scene gives the
// same tree.
#include "tracer/sphere_tree.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <ctime>
#include <limits>

#include "scenes/error.h"
#include "tracer/tree_references.h"
#include "tracer/tree_rounding.h"
#include "tracer/tree_test_scenes.h"

namespace plumbline {
namespace {

TreeOptions with(int leaf_size, int width, float split_long) {
  TreeOptions options;
  options.leaf_size = leaf_size;
  options.width = width;
  options.split_long = split_long;
  return options;
}

/// The ball of radius `extra` around `p` lies in the node's ball and box, exactly: |p - center|^2 <= (radius -
/// extra)^2, and every product is of two floats.
bool holds(const TreeNode& node, const glm::vec3& p, float extra) {
  std::vector<double> terms;
  for (int i = 0; i < 3; ++i) {
    const double x = p[i], c = node.center[i];
    terms.insert(terms.end(), {x * x, -2.0 * (x * c), c * c});
    if (sum_down(x, -extra) < node.lower[i] || sum_up(x, extra) > node.upper[i]) return false;
  }
  const double r = node.radius, e = extra;
  terms.insert(terms.end(), {-(r * r), 2.0 * (r * e), -(e * e)});
  return node.radius >= extra && exact_sign(terms) <= 0;
}

bool holds(const Scene& scene, const TreeNode& node, std::uint32_t primitive) {
  if (!scene.is_triangle(primitive)) return holds(node, scene.sphere(primitive).center, scene.sphere(primitive).radius);
  for (const glm::vec3& corner : scene.corners(primitive))
    if (!holds(node, corner, 0.0f)) return false;
  return true;
}

/// Calls visit(leaf, the nodes from the root down to it) for every leaf; fails where a node is met twice or never.
template <typename Visit>
void for_each_leaf(const SphereTree& tree, const Visit& visit) {
  std::vector<int> met(tree.nodes.size(), 0);
  std::vector<std::uint32_t> path;
  const auto walk = [&](const auto& self, std::uint32_t at) -> void {
    REQUIRE(at < tree.nodes.size());
    if (++met[at] > 1) FAIL("node " << at << " has two parents");
    const TreeNode& node = tree.nodes[at];
    path.push_back(at);
    if (node.is_leaf()) visit(node, path);
    for (std::uint32_t i = 0; i < node.child_count; ++i) self(self, node.first_child + i);
    path.pop_back();
  };
  walk(walk, 0);
  for (std::size_t i = 0; i < met.size(); ++i)
    if (met[i] == 0) FAIL("node " << i << " hangs in the air");
}

bool can_be_hit(const Scene& scene, std::uint32_t primitive) {
  if (!scene.is_triangle(primitive)) return scene.sphere(primitive).radius > 0.0f;
  const auto corners = scene.corners(primitive);
  return !has_no_area(corners[0], corners[1], corners[2]);
}

/// Shape, limits, and, where nothing is split, that every primitive stands in one leaf, held by all nodes above.
void check_tree(const Scene& scene, const SphereTree& tree, bool whole) {
  std::vector<int> seen(scene.primitive_count(), 0);
  std::size_t wrong_size = 0, wrong_width = 0, not_held = 0, twice = 0;
  for_each_leaf(tree, [&](const TreeNode& leaf, const std::vector<std::uint32_t>& path) {
    wrong_size += leaf.reference_count < 1 || leaf.reference_count > static_cast<std::uint32_t>(tree.options.leaf_size);
    std::vector<std::uint32_t> primitives;
    for (std::uint32_t i = 0; i < leaf.reference_count; ++i)
      primitives.push_back(tree.references.at(leaf.first_reference + i));
    for (const std::uint32_t primitive : primitives) {
      ++seen.at(primitive);
      twice += std::count(primitives.begin(), primitives.end(), primitive) > 1;
      for (const std::uint32_t node : path) not_held += whole && !holds(scene, tree.nodes[node], primitive);
    }
  });
  for (const TreeNode& node : tree.nodes) {
    wrong_width += node.child_count == 1 || (!node.is_leaf() && node.reference_count != 0);
    wrong_width += tree.options.width != 0 && node.child_count > static_cast<std::uint32_t>(tree.options.width);
  }
  std::size_t missing = 0, repeated = 0;
  for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
    missing += can_be_hit(scene, p) != (seen[p] > 0);
    repeated += whole && seen[p] > 1;
  }
  REQUIRE(wrong_size == 0);
  REQUIRE(wrong_width == 0);
  REQUIRE(not_held == 0);
  REQUIRE(twice == 0);
  REQUIRE(missing == 0);
  REQUIRE(repeated == 0);
}

/// Points of every triangle: for each there is a leaf with that triangle whose whole path holds the point.
void check_parts_cover(const Scene& scene, const SphereTree& tree) {
  struct Place {
    std::uint32_t primitive;
    std::vector<std::uint32_t> path;
  };
  std::vector<std::vector<Place>> places(scene.primitive_count());
  for_each_leaf(tree, [&](const TreeNode& leaf, const std::vector<std::uint32_t>& path) {
    for (std::uint32_t i = 0; i < leaf.reference_count; ++i) {
      const std::uint32_t primitive = tree.references[leaf.first_reference + i];
      places[primitive].push_back({primitive, path});
    }
  });
  // The point itself is rounded to double: by less than 2^-50 of the largest coordinate.
  const auto near = [](const TreeNode& node, const glm::dvec3& p, double rounding) {
    bool inside = glm::length(p - glm::dvec3(node.center)) <= node.radius + rounding;
    for (int i = 0; i < 3; ++i) inside = inside && p[i] >= node.lower[i] - rounding && p[i] <= node.upper[i] + rounding;
    return inside;
  };
  std::size_t lost = 0;
  for (std::uint32_t primitive = 0; primitive < scene.triangles.size(); ++primitive) {
    Random random(1, name_hash("points"), primitive);
    const auto corners = scene.corners(primitive);
    if (!can_be_hit(scene, primitive)) continue;
    for (int i = 0; i < 40; ++i) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      if (i % 4 == 1) u = 0.0;
      if (i % 4 == 2) v = 1.0 - u;
      if (i % 4 == 3) u = std::round(u * 16.0) / 16.0, v = std::round(v * 16.0) / 16.0;  // on the cuts
      if (u + v > 1.0) continue;
      const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
      const glm::dvec3 p = (1.0 - u - v) * a + u * b + v * c;
      const double largest = glm::length(glm::abs(a) + glm::abs(b) + glm::abs(c));
      lost += std::none_of(places[primitive].begin(), places[primitive].end(), [&](const Place& place) {
        return std::all_of(place.path.begin(), place.path.end(),
                           [&](std::uint32_t node) { return near(tree.nodes[node], p, 0x1p-50 * largest); });
      });
    }
  }
  REQUIRE(lost == 0);
}

TEST_CASE("a sphere tree holds every primitive exactly, in leaves and nodes of the size asked for", "[tree]") {
  const Scene scene = random_scene(1, 1200, 500);
  for (const int leaf_size : {1, 2, 4, 8})
    for (const int width : {0, 2, 3, 100}) {
      INFO("leaf size " << leaf_size << ", width " << width);
      const SphereTree tree = build_sphere_tree(scene, with(leaf_size, width, 0.0f));
      check_tree(scene, tree, true);
      REQUIRE(tree.nodes.size() > 400u);
    }
}

TEST_CASE("nasty scenes end in trees that hold everything and are not deep", "[tree]") {
  for (const Scene& scene : nasty_scenes()) {
    INFO(scene.name);
    const SphereTree tree = build_sphere_tree(scene, with(2, 2, 0.0f));
    check_tree(scene, tree, true);
    REQUIRE(tree_stats(tree).depth <= 128);
    const SphereTree split = build_sphere_tree(scene, with(4, 0, 0.4f));
    check_tree(scene, split, false);
    check_parts_cover(scene, split);
  }
}

TEST_CASE("a thousand identical primitives are halved, not peeled off", "[tree]") {
  for (const Scene& scene : nasty_scenes())
    if (scene.name == "identical triangles") {
      // 3000 references: 12 halvings, and the root
      REQUIRE(tree_stats(build_sphere_tree(scene, with(1, 2, 0.0f))).depth == 13);
    }
}

TEST_CASE("the parts of split triangles cover them, and are told apart from nothing split", "[tree]") {
  Scene scene = random_scene(2, 400, 100);
  Random random(2, name_hash("long ones"), 0);
  for (int i = 0; i < 60; ++i) add_triangle(scene, cube_point(random), cube_point(random), cube_point(random));
  for (const float split : {0.7f, 0.25f, 0.0625f}) {
    INFO("split_long " << split);
    const SphereTree tree = build_sphere_tree(scene, with(4, 0, split));
    REQUIRE(tree.references.size() > scene.primitive_count());
    check_tree(scene, tree, false);
    check_parts_cover(scene, tree);
  }
}

TEST_CASE("the best split_long is the cheapest of its trials, and is told", "[tree]") {
  Scene diagonals;  // long thin triangles across the cube: splitting pays
  Random random(3, name_hash("diagonals"), 0);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 a = cube_point(random), b = cube_point(random);
    add_triangle(diagonals, a, b, b + 0.01f * cube_point(random));
  }
  const SphereTree best = build_sphere_tree(diagonals);
  const double whole = expected_cost(build_sphere_tree(diagonals, with(4, 0, 0.0f))).total();
  REQUIRE(best.options.split_long > 0.0f);
  REQUIRE(expected_cost(best).total() < 0.7 * whole);
  check_parts_cover(diagonals, best);
  const Scene crumbs = random_scene(4, 500, 0, 0.01f);  // nothing is long
  REQUIRE(build_sphere_tree(crumbs).options.split_long == 0.0f);
}

TEST_CASE("the tree is the same, bit for bit, on any number of threads", "[tree]") {
  Scene scene = random_scene(5, 3000, 500, 0.02f);
  Random random(5, name_hash("long ones"), 0);
  for (int i = 0; i < 50; ++i) add_triangle(scene, cube_point(random), cube_point(random), cube_point(random));
  const SphereTree one = build_sphere_tree(scene, {}, 1);
  for (const int threads : {2, 3, 0}) {
    const SphereTree other = build_sphere_tree(scene, {}, threads);
    REQUIRE(other.references == one.references);
    REQUIRE(other.nodes.size() == one.nodes.size());
    const bool same =
        std::equal(one.nodes.begin(), one.nodes.end(), other.nodes.begin(), [](const auto& a, const auto& b) {
          return a.center == b.center && a.radius == b.radius && a.lower == b.lower && a.upper == b.upper &&
                 a.first_child == b.first_child && a.child_count == b.child_count &&
                 a.first_reference == b.first_reference && a.reference_count == b.reference_count;
        });
    REQUIRE(same);
  }
}

TEST_CASE("an empty scene, or one of which nothing can be hit, has an empty tree", "[tree]") {
  REQUIRE(build_sphere_tree(Scene{}).nodes.empty());
  Scene scene;
  add_triangle(scene, glm::vec3(0.0f), glm::vec3(1.0f), glm::vec3(3.0f));  // on a line
  scene.spheres.push_back({glm::vec3(0.0f), 0.0f, 0});
  for (const float split : {kSplitBest, 0.0f, 0.1f}) {
    const SphereTree tree = build_sphere_tree(scene, with(4, 0, split));
    REQUIRE(tree.nodes.empty());
    REQUIRE(tree.references.empty());
    REQUIRE(expected_cost(tree).total() == 0.0);
    REQUIRE(tree_stats(tree).depth == 0);
  }
}

TEST_CASE("what cannot be built is refused", "[tree]") {
  const Scene good = random_scene(6, 10, 10);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const TreeOptions& options :
       {with(0, 0, 0.0f), with(9, 0, 0.0f), with(4, 1, 0.0f), with(4, -2, 0.0f), with(4, 0, -0.5f), with(4, 0, kNan)})
    REQUIRE_THROWS_AS(build_sphere_tree(good, options), InputError);
  Scene bad = good;
  bad.positions[7].y = kNan;
  REQUIRE_THROWS_AS(build_sphere_tree(bad), InputError);
  bad = good;
  bad.spheres[3].radius = std::numeric_limits<float>::infinity();
  REQUIRE_THROWS_AS(build_sphere_tree(bad), InputError);
  bad = good;
  bad.spheres[3].center.x = 3.3e38f, bad.spheres[3].radius = 2e37f;  // its box has no float
  REQUIRE_THROWS_AS(build_sphere_tree(bad), InputError);
  bad = good;  // each box has floats, the ball around both has none
  for (const float x : {-3e38f, 3e38f}) add_triangle(bad, {x, x, x}, {x, 0.9f * x, x}, {0.9f * x, x, x});
  REQUIRE_THROWS_AS(build_sphere_tree(bad), InputError);
}

TEST_CASE("the expected cost is counted from the radii", "[tree]") {
  SphereTree tree;
  tree.nodes.resize(4);
  tree.nodes[0].radius = 2.0f, tree.nodes[0].first_child = 1, tree.nodes[0].child_count = 3;
  for (int i = 1; i < 4; ++i) tree.nodes[i].radius = 1.0f, tree.nodes[i].reference_count = i;
  const TreeCost cost = expected_cost(tree);
  REQUIRE(cost.sphere_tests == 4.0);  // the root's and three when it is hit
  REQUIRE(cost.leaves == 0.75);       // three of a quarter each
  REQUIRE(cost.primitive_tests == 6.0 * 0.25);
  const TreeStats stats = tree_stats(tree);
  REQUIRE((stats.nodes == 4 && stats.leaves == 3 && stats.depth == 2));
  REQUIRE(stats.widths == std::vector<std::size_t>{0, 0, 0, 1});
  REQUIRE(stats.leaf_sizes == std::vector<std::size_t>{0, 1, 1, 1});
}

TEST_CASE("the time to build grows little faster than the scene", "[tree]") {
  const auto seconds = [](std::uint32_t triangles) {  // of processor time, all threads: other programs do not count
    const Scene scene = random_scene(7, triangles, 0, 0.5f / std::cbrt(static_cast<float>(triangles)));
    const std::clock_t start = std::clock();
    REQUIRE(build_sphere_tree(scene).references.size() == triangles);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double small = seconds(5000), large = seconds(80000);
  WARN("80,000 triangles took " << large << " s of processor time, 5,000 took " << small << " s");
  // 16 times the triangles: n log n and colder caches take 16 * 1.3 to 16 * 2.5 times as long, quadratic time 16 * 16.
  REQUIRE(large < 16 * 6 * small);
}

}  // namespace
}  // namespace plumbline
