// SPDX-License-Identifier: GPL-3.0-or-later
// The command `explain`: one ray, from the command line to its explanation.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "harness/commands.h"
#include "harness/explain.h"
#include "harness/hit_cases.h"
#include "harness/progress.h"
#include "harness/tree_file.h"
#include "harness/walk_record.h"
#include "reports/files.h"
#include "scenes/animation.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct ExplainArguments {
  std::string scene, ray, pixel, time, tree, against, json, html;
  bool all = false, has_bake_options = false;
  BakeOptions options;
};

bool ends_with(const std::string& text, const char* end) { return std::filesystem::path(text).extension() == end; }

/// The image that is walked, and the sound one of its shape.
struct Images {
  GeometryImage own, sound;
  bool has_sound = false;
  std::string source;
};

Images images_of(const ExplainArguments& a, const Scene& scene) {
  Images images;
  if (a.tree.empty()) {
    images.own = bake(scene, a.options);
    images.source = "baked now";
    return images;
  }
  images.own = read_tree_of(scene, a.scene, a.tree);
  images.source = a.tree;
  images.sound = bake(scene, images.own.options);
  images.has_sound = shape_of(images.sound) == shape_of(images.own);
  return images;
}

/// The other walk: of a file, of a tree that was read, or of a variant.
ComparisonRecord compared_with(const ExplainArguments& a, Session& session, const Scene& scene, const Explanation& e,
                               const GeometryImage& image, const ExplanationRecord& record) {
  const ComparedWalk own{&e.walk, &image, record.shape};
  if (ends_with(a.against, ".json")) {
    const ExplanationRecord other = explanation_from_json(read_text(a.against), a.against);
    if (other.ray != record.ray)
      throw InputError(a.against + ": the walk of another ray; explain the same one, --ray=" + other.ray[0] + "," +
                       other.ray[1] + "," + other.ray[2]);
    // Both as they were written down, where a NaN is a NaN.
    const Walk first = walk_of(explanation_from_json(explanation_to_json(record), "this walk"), "this walk");
    const Walk second = walk_of(other, a.against);
    ComparisonRecord c = compare_walks({&first, &image, record.shape}, {&second, nullptr, other.shape});
    c.with = a.against + " (" + other.driver + ")";
    for (const auto& [who, text] : other.answers)
      if (who == "tracer") c.second_answer = text;
    return c;
  }
  const bool is_file = ends_with(a.against, ".exr");
  const GeometryImage other =
      is_file ? read_tree_of(scene, a.scene, a.against) : bake(scene, variant_options(a.against));
  const Walk walk = capture_walk(session.context(), other, e.ray);
  ComparisonRecord c = compare_walks(own, {&walk, &other, shape_of(other)});
  c.with = is_file ? a.against : "variant " + a.against;
  c.second_answer = describe(walk.hit);
  return c;
}

int explain_ray(const ExplainArguments& a, const std::string& command) {
  if (a.ray.empty() && a.pixel.empty())
    throw InputError("explain needs --ray or --pixel; see `plumbline explain --help`");
  if (!a.tree.empty() && a.has_bake_options)
    throw InputError("--tree walks an image that is baked already; leave the options of a bake out");
  Progress progress;
  progress.show(0.0, "loading " + a.scene);
  Scene scene = load_to_trace(a.scene);
  if (!a.time.empty()) set_time(scene, parse_time(a.time));
  const Ray ray = a.ray.empty() ? pixel_ray(scene, a.pixel) : parse_ray(a.ray);
  progress.show(0.2, "baking");
  const Images images = images_of(a, scene);
  Session session;
  const Stage& stage = session.stage(a.scene, std::move(scene));
  progress.show(0.7, "walking");
  const GeometryImage* sound = a.tree.empty() ? &images.own : images.has_sound ? &images.sound : nullptr;
  Examiner examiner(session, {&stage, &images.own, sound, {}, images.source});
  const Explanation e = examiner.explain(ray);
  ExplanationRecord record = examiner.record(e, command);
  if (!a.against.empty()) record.against = compared_with(a, session, stage.scene, e, images.own, record);
  progress.clear();
  if (!a.tree.empty() && !images.has_sound)
    std::fprintf(stderr,
                 "warning: a bake of %s with the options of %s has another shape; where links should lead is read from "
                 "the tree itself\n",
                 a.scene.c_str(), a.tree.c_str());
  std::fputs(explanation_text(record, a.all).c_str(), stdout);
  if (!a.json.empty()) write_text(a.json, explanation_to_json(record));
  if (!a.html.empty()) write_text(a.html, explanation_html(record));
  return e.is_wrong ? 1 : 0;
}

}  // namespace

void add_explain_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<ExplainArguments>();
  CLI::App* sub =
      app.add_subcommand("explain", "Tell of one ray what everybody answers, and walk the tree with it step by step");
  sub->add_option("SCENE", a->scene, "Scene file or generator")->required();
  auto* ray = sub->add_option(
      "--ray", a->ray, "OX,OY,OZ,DX,DY,DZ[,TMAX]; decimal or hex floats; write --ray=... where it begins with a minus");
  sub->add_option("--pixel", a->pixel, "X,Y: the ray through the centre of a pixel; 0,0 is the top left")
      ->excludes(ray);
  sub->add_option("--time", a->time, "Seconds: where the scene's animation stands; as at rest if not given");
  sub->add_option("--tree", a->tree, "TREE.exr: walk this image of the scene instead of one that is baked now");
  sub->add_option(
      "--against", a->against,
      "Compare with the walk through OTHER.exr, or through a variant such as paper_sphere_threaded, or with "
      "a WALK.json that --json wrote, under another driver for instance");
  sub->add_flag("--all", a->all, "Print every step, not only those that tell something");
  sub->add_option("--json", a->json, "Write the whole explanation to this file");
  sub->add_option("--html", a->html, "Write it as a page with a picture of the ray among the volumes that it met");
  const std::size_t before = sub->get_options().size();
  add_bake_options(*sub, a->options);
  const std::vector<CLI::Option*> options = sub->get_options();
  const std::vector<CLI::Option*> bake_options(options.begin() + static_cast<std::ptrdiff_t>(before), options.end());
  commands.emplace_back(sub, [a, bake_options] {
    a->has_bake_options =
        std::any_of(bake_options.begin(), bake_options.end(), [](const CLI::Option* o) { return o->count() > 0; });
    std::string command = "./plumbline explain " + plumbline::quoted(a->scene);
    const auto add = [&](const std::string& name, const std::string& value) {
      if (!value.empty()) command += " " + name + "=" + plumbline::quoted(value);
    };
    add("--ray", a->ray), add("--pixel", a->pixel), add("--time", a->time), add("--tree", a->tree);
    add("--against", a->against);
    for (const CLI::Option* o : bake_options)
      if (o->count() > 0) add(o->get_name(), o->results().front());
    return explain_ray(*a, command);
  });
}

}  // namespace plumbline
