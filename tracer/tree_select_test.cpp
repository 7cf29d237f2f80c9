// SPDX-License-Identifier: MIT
// The stages of the build, each against the plainest statement of what it is for.
#include "tracer/tree_select.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "tracer/tree_reinsert.h"
#include "tracer/tree_test_scenes.h"

namespace plumbline {
namespace {

struct Binary {
  References references;
  std::vector<BinaryNode> nodes;
};

Binary binary_tree(const Scene& scene, float split_long = 0.0f) {
  Binary binary;
  binary.references = collect_references(scene, split_long);
  binary.nodes = split_references(binary.references, 1);
  fit_balls(binary.nodes, binary.references, 1);
  return binary;
}

double sum_of_diagonals(const std::vector<BinaryNode>& nodes) {
  double sum = 0.0;
  for (const BinaryNode& node : nodes)
    if (node.second_child != 0) sum += node.box.diagonal2();
  return sum;
}

/// Ranges, order and boxes of a binary tree from the node `at` on.
void check_binary(const Binary& binary, std::uint32_t at) {
  const BinaryNode& node = binary.nodes.at(at);
  Box box;
  for (std::uint32_t i = 0; i < node.count; ++i) box.add(binary.references.list.at(node.first + i).box);
  REQUIRE((box.lower == node.box.lower && box.upper == node.box.upper));
  REQUIRE((node.second_child == 0) == (node.count == 1));
  if (node.count == 1) return;
  const BinaryNode &a = binary.nodes.at(at + 1), &b = binary.nodes.at(node.second_child);
  REQUIRE(node.second_child == at + 2 * a.count);
  REQUIRE((a.first == node.first && b.first == node.first + a.count && a.count + b.count == node.count));
  check_binary(binary, at + 1);
  check_binary(binary, node.second_child);
}

int depth_below(const Binary& binary, std::uint32_t at) {
  const std::uint32_t second = binary.nodes[at].second_child;
  return second == 0 ? 0 : 1 + std::max(depth_below(binary, at + 1), depth_below(binary, second));
}

std::multiset<std::uint32_t> primitives_of(const References& references) {
  std::multiset<std::uint32_t> primitives;
  for (const Reference& reference : references.list) primitives.insert(reference.primitive);
  return primitives;
}

/// The cheapest tree below `at` if `above` is the squared radius of the nearest kept ancestor, by the definition: keep
/// the node, leave it out, or end there. Exponential time.
double least_cost(const Binary& binary, std::uint32_t at, double above, int leaf_size) {
  const BinaryNode& node = binary.nodes[at];
  const double radius2 = static_cast<double>(node.radius) * node.radius;
  double best = std::numeric_limits<double>::infinity();
  std::set<std::uint32_t> primitives;
  for (std::uint32_t i = 0; i < node.count; ++i) primitives.insert(binary.references.list[node.first + i].primitive);
  const double count = static_cast<double>(primitives.size());
  if (count <= leaf_size) best = above * kStepCost + radius2 * (kLeafCost + count * kPrimitiveCost);
  if (node.second_child != 0) {
    const auto children = [&](double ancestor) {
      return least_cost(binary, at + 1, ancestor, leaf_size) +
             least_cost(binary, node.second_child, ancestor, leaf_size);
    };
    best = std::min({best, above * kStepCost + children(radius2), at == 0 ? best : children(above)});
  }
  return best;
}

TEST_CASE("the dynamic programming finds the cheapest tree there is", "[tree]") {
  int dropped = 0;
  for (int i = 0; i < 60; ++i) {
    const bool split = i % 3 == 0;
    const Scene scene = random_scene(100 + i, i % 2 ? 12 : 5, i % 2 ? 0 : 6, i % 4 < 2 ? 0.2f : 1.0f);
    const Binary binary = binary_tree(scene, split ? 0.8f : 0.0f);
    if (binary.references.list.size() > 18) continue;  // the definition takes exponential time
    TreeOptions options;
    options.leaf_size = 1 + i % 4;
    const SphereTree tree = select_nodes(binary.nodes, binary.references, options);
    const double radius2 = static_cast<double>(tree.nodes[0].radius) * tree.nodes[0].radius;
    INFO("scene " << i << " of " << binary.references.list.size() << " references");
    const double found = expected_cost(tree).total() * radius2;
    REQUIRE(found == Approx(least_cost(binary, 0, radius2, options.leaf_size)).epsilon(1e-12));
    const TreeStats stats = tree_stats(tree);
    for (std::size_t k = 3; k < stats.widths.size(); ++k) dropped += static_cast<int>(stats.widths[k]);
  }
  REQUIRE(dropped > 20);  // else the scenes ask nothing
}

TEST_CASE("more freedom never costs more: wider nodes, larger leaves", "[tree]") {
  const Binary binary = binary_tree(random_scene(8, 3000, 1000));
  const auto cost = [&](int leaf_size, int width) {
    TreeOptions options;
    options.leaf_size = leaf_size, options.width = width;
    return expected_cost(select_nodes(binary.nodes, binary.references, options)).total();
  };
  double plain = kStepCost;  // every node kept, one primitive in each leaf
  const double root2 = std::pow(static_cast<double>(binary.nodes[0].radius), 2.0);
  for (const BinaryNode& node : binary.nodes) {
    const double share = std::pow(static_cast<double>(node.radius), 2.0) / root2;
    plain += share * (node.second_child == 0 ? kLeafCost + kPrimitiveCost : 2.0 * kStepCost);
  }
  REQUIRE(cost(1, 2) == Approx(plain));
  REQUIRE(cost(1, 3) < cost(1, 2));
  REQUIRE(cost(1, 0) <= cost(1, 3));
  REQUIRE(cost(2, 2) < cost(1, 2));
  REQUIRE(cost(4, 2) <= cost(2, 2));
  REQUIRE(cost(4, 0) < cost(4, 2));
  REQUIRE(cost(8, 0) <= cost(4, 0));
}

TEST_CASE("splits and reinsertion order the references and keep them all", "[tree]") {
  for (const Scene& scene : nasty_scenes()) {
    INFO(scene.name);
    Binary binary;
    binary.references = collect_references(scene, 0.0f);
    const std::multiset<std::uint32_t> before = primitives_of(binary.references);
    binary.nodes = split_references(binary.references, 2);
    check_binary(binary, 0);
    REQUIRE(depth_below(binary, 0) <= kMaxSplitDepth + std::ceil(std::log2(before.size())));
    const double cost = sum_of_diagonals(binary.nodes);
    reinsert_subtrees(binary.nodes, binary.references, 1 << 20);
    check_binary(binary, 0);
    REQUIRE(depth_below(binary, 0) <= kMaxBinaryDepth);
    REQUIRE(sum_of_diagonals(binary.nodes) <= cost * (1.0 + 1e-12));
    REQUIRE(primitives_of(binary.references) == before);
  }
}

TEST_CASE("reinsertion mends what greedy splits get wrong", "[tree]") {
  // A row of spheres, each with a cluster of small ones around it: a binary split cuts through clusters.
  Scene scene;
  Random random(9, name_hash("clusters"), 0);
  for (int i = 0; i < 60; ++i) {
    const glm::vec3 center = 4.0f * cube_point(random);
    scene.spheres.push_back({center, 0.5f, 0});
    for (int k = 0; k < 12; ++k) scene.spheres.push_back({center + 0.65f * glm::vec3(random.direction()), 0.15f, 0});
  }
  Binary binary;
  binary.references = collect_references(scene, 0.0f);
  binary.nodes = split_references(binary.references, 1);
  const double cost = sum_of_diagonals(binary.nodes);
  reinsert_subtrees(binary.nodes, binary.references, 1 << 22);
  REQUIRE(sum_of_diagonals(binary.nodes) < 0.97 * cost);
}

TEST_CASE("a fitted ball is no larger than the ball around the node's box", "[tree]") {
  const Binary binary = binary_tree(random_scene(10, 2000, 500));
  double fitted = 0.0, boxed = 0.0;
  for (const BinaryNode& node : binary.nodes) {
    const double half = 0.5 * std::sqrt(node.box.diagonal2());
    // 2^-24 where the search for the ball ends; and its centre is rounded, by at most 2^-25 of each coordinate below 2
    REQUIRE(node.radius <= half * (1.0 + 0x1p-23) + 0x1p-23);
    fitted += static_cast<double>(node.radius) * node.radius, boxed += half * half;
  }
  REQUIRE(fitted < 0.8 * boxed);  // the design: fitted balls save 20 to 45 % of the steps
}

TEST_CASE("a triangle without area is told exactly", "[tree]") {
  Random random(11, name_hash("no area"), 0);
  for (int i = 0; i < 1000; ++i) {
    // Integer corners on a line, exact in float; one corner moved by one unit in the last place leaves the line.
    const auto integer = [&] { return static_cast<float>(static_cast<int>(random.below(2001)) - 1000); };
    const glm::vec3 a(integer(), integer(), integer()), step(integer(), integer(), integer());
    glm::vec3 c = a + static_cast<float>(random.below(9)) * step;
    REQUIRE(has_no_area(a, a + step, c));
    REQUIRE(has_no_area(c, a, a + step));
    int axis = static_cast<int>(random.below(3));
    if (step[(axis + 1) % 3] == 0.0f && step[(axis + 2) % 3] == 0.0f) continue;
    c[axis] = std::nextafter(c[axis], 1e9f);
    REQUIRE_FALSE(has_no_area(a, a + step, c));
  }
  // Plain double arithmetic makes nothing of this one: (2^40 - 2^-20 - 2^40) + 2^-60 - 2^-60.
  REQUIRE_FALSE(has_no_area({0x1p-60f, -0x1p-100f, 0.0f}, {1.0f, 1.0f, 0.0f}, {0x1p40f, 0x1p40f, 0.0f}));
  const float tiny = std::numeric_limits<float>::denorm_min();
  REQUIRE_FALSE(has_no_area(glm::vec3(0.0f), glm::vec3(tiny, 0.0f, 0.0f), glm::vec3(0.0f, tiny, 0.0f)));
}

TEST_CASE("cutting makes parts no longer than asked, each with a box that is smaller than the whole", "[tree]") {
  Scene scene;
  add_triangle(scene, {0, 0, 0}, {10, 9, 8}, {10, 9, 8.1f});
  scene.spheres.push_back({glm::vec3(5.0f), 0.1f, 0});
  const double radius = 0.5 * glm::length(glm::dvec3(10, 9, 8.1));
  const References whole = collect_references(scene, 0.0f), parts = collect_references(scene, 0.1f);
  REQUIRE(whole.list.size() == 2);
  REQUIRE(parts.list.size() > 10);
  double diagonals = 0.0;
  for (const Reference& reference : parts.list) {
    const glm::vec3 size = reference.box.upper - reference.box.lower;
    REQUIRE(std::max({size.x, size.y, size.z}) <= 0.1 * radius * (1.0 + 1e-5));
    if (reference.primitive == 0) diagonals += reference.box.diagonal2();
  }
  REQUIRE(diagonals < 0.1 * whole.list[0].box.diagonal2());
}

}  // namespace
}  // namespace plumbline
