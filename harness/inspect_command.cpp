// SPDX-License-Identifier: GPL-3.0-or-later
// The command `inspect`: what a tree is made of and what it costs, of a scene as it would be baked or of a baked file;
// of one, or of two side by side.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "harness/clock.h"
#include "harness/commands.h"
#include "harness/hit_cases.h"
#include "harness/inspect.h"
#include "harness/progress.h"
#include "harness/variants.h"
#include "harness/version.h"
#include "reports/files.h"
#include "reports/inspect_report.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct InspectArguments {
  std::string input, scene, compare, out, json;
  std::uint64_t seed = 1;
  std::size_t top = 5, lines = 1 << 16;
  int width = 384;
  BakeOptions options;
};

/// A geometry image, however it came to be.
struct Subject {
  std::string name, source;
  GeometryImage image;
  double bake_seconds = 0.0;  ///< 0: it was read
};

bool is_exr(const std::string& path) {
  std::string end = path.size() < 4 ? "" : path.substr(path.size() - 4);
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return end == ".exr";
}

Subject read_subject(const std::string& path) {
  Subject subject;
  subject.image = read_geometry_image(path);
  subject.name = std::filesystem::path(path).filename().string();
  subject.source = path;
  return subject;
}

Subject bake_subject(const Scene& scene, const std::string& spec, const BakeOptions& options, const std::string& name) {
  Subject subject;
  const auto start = Clock::now();
  subject.image = bake(scene, options);
  subject.bake_seconds = seconds_since(start);
  subject.name = name;
  subject.source = spec;
  return subject;
}

/// The camera that rays are shot from, `width` pixels wide, and whose it is.
Camera camera_of(const std::optional<Scene>& scene, const GeometryImage& image, int width, std::string& said) {
  Camera camera;
  if (scene) {
    camera = scene->camera;
    said = scene->has_camera ? "Camera rays are those of the scene's own camera."
                             : "The scene has no camera: one was made up that frames it.";
  } else {
    // A scene of one sphere, the image's ball, is framed as any other.
    Scene ball;
    const double unit = std::ldexp(1.0, -image.scale_exponent);
    ball.spheres.push_back(
        {glm::vec3(glm::dvec3(image.center) * unit), static_cast<float>(static_cast<double>(image.radius) * unit), 0});
    if (!(ball.spheres[0].radius > 0.0f)) ball.spheres[0].radius = 1.0f;
    frame_camera(ball);
    camera = ball.camera;
    said = "A baked tree holds no camera: one was made up that frames its ball; --scene SCENE gives it the scene's.";
  }
  const int height = std::clamp(width * camera.height / std::max(1, camera.width), 16, 4 * width);
  camera.width = width, camera.height = height;
  return camera;
}

int inspect_subjects(const InspectArguments& a) {
  const std::string spec = is_exr(a.input) ? a.scene : a.input;
  std::optional<Scene> scene;
  if (!spec.empty()) scene = load_to_trace(spec);
  std::vector<Subject> subjects;
  Progress progress;
  progress.show(0.0, "baking");
  if (is_exr(a.input))
    subjects.push_back(read_subject(a.input));
  else
    subjects.push_back(bake_subject(*scene, spec, a.options, variant_name(a.options)));
  if (!a.compare.empty()) {
    if (is_exr(a.compare)) {
      subjects.push_back(read_subject(a.compare));
    } else {
      if (!scene)
        throw InputError("to bake what " + a.input + " is compared with, `" + a.compare +
                         "`, the scene is needed: add --scene SCENE");
      const BakeOptions options = parse_bake_options(a.compare, is_exr(a.input) ? BakeOptions{} : a.options);
      const std::string name = variant_name(options);
      subjects.push_back(bake_subject(*scene, spec, options, name == subjects[0].name ? name + " " + a.compare : name));
    }
    if (subjects[0].name == subjects[1].name) subjects[1].name += " (2)";
  }

  InspectRecord record;
  record.version = version(), record.commit = commit();
  record.command = "./plumbline inspect " + quoted(a.input) +
                   (is_exr(a.input) && !spec.empty() ? " --scene " + quoted(spec) : "") +
                   (a.compare.empty() ? "" : " --compare " + quoted(a.compare));
  GlContext context;
  record.driver = context.renderer() + ", OpenGL " + context.version();
  InspectTask task;
  task.camera = camera_of(scene, subjects[0].image, a.width, record.camera);
  task.scene = scene ? &*scene : nullptr;
  task.spec = spec;
  task.lines = a.lines, task.seed = a.seed, task.top = a.top, task.out = a.out;
  std::vector<Inspection> inspections;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    task.name = subjects[i].name, task.source = subjects[i].source;
    task.stem = "inspect." + std::to_string(i + 1);
    task.image = &subjects[i].image, task.bake_seconds = subjects[i].bake_seconds;
    task.progress = [&](double share, const std::string& what) {
      progress.show((static_cast<double>(i) + share) / static_cast<double>(subjects.size()), what);
    };
    inspections.push_back(inspect(context, task));
  }
  std::vector<std::uint32_t> there, back;
  if (inspections.size() == 2) {
    there = twins_between(inspections[0].inspected, inspections[1].inspected);
    back = twins_between(inspections[1].inspected, inspections[0].inspected);
    record.are_alike = !there.empty();
  }
  for (std::size_t i = 0; i < inspections.size(); ++i) {
    const std::vector<NodeLoad> other = inspections.size() == 2 ? inspections[1 - i].loads : std::vector<NodeLoad>{};
    list_nodes(subjects[i].image, a.top, i == 0 ? there : back, other, inspections[i]);
  }
  for (Inspection& inspection : inspections) record.bakes.push_back(std::move(inspection.record));
  progress.clear();
  std::printf("%s\n%s", record.camera.c_str(), inspect_text(record).c_str());
  if (!a.json.empty()) write_text(a.json, inspect_json(record));
  if (!a.out.empty()) {
    write_inspect_report(record, a.out);
    std::printf("\nReport: %s\n", (std::filesystem::path(a.out) / "inspect.html").string().c_str());
  }
  return 0;
}

}  // namespace

void add_inspect_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<InspectArguments>();
  CLI::App* sub = app.add_subcommand(
      "inspect", "Tell what a tree is made of and what it costs: figures, pictures, the tree itself to walk through");
  sub->add_option("SCENE", a->input, "Scene file or generator, which is baked; or a baked TREE.exr")->required();
  sub->add_option("--scene", a->scene, "The scene that TREE.exr was baked from: gives it a camera, and names");
  sub->add_option("--compare", a->compare,
                  "Another TREE.exr, or bake options as a word, such as layout=paper,bounds=aabb: both side by side");
  sub->add_option("--top", a->top, "List so many nodes that cost most, and rays that walk longest")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000}))
      ->capture_default_str();
  sub->add_option("--lines", a->lines, "Random lines through the scene's ball")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}))
      ->capture_default_str();
  sub->add_option("--camera-width", a->width, "Pixels in a row of the camera's picture")
      ->check(CLI::Range(16, 1024))
      ->capture_default_str();
  sub->add_option("--seed", a->seed, "Seed of the random lines")->capture_default_str();
  sub->add_option("--out", a->out, "Folder for inspect.html, inspect.json and pictures; none if not given");
  sub->add_option("--json", a->json, "Write the figures to this file too");
  add_bake_options(*sub, a->options);
  commands.emplace_back(sub, [a] { return inspect_subjects(*a); });
}

}  // namespace plumbline
