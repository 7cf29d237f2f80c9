// SPDX-License-Identifier: GPL-3.0-or-later
// The command `render`: a scene becomes a picture.
#include <cstdio>
#include <memory>

#include "harness/commands.h"
#include "harness/render_reference.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct RenderArguments {
  std::string scene, output, engine = "reference", size, time, model;
  ReferenceSettings settings;
};

void parse_size(const std::string& text, ReferenceSettings& settings) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &settings.width, &settings.height, &used) != 2 ||
      used != static_cast<int>(text.size()) || settings.width < 1 || settings.height < 1)
    throw InputError("--size takes WIDTHxHEIGHT, such as 640x480; it is '" + text + "'");
}

int render_scene(RenderArguments a) {
  const Scene scene = load_to_trace(a.scene);
  if (!a.size.empty()) parse_size(a.size, a.settings);
  if (!a.time.empty()) a.settings.time = parse_time(a.time);
  if (!a.model.empty()) {
    a.settings.effects = scene.effects;
    a.settings.effects->model = a.model == "physical" ? Effects::Model::physical : Effects::Model::paper;
  }
  render_reference(scene, a.settings, a.scene, a.output);
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<RenderArguments>();
  CLI::App* sub = app.add_subcommand("render", "Render a picture of a scene as EXR or PNG");
  sub->add_option("SCENE", a->scene, "Scene file or generator")->required();
  sub->add_option("-o,--output", a->output, "IMAGE.exr or IMAGE.png")->required();
  sub->add_option("--engine", a->engine, "Who renders")->check(CLI::IsMember({"reference"}))->capture_default_str();
  sub->add_option("--size", a->size, "WIDTHxHEIGHT in pixels; the camera's if not given");
  sub->add_option("--frames", a->settings.frames, "Samples of each pixel")
      ->check(CLI::Range(1u, 0x7fffffffu))
      ->capture_default_str();
  sub->add_option("--seed", a->settings.seed, "Of the random numbers")->capture_default_str();
  sub->add_option("--time", a->time, "Seconds of the scene's animation; 0 if not given");
  sub->add_option("--model", a->model, "Densities of the effects; the scene's if not given")
      ->check(CLI::IsMember({"paper", "physical"}));
  commands.emplace_back(sub, [a] { return render_scene(*a); });
}

}  // namespace plumbline
