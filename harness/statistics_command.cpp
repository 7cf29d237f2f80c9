// SPDX-License-Identifier: GPL-3.0-or-later
// The command `statistics`: what the statistical tests are worth. How often they raise a false alarm, measured by
// comparing the reference with itself; and which faults they find, seeded into the reference one at a time.
#include <cmath>
#include <cstdio>
#include <memory>

#include "harness/clock.h"
#include "harness/commands.h"
#include "harness/distributions.h"
#include "harness/independent.h"
#include "harness/picture_faults.h"
#include "harness/progress.h"
#include "reports/format.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

struct StatisticsArguments {
  std::string scene = "figure_1", model = "physical", fault, effects;
  int alarms = 0;
  std::uint64_t seed = 1;
  Depth depth;
};

/// "soft_shadow,dof"; all where nothing is named.
Effects effects_asked(const StatisticsArguments& a, const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at < a.effects.size();) {
    const std::size_t end = std::min(a.effects.find(',', at), a.effects.size());
    names.push_back(a.effects.substr(at, end - at));
    at = end + 1;
  }
  return effects_of(scene, names.empty() ? effect_names() : names,
                    a.model == "physical" ? Effects::Model::physical : Effects::Model::paper);
}

/// The p-value of each family's distribution over the repetitions, and the number of alarms.
int measure_alarms(const StatisticsArguments& a, const Scene& scene) {
  const Effects effects = effects_asked(a, scene);
  int alarms = 0;
  std::vector<double> spread, whole;
  Progress progress;
  for (int i = 0; i < a.alarms; ++i) {
    const std::uint64_t seed = mix64(a.seed + static_cast<std::uint64_t>(i));
    const PictureComparison result =
        compare_engines(scene, effects, a.depth, seed, make_reference_engine, make_reference_engine);
    if (result.alarm()) {
      ++alarms;
      progress.clear();
      std::printf("alarm %d: %s\n", i, result.verdict().c_str());
    }
    for (const TestFamily& family : result.families)
      if (family.name == "spread of p-values") spread.push_back(family.p);
    whole.push_back(result.whole_student_p);
    progress.show(static_cast<double>(i + 1) / a.alarms, "false alarms");
  }
  progress.clear();
  std::printf("%d comparisons of the reference with itself: %d alarms\n", a.alarms, alarms);
  std::printf("whole picture: p-values uniform with p = %.3g (Kolmogorov-Smirnov), %.3g (Anderson-Darling)\n",
              test_uniform(whole).kolmogorov_p, test_uniform(whole).anderson_p);
  int low = 0;
  for (const double p : spread) low += p <= 0.05;
  std::printf("spread of p-values: %d of %d at or below 0.05\n", low, a.alarms);
  return alarms == 0 ? 0 : 1;
}

int seed_faults(const StatisticsArguments& a) {
  bool all = true, any = false;
  std::printf("%-18s %-8s %7s  %s\n", "fault", "", "seconds", "what told of it");
  for (const PictureFault& fault : picture_faults()) {
    if (!a.fault.empty() && fault.change.name != a.fault) continue;
    any = true;
    const auto start = Clock::now();
    const PictureComparison result = compare_with_fault(fault, a.seed);
    std::string told;
    for (const TestFamily& family : result.families)
      if (family.alarm()) told += (told.empty() ? "" : "; ") + family.name + ": " + family.worst;
    if (told.empty()) {
      all = false;
      told = fault.what + " (least p " + value_text(result.p()) + ", level " + value_text(result.level) + ")";
    }
    std::printf("%-18s %-8s %7.1f  %s\n", fault.change.name.c_str(), result.alarm() ? "caught" : "MISSED",
                seconds_since(start), told.c_str());
    if (!a.fault.empty())
      for (const TestFamily& family : result.families)
        std::printf("  %-20s p %-10.3g level %-10.3g %s; would see %s\n", family.name.c_str(), family.p, family.level,
                    family.worst.c_str(), family.would_see.c_str());
    std::fflush(stdout);
  }
  if (!any) throw InputError("there is no fault '" + a.fault + "'; `plumbline statistics` seeds them all");
  return all ? 0 : 1;
}

}  // namespace

void add_statistics_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<StatisticsArguments>();
  CLI::App* sub = app.add_subcommand(
      "statistics", "What the statistical tests are worth: faults seeded into the reference, or false alarms counted");
  sub->add_option("SCENE", a->scene, "Of --alarms: scene file or generator; what effects need and it lacks is added")
      ->capture_default_str();
  sub->add_option("--alarms", a->alarms, "Compare the reference with itself so often, instead of seeding faults")
      ->check(CLI::Range(1, 100000));
  sub->add_option("--effects", a->effects, "With --alarms: such as soft_shadow,dof; all if not given");
  sub->add_option("--fault", a->fault, "Seed this one only");
  sub->add_option("--model", a->model, "With --alarms: densities of the effects")
      ->check(CLI::IsMember({"paper", "physical"}))
      ->capture_default_str();
  sub->add_option("--width", a->depth.width, "With --alarms: of the pictures, pixels")
      ->check(CLI::Range(8, 1024))
      ->capture_default_str();
  sub->add_option("--height", a->depth.height, "With --alarms: likewise")
      ->check(CLI::Range(8, 1024))
      ->capture_default_str();
  sub->add_option("--frames", a->depth.frames, "With --alarms: of each of the 64 batches")
      ->check(CLI::Range(1u, 1u << 20))
      ->capture_default_str();
  sub->add_option("--seed", a->seed, "Of all random numbers")->capture_default_str();
  commands.emplace_back(
      sub, [a] { return a->alarms > 0 ? measure_alarms(*a, with_effects(load_to_trace(a->scene))) : seed_faults(*a); });
}

}  // namespace plumbline
