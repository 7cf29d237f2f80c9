// SPDX-License-Identifier: GPL-3.0-or-later
// The cases of transforms that move: frames of an animation, and many updates in a row, each against a scene that is
// built anew.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>

#include "harness/catalogue.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "harness/transform_cases.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kSampleOneIn = 1024;
constexpr int kFrames = 12;
constexpr int kUpdates = 1000;

/// What is kept up to date while nodes move: the scene, its trees, its image, and the driver's copy of it.
struct Moving {
  Scene scene;
  SceneTree tree;
  GeometryImage image;
  Probe probe;
  std::uint64_t uploaded = 0;  ///< texels, by the updates

  Moving(Session& session, const Stage& stage)
      : scene(stage.scene), tree(stage.tree), image(stage.image), probe(session.context(), image) {}

  void move(std::span<const std::uint32_t> nodes) {
    probe.update(image, update_transforms(scene, nodes, tree, image));
    uploaded += probe.texels_uploaded();
  }
};

/// Holds what was kept up to date against a stage that is built anew: the image texel for texel, and rays of all
/// families ray by ray.
void examine(CaseContext& context, Moving& moving, const std::string& spec, const std::string& when, std::uint64_t seed,
             std::size_t per_family, const std::string& replay, Tally& tally, CaseRecord& record) {
  const Stage& anew = context.session.stage(spec, moving.scene);
  const auto complain = [&](const std::string& what) {
    record.status = CaseStatus::failed;
    record.message += (record.message.empty() ? "" : "; ") + what + " (" + when + ")";
  };
  if (const std::uint64_t differing = differing_texels(moving.image, anew.image); differing > 0)
    complain(std::to_string(differing) + " texels differ from a full bake");
  if (moving.image.center != anew.image.center || moving.image.radius != anew.image.radius ||
      moving.image.cell_count != anew.image.cell_count)
    complain("the image's ball or its cap differ from a full bake's");
  const std::vector<Ray> rays = mixed_rays(anew.rays, seed, per_family);
  TraceBuffers buffers;
  const std::uint64_t first = tally.rays();
  trace_and_judge(anew.judge, moving.probe, anew.embree, rays, first, seed, buffers, tally);
  record.trace_seconds += buffers.trace_seconds;
  // As long as the stage is there; what fails in a later one is explained then.
  explain_failing(context, {&anew, &moving.image, &anew.image, {}, "kept up to date, " + when}, record.name, replay,
                  tally);
}

/// record_tally and conclude, with what the case itself has complained of.
void finish(const Tally& tally, const std::string& spec, CaseRecord& record) {
  const std::string complaint = record.message;
  record_tally(tally, spec, record);
  if (!complaint.empty()) record.message = complaint;
  conclude(tally, tally.rays(), record);
}

}  // namespace

std::uint64_t differing_texels(const GeometryImage& a, const GeometryImage& b) {
  if (a.texels.size() != b.texels.size()) return std::max(a.texels.size(), b.texels.size());
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    count += std::memcmp(&a.texels[i], &b.texels[i], sizeof(glm::vec4)) != 0;
  return count;
}

Transform nearby(const Transform& rest, double reach, std::uint64_t seed, std::uint64_t number) {
  Random random(seed, name_hash("nearby transform"), number);
  const glm::dvec3 axis = random.direction(), step = random.direction();
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(random.uniform(-1.0, 1.0), axis));
  const double scale = std::exp2(random.uniform(-0.25, 0.25));
  Transform moved;
  moved.linear = glm::mat3(glm::dmat3(rest.linear) * turn * scale);
  moved.translation = glm::vec3(glm::dvec3(rest.translation) + 0.1 * reach * random.uniform() * step);
  return moved;
}

Case frames_case(const ListedScene& scene, std::uint64_t per_family) {
  Case c = scene_case(
      "transforms.frames." + scene.name, "transforms", scene, "6",
      "At each of twelve times of the animation the image that was brought up to date in place equals a full bake, "
      "texel for texel, and every ray of every family hits what exact arithmetic says.");
  c.run = [per_family](CaseContext& context, const Case& self, CaseRecord& record) {
    const Stage& start = context.session.stage(self.spec);
    const TimeRange range = time_range(start.scene);
    if (is_skipped(start, record)) return;
    if (start.scene.animation.empty()) {
      record.status = CaseStatus::skipped;
      record.message = "nothing moves in this scene";
      return;
    }
    Moving moving(context.session, start);
    Tally tally;
    std::vector<std::string> times;
    for (int i = 0; i < kFrames; ++i) {
      const double time = range.first + (range.last - range.first) * i / (kFrames - 1);
      moving.move(set_time(moving.scene, time));
      char at[32];
      std::snprintf(at, sizeof at, "%.17g", time);
      times.push_back(at);
      examine(context, moving, self.spec + " at " + at, "at " + times.back() + " s",
              case_seed(context.seed, self.name) + static_cast<std::uint64_t>(i), per_family,
              "./plumbline explain " + quoted(self.spec) + " --time " + at, tally, record);
      context.progress(static_cast<double>(i + 1) / kFrames);
    }
    record.figures.push_back({"frames", "1", kFrames});
    record.figures.push_back({"texels uploaded per frame", "texels", static_cast<double>(moving.uploaded) / kFrames});
    finish(tally, self.spec, record);
    for (RayRecord& r : record.worst) {
      const std::size_t frame = r.index / (tally.rays() / kFrames);
      r.replay.insert(r.replay.find(" --ray="), " --time " + times.at(frame));
    }
  };
  return c;
}

Case updates_case(const ListedScene& scene, std::uint64_t per_family) {
  Case c = scene_case(
      "transforms.updates." + scene.name, "transforms", scene, "6",
      "After a thousand updates in a row the image equals a full bake of the moved scene, texel for texel, and every "
      "ray of every family hits what exact arithmetic says.");
  c.run = [per_family](CaseContext& context, const Case& self, CaseRecord& record) {
    const Stage& start = context.session.stage(self.spec);
    if (is_skipped(start, record)) return;
    const std::uint64_t seed = case_seed(context.seed, self.name);
    const double reach = start.rays.ball.radius;
    const std::uint32_t count = static_cast<std::uint32_t>(start.scene.nodes.size());
    Moving moving(context.session, start);
    Random random(seed, name_hash("moved nodes"), 0);
    int done = 0;
    // A transform that would be refused is drawn anew.
    for (int i = 0; done < kUpdates && i < 2 * kUpdates; ++i) {
      const std::uint32_t node = random.below(count);
      Node& moved = moving.scene.nodes[node];
      // A step in units of what stands behind the node: a scene that lies far away stays together.
      const NodeStep& step = start.judge.bounds.spaces.nodes[node];
      const double size = largest_stretch(step.linear) * step.content.radius;
      const Transform next = nearby(moved.rest, std::min(size, reach), seed, static_cast<std::uint64_t>(i));
      if (*transform_error(next)) continue;
      moved.transform = next;
      moving.move({&node, 1});
      ++done;
      if (i % 50 == 0) context.progress(static_cast<double>(done) / kUpdates);
    }
    if (done < kUpdates || moving.uploaded == 0) {
      record.status = CaseStatus::failed;
      record.message = "only " + std::to_string(done) + " of " + std::to_string(kUpdates) + " updates were made";
    }
    record.figures.push_back({"updates", "1", static_cast<double>(done)});
    record.figures.push_back(
        {"texels uploaded per update", "texels", static_cast<double>(moving.uploaded) / std::max(1, done)});
    Tally tally;
    examine(context, moving, self.spec + " (moved)", "after a thousand updates", seed, per_family, record.replay, tally,
            record);
    finish(tally, self.spec, record);
    // The rays belong to the moved scene, which no file holds: the case itself repeats them.
    for (RayRecord& r : record.worst) r.replay = record.replay;
  };
  return c;
}

}  // namespace plumbline
