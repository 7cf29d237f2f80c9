// SPDX-License-Identifier: MIT
// Figures of trees that are small enough to be computed by hand, and counts of visits against the shader's own steps.
#include "tracer/inspect.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "tracer/inspect_figures.h"
#include "tracer/inspect_rays.h"
#include "tracer/overlap.h"
#include "tracer/tree_test_scenes.h"

using namespace plumbline;

namespace {

/// Radii in the image are padded by 2^-17 of the scene's radius and rounded up by less than 2^-19 of themselves; what
/// is computed from them by hand without that is off by three times as much in a volume, and in a ratio of two.
constexpr double kPadding = 6.0 * 0x1p-16;

Scene two_spheres(float distance) {
  Scene scene;
  scene.name = "two_spheres";
  scene.materials.resize(1);
  scene.spheres = {{{-distance / 2, 0, 0}, 1.0f, 0}, {{distance / 2, 0, 0}, 1.0f, 0}};
  return scene;
}

std::vector<BakeOptions> all_options() {
  std::vector<BakeOptions> all;
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
      for (const Links links : {Links::octant, Links::threaded}) {
        BakeOptions options;
        options.layout = layout, options.bounds = bounds, options.links = links, options.width = 16;
        all.push_back(options);
      }
  return all;
}

BakeOptions one_each(BakeOptions options) {
  options.tree.leaf_size = 1;
  return options;
}

std::uint64_t sum(const std::vector<std::uint64_t>& histogram) {
  std::uint64_t total = 0;
  for (const std::uint64_t count : histogram) total += count;
  return total;
}

Volume ball(const glm::vec3& center, float radius) { return {false, center, radius * radius, {}, {}}; }
Volume box(const glm::vec3& lower, const glm::vec3& upper) { return {true, {}, 0.0f, lower, upper}; }

}  // namespace

TEST_CASE("inspect: a root with two leaves, by hand") {
  for (const BakeOptions& variant : all_options()) {
    const GeometryImage image = bake(two_spheres(4.0f), one_each(variant));
    const InspectedImage inspected = inspect_image(image);
    INFO(name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
    CHECK(inspected.fault_count == 0);
    REQUIRE(inspected.nodes.size() == 3);
    CHECK(inspected.nodes[0].children == 2);
    CHECK(inspected.nodes[0].primitives == 2);
    CHECK(inspected.nodes[2].parent == 0);
    const TreeFigures f = figures_of(image, inspected);
    CHECK(f.nodes == 3);
    CHECK(f.leaves == 2);
    CHECK(f.depth == 2);
    CHECK(f.depths == std::vector<std::uint64_t>{0, 0, 2});
    CHECK(f.nodes_at == std::vector<std::uint64_t>{0, 1, 2});
    CHECK(f.widths == std::vector<std::uint64_t>{0, 0, 1});
    CHECK(f.leaf_sizes == std::vector<std::uint64_t>{0, 2});
    CHECK(f.overlap.count == 1);
    CHECK(f.overlap.max == 0.0);
    // The image's ball has radius 3, and so has the root's. Every line visits the root (and an end), all that hit the
    // root visit both leaves: with spheres all do; of boxes it is the share of the surfaces. A leaf of radius 1 is hit
    // by 1 / 9 of the lines, its box of side 2 by 24 of 36 pi.
    const bool boxes = variant.bounds == Bounds::aabb;
    const double root = boxes ? (2 * 4 + 4 * 12) / (36 * std::numbers::pi) : 1.0;
    const double leaf = boxes ? 24.0 / (36 * std::numbers::pi) : 1.0 / 9.0;
    const double end = variant.layout == Layout::compact ? 1.0 : 0.0;
    CHECK(f.cost.visits == Approx(end + 1.0 + 2.0 * root).epsilon(kPadding));
    CHECK(f.cost.primitives == Approx(2.0 * leaf).epsilon(kPadding));
    CHECK(f.cost.transforms == 0.0);
    CHECK(f.slack.count == (boxes ? 0u : 3u));
    if (!boxes) {
      CHECK(f.slack.min >= 1.0);
      CHECK(f.slack.max <= 1.0 + kPadding);
    }
  }
}

TEST_CASE("inspect: memory by kind of texel, by hand") {
  // Three nodes, spheres without triangles (two texels each), one copy or eight.
  for (const BakeOptions& variant : all_options()) {
    const GeometryImage image = bake(two_spheres(4.0f), one_each(variant));
    const auto counts = count_kinds(texel_kinds(image, inspect_image(image)));
    const auto of = [&](TexelKind kind) { return counts[static_cast<std::size_t>(kind)]; };
    INFO(name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
    const std::uint64_t tops = variant.bounds == Bounds::aabb ? 6 : 3, others = image.copy_count - 1;
    const std::uint64_t links = variant.layout == Layout::paper ? 3 : 0;
    CHECK(of(TexelKind::node) == tops);
    CHECK(of(TexelKind::link) == links);
    CHECK(of(TexelKind::copy) == others * (tops + links));
    CHECK(of(TexelKind::end) == (variant.layout == Layout::compact ? image.copy_count : 0u));
    CHECK(of(TexelKind::primitive) == 4);
    CHECK(of(TexelKind::transform) == 0);
    std::uint64_t all = 0;
    for (const std::uint64_t count : counts) all += count;
    CHECK(all == image.texels.size());
  }
}

TEST_CASE("inspect: volumes that siblings share, in closed form") {
  const double pi = std::numbers::pi;
  // Two unit balls at distance 1: a lens of 5 pi / 12.
  CHECK(shared_volume(ball({0, 0, 0}, 1), ball({1, 0, 0}, 1)) == Approx(5 * pi / 12).epsilon(1e-12));
  // One inside the other; touching from inside, from outside; apart; the same twice.
  CHECK(shared_volume(ball({0, 0, 0}, 2), ball({0.5f, 0, 0}, 1)) == Approx(4 * pi / 3).epsilon(1e-12));
  CHECK(shared_volume(ball({0, 0, 0}, 2), ball({1, 0, 0}, 1)) == Approx(4 * pi / 3).epsilon(1e-12));
  CHECK(shared_volume(ball({0, 0, 0}, 1), ball({2, 0, 0}, 1)) == 0.0);
  CHECK(shared_volume(ball({0, 0, 0}, 1), ball({5, 0, 0}, 1)) == 0.0);
  CHECK(shared_volume(ball({0, 0, 0}, 1), ball({0, 0, 0}, 1)) == Approx(4 * pi / 3).epsilon(1e-12));
  CHECK(shared_volume(box({0, 0, 0}, {2, 2, 2}), box({1, 1, 1}, {3, 3, 4})) == 1.0);
  CHECK(shared_volume(box({0, 0, 0}, {2, 2, 2}), box({2, 0, 0}, {3, 3, 3})) == 0.0);
  const std::vector<Volume> three(3, box({0, 0, 0}, {1, 1, 1}));
  CHECK(sibling_overlap(box({0, 0, 0}, {2, 2, 2}), three) == 3.0 / 8.0);
  CHECK(std::isnan(sibling_overlap(ball({0, 0, 0}, 0), {})));
  // Many children: a row in which each shares half of itself with the next, and a heap that is too much to look at.
  std::vector<Volume> row, heap(100000, box({0, 0, 0}, {1, 1, 1}));
  CHECK(std::isnan(sibling_overlap(box({0, 0, 0}, {1, 1, 1}), heap)));
  for (int i = 100000; i-- > 0;)
    row.push_back(box({static_cast<float>(i), 0, 0}, {static_cast<float>(i) + 1.5f, 1, 1}));
  CHECK(sibling_overlap(box({0, 0, 0}, {100000, 1, 1}), row) == 99999 * 0.5 / 100000);
}

TEST_CASE("inspect: the overlap of two balls in a tree") {
  BakeOptions options;
  const GeometryImage image = bake(two_spheres(1.0f), one_each(options));
  const InspectedImage inspected = inspect_image(image);
  REQUIRE(inspected.nodes.size() == 3);
  // 5 pi / 12 of the root's 4 pi / 3 * 1.5^3.
  CHECK(inspected.nodes[0].overlap == Approx(5.0 / 54.0).epsilon(8 * kPadding));
  CHECK(std::isnan(inspected.nodes[1].overlap));
  CHECK(figures_of(image, inspected).overlap_met == inspected.nodes[0].overlap);
}

TEST_CASE("inspect: regions behind transforms are counted once, and paid for as often as they are met") {
  for (const BakeOptions& variant : all_options()) {
    const Scene scene = load_scene("nested");
    const GeometryImage image = bake(scene, variant);
    const InspectedImage inspected = inspect_image(image);
    const TreeFigures f = figures_of(image, inspected);
    INFO(name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
    CHECK(inspected.fault_count == 0);
    CHECK(inspected.regions.size() > 2);
    CHECK(f.primitives == image.primitive_count);
    CHECK(sum(f.depths) == f.leaves);
    CHECK(sum(f.nodes_at) == f.nodes);
    CHECK(sum(f.leaf_sizes) + f.transforms == f.leaves);
    CHECK(sum(f.widths) + f.leaves == f.nodes);
    const auto counts = count_kinds(texel_kinds(image, inspected));
    CHECK(counts[static_cast<std::size_t>(TexelKind::transform)] == kTransformTexels * image.transform_count);
    std::uint64_t all = 0;
    for (const std::uint64_t count : counts) all += count;
    CHECK(all == image.texels.size());
    for (std::uint32_t n = 0; n < inspected.entrance.size(); ++n)
      if (inspected.entrance[n] != kNone) CHECK(inspected.nodes[inspected.entrance[n]].transform == n);
  }
}

TEST_CASE("inspect: the cost behind a transform, by hand") {
  // Two unit spheres at distance 4, in a part that is shown once, twice as large, by a node.
  Scene scene = two_spheres(4.0f);
  Part part;
  part.sphere_count = 2;
  scene.parts.push_back(part);
  Node node;
  node.part = 0;
  node.transform.linear = glm::mat3(2.0f);
  node.rest = node.transform;
  scene.nodes.push_back(node);
  for (const BakeOptions& variant : all_options()) {
    const GeometryImage image = bake(scene, one_each(variant));
    const InspectedImage inspected = inspect_image(image);
    INFO(name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
    REQUIRE(inspected.regions.size() == 2);
    REQUIRE(inspected.nodes.size() == 4);
    CHECK(inspected.nodes[inspected.entrance[0]].region == 0);
    // The world: a leaf of radius 6 (its box of side 12 covers every line), an end; behind it the ball of radius 3
    // doubled is the world's own, so that the part costs what it would alone.
    const bool boxes = variant.bounds == Bounds::aabb;
    const double root = boxes ? (2 * 4 + 4 * 12) / (36 * std::numbers::pi) : 1.0;
    const double leaf = boxes ? 24.0 / (36 * std::numbers::pi) : 1.0 / 9.0;
    const double ends = variant.layout == Layout::compact ? 2.0 : 0.0;
    const LineCost cost = figures_of(image, inspected).cost;
    CHECK(cost.transforms == Approx(1.0).epsilon(4 * kPadding));
    CHECK(cost.visits == Approx(ends + 2.0 + 2.0 * root).epsilon(4 * kPadding));
    CHECK(cost.primitives == Approx(2.0 * leaf).epsilon(4 * kPadding));
  }
}

TEST_CASE("inspect: the shader's counters add up to its own steps and tests") {
  GlContext context;
  for (const char* spec : {"sphereflake:2", "nested"}) {
    const Scene scene = load_scene(spec);
    for (const BakeOptions& variant : all_options()) {
      const GeometryImage image = bake(scene, variant);
      const InspectedImage inspected = inspect_image(image);
      VisitProbe counting(context, image);
      Probe plain(context, image);
      const std::vector<Ray> rays = random_lines(image, 3000, 7);
      std::vector<Hit> hits(rays.size()), as_always(rays.size());
      counting.trace(rays, hits);
      plain.trace(rays, as_always);
      std::uint64_t steps = 0, tests = 0, visits = 0, primitives = 0, of_nodes = 0;
      bool same = true;
      for (std::size_t i = 0; i < hits.size(); ++i) {
        steps += hits[i].steps, tests += hits[i].primitive_tests;
        same = same && hits[i].kind == as_always[i].kind && hits[i].primitive == as_always[i].primitive &&
               hits[i].t == as_always[i].t && hits[i].steps == as_always[i].steps;
      }
      const std::vector<NodeVisits> counted = counting.visits();
      for (const NodeVisits& v : counted) visits += v.visits;
      const std::vector<NodeLoad> loads = node_loads(inspected, counted);
      for (const NodeLoad& load : loads) of_nodes += load.visits, primitives += load.primitive_tests;
      INFO(spec << " " << name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
      CHECK(same);
      CHECK(steps > 0);
      CHECK(visits == steps);
      CHECK(primitives == tests);
      // Ends are no nodes.
      if (variant.layout == Layout::paper) CHECK(of_nodes == steps);
      if (variant.layout == Layout::compact) CHECK(of_nodes < steps);
    }
  }
}

TEST_CASE("inspect: a leaf that a walk comes back to is counted once") {
  // Triangles in one plane and rays within it: each is seen edge-on and resolved in another pass.
  Scene scene;
  scene.name = "flat";
  scene.materials.resize(1);
  Random random(1, name_hash("flat"), 0);
  const auto flat = [&] { return glm::vec3(random.uniform(-1, 1), 0.5, random.uniform(-1, 1)); };
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 corner = flat();
    add_triangle(scene, corner, corner + 0.1f * (flat() - flat()), corner + 0.1f * (flat() - flat()));
  }
  std::vector<Ray> rays(300);
  for (Ray& ray : rays) ray.origin = 3.0f * flat() - glm::vec3(0, 1, 0), ray.direction = flat() - flat();
  GlContext context;
  for (const BakeOptions& variant : all_options()) {
    const GeometryImage image = bake(scene, variant);
    VisitProbe probe(context, image);
    std::vector<Hit> hits(rays.size());
    probe.trace(rays, hits);
    std::uint64_t steps = 0, visits = 0;
    for (const Hit& hit : hits) steps += hit.steps;
    for (const NodeVisits& v : probe.visits()) visits += v.visits;
    INFO(name_of(variant.layout) << " " << name_of(variant.bounds) << " " << name_of(variant.links));
    CHECK(steps > 2 * rays.size());
    CHECK(visits == steps);
  }
}

TEST_CASE("inspect: random lines meet nodes as often as the cost model says") {
  const Scene scene = two_spheres(4.0f);
  const GeometryImage image = bake(scene, one_each({}));
  const InspectedImage inspected = inspect_image(image);
  GlContext context;
  VisitProbe probe(context, image);
  const std::size_t count = 200'000;
  const std::vector<Ray> rays = random_lines(image, count, 3);
  std::vector<Hit> hits(count);
  probe.trace(rays, hits);
  const std::vector<NodeLoad> loads = node_loads(inspected, probe.visits());
  CHECK(loads[0].visits == count);
  // Both leaves are visited by all; each is hit by one line in nine, but for those that the other has stopped. Seen
  // from a point of one ball the centre of the other is at least 3 away, so that at most 1 / 3^2 of the lines through
  // it meet the other too (by the cosine law). Six standard deviations of a binomial count.
  for (const std::size_t leaf : {1u, 2u}) {
    const double n = static_cast<double>(count), p = 1.0 / 9.0, deviation = 6.0 * std::sqrt(n * p * (1.0 - p));
    CHECK(static_cast<double>(loads[leaf].hits) < n * p + deviation);
    CHECK(static_cast<double>(loads[leaf].hits) > n * p * (1.0 - 1.0 / 9.0) - deviation);
  }
}

TEST_CASE("inspect: depth and overlap of hits go through transforms") {
  const Scene scene = load_scene("nested");
  const GeometryImage image = bake(scene);
  const InspectedImage inspected = inspect_image(image);
  const HitPlaces places(image, inspected);
  GlContext context;
  Probe probe(context, image);
  const std::vector<Ray> rays = random_lines(image, 4000, 5);
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  std::size_t placed = 0;
  for (const Hit& hit : hits) {
    if (hit.kind != HitKind::hit) {
      CHECK(places.depth(hit) == 0);
      continue;
    }
    // At least one node for each space.
    const std::size_t spaces = chain_of(scene, hit.instance).size() + 1;
    CHECK(places.depth(hit) >= spaces - (inspected.regions[0].node_count == 0));
    CHECK(places.overlap(hit) >= 0.0);
    placed += spaces > 2;
  }
  CHECK(placed > 0);
}

TEST_CASE("inspect: a broken image is taken apart as far as it goes") {
  GeometryImage image = bake(load_scene("sphereflake:2"));
  const InspectedImage whole = inspect_image(image);
  image.texels[1].w = 0.0f;
  const InspectedImage broken = inspect_image(image);
  CHECK(broken.fault_count > 0);
  CHECK_FALSE(broken.faults.empty());
  CHECK(figures_of(image, broken).slack.count == 0);
  CHECK(figures_of(image, whole).slack.count > 0);
  image.primitive_count = 0x7fffffff;
  CHECK_THROWS_AS(inspect_image(image), InputError);
}
