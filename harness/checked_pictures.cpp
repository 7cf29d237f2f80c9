// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/checked_pictures.h"

#include <algorithm>

#include "harness/clock.h"
#include "harness/independent.h"
#include "harness/picture_changes.h"
#include "harness/picture_report.h"
#include "harness/tracer_engine.h"
#include "reports/format.h"
#include "reports/summary.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kBatches = Depth{}.batches;
constexpr std::uint32_t kMostFrames = 16;  ///< of each batch, where nothing is asked

/// What an engine costs on this machine and scene, in seconds.
struct EngineCost {
  double made = 0.0, frame = 0.0;
};

EngineCost cost_of(const MakePictureEngine& make, const Scene& scene, const PictureSettings& settings) {
  constexpr double kLongEnough = 0.25;  // where one frame takes so long, a second one would tell nothing new
  constexpr std::uint32_t kMore = 4;
  auto start = Clock::now();
  const auto engine = make(scene, settings);
  EngineCost cost{seconds_since(start), 0.0};
  start = Clock::now();
  engine->render(0, 1);
  cost.frame = seconds_since(start);
  if (cost.frame >= kLongEnough) return cost;
  start = Clock::now();
  engine->render(1, kMore);
  cost.frame = seconds_since(start) / kMore;
  return cost;
}

/// The time of compare_engines: both engines' batches, as many samples for the directions, and four pictures of 16
/// frames for the rounding of places.
double seconds_of(const EngineCost& tracer, const EngineCost& reference, std::size_t changes, std::uint32_t frames) {
  const double samples = static_cast<double>(kBatches) * frames;
  return tracer.made + samples * tracer.frame + static_cast<double>(changes + 6) * reference.made +
         (2.0 * samples + 64.0) * reference.frame;
}

void run_checked_picture(CaseContext& context, const Case& self, CaseRecord& record, const CheckedPictures& asked) {
  const Scene scene = drt_scene(self.spec);
  const Effects effects = effects_of(scene, effect_names(), scene.effects.model);
  RenderSettings own;
  own.patches = asked.patches;
  const MakePictureEngine tracer = tracer_engines(own);
  Depth depth;
  depth.width = asked.width, depth.height = asked.height;
  depth.frames = (asked.frames + kBatches - 1) / kBatches;
  if (asked.frames == 0) {
    const PictureSettings pilot{depth.width, depth.height, effects, 0, 0.0};
    const EngineCost of_tracer = cost_of(tracer, scene, pilot),
                     of_reference = cost_of(make_reference_engine, scene, pilot);
    const std::size_t changes = small_changes(scene, effects).size();
    const auto seconds = [&](std::uint32_t frames) { return seconds_of(of_tracer, of_reference, changes, frames); };
    depth.frames = kMostFrames;
    while (depth.frames > 0 && seconds(depth.frames) > asked.seconds) depth.frames /= 2;
    if (depth.frames == 0) {
      record.status = CaseStatus::skipped;
      record.message = "a picture of " + std::to_string(kBatches) + " samples a pixel would take " +
                       duration(seconds(1)) + "; --picture-frames " + std::to_string(kBatches) +
                       " asks for it all the same";
      return;
    }
  }
  record.replay += " --picture-size " + std::to_string(depth.width) + "x" + std::to_string(depth.height) +
                   " --picture-frames " + std::to_string(kBatches * depth.frames);
  const PictureComparison result = compare_engines(scene, effects, depth, case_seed(context.seed, self.name), tracer,
                                                   make_reference_engine, context.progress);
  record_comparison(result, context.out, self.name, record);
}

}  // namespace

Case checked_picture_case(const ListedScene& scene, const CheckedPictures& settings) {
  Case c = scene_case(
      "drt.picture." + scene.name, "combined", scene, "7",
      "A picture of the scene with all effects is the reference's: in every pixel, tile and the whole, in means and "
      "variances. What effects need and the scene lacks is added.");
  c.run = [settings](CaseContext& context, const Case& self, CaseRecord& record) {
    run_checked_picture(context, self, record, settings);
  };
  return c;
}

std::string pictures_text(const RunRecord& run) {
  std::string text;
  for (const CaseRecord& record : run.cases)
    if (record.name.starts_with("drt."))
      text += "Pictures, " + record.name + ": " + std::string(status_name(outcome(record))) +
              (record.message.empty() ? "" : ", " + message_of(record)) + "\n";
  return text;
}

}  // namespace plumbline
