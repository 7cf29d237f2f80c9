// SPDX-License-Identifier: GPL-3.0-or-later
// Whole pictures by the production renderer: Figure 6 and Figure 1, and what each source of random numbers costs.
// Seconds are of everything: rays made, walked and shaded, shadows and reflections, sums; the ratios of walks tell
// where bundles win and where they lose.
#include <array>
#include <memory>

#include "harness/bench_paper.h"
#include "harness/clock.h"
#include "scenes/generate.h"
#include "tracer/renderer.h"

namespace plumbline {
namespace {

class RenderBench {
 public:
  RenderBench(int rounds, const std::function<void(double, const std::string&)>& progress)
      : rounds_(rounds), progress_(progress) {}

  std::vector<PaperFigure> run() {
    figure_6("sphereflake_3", "sphereflake:3", 2.52 / 2.11, 2.11 / 0.35, 0.0);
    figure_6("sphereflake_4", "sphereflake:4", 9.93 / 8.28, 8.28 / 1.1, 0.3);
    figure_1();
    random_sources();
    return std::move(figures_);
  }

 private:
  void add(const std::string& name, const std::string& unit, std::vector<double> values, double paper = 0.0) {
    figures_.push_back({make_metric(name, unit, std::move(values)), paper});
  }

  /// Renders frames from 0 on.
  static double seconds(Renderer& renderer, std::uint32_t frames) {
    renderer.restart(0.0);
    const auto start = Clock::now();
    renderer.add_frames(0, frames);
    return seconds_since(start);
  }

  void figure_6(const std::string& name, const std::string& spec, double paper, double paper_growth, double from) {
    constexpr std::uint32_t kSamples = 12;  // whole bundles of every size
    const Scene scene = load_scene(spec);
    std::vector<std::unique_ptr<Renderer>> of_size;
    for (int size = 1; size <= 4; ++size) {
      RenderSettings settings;
      settings.width = settings.height = 256;
      settings.bundle = {size};
      of_size.push_back(std::make_unique<Renderer>(context_, scene, settings));
    }
    std::array<std::vector<double>, 4> gain, primary, shadow, bounced;
    std::vector<double> growth, walking;
    for (int round = -1; round < rounds_; ++round) {
      std::array<double, 4> spent{};
      std::array<WalkSeconds, 4> walks{};
      for (std::size_t i = 0; i < of_size.size(); ++i) {
        const WalkSeconds before = of_size[i]->walk_seconds();
        spent[i] = seconds(*of_size[i], kSamples);
        const WalkSeconds after = of_size[i]->walk_seconds();
        walks[i] = {after.primary - before.primary, after.shadow - before.shadow, after.bounced - before.bounced};
      }
      const double two = seconds(*of_size[1], 2), sixteen = seconds(*of_size[1], 16);
      progress_(from + 0.3 * (round + 2) / (rounds_ + 1), "pictures of " + name);
      if (round < 0) continue;
      for (std::size_t i = 1; i < of_size.size(); ++i) {
        gain[i].push_back(spent[0] / spent[i]);
        primary[i].push_back(walks[0].primary / walks[i].primary);
        shadow[i].push_back(walks[0].shadow / walks[i].shadow);
        bounced[i].push_back(walks[0].bounced / walks[i].bounced);
      }
      walking.push_back((walks[0].primary + walks[0].shadow + walks[0].bounced) / spent[0]);
      growth.push_back(sixteen / two);
    }
    for (std::size_t i = 1; i < of_size.size(); ++i) {
      const std::string of = "." + name + "." + std::to_string(i + 1);
      add("picture_6.parallel_vs_naive" + of, "rays/s", gain[i], i == 1 ? paper : 0.0);
      add("picture_6.walks_of_primary_rays" + of, "rays/s", primary[i]);
      add("picture_6.walks_of_shadow_rays" + of, "rays/s", shadow[i]);
      add("picture_6.walks_of_bounced_rays" + of, "rays/s", bounced[i]);
    }
    add("picture_6.share_of_walks." + name, "s", walking);
    add("picture_6.sixteen_rays_vs_two." + name, "s", growth, paper_growth);
  }

  void figure_1() {
    const Scene scene = load_scene("figure_1");
    RenderSettings all, none;
    all.width = none.width = 320, all.height = none.height = 240;
    none.effects = scene.effects;
    none.effects->antialias = none.effects->soft_shadows = none.effects->depth_of_field = false;
    none.effects->glossy_reflections = none.effects->motion_blur = false;
    Renderer distributed(context_, scene, all), sharp(context_, scene, none);
    std::vector<double> ratio;
    for (int round = -1; round < rounds_; ++round) {
      const double one = seconds(sharp, 1), sixteen = seconds(distributed, 16);
      progress_(0.6 + 0.2 * (round + 2) / (rounds_ + 1), "figure 1");
      if (round >= 0) ratio.push_back(sixteen / one);
    }
    add("picture_1.sixteen_rays_vs_sharp", "s", ratio, 3.57 / 0.26);
  }

  void random_sources() {
    const Scene scene = load_scene("sphereflake:3");
    std::vector<std::unique_ptr<Renderer>> of_kind;
    for (const RandomKind kind : {RandomKind::hash, RandomKind::md5, RandomKind::texture}) {
      RenderSettings settings;
      settings.width = settings.height = 256;
      settings.random = kind;
      of_kind.push_back(std::make_unique<Renderer>(context_, scene, settings));
    }
    std::array<std::vector<double>, 3> cost;
    for (int round = -1; round < rounds_; ++round) {
      std::array<double, 3> spent{};
      for (std::size_t i = 0; i < of_kind.size(); ++i) spent[i] = seconds(*of_kind[i], 8);
      progress_(0.8 + 0.2 * (round + 2) / (rounds_ + 1), "random numbers");
      if (round < 0) continue;
      for (std::size_t i = 1; i < of_kind.size(); ++i) cost[i].push_back(spent[i] / spent[0]);
    }
    add("random.md5_vs_hash", "s", cost[1]);
    add("random.texture_vs_hash", "s", cost[2]);
  }

  int rounds_;
  const std::function<void(double, const std::string&)>& progress_;
  GlContext context_;
  std::vector<PaperFigure> figures_;
};

}  // namespace

std::vector<PaperFigure> run_render_bench(int rounds, const std::function<void(double, const std::string&)>& progress) {
  return RenderBench(rounds, progress).run();
}

}  // namespace plumbline
