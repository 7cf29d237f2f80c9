// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/inspect.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "harness/clock.h"
#include "harness/hit_cases.h"
#include "harness/inspect_pictures.h"
#include "tracer/probe.h"

namespace plumbline {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SpreadRecord spread_of(const Summary& s) { return {s.count, s.mean, s.min, s.median, s.p99, s.max}; }

HistogramRecord histogram_of(const std::string& name, const std::string& unit,
                             const std::vector<std::uint64_t>& counts) {
  HistogramRecord h{name, unit, 0, 1, counts};
  while (!h.counts.empty() && h.counts.front() == 0) h.counts.erase(h.counts.begin()), ++h.first;
  return h;
}

/// At most 60 bars, of a width of 1, 2, 5, 10, ...
HistogramRecord histogram_of(const std::string& name, const std::vector<double>& values) {
  HistogramRecord h;
  h.name = name, h.unit = "rays";
  const double most = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  for (int i = 0; most / static_cast<double>(h.width) >= 60.0; ++i)
    h.width = i % 3 == 1 ? h.width / 2 * 5 : h.width * 2;
  h.counts.assign(static_cast<std::size_t>(most) / h.width + 1, 0);
  for (const double value : values) ++h.counts[static_cast<std::size_t>(value) / h.width];
  return h;
}

std::string region_name(const InspectTask& task, const InspectedRegion& region) {
  if (region.from.empty()) return "world";
  const std::uint32_t first = region.from[0];
  std::string name = "behind node " + std::to_string(first);
  if (task.scene != nullptr && first < task.scene->nodes.size() && !task.scene->nodes[first].name.empty())
    name += " (" + task.scene->nodes[first].name + ")";
  if (region.from.size() > 1) name += " and " + std::to_string(region.from.size() - 1) + " more";
  return name;
}

void record_trees(const InspectTask& task, const InspectedImage& inspected, const TreeFigures& figures,
                  InspectedBake& record) {
  const GeometryImage& image = *task.image;
  const BakeOptions& o = image.options;
  record.options = {{"layout", name_of(o.layout)},
                    {"bounds", name_of(o.bounds)},
                    {"links", name_of(o.links)},
                    {"transform-out", name_of(o.transform_out)},
                    {"transform-list", name_of(o.transform_list)},
                    {"leaf-size", std::to_string(o.tree.leaf_size)},
                    {"tree-width", std::to_string(o.tree.width)}};
  record.width = image.width, record.height = image.height;
  record.unit = std::ldexp(1.0, -image.scale_exponent);
  record.faults = inspected.faults, record.fault_count = inspected.fault_count;
  record.nodes = figures.nodes, record.leaves = figures.leaves, record.primitives = figures.primitives;
  record.transforms = figures.transforms, record.depth = figures.depth, record.copies = image.copy_count;
  record.expected_steps = figures.cost.visits, record.expected_tests = figures.cost.primitives;
  record.expected_transforms = figures.cost.transforms;
  record.slack = spread_of(figures.slack), record.overlap = spread_of(figures.overlap);
  record.overlap_met = figures.overlap_met;
  record.histograms = {histogram_of("nodes by depth", "nodes", figures.nodes_at),
                       histogram_of("leaves by depth", "leaves", figures.depths),
                       histogram_of("inner nodes by children", "nodes", figures.widths),
                       histogram_of("leaves by primitives", "leaves", figures.leaf_sizes)};
  for (std::size_t r = 0; r < inspected.regions.size(); ++r) {
    const InspectedRegion& region = inspected.regions[r];
    const RegionFigures& f = figures.regions[r];
    record.regions.push_back({region_name(task, region), std::max<std::uint64_t>(region.from.size(), 1), f.nodes,
                              f.leaves, f.transforms, f.primitives, f.depth, f.texels, f.cost.visits,
                              f.cost.primitives});
  }
}

/// One kind of rays, traced.
struct Traced {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
};

InspectedRays record_rays(const InspectTask& task, const Traced& traced, const std::string& name,
                          const std::string& what, bool is_camera) {
  InspectedRays record;
  record.name = name, record.what = what, record.count = traced.rays.size();
  std::vector<double> steps, tests;
  for (const Hit& hit : traced.hits) {
    record.hits += hit.kind == HitKind::hit;
    steps.push_back(hit.steps), tests.push_back(hit.primitive_tests);
  }
  record.histogram = histogram_of("steps: " + name, steps);
  record.steps = spread_of(summarize_values(steps)), record.tests = spread_of(summarize_values(std::move(tests)));
  record.expected_steps = record.expected_tests = kNan;
  std::vector<std::size_t> order(traced.hits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t count = std::min(task.top, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::size_t a, std::size_t b) { return steps[a] != steps[b] ? steps[a] > steps[b] : a < b; });
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = order[k];
    const Hit& hit = traced.hits[i];
    const auto width = static_cast<std::size_t>(task.camera.width);
    InspectedRayRecord ray;
    ray.origin = hex_vector(traced.rays[i].origin), ray.direction = hex_vector(traced.rays[i].direction);
    ray.where = is_camera ? "pixel " + std::to_string(i % width) + ", " + std::to_string(i / width) + " of " +
                                std::to_string(task.camera.width) + " x " + std::to_string(task.camera.height)
                          : "line " + std::to_string(i);
    ray.steps = hit.steps, ray.tests = hit.primitive_tests, ray.transforms = hit.transforms;
    ray.answer = describe(hit);
    if (!task.spec.empty())
      ray.replay = "./plumbline explain " + quoted(task.spec) + " --ray=" + ray_argument(traced.rays[i]);
    record.longest.push_back(std::move(ray));
  }
  return record;
}

}  // namespace

Inspection inspect(GlContext& context, const InspectTask& task) {
  const GeometryImage& image = *task.image;
  Inspection result;
  InspectedBake& record = result.record;
  record.name = task.name, record.source = task.source, record.bake_seconds = task.bake_seconds;
  const auto say = [&](double share, const std::string& what) {
    if (task.progress) task.progress(share, task.name + ": " + what);
  };
  say(0.0, "taking it apart");
  auto start = Clock::now();
  result.inspected = inspect_image(image);
  const InspectedImage& inspected = result.inspected;
  const TreeFigures figures = figures_of(image, inspected);
  record_trees(task, inspected, figures, record);
  const std::vector<TexelKind> kinds = texel_kinds(image, inspected);
  const auto counts = count_kinds(kinds);
  for (std::size_t k = 0; k < kTexelKinds; ++k)
    record.memory.push_back({name_of(static_cast<TexelKind>(k)), counts[k]});
  record.statistics_seconds = seconds_since(start);

  say(0.4, "tracing rays");
  start = Clock::now();
  VisitProbe probe(context, image);
  Traced camera, lines;
  const CameraFrame frame = camera_frame(task.camera);
  for (int y = 0; y < task.camera.height; ++y)
    for (int x = 0; x < task.camera.width; ++x) camera.rays.push_back(camera_ray(frame, x, y));
  lines.rays = random_lines(image, task.lines, task.seed);
  for (Traced* traced : {&camera, &lines}) {
    traced->hits.resize(traced->rays.size());
    probe.trace(traced->rays, traced->hits);
  }
  result.loads = node_loads(inspected, probe.visits());
  record.trace_seconds = seconds_since(start);
  record.rays.push_back(record_rays(task, camera, "camera", "One ray through the centre of each pixel.", true));
  record.rays.push_back(record_rays(task, lines, "lines", "Random lines through the scene's ball.", false));
  record.rays.back().expected_steps = figures.cost.visits, record.rays.back().expected_tests = figures.cost.primitives;
  record.visits_by_depth.assign(figures.nodes_at.size(), 0);
  for (std::size_t i = 0; i < result.loads.size(); ++i)
    record.visits_by_depth[inspected.nodes[i].depth] += result.loads[i].visits;

  if (!task.out.empty()) {
    say(0.8, "painting");
    paint_image(task, kinds, record.pictures);
    paint_rays(task, inspected, camera.rays, camera.hits, record.pictures);
  }
  say(1.0, "done");
  return result;
}

}  // namespace plumbline
