// SPDX-License-Identifier: GPL-3.0-or-later
// Inspections: what is recorded, which trees are alike, and options given as a word.
#include "harness/inspect.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "harness/commands.h"
#include "scenes/error.h"
#include "scenes/generate.h"

using namespace plumbline;

namespace {

struct Inspected {
  GeometryImage image;
  Inspection inspection;
};

Inspected inspect_scene(GlContext& context, const Scene& scene, const BakeOptions& options = {}) {
  Inspected result{bake(scene, options), {}};
  InspectTask task;
  task.name = "test", task.source = task.spec = "sphereflake:2";
  task.image = &result.image, task.scene = &scene;
  task.camera = scene.camera;
  task.camera.width = task.camera.height = 32;
  task.lines = 500;
  result.inspection = inspect(context, task);
  return result;
}

std::vector<NodeLoad> nothing;

}  // namespace

TEST_CASE("Inspect: records hold what was traced, and the costliest nodes come first") {
  GlContext context;
  const Scene scene = load_scene("sphereflake:2");
  Inspected a = inspect_scene(context, scene);
  list_nodes(a.image, 5, {}, nothing, a.inspection);
  const InspectedBake& record = a.inspection.record;
  REQUIRE(record.rays.size() == 2);
  CHECK(record.rays[0].count == 32 * 32);
  CHECK(record.rays[1].count == 500);
  CHECK(record.outline.size() == record.nodes);
  CHECK(record.kept_depth == 0);
  REQUIRE(record.costliest.size() == 5);
  double most = 0.0;
  for (const InspectedNodeRecord& node : record.outline) most = std::max(most, node.cost);
  CHECK(record.costliest[0].cost == most);
  for (std::size_t i = 1; i < 5; ++i) CHECK(record.costliest[i].cost <= record.costliest[i - 1].cost);
  // Every ray visits the root; rays whose line passes the scene's ball visit nothing at all.
  CHECK(record.visits_by_depth[1] >= 500);
  CHECK(record.visits_by_depth[1] <= 500 + 32 * 32);
  for (const InspectedRays& rays : record.rays) {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : rays.histogram.counts) sum += count;
    CHECK(sum == rays.count);
    REQUIRE(rays.longest.size() == 5);
    CHECK(static_cast<double>(rays.longest[0].steps) == rays.steps.max);
    CHECK(rays.longest[0].replay.find("./plumbline explain sphereflake:2 --ray=") == 0);
  }
  std::uint64_t texels = 0;
  for (const ShareRecord& share : record.memory) texels += share.count;
  CHECK(texels == a.image.texels.size());
}

TEST_CASE("Inspect: trees are alike whatever layout, bounds and links are, and not with other leaves") {
  GlContext context;
  for (const char* spec : {"sphereflake:2", "nested"}) {
    const Scene scene = load_scene(spec);
    const InspectedImage a = inspect_image(bake(scene));
    for (const Layout layout : {Layout::compact, Layout::paper})
      for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
        for (const Links links : {Links::octant, Links::threaded}) {
          BakeOptions options;
          options.layout = layout, options.bounds = bounds, options.links = links;
          const InspectedImage b = inspect_image(bake(scene, options));
          const std::vector<std::uint32_t> twins = twins_between(a, b);
          INFO(spec << " " << name_of(layout) << " " << name_of(bounds) << " " << name_of(links));
          REQUIRE(twins.size() == a.nodes.size());
          bool same = true;
          std::vector<bool> met(b.nodes.size(), false);
          for (std::uint32_t i = 0; i < twins.size(); ++i) {
            const InspectedNode &x = a.nodes[i], &y = b.nodes[twins[i]];
            same = same && !met[twins[i]] && x.cluster == y.cluster && x.transform == y.transform &&
                   x.children == y.children && x.depth == y.depth &&
                   (x.parent == kNone ? y.parent == kNone : twins[x.parent] == y.parent);
            met[twins[i]] = true;
          }
          CHECK(same);
        }
    BakeOptions other;
    other.tree.leaf_size = 1;
    CHECK(twins_between(a, inspect_image(bake(load_scene("sphereflake:2"), other))).empty());
  }
}

TEST_CASE("Inspect: an image without anything in it") {
  GlContext context;
  Scene scene;
  scene.name = "empty";
  Inspected a = inspect_scene(context, scene);
  list_nodes(a.image, 5, {}, nothing, a.inspection);
  CHECK(a.inspection.record.nodes == 0);
  CHECK(a.inspection.record.outline.empty());
  CHECK(a.inspection.record.rays[0].hits == 0);
}

TEST_CASE("Inspect: bake options as a word") {
  const BakeOptions options = parse_bake_options("layout=paper,bounds=aabb,leaf-size=2", {});
  CHECK(options.layout == Layout::paper);
  CHECK(options.bounds == Bounds::aabb);
  CHECK(options.links == BakeOptions{}.links);
  CHECK(options.tree.leaf_size == 2);
  BakeOptions base;
  base.links = Links::threaded;
  CHECK(parse_bake_options("layout=paper", base).links == Links::threaded);
  for (const char* wrong :
       {"", "layout", "layout=cubic", "leaf-size=0", "colour=red", "layout=paper,,bounds=aabb", ","})
    CHECK_THROWS_AS(parse_bake_options(wrong, {}), InputError);
}
