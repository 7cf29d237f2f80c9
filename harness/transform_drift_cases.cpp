// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `transforms.drift` and `transforms.bunnies`: how the paper's way out of a transform wears a ray away, and
// ten thousand instances of a real mesh.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>

#include "harness/catalogue.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "reference/exact_values.h"
#include "reports/files.h"
#include "reports/plot.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::size_t kDriftRays = 4096;

/// A node's transform: any rotation, a scale between 1/2 and 2, and a step that keeps the unit ball around the origin.
Transform tumbled(Random& random) {
  const glm::dquat turn = glm::angleAxis(random.uniform(0.0, 6.0), random.direction());
  const double scale = std::exp2(random.uniform(-0.5, 0.5));
  return {glm::mat3(glm::mat3_cast(turn) * scale), glm::vec3(0.05 * random.direction())};
}

/// A wall behind transforms that rays pass through without hitting anything: `count` nodes that stand one inside the
/// other (nested) or all in one place. What they show is two grains at the ends of a long diameter. The wall is the
/// last node, with the identity for a transform: what stands in the world itself is walked before the nodes, so it
/// would not see the drift.
Scene drift_scene(std::uint32_t count, bool nested) {
  Scene s;
  s.name = "drift";
  s.materials.emplace_back();
  s.positions = {{-40, -40, 6}, {40, -40, 6}, {0, 60, 6.5}};
  s.triangles.push_back({{0, 1, 2}});
  s.spheres = {{{3, 0, 0}, 0.001f, 0}, {{-3, 0, 0}, 0.001f, 0}};
  s.parts.push_back({"wall", 0, 1, 0, 0});
  s.parts.push_back({"grains", 1, 0, 0, 2});
  Random random(1, name_hash("drift"), count * 2 + nested);
  for (std::uint32_t i = 0; i < count; ++i) {
    Node node;
    node.name = "node " + std::to_string(i);
    node.parent = nested && i > 0 ? i - 1 : kNone;
    node.part = !nested || i + 1 == count ? 1 : kNone;
    node.transform = node.rest = tumbled(random);
    s.nodes.push_back(node);
  }
  Node wall;
  wall.name = "wall";
  wall.part = 0;
  s.nodes.push_back(wall);
  frame_camera(s);
  return s;
}

/// Errors of the position on the wall, in units of 2^-24 of the scene's radius: median and greatest.
struct Errors {
  double median = 0.0, greatest = 0.0;
};

Errors drift_of(Session& session, const Scene& scene, TransformOut out, std::uint32_t transforms, std::uint64_t seed) {
  BakeOptions options;
  options.transform_out = out;
  options.links = Links::threaded;  // with the list: nodes are walked in their order, the wall last
  options.transform_list = TransformList::root;
  const GeometryImage image = bake(scene, options);
  const auto wall = static_cast<std::uint32_t>(scene.nodes.size() - 1);
  std::vector<Ray> rays(kDriftRays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Random random(seed, name_hash("drift rays"), i);
    const glm::dvec3 from = glm::dvec3(0, 0, -5) + 0.3 * random.direction(), through = 0.3 * random.direction();
    rays[i] = {glm::vec3(from), glm::vec3(through - from)};
  }
  std::vector<Hit> hits(rays.size());
  session.probe(image).trace(rays, hits);
  const double unit = 0x1p-24 * bounding_ball(scene).radius;
  std::vector<double> errors;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].kind != HitKind::hit || hits[i].instance != wall || hits[i].transforms != transforms + 1) continue;
    const ReferenceHit truth = exact_hit(scene, rays[i], wall, hits[i].primitive);
    errors.push_back(glm::length(glm::dvec3(hits[i].position) - truth.position) / unit);
  }
  if (errors.size() < kDriftRays / 2)
    throw EnvironmentError("of " + std::to_string(kDriftRays) + " rays only " + std::to_string(errors.size()) +
                           " pass through all " + std::to_string(transforms) + " transforms");
  std::sort(errors.begin(), errors.end());
  return {errors[errors.size() / 2], errors.back()};
}

/// One plot: both variants over the number of transforms.
struct DriftCurve {
  PlotSeries inverse_median{"inverse, median", "#d55e00", false, {}, {}},
      inverse_greatest{"inverse, greatest", "#d55e00", true, {}, {}},
      restore_median{"restore, median", "#0072b2", false, {}, {}},
      restore_greatest{"restore, greatest", "#0072b2", true, {}, {}};
};

DriftCurve measure(Session& session, const std::vector<std::uint32_t>& counts, bool nested, std::uint64_t seed,
                   const std::function<void(double)>& progress) {
  DriftCurve curve;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const Scene scene = drift_scene(counts[i], nested);
    const Errors inverse = drift_of(session, scene, TransformOut::inverse, counts[i], seed);
    const Errors restore = drift_of(session, scene, TransformOut::restore, counts[i], seed);
    const auto add = [&](PlotSeries& series, double y) {
      series.x.push_back(counts[i]);
      series.y.push_back(y);
    };
    add(curve.inverse_median, inverse.median), add(curve.inverse_greatest, inverse.greatest);
    add(curve.restore_median, restore.median), add(curve.restore_greatest, restore.greatest);
    progress(static_cast<double>(i + 1) / static_cast<double>(counts.size()));
  }
  return curve;
}

PictureRecord plot_of(const DriftCurve& curve, const std::string& x_label, const CaseContext& context,
                      const std::string& stem, const std::string& title, const std::string& caption) {
  Plot plot{x_label, "error of the position (2^-24 of the scene's radius)", true, true, {}};
  plot.series = {curve.inverse_greatest, curve.inverse_median, curve.restore_greatest, curve.restore_median};
  return save_plot(plot, context.out, stem, title, caption);
}

/// The slope of y over x between the first and the last point, in decades for each decade.
double growth(const PlotSeries& s) { return std::log(s.y.back() / s.y.front()) / std::log(s.x.back() / s.x.front()); }

}  // namespace

Case drift_case() {
  Case c;
  c.name = "transforms.drift";
  c.feature = "transforms";
  c.paper = "6";
  c.proves =
      "A ray that leaves transforms by their inverses drifts with each one left; a ray that is restored does not drift "
      "at all.";
  c.run = [](CaseContext& context, const Case& self, CaseRecord& record) {
    const std::uint64_t seed = case_seed(context.seed, self.name);
    const DriftCurve depth =
        measure(context.session, {1, 2, 4, 8, 16}, true, seed, [&](double share) { context.progress(0.5 * share); });
    const DriftCurve crossed = measure(context.session, {1, 2, 4, 8, 16, 32, 64, 128, 256}, false, seed,
                                       [&](double share) { context.progress(0.5 + 0.5 * share); });
    record.pictures.push_back(plot_of(depth, "nesting depth (transforms)", context, self.name + ".depth",
                                      "Drift over nesting depth",
                                      "Error of the hit on a wall behind nested transforms that the ray went into and "
                                      "came out of."));
    record.pictures.push_back(plot_of(crossed, "instances crossed", context, self.name + ".crossed",
                                      "Drift over instances crossed",
                                      "Error of the hit on a wall behind instances that the ray went into and came out "
                                      "of, one after the other."));
    record.figures.push_back({"growth with depth, inverse", "decades per decade", growth(depth.inverse_median)});
    record.figures.push_back({"growth with instances, inverse", "decades per decade", growth(crossed.inverse_median)});
    record.figures.push_back({"inverse over restore, 256 instances", "ratio",
                              crossed.inverse_median.y.back() / crossed.restore_median.y.back()});
    // A restored ray has the very bits that it had: the error is that of the wall alone, whatever it has passed. The
    // scene's radius varies a little with the transforms, and so does the unit.
    for (const PlotSeries* s : {&depth.restore_median, &crossed.restore_median}) {
      const auto [least, most] = std::minmax_element(s->y.begin(), s->y.end());
      if (!(*most <= 1.25 * *least)) {
        record.status = CaseStatus::failed;
        record.message = "the error behind restored transforms varies from " + std::to_string(*least) + " to " +
                         std::to_string(*most) + " units with their number";
      }
    }
    if (record.status == CaseStatus::passed)
      record.message = "behind 256 instances the median error is " +
                       std::to_string(std::lround(crossed.inverse_median.y.back() / crossed.restore_median.y.back())) +
                       " times as large by inverses as by restoring";
  };
  return c;
}

Case bunnies_case(std::uint64_t per_family) {
  Case c;
  c.name = "transforms.bunnies";
  c.feature = "transforms";
  c.scene = "bunnies";
  c.paper = "6";
  c.proves =
      "Ten thousand instances of a mesh of 69,451 triangles, 7 x 10^8 triangles seen and the memory of one, trace and "
      "compare.";
  c.run = [per_family](CaseContext& context, const Case& self, CaseRecord& record) {
    const std::filesystem::path mesh = data_folder() / "obj/bunny/stanford-bunny.obj";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(mesh, ignored)) {
      record.status = CaseStatus::skipped;
      record.message = mesh.string() + " is not there; PLUMBLINE_DATA names the folder of real scenes";
      return;
    }
    // A file, so that `explain` can load the scene again.
    const std::filesystem::path file = context.out / "scenes" / "bunnies.json";
    const std::string source = std::filesystem::absolute(mesh).string();
    std::string escaped;
    for (const char ch : source) escaped += ch == '"' || ch == '\\' ? std::string("\\") + ch : std::string(1, ch);
    write_text(file, R"({
  "camera": { "from": [-3, 4.5, 15], "at": [0, 0, 2], "angle": 45, "width": 640, "height": 480 },
  "lights": [{ "position": [-10, 20, 15] }],
  "nodes": [
    {
      "name": "bunny",
      "part": { "source": ")" +
                         escaped + R"(" },
      "transform": { "translate": [-14.85, 0, -14.85] },
      "jitter": { "seed": 1, "translate": [0.05, 0, 0.05], "rotate": { "axis": [0, 1, 0], "degrees": 180 }, "scale": [0.6, 1.1] },
      "repeat": [
        { "count": 100, "by": { "translate": [0.3, 0, 0] } },
        { "count": 100, "by": { "translate": [0, 0, 0.3] } }
      ]
    }
  ]
}
)");
    Stage& stage = context.session.stage(file.string());
    const std::uint64_t seed = case_seed(context.seed, self.name);
    Tally tally;
    TraceBuffers buffers;
    for (const RayFamilyInfo& family : ray_families()) {
      std::vector<Ray> rays(per_family);
      generate_rays_parallel(stage.rays, family.family, seed, 0, rays);
      trace_and_judge(stage.judge, context.session.probe(stage), stage.embree, rays, tally.rays(), seed, buffers,
                      tally);
      context.progress(static_cast<double>(tally.rays()) / static_cast<double>(per_family * ray_families().size()));
    }
    record.trace_seconds = buffers.trace_seconds;
    record.figures.push_back({"triangles seen", "1", static_cast<double>(placed_count(stage.scene))});
    record.figures.push_back({"triangles held", "1", static_cast<double>(stage.scene.triangles.size())});
    record.figures.push_back({"image", "texels", static_cast<double>(stage.image.texels.size())});
    explain_failing(context, examined_of(stage), self.name, "./plumbline explain " + quoted(stage.spec), tally);
    record_tally(tally, stage.spec, record);
    conclude(tally, tally.rays(), record);
  };
  return c;
}

}  // namespace plumbline
