// SPDX-License-Identifier: GPL-3.0-or-later
// The command `render`: a scene becomes a picture, or a sequence of them.
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "harness/commands.h"
#include "harness/picture_file.h"
#include "harness/progress.h"
#include "harness/render_tracer.h"
#include "reference/renderer.h"
#include "reports/format.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct RenderArguments {
  std::string scene, output, engine = "tracer", size, time, model, effects, random = "hash";
  std::uint32_t images = 0;  // of an animation
  RenderSettings settings;
};

RandomKind parse_random(const std::string& name) {
  return name == "md5" ? RandomKind::md5 : name == "texture" ? RandomKind::texture : RandomKind::hash;
}

/// An engine that renders pictures of one scene at different times.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual bool lit_by_default() const = 0;
  virtual RenderedPicture render(double time, const RenderProgress& progress) = 0;
  virtual PictureAttributes attributes(double time) const = 0;
};

class TracerEngine final : public Engine {
 public:
  TracerEngine(const Scene& scene, const std::string& spec, const RenderSettings& settings)
      : renderer_(context_, scene, settings), spec_(spec) {}
  bool lit_by_default() const override { return renderer_.lit_by_default(); }
  RenderedPicture render(double time, const RenderProgress& progress) override {
    const RenderSettings& settings = renderer_.settings();
    renderer_.restart(time);
    renderer_.add_frames(settings.first_frame, settings.frames, progress);
    return renderer_.picture();
  }
  PictureAttributes attributes(double time) const override {
    return tracer_attributes(renderer_, context_, spec_, time);
  }

 private:
  GlContext context_;
  Renderer renderer_;
  std::string spec_;
};

class ReferenceEngine final : public Engine {
 public:
  ReferenceEngine(const Scene& scene, const std::string& spec, const RenderSettings& asked)
      : scene_(scene), spec_(spec) {
    settings_.width = asked.width, settings_.height = asked.height;
    settings_.frames = asked.frames, settings_.first_frame = asked.first_frame;
    settings_.seed = asked.seed;
    settings_.effects = asked.effects;
    prepare(asked.time);
  }
  bool lit_by_default() const override { return renderer_->lit_by_default(); }
  RenderedPicture render(double time, const RenderProgress& progress) override {
    prepare(time);
    return *renderer_->render(progress);
  }
  PictureAttributes attributes(double time) const override {
    const ReferenceSettings& used = renderer_->settings();
    return picture_attributes("reference", spec_, used.first_frame, used.frames, used.seed, time, *used.effects);
  }

 private:
  void prepare(double time) {
    if (renderer_ && time == settings_.time) return;
    settings_.time = time;
    renderer_.reset();
    renderer_.emplace(scene_, settings_);
  }
  Scene scene_;
  std::string spec_;
  ReferenceSettings settings_;
  std::optional<ReferenceRenderer> renderer_;
};

/// "out.png" becomes "out.0007.png".
std::filesystem::path numbered(const std::filesystem::path& path, std::uint32_t number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, ".%04u", number);
  return path.parent_path() / (path.stem().string() + digits + path.extension().string());
}

void render_one(Engine& engine, const RenderArguments& a, double time, const std::filesystem::path& output,
                const std::string& what) {
  const auto start = std::chrono::steady_clock::now();
  Progress progress;
  const RenderedPicture picture = engine.render(time, [&](double share) {
    progress.show(share, what);
    return true;
  });
  progress.clear();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::uint64_t wrong = count_not_finite(picture);
  if (wrong > 0)
    std::fprintf(stderr, "warning: %s not finite (black in a PNG, NaN or infinite in an EXR)\n",
                 counted(wrong, "pixel").c_str());
  write_picture(picture, engine.attributes(time), output);
  const double samples = static_cast<double>(picture.mean.size()) * picture.frames;
  std::printf("%s: %d x %d pixels, %s by the %s, %s, %s samples per second\n", output.c_str(), picture.width,
              picture.height, counted(picture.frames, "frame").c_str(), a.engine.c_str(), duration(seconds).c_str(),
              short_count(static_cast<std::uint64_t>(samples / seconds)).c_str());
}

int render_scene(RenderArguments a) {
  require_picture_name(a.output);
  const Scene scene = load_to_trace(a.scene);
  if (!a.size.empty()) parse_size("--size", a.size, a.settings.width, a.settings.height);
  if (!a.time.empty()) a.settings.time = parse_time(a.time);
  a.settings.random = parse_random(a.random);
  a.settings.effects = scene.effects;
  if (!a.model.empty())
    a.settings.effects->model = a.model == "physical" ? Effects::Model::physical : Effects::Model::paper;
  if (!a.effects.empty()) set_effects(a.effects, *a.settings.effects);
  if (a.images > 0 && scene.animation.empty())
    throw InputError(a.scene + ": --animate needs a scene with keyframes; nothing moves in this one");
  const TimeRange range = time_range(scene);
  if (a.images > 0) a.settings.time = range.first;

  std::unique_ptr<Engine> engine;
  if (a.engine == "tracer") {
    engine = std::make_unique<TracerEngine>(scene, a.scene, a.settings);
  } else {
    engine = std::make_unique<ReferenceEngine>(scene, a.scene, a.settings);
  }
  if (engine->lit_by_default()) std::fprintf(stderr, "warning: the scene has no light; one beside the eye lights it\n");
  if (!scene.has_camera) std::fprintf(stderr, "warning: the scene has no camera; this view shows all of it\n");
  if (a.images == 0) render_one(*engine, a, a.settings.time, a.output, "rendering");
  for (std::uint32_t i = 0; i < a.images; ++i) {
    const double share = a.images > 1 ? static_cast<double>(i) / (a.images - 1) : 0.0;
    render_one(*engine, a, range.first + share * (range.last - range.first), numbered(a.output, i),
               "image " + std::to_string(i + 1) + " of " + std::to_string(a.images));
  }
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<RenderArguments>();
  CLI::App* sub = app.add_subcommand("render", "Render a picture of a scene as EXR or PNG");
  sub->add_option("SCENE", a->scene, "Scene file or generator")->required();
  sub->add_option("-o,--output", a->output,
                  "IMAGE.exr (linear colours, variance, depth, normal, ids, steps) or IMAGE.png (sRGB)")
      ->required();
  sub->add_option("--engine", a->engine, "Who renders: the production tracer, or the reference")
      ->check(CLI::IsMember({"tracer", "reference"}))
      ->capture_default_str();
  sub->add_option("--size", a->size, "WIDTHxHEIGHT in pixels; the camera's if not given");
  sub->add_option("--frames", a->settings.frames, "Samples of each pixel")
      ->check(CLI::Range(1u, 0x7fffffffu))
      ->capture_default_str();
  sub->add_option("--first-frame", a->settings.first_frame, "Number of the first frame: other numbers, other noise")
      ->check(CLI::Range(0u, 0x7ffffffeu))
      ->capture_default_str();
  sub->add_option("--seed", a->settings.seed, "Of the random numbers")->capture_default_str();
  CLI::Option* time = sub->add_option("--time", a->time, "Seconds of the scene's animation; 0 if not given");
  sub->add_option("--animate", a->images,
                  "Render so many images over the time of the keyframes: IMAGE.0000.png, IMAGE.0001.png, ...")
      ->check(CLI::Range(1u, 9999u))
      ->excludes(time);
  sub->add_option("--effects", a->effects,
                  "What is switched on: all, none, or a list of aa, dof, soft_shadow, glossy, motion_blur; the scene's "
                  "if not given");
  sub->add_option("--model", a->model, "Densities of the effects; the scene's if not given")
      ->check(CLI::IsMember({"paper", "physical"}));
  sub->add_option("--random", a->random, "Random numbers of the tracer: a hash, MD5, or the paper's noise texture")
      ->check(CLI::IsMember({"hash", "md5", "texture"}))
      ->capture_default_str();
  sub->add_option("--bundle", a->settings.bundle.rays,
                  "Rays that walk the tree together: samples of a pixel, or neighbours")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  add_bake_options(*sub, a->settings.bake);
  commands.emplace_back(sub, [a] { return render_scene(*a); });
}

}  // namespace plumbline
