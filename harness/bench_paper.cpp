// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds are the driver's from drawing to results, position and normal included. All rays are primary rays: 512 x 512
// pixels, seeded places in them.
#include "harness/bench_paper.h"

#include <array>
#include <cstdio>
#include <numeric>

#include "harness/session.h"
#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr int kFrame = 512;
constexpr std::size_t kPixels = std::size_t{kFrame} * kFrame;
constexpr std::array<int, 4> kSizes{1, 2, 3, 4};

/// Sample `s` of every pixel, row by row.
std::vector<Ray> frame_rays(Camera camera, std::uint64_t s) {
  camera.width = camera.height = kFrame;
  std::vector<Ray> rays;
  rays.reserve(kPixels);
  for (int y = 0; y < kFrame; ++y)
    for (int x = 0; x < kFrame; ++x) {
      Random random(s, name_hash("place in the pixel"), static_cast<std::uint64_t>(y * kFrame + x));
      const double a = random.uniform(-0.5, 0.5), b = random.uniform(-0.5, 0.5);
      rays.push_back(camera_ray(camera, x + a, y + b));
    }
  return rays;
}

/// Bundles of these frames' rays: ray k of bundle i is ray i of frame k.
std::vector<Ray> interleaved(const std::vector<const std::vector<Ray>*>& frames) {
  std::vector<Ray> rays;
  rays.reserve(frames.size() * kPixels);
  for (std::size_t i = 0; i < kPixels; ++i)
    for (const std::vector<Ray>* frame : frames) rays.push_back((*frame)[i]);
  return rays;
}

/// The rays of a frame with those of pixel (x + dx, y + dy) at pixel (x, y).
std::vector<Ray> shifted(const std::vector<Ray>& frame, int dx, int dy) {
  std::vector<Ray> rays;
  rays.reserve(frame.size());
  for (int y = 0; y < kFrame; ++y)
    for (int x = 0; x < kFrame; ++x)
      rays.push_back(frame[static_cast<std::size_t>((y + dy) % kFrame * kFrame + (x + dx) % kFrame)]);
  return rays;
}
std::vector<Ray> shuffled(std::vector<Ray> frame) {
  Random random(1, name_hash("shuffled pixels"), 0);
  for (std::size_t i = frame.size(); i > 1; --i)
    std::swap(frame[i - 1], frame[random.below(static_cast<std::uint32_t>(i))]);
  return frame;
}

class PaperBench {
 public:
  PaperBench(int rounds, const std::function<void(double, const std::string&)>& progress)
      : rounds_(rounds), progress_(progress) {}

  std::vector<PaperFigure> run() {
    figure_4();
    figure_6("sphereflake_3", "sphereflake:3", 2.52 / 2.11, 2.11 / 0.35, 0.4);
    figure_6("sphereflake_4", "sphereflake:4", 9.93 / 8.28, 8.28 / 1.1, 0.7);
    return std::move(figures_);
  }

 private:
  void add(const std::string& name, const std::string& unit, std::vector<double> values, double paper = 0.0) {
    figures_.push_back({make_metric(name, unit, std::move(values)), paper});
  }

  /// A probe for each size of bundle.
  std::vector<Probe> probes(const GeometryImage& image) {
    std::vector<Probe> all;
    for (const int size : kSizes) all.emplace_back(session_.context(), image, BundleSize{size});
    return all;
  }

  double seconds(Probe& probe, const std::vector<Ray>& rays) {
    hits_.resize(rays.size());
    probe.trace(rays, hits_);
    return probe.draw_seconds();
  }
  /// Of the last trace, per ray; a bundle's are counted for each of its rays.
  double mean_steps() const {
    double sum = 0.0;
    for (const Hit& hit : hits_) sum += hit.steps;
    return sum / static_cast<double>(hits_.size());
  }

  void figure_4() {
    Stage& stage = session_.stage("creature");
    std::vector<Probe> of_size = probes(stage.image);
    const std::vector<Ray> first = frame_rays(stage.scene.camera, 0), second = frame_rays(stage.scene.camera, 1);
    struct Row {
      const char* name;
      std::vector<Ray> other;
      double paper;
      std::vector<double> frames{}, rays{};
    };
    std::vector<Row> rows;
    rows.push_back({"coherent", second, 44.0 / 51.0});
    rows.push_back({"partially_coherent", shifted(second, 32, 16), 26.0 / 51.0});
    rows.push_back({"incoherent", shuffled(second), 14.0 / 51.0});
    for (int round = -1; round < rounds_; ++round)
      for (Row& row : rows) {
        const double single = seconds(of_size[0], first), other = seconds(of_size[0], row.other);
        const double bundled = seconds(of_size[1], interleaved({&first, &row.other}));
        progress_(0.4 * (round + 2) / (rounds_ + 1), "figure 4");
        if (round < 0) continue;
        row.frames.push_back(single / bundled);
        row.rays.push_back((single + other) / bundled);
      }
    for (Row& row : rows) {
      add(std::string("figure_4.two_rays_vs_one.") + row.name, "frames/s", row.frames, row.paper);
      add(std::string("figure_4.together_vs_apart.") + row.name, "rays/s", row.rays);
    }
  }

  void figure_6(const std::string& name, const std::string& spec, double paper, double paper_growth, double from) {
    constexpr int kSamples = 16;
    Stage& stage = session_.stage(spec);
    std::vector<Probe> of_size = probes(stage.image);
    std::vector<std::vector<Ray>> frames;
    for (int s = 0; s < kSamples; ++s) frames.push_back(frame_rays(stage.scene.camera, static_cast<std::uint64_t>(s)));
    std::array<std::vector<double>, kMostBundled + 1> gain, visits, visit_cost, finishing, left;
    std::vector<double> growth;
    for (int round = -1; round < rounds_; ++round) {
      // Groups of 12 samples for bundles of 3 would be another set of rays, so ratios are of the rays at hand.
      std::array<double, kMostBundled + 1> spent{}, steps{}, rays{}, after{};
      double two = 0.0, sixteen = 0.0;
      for (int s = 0; s < kSamples; ++s)
        for (const int size : kSizes) {
          if (s % size != 0 || s + size > kSamples) continue;
          std::vector<const std::vector<Ray>*> group;
          for (int k = 0; k < size; ++k) group.push_back(&frames[static_cast<std::size_t>(s + k)]);
          const auto at = static_cast<std::size_t>(size);
          Probe& probe = of_size[at - 1];
          const double t = size == 1 ? seconds(probe, *group[0]) : seconds(probe, interleaved(group));
          spent[at] += t;
          after[at] += probe.resumed_seconds();
          rays[at] += static_cast<double>(hits_.size());
          steps[at] += mean_steps() * static_cast<double>(hits_.size());
          if (round >= 0 && s == 0)
            left[at].push_back(static_cast<double>(probe.rays_left_alone()) / static_cast<double>(hits_.size()));
          if (size == 2) sixteen += t, two += s == 0 ? t : 0.0;
        }
      progress_(from + 0.3 * (round + 2) / (rounds_ + 1), "figure 6, " + name);
      if (round < 0) continue;
      for (const int size : kSizes) {
        const auto at = static_cast<std::size_t>(size);
        const double alone = spent[1] / rays[1], alone_steps = steps[1] / rays[1];
        gain[at].push_back(alone / (spent[at] / rays[at]));
        visits[at].push_back(steps[at] / rays[at] / alone_steps);
        visit_cost[at].push_back((spent[at] - after[at]) / (steps[at] / size) / (spent[1] / steps[1]));
        finishing[at].push_back(after[at] / spent[at]);
      }
      growth.push_back(sixteen / two);
    }
    for (const int size : {2, 3, 4}) {
      const auto at = static_cast<std::size_t>(size);
      const std::string what = "." + name + "." + std::to_string(size);
      add("figure_6.parallel_vs_naive" + what, "rays/s", gain[at], size == 2 ? paper : 0.0);
      add("figure_6.visits_of_bundle_vs_ray" + what, "nodes", visits[at]);
      add("figure_6.cost_of_visit_vs_single" + what, "s/node", visit_cost[at]);
      add("figure_6.share_of_second_pass" + what, "s", finishing[at]);
      add("figure_6.left_alone" + what, "share", left[at]);
    }
    add("figure_6.sixteen_rays_vs_two." + name, "s", growth, paper_growth);
  }

  int rounds_;
  const std::function<void(double, const std::string&)>& progress_;
  Session session_;
  std::vector<PaperFigure> figures_;
  std::vector<Hit> hits_;
};

}  // namespace

std::vector<PaperFigure> run_paper_bench(int rounds, const std::function<void(double, const std::string&)>& progress) {
  return PaperBench(rounds, progress).run();
}

std::string paper_table(const std::vector<PaperFigure>& figures) {
  std::string text;
  char line[200];
  std::snprintf(line, sizeof line, "%-52s %9s %9s %9s %9s  %-9s %6s\n", "ratio", "paper", "median", "min", "max", "of",
                "rounds");
  text += line;
  for (const PaperFigure& f : figures) {
    char paper[16] = "";
    if (f.paper > 0.0) std::snprintf(paper, sizeof paper, "%.3f", f.paper);
    std::snprintf(line, sizeof line, "%-52s %9s %9.4g %9.4g %9.4g  %-9s %6d\n", f.metric.name.c_str(), paper,
                  f.metric.median, f.metric.min, f.metric.max, f.metric.unit.c_str(), f.metric.rounds);
    text += line;
  }
  return text;
}

}  // namespace plumbline
