// SPDX-License-Identifier: GPL-3.0-or-later
// Explanations: what a broken tree lost is named, a failing ray of a report leads to its page, walks survive their
// files, and two walks part where they part.
#include "harness/explain.h"

#include <unistd.h>

#include <bit>
#include <catch2/catch.hpp>
#include <filesystem>

#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "harness/run.h"
#include "harness/tree_file.h"
#include "harness/walk_record.h"
#include "reports/files.h"
#include "reports/json.h"
#include "reports/merge.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plumbline_explain_test_" + std::to_string(::getpid()));
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// A camera ray of the stage that hits something, and its explanation through the stage's own image.
Explanation hitting(Session& session, const Stage& stage) {
  Examiner examiner(session, examined_of(stage));
  std::vector<Ray> rays(64);
  generate_rays(stage.rays, RayFamily::inside, 3, 0, rays);
  for (const Ray& ray : rays) {
    const Explanation e = examiner.explain(ray);
    if (e.tracer.kind == HitKind::hit && e.judgement.verdict == Verdict::agree && e.loss->chain.size() > 2) return e;
  }
  FAIL("no ray hits");
  return {};
}

/// The image with a node's sphere so small that the walk is rejected there.
GeometryImage with_small_sphere(GeometryImage image, const Walk& walk, const Ancestor& node) {
  const std::uint32_t mask = (1u << image.payload_bits) - 1u;
  float& w = image.texels[unit_texel(image, node.cell)].w;
  const std::uint32_t kept = std::bit_cast<std::uint32_t>(w) & (mask | 1u << 31);
  const float r2 = 0.9f * walk.steps[node.step].distance2;
  w = std::bit_cast<float>((std::bit_cast<std::uint32_t>(r2) & ~mask) | kept);
  return image;
}

}  // namespace

TEST_CASE("Explain names the sphere that was shrunk, in words, as data and in the picture") {
  Session session;
  const Stage& stage = session.stage("creature");
  const Explanation good = hitting(session, stage);
  CHECK(good.layer == Layer::none);
  CHECK_FALSE(good.is_wrong);
  const Ancestor& victim = good.loss->chain.back();
  const GeometryImage broken = with_small_sphere(stage.image, good.walk, victim);
  Examiner examiner(session, {&stage, &broken, &stage.image, {}, "broken"});
  const Explanation e = examiner.explain(good.ray);
  INFO(e.sentence);
  CHECK(e.is_wrong);
  CHECK(e.judgement.verdict == Verdict::tracer_wrong);
  CHECK(e.layer == Layer::bounds);
  const std::string cell = "node " + std::to_string(victim.node) + " at cell (" + std::to_string(victim.x) + ", " +
                           std::to_string(victim.y) + ")";
  CHECK_THAT(e.sentence, Contains("sphere of " + cell + " rejected the ray") && Contains("too small by"));
  const ExplanationRecord r = examiner.record(e, "./plumbline explain creature");
  CHECK(r.steps.at(r.fault.step).cell == victim.cell);
  CHECK(r.steps.at(r.fault.step).notable);
  CHECK(r.fault.as_baked == "no");
  // The cut of the sphere at fault stays off the ray by what it lacks: in units of the image, which are the world's.
  std::size_t faults = 0;
  for (const ShapeRecord& shape : r.slice.shapes) {
    if (shape.role != "fault") continue;
    ++faults;
    REQUIRE(shape.is_ellipse);
    CHECK(std::abs(shape.rx - shape.ry) <= 1e-9 * shape.rx);
    CHECK(std::abs(shape.rx - e.loss->radius) <= 1e-6 * shape.rx);
    CHECK(std::abs(shape.y) > shape.ry);
    CHECK(std::abs(std::abs(shape.y) - shape.ry - r.fault.shortfall) <= 1e-3 * shape.ry);
  }
  CHECK(faults == 1);
  const std::string text = explanation_text(r, false);
  CHECK_THAT(text, Contains("\n  > ") && Contains(e.sentence) && Contains("layer        bounds"));
  CHECK(explanation_text(r, true).size() > text.size());
  CHECK_THAT(explanation_html(r), Contains(cell));
}

TEST_CASE("Of a long walk what tells something is kept, and indices stay right") {
  Session session;
  const Stage& stage = session.stage("creature");
  const Explanation e = hitting(session, stage);
  Examiner examiner(session, examined_of(stage));
  const ExplanationRecord whole = examiner.record(e, ""), part = examiner.record(e, "", 8);
  CHECK(part.total_steps == whole.steps.size());
  CHECK(part.steps.size() == 8);
  for (std::size_t i = 0; i < whole.chain.size(); ++i) {
    if (part.chain[i].step == kNoNumber) continue;
    CHECK(part.steps.at(part.chain[i].step).cell == whole.chain[i].cell);
  }
}

TEST_CASE("A walk that was written down is the walk") {
  Session session;
  const Stage& stage = session.stage("nested");
  const Explanation e = hitting(session, stage);
  Examiner examiner(session, examined_of(stage));
  const ExplanationRecord r = examiner.record(e, "");
  const Walk back = walk_of(explanation_from_json(explanation_to_json(r), "walk.json"), "walk.json");
  CHECK_FALSE(first_divergence(e.walk, back));
  const ComparisonRecord same = compare_walks({&e.walk, &stage.image, r.shape}, {&back, nullptr, r.shape});
  CHECK(same.same);
  CHECK(same.step_by_step);
  Walk changed = back;
  changed.steps.at(2).cell += 1;
  const ComparisonRecord other = compare_walks({&e.walk, &stage.image, r.shape}, {&changed, nullptr, r.shape});
  CHECK_FALSE(other.same);
  CHECK_THAT(other.sentence, Contains("step 3: "));
  CHECK(other.second->cell == changed.steps[2].cell);
}

TEST_CASE("Walks through images that are built otherwise are compared by what was tested") {
  Session session;
  const Stage& stage = session.stage("creature");
  const Explanation e = hitting(session, stage);
  const auto against = [&](const GeometryImage& image) {
    const Walk walk = capture_walk(session.context(), image, e.ray);
    return compare_walks({&e.walk, &stage.image, shape_of(stage.image)}, {&walk, &image, shape_of(image)});
  };
  const ComparisonRecord paper = against(bake(stage.scene, variant_options("paper_sphere_octant")));
  INFO(paper.sentence);
  CHECK_FALSE(paper.step_by_step);
  CHECK(paper.same);
  GeometryImage broken = bake(stage.scene, variant_options("paper_sphere_octant"));
  for (glm::vec4& texel : broken.texels) texel.w = texel.w > 0.0f && texel.w < 1e30f ? 1e-30f * texel.w : texel.w;
  CHECK_FALSE(against(broken).same);
  CHECK_FALSE(against(bake(stage.scene, variant_options("leaf_1"))).same);
  CHECK_THROWS_AS(variant_options("no_such_variant"), InputError);
}

TEST_CASE("A tree of another scene is refused, a broken one of this scene is not") {
  const Folder folder;
  const Scene creature = load_scene("creature");
  const auto written = [&](const GeometryImage& image) {
    std::filesystem::create_directories(folder.path);
    write_geometry_image(image, folder.path / "tree.exr");
    return folder.path / "tree.exr";
  };
  GeometryImage image = bake(creature);
  image.texels[5].w = 0.0f;
  CHECK(read_tree_of(creature, "creature", written(image)).texels.size() == image.texels.size());
  const auto other = written(bake(load_scene("sphereflake:2")));
  CHECK_THROWS_WITH(read_tree_of(creature, "creature", other), Contains("no tree of creature"));
  CHECK_THROWS_AS(read_tree_of(load_scene("nested"), "nested", written(image)), InputError);
}

TEST_CASE("A failing ray of a report leads to its explanation, after a merge too") {
  const Folder folder;
  Case c;
  c.name = "made_up.broken_tree", c.feature = "made_up", c.scene = c.spec = "creature";
  c.run = [](CaseContext& context, const Case& self, CaseRecord& record) {
    const Stage& stage = context.session.stage(self.spec);
    const Explanation good = hitting(context.session, stage);
    const GeometryImage broken = with_small_sphere(stage.image, good.walk, good.loss->chain.back());
    Probe probe(context.session.context(), broken);
    std::vector<Ray> rays(2000);
    generate_rays(stage.rays, RayFamily::inside, 3, 0, rays);
    Tally tally;
    TraceBuffers buffers;
    trace_and_judge(stage.judge, probe, stage.embree, rays, 0, 3, buffers, tally);
    explain_failing(context, {&stage, &broken, &stage.image, {}, "broken"}, self.name, "./plumbline explain creature",
                    tally);
    record_tally(tally, self.spec, record);
    conclude(tally, rays.size(), record);
  };
  RunOptions options;
  options.out = folder.path / "run", options.quiet = true;
  const RunRecord run = run_cases({c}, options);
  REQUIRE(run.cases.size() == 1);
  INFO(run.cases[0].message);
  CHECK(run.cases[0].status == CaseStatus::failed);
  CHECK_THAT(run.cases[0].message, Contains("lost: bounds "));
  merge_reports({options.out}, folder.path / "merged");
  std::size_t pages = 0;
  for (const char* name : {"run", "merged"}) {
    const RunRecord read = read_results(folder.path / name / "results.json");
    CHECK_THAT(read_text(folder.path / name / "index.html"), Contains("explanations/made"));
    for (const RayRecord& ray : read.cases.at(0).worst) {
      if (ray.verdict != "tracer_wrong" && ray.verdict != "leak") continue;
      CHECK(ray.layer == "bounds");
      CHECK_THAT(ray.reason, Contains("Lost by the layer bounds: sphere of node"));
      if (ray.explanation.empty()) continue;
      ++pages;
      CHECK(std::filesystem::path(ray.explanation).is_relative());
      CHECK_THAT(read_text(folder.path / name / ray.explanation), Contains("rejected the ray"));
    }
  }
  CHECK(pages >= 2);
  CHECK(pages <= 2 * kMostPages);
}
