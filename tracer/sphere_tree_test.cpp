// SPDX-License-Identifier: MIT
// What any user of a sphere tree relies on: it holds every primitive, exactly, and walks end.
#include "tracer/sphere_tree.h"

#include <catch2/catch.hpp>

#include "scenes/random.h"
#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

Scene random_scene(std::uint64_t seed, std::uint32_t triangles, std::uint32_t spheres) {
  Scene scene;
  Random random(seed, name_hash("tree scene"), 0);
  const auto point = [&] { return glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 corner = point();
    for (int k = 0; k < 3; ++k) scene.positions.push_back(corner + 0.05f * point());
    Triangle triangle;
    triangle.position = {3 * i, 3 * i + 1, 3 * i + 2};
    scene.triangles.push_back(triangle);
  }
  for (std::uint32_t i = 0; i < spheres; ++i)
    scene.spheres.push_back({point(), static_cast<float>(random.uniform(0.001, 0.05)), 0});
  scene.materials.resize(1);
  return scene;
}

/// |p - center| + extra <= radius, exactly: |p - center|^2 <= (radius - extra)^2, and every product is of two floats.
bool holds(const TreeNode& node, const glm::vec3& p, float extra = 0.0f) {
  std::vector<double> terms;
  const auto product = [&](double a, double b, double factor) { terms.push_back(factor * (a * b)); };
  for (int i = 0; i < 3; ++i) {
    product(p[i], p[i], 1), product(p[i], node.center[i], -2), product(node.center[i], node.center[i], 1);
    if (sum_down(p[i], -extra) < node.lower[i] || sum_up(p[i], extra) > node.upper[i]) return false;
  }
  product(node.radius, node.radius, -1), product(node.radius, extra, 2), product(extra, extra, -1);
  return node.radius >= extra && exact_sign(terms) <= 0;
}

/// Everything below `node` that `outer` must hold; marks what it meets.
void check_below(const Scene& scene, const SphereTree& tree, std::uint32_t node, std::vector<int>& seen,
                 std::vector<std::uint32_t>& above, std::size_t& nodes) {
  ++nodes;
  REQUIRE(nodes <= tree.nodes.size());
  above.push_back(node);
  const TreeNode& n = tree.nodes[node];
  if (n.is_leaf()) {
    REQUIRE(n.reference_count >= 1);
    REQUIRE(n.reference_count <= static_cast<std::uint32_t>(tree.options.leaf_size));
  } else {
    REQUIRE(n.reference_count == 0);
    REQUIRE(n.child_count >= 2);
    if (tree.options.width) REQUIRE(n.child_count <= static_cast<std::uint32_t>(tree.options.width));
  }
  for (std::uint32_t i = 0; i < n.reference_count; ++i) {
    const std::uint32_t p = tree.references.at(n.first_reference + i);
    ++seen.at(p);
    for (const std::uint32_t a : above) {
      bool inside = true;
      if (scene.is_triangle(p))
        for (const glm::vec3& corner : scene.corners(p)) inside = inside && holds(tree.nodes[a], corner);
      else
        inside = holds(tree.nodes[a], scene.sphere(p).center, scene.sphere(p).radius);
      if (!inside) FAIL("node " << a << " does not hold primitive " << p);
    }
  }
  for (std::uint32_t i = 0; i < n.child_count; ++i) check_below(scene, tree, n.first_child + i, seen, above, nodes);
  above.pop_back();
}

void check_tree(const Scene& scene, const SphereTree& tree) {
  std::vector<int> seen(scene.primitive_count(), 0);
  std::vector<std::uint32_t> above;
  std::size_t nodes = 0;
  check_below(scene, tree, 0, seen, above, nodes);
  REQUIRE(nodes == tree.nodes.size());
  for (const int count : seen) REQUIRE(count == 1);
}

TEST_CASE("a sphere tree holds every primitive exactly once") {
  for (const int leaf_size : {1, 2, 4, 8}) {
    TreeOptions options;
    options.leaf_size = leaf_size;
    const Scene scene = random_scene(1, 700, 300);
    check_tree(scene, build_sphere_tree(scene, options));
  }
}

TEST_CASE("an empty scene has an empty tree") { REQUIRE(build_sphere_tree(Scene{}).nodes.empty()); }

}  // namespace
}  // namespace plumbline
