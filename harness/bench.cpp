// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/bench.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/clock.h"
#include "harness/hit_cases.h"
#include "harness/scene_list.h"
#include "harness/session.h"
#include "harness/transform_cases.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "tracer/verify.h"

namespace plumbline {
namespace {

constexpr int kFrame = 512;  ///< pixels, each way

std::vector<Ray> frame_rays(const Scene& scene) {
  Camera camera = scene.camera;
  camera.width = camera.height = kFrame;
  std::vector<Ray> rays;
  rays.reserve(kFrame * kFrame);
  for (int y = 0; y < kFrame; ++y)
    for (int x = 0; x < kFrame; ++x) rays.push_back(camera_ray(camera, x, y));
  return rays;
}

/// Speeds of both sides on the same rays, a value per round.
struct Race {
  std::vector<double> tracer, embree, ratio;  ///< rays/s, rays/s, tracer over Embree
  double steps = 0.0, tests = 0.0;            ///< per ray
};

Race race(Probe& probe, const EmbreeScene& embree, const std::vector<Ray>& rays, int rounds,
          const std::function<void(int)>& tick) {
  Race r;
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);  // warm: the driver compiles on first use
  embree.intersect_only(rays);
  for (int i = 0; i < rounds; ++i) {
    probe.trace(rays, hits);
    const double tracer = probe.draw_seconds();
    const auto start = Clock::now();
    embree.intersect_only(rays);
    const double other = seconds_since(start);
    const double n = static_cast<double>(rays.size());
    r.tracer.push_back(n / tracer);
    r.embree.push_back(n / other);
    r.ratio.push_back(other / tracer);
    tick(i);
  }
  for (const Hit& h : hits) r.steps += h.steps, r.tests += h.primitive_tests;
  r.steps /= static_cast<double>(rays.size()), r.tests /= static_cast<double>(rays.size());
  return r;
}

/// The largest resident size since reset_peak, in MB; 0 where the system does not tell.
double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024.0;
  return 0.0;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

class Bench {
 public:
  explicit Bench(const BenchOptions& options) : options_(options) {}

  std::vector<Metric> run() {
    std::vector<ListedScene> scenes = own_scenes();
    std::erase_if(scenes, [](const ListedScene& s) {
      return s.name != "sphereflake_3" && s.name != "sphereflake_4" && s.name != "creature";
    });
    for (const ListedScene& s : real_scenes())
      if (s.name == "bunny" || s.name == "medieval") scenes.push_back(s);
    const std::size_t plain = scenes.size();
    for (const ListedScene& s : placed_scenes())
      if (s.name == "crowd" || s.name == "figure_1") scenes.push_back(s);
    const double parts = static_cast<double>(scenes.size()) + 2.0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      base_ = static_cast<double>(i) / parts;
      width_ = 1.0 / parts;
      of_scene(scenes[i]);
      if (scenes[i].has_nodes) of_transforms(scenes[i]);
    }
    growth();
    base_ = (parts - 2.0) / parts;
    if (options_.variants) variants(scenes[plain - 1]);
    base_ = (parts - 1.0) / parts;
    bakes();
    return std::move(metrics_);
  }

 private:
  void add(const std::string& name, const std::string& unit, std::vector<double> values) {
    metrics_.push_back(make_metric(name, unit, std::move(values)));
  }

  Race race_of(const std::string& name, Probe& probe, const Stage& stage, const std::vector<Ray>& rays, double from,
               double to) {
    return race(probe, stage.embree, rays, options_.rounds, [&](int i) {
      options_.progress(base_ + width_ * (from + (to - from) * (i + 1) / options_.rounds), name);
    });
  }

  void of_scene(const ListedScene& scene) {
    Stage& stage = session_.stage(scene.spec);
    std::vector<Ray> random(kFrame * kFrame);
    generate_rays_parallel(stage.rays, RayFamily::chords, 1, 0, random);
    const std::vector<std::pair<std::string, std::vector<Ray>>> kinds{{"primary", frame_rays(stage.scene)},
                                                                      {"random", random}};
    BakeOptions boxed;
    boxed.bounds = Bounds::aabb;
    const GeometryImage boxes = bake(stage.scene, boxed);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const auto& [kind, rays] = kinds[k];
      const double at = 0.5 * static_cast<double>(k);
      const Race r = race_of(kind + " rays, " + scene.name, session_.probe(stage), stage, rays, at, at + 0.25);
      add(kind + "_vs_embree." + scene.name, "ratio", r.ratio);
      add(kind + "_rays_per_second." + scene.name, "rays/s", r.tracer);
      add(kind + "_embree_rays_per_second." + scene.name, "rays/s", r.embree);
      add(kind + "_steps." + scene.name, "steps/ray", {r.steps});
      add(kind + "_primitive_tests." + scene.name, "tests/ray", {r.tests});
      const Race b =
          race_of(kind + " rays among boxes, " + scene.name, session_.probe(boxes), stage, rays, at + 0.25, at + 0.5);
      add(kind + "_boxes_vs_embree." + scene.name, "ratio", b.ratio);
    }
    overhead(scene, stage);
  }

  /// What a comparison run spends on anything but the tracing of both sides, each from rays to hits: making rays, and
  /// verdicts.
  void overhead(const ListedScene& scene, Stage& stage) {
    std::vector<double> shares;
    Tally tally;
    TraceBuffers buffers;
    std::vector<Ray> rays(kFrame * kFrame);
    for (int i = 0; i < options_.rounds; ++i) {
      buffers.trace_seconds = 0.0;
      const auto start = Clock::now();
      for (const RayFamily family : {RayFamily::camera, RayFamily::chords}) {
        generate_rays_parallel(stage.rays, family, static_cast<std::uint64_t>(i), 0, rays);
        trace_and_judge(stage.judge, session_.probe(stage), stage.embree, rays, 0, 1, buffers, tally);
      }
      shares.push_back(1.0 - buffers.trace_seconds / seconds_since(start));
    }
    add("overhead.check." + scene.name, "share", shares);
  }

  /// What moving a node costs beside a bake, and the two ways out of a transform and of keeping transforms side by
  /// side.
  void of_transforms(const ListedScene& scene) {
    Stage& stage = session_.stage(scene.spec);
    const std::vector<Ray> rays = frame_rays(stage.scene);
    std::vector<Hit> hits(rays.size());
    const auto seconds = [&](Probe& probe) {
      probe.trace(rays, hits);
      return probe.draw_seconds();
    };
    BakeOptions listed;
    listed.transform_list = TransformList::root;
    const GeometryImage list = bake(stage.scene, listed);
    std::vector<double> inverse, listing;
    for (int i = -1; i < options_.rounds; ++i) {
      const double restore = seconds(session_.probe(stage));
      const double inverted = seconds(session_.probe(stage, TransformOut::inverse));
      const double in_list = seconds(session_.probe(list));
      if (i < 0) continue;
      inverse.push_back(inverted / restore);
      listing.push_back(in_list / restore);
    }
    add("restore_vs_inverse." + scene.name, "ratio", inverse);
    add("list_vs_tree." + scene.name, "ratio", listing);

    Scene moving = stage.scene;
    SceneTree tree = stage.tree;
    GeometryImage image = stage.image;
    Probe probe(session_.context(), image);
    const double reach = stage.rays.ball.radius;
    std::vector<double> shares, updates, bakes, uploads;
    for (int i = 0; i < options_.rounds; ++i) {
      const auto bake_start = Clock::now();
      const SceneTree anew = build_scene_tree(moving);
      const GeometryImage baked = bake(moving, anew, BakeOptions{});
      bakes.push_back(seconds_since(bake_start));
      constexpr int kMoves = 100;
      double spent = 0.0;
      for (int k = 0; k < kMoves; ++k) {
        const std::uint32_t node =
            static_cast<std::uint32_t>(mix64(static_cast<std::uint64_t>(i * kMoves + k)) % moving.nodes.size());
        Node& moved = moving.nodes[node];
        const double size = stage.judge.bounds.spaces.nodes[node].content.radius;
        moved.transform = nearby(moved.rest, std::min(size, reach), 1, static_cast<std::uint64_t>(k));
        const auto start = Clock::now();
        probe.update(image, update_transforms(moving, {&node, 1}, tree, image));
        spent += seconds_since(start);
        uploads.push_back(static_cast<double>(probe.texels_uploaded()));
      }
      updates.push_back(spent / kMoves);
      shares.push_back(updates.back() / bakes.back());
    }
    add("update_vs_bake." + scene.name, "ratio", shares);
    add("update_seconds." + scene.name, "s", updates);
    add("bake_seconds." + scene.name, "s", bakes);
    add("update_texels." + scene.name, "texels", uploads);
  }

  void growth() {
    // Frames of both sizes in turn, so that the ratio is of one moment.
    const GeometryImage image3 = session_.stage("sphereflake:3").image;
    const std::vector<Ray> rays3 = frame_rays(session_.stage("sphereflake:3").scene);
    const GeometryImage image4 = session_.stage("sphereflake:4").image;
    const std::vector<Ray> rays4 = frame_rays(session_.stage("sphereflake:4").scene);
    std::vector<Hit> hits(rays3.size());
    const auto seconds = [&](const GeometryImage& image, const std::vector<Ray>& rays) {
      Probe& probe = session_.probe(image);
      probe.trace(rays, hits);
      return probe.draw_seconds();
    };
    std::vector<double> ratios;
    for (int i = -1; i < options_.rounds; ++i) {
      const double t3 = seconds(image3, rays3), t4 = seconds(image4, rays4);
      if (i >= 0) ratios.push_back(t4 / t3);
    }
    add("growth.sphereflake_3_4", "ratio", ratios);
  }

  void variants(const ListedScene& scene) {
    Stage& stage = session_.stage(scene.spec);
    const std::vector<Ray> rays = frame_rays(stage.scene);
    std::vector<Hit> hits(rays.size());
    const std::vector<Variant> all = all_variants();
    for (std::size_t v = 0; v < all.size(); ++v) {
      const GeometryImage image = bake(stage.scene, all[v].options);
      const auto trace = [&](Probe& probe) {
        probe.trace(rays, hits);
        return probe.draw_seconds();
      };
      std::vector<double> ratios;
      double steps = 0.0;
      for (int i = -1; i < options_.rounds; ++i) {
        // A variant of the default's own kind shares its program, so the image is uploaded in turn.
        const double variant = trace(session_.probe(image));
        if (i < 0)
          for (const Hit& h : hits) steps += h.steps;
        const double standard = trace(session_.probe(stage));
        if (i >= 0) ratios.push_back(standard / variant);
      }
      add("variant_vs_default." + all[v].name + "." + scene.name, "ratio", ratios);
      add("variant_steps." + all[v].name + "." + scene.name, "steps/ray", {steps / static_cast<double>(rays.size())});
      options_.progress(base_ + width_ * static_cast<double>(v + 1) / static_cast<double>(all.size()),
                        "variant " + all[v].name);
    }
  }

  void bakes() {
    for (const int size :
         options_.large ? std::vector<int>{10'000, 100'000, 1'000'000} : std::vector<int>{10'000, 100'000}) {
      options_.progress(base_ + 0.3 * width_, "bake of " + std::to_string(size) + " triangles");
      const Scene scene = generate_scene("grid", size);
      std::vector<double> seconds, memory, verifying;
      const double before = (reset_peak(), peak_megabytes());
      const int rounds = size >= 1'000'000 ? 1 : std::min(options_.rounds, 3);
      double texels = 0.0;
      for (int i = 0; i < rounds; ++i) {
        const auto start = Clock::now();
        const SceneTree tree = build_scene_tree(scene);
        const GeometryImage image = bake(scene, tree, BakeOptions{});
        seconds.push_back(seconds_since(start));
        memory.push_back(peak_megabytes() - before);
        texels = static_cast<double>(image.texels.size());
        verifying.push_back(certify(image, &scene, &tree).seconds / seconds.back());
      }
      char exponent[16];
      std::snprintf(exponent, sizeof exponent, "1e%d", size == 10'000 ? 4 : size == 100'000 ? 5 : 6);
      add(std::string("bake_seconds.") + exponent, "s", seconds);
      add(std::string("bake_megabytes.") + exponent, "MB", memory);
      add(std::string("verify_vs_bake.") + exponent, "ratio", verifying);
      add(std::string("bake_texels.") + exponent, "texels", {texels});
    }
  }

  const BenchOptions& options_;
  Session session_;
  std::vector<Metric> metrics_;
  double base_ = 0.0, width_ = 0.0;
};

}  // namespace

Metric make_metric(const std::string& name, const std::string& unit, std::vector<double> values) {
  PLUMBLINE_ASSERT(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double median = n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
  return {name, unit, median, values.front(), values.back(), static_cast<int>(n)};
}

std::vector<Metric> run_bench(const BenchOptions& options) { return Bench(options).run(); }

std::string bench_table(const std::vector<Metric>& metrics) {
  std::string text;
  char line[200];
  std::snprintf(line, sizeof line, "%-48s %14s %14s %14s  %-10s %6s\n", "metric", "median", "min", "max", "unit",
                "rounds");
  text += line;
  for (const Metric& m : metrics) {
    std::snprintf(line, sizeof line, "%-48s %14.6g %14.6g %14.6g  %-10s %6d\n", m.name.c_str(), m.median, m.min, m.max,
                  m.unit.c_str(), m.rounds);
    text += line;
  }
  return text;
}

std::string bench_json(const std::vector<Metric>& metrics) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Metric& m : metrics)
    list.push_back({{"name", m.name},
                    {"unit", m.unit},
                    {"median", m.median},
                    {"min", m.min},
                    {"max", m.max},
                    {"rounds", m.rounds}});
  return nlohmann::ordered_json{{"metrics", list}}.dump(2) + "\n";
}

}  // namespace plumbline
