// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `drt.paired.*`: pictures in which every sample is followed by the reference with the tracer's own numbers.
#include <algorithm>
#include <cmath>

#include "harness/catalogue.h"
#include "harness/hit_cases.h"
#include "harness/paired_picture.h"
#include "harness/picture_report.h"
#include "reports/format.h"
#include "reports/picture.h"

namespace plumbline {
namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr std::size_t kMostRows = 12;

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

const char* name_of(SampleVerdict verdict) {
  return verdict == SampleVerdict::agree ? "agrees" : verdict == SampleVerdict::apart ? "stands apart" : "differs";
}

void record_figures(PairedTally& tally, CaseRecord& record) {
  const auto note = [&](const std::string& name, const char* unit, double value) {
    record.figures.push_back({name, unit, value});
  };
  const double samples = std::max(1.0, static_cast<double>(tally.samples));
  note("samples compared", "samples", static_cast<double>(tally.samples));
  note("samples that stand apart", "%", 100.0 * static_cast<double>(tally.apart) / samples);
  note("samples that differ", "samples", static_cast<double>(tally.differ));
  note("samples whose colour uses more than 10 % of its bound", "%",
       100.0 * static_cast<double>(tally.above_tenth) / samples);
  for (std::size_t step = 0; step < kPairedSteps; ++step)
    if (tally.largest[step] > 0.0)
      note("largest error, " + std::string(name_of(static_cast<PairedStep>(step))), "bounds", tally.largest[step]);
  note("shadow rays", "rays", static_cast<double>(tally.shadow_rays));
  for (const auto& [share, name] : {std::pair{0.5, "50 %"}, std::pair{0.9, "90 %"}, std::pair{0.99, "99 %"}})
    note("whole samples differ from the reference's own by, " + std::string(name), "of 1",
         quantile(tally.end_to_end, share));
}

void record_table(const PairedTally& tally, CaseRecord& record) {
  if (tally.kept.empty()) return;
  TableRecord table;
  table.title = "Samples that differ or stand apart";
  table.columns = {"pixel", "frame", "verdict", "first event at", "ray", "what", "replay"};
  for (std::size_t i = 0; i < std::min(kMostRows, tally.kept.size()); ++i) {
    const PairedSample& s = tally.kept[i];
    table.rows.push_back({std::to_string(s.x) + "," + std::to_string(s.y), std::to_string(s.frame), name_of(s.verdict),
                          name_of(s.step), std::to_string(s.ray), s.event,
                          s.replay.empty() ? record.replay : s.replay});
  }
  record.tables.push_back(std::move(table));
}

void record_pictures(CaseContext& context, const Case& self, const PairedTally& tally, CaseRecord& record) {
  const auto add = [&](const Picture& picture, const char* stem, const char* title, const char* caption) {
    record.pictures.push_back(save_picture(picture, context.out, self.name + "." + stem, title, caption));
  };
  PicturePair pair{tally.tracer, tally.reference, kWidth, kHeight, "Tracer", "Reference", ""};
  const double samples = static_cast<double>(tally.samples) / (kWidth * kHeight);
  for (auto* sums : {&pair.tested, &pair.truth})
    for (glm::dvec3& color : *sums) color /= std::max(1.0, samples);
  pair.caption = "Mean of " + value_text(samples) + " samples a pixel, half of each model, with the tracer's numbers.";
  record_pair(pair, context.out, self.name, record);
  add(paint_values(tally.error_in_bounds, kWidth, kHeight, "bounds", {0.0, 1.0}), "error", "Error of the colour",
      "Difference between tracer and reference in units of what rounding may do, the largest of the pixel's samples.");
  const std::vector<std::string> names{"agree", "apart", "differ"};
  add(paint_verdicts(tally.verdict, names, {}, kWidth, kHeight, 0), "verdicts", "Samples",
      "Pixels with a sample that differs, or that hangs on a tie, a grazing ray or a choice that 32 bits do not "
      "settle.");
}

/// What a case asks of a scene.
struct PairedAsked {
  PairedEffects effects = PairedEffects::all;
  RandomKind random = RandomKind::hash;
  std::vector<ShaderPatch> patches;
};

void run_paired(CaseContext& context, const Case& self, CaseRecord& record, const PairedAsked& asked) {
  // One frame of each model at least; where things move each has a time of its own.
  const auto samples = static_cast<std::uint64_t>(kWidth) * kHeight;
  PairedSettings settings;
  settings.width = kWidth, settings.height = kHeight;
  settings.frames = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, self.rays / (2 * samples)));
  settings.seed = case_seed(context.seed, self.name);
  settings.random = asked.random;
  settings.patches = asked.patches;
  PairedTally tally;
  for (const Effects::Model model : {Effects::Model::paper, Effects::Model::physical}) {
    const Scene scene = with_effects(context.session.stage(self.spec), asked.effects, model);
    compare_picture(context.session, self.spec, scene, settings, tally);
    context.progress(model == Effects::Model::paper ? 0.5 : 1.0);
  }
  record.rays = tally.rays + tally.shadow_rays;
  for (const Verdict v : kVerdicts)
    if (const std::uint64_t count = tally.verdicts[static_cast<std::size_t>(v)]; count > 0)
      record.verdicts[std::string(verdict_name(v))] = count;
  record_figures(tally, record);
  record_table(tally, record);
  record_pictures(context, self, tally, record);
  if (tally.differ == 0) {
    record.message = std::to_string(tally.samples) + " samples, " + std::to_string(tally.apart) + " of them apart";
    return;
  }
  const PairedSample& worst = tally.kept.front();
  record.status = CaseStatus::failed;
  record.message = std::to_string(tally.differ) + " of " + std::to_string(tally.samples) + " samples differ; pixel " +
                   std::to_string(worst.x) + "," + std::to_string(worst.y) + ", frame " + std::to_string(worst.frame) +
                   ", ray " + std::to_string(worst.ray) + ", " + name_of(worst.step) + ": " + worst.event;
}

std::string feature_of(PairedEffects effects) { return effects == PairedEffects::all ? "combined" : name_of(effects); }

Case paired_case(const ListedScene& scene, const PairedAsked& asked, std::uint64_t samples) {
  const bool is_hash = asked.random == RandomKind::hash;
  const std::string effects = name_of(asked.effects), source = is_hash ? "" : std::string(name_of(asked.random)) + ".";
  Case c = scene_case("drt.paired." + source + effects + "." + scene.name, feature_of(asked.effects), scene, "7",
                      "Given the tracer's own random numbers" +
                          std::string(is_hash                           ? ""
                                      : asked.random == RandomKind::md5 ? " (by MD5)"
                                                                        : " (of the image of noise)") +
                          ", every step of every sample is what the reference computes, within what rounding may do; "
                          "effects: " +
                          effects + ", in both models.");
  c.rays = samples;
  c.run = [asked](CaseContext& context, const Case& self, CaseRecord& record) {
    run_paired(context, self, record, asked);
  };
  return c;
}

}  // namespace

std::vector<Case> paired_cases(const ListedScene& scene, const PairedOptions& options) {
  std::vector<Case> cases;
  for (const PairedEffects effects : kPairedEffects) {
    if (options.few && effects != PairedEffects::none && effects != PairedEffects::all) continue;
    if (effects == PairedEffects::motion_blur && !scene.moves) continue;
    cases.push_back(paired_case(scene, {effects, RandomKind::hash, options.patches}, options.samples));
  }
  if (!options.every_source) return cases;
  for (const RandomKind random : {RandomKind::md5, RandomKind::texture})
    cases.push_back(paired_case(scene, {PairedEffects::all, random, options.patches}, options.samples));
  return cases;
}

}  // namespace plumbline
