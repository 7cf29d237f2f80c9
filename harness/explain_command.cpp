// SPDX-License-Identifier: GPL-3.0-or-later
// The command `explain`: one ray, from the command line to its explanation.
#include <cstdio>
#include <memory>

#include "harness/commands.h"
#include "harness/explain.h"
#include "scenes/animation.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct ExplainArguments {
  std::string scene, ray, pixel, time;
  TransformOut out = TransformOut::restore;
};

int explain_ray(const ExplainArguments& a) {
  if (a.ray.empty() && a.pixel.empty())
    throw InputError("explain needs --ray or --pixel; see `plumbline explain --help`");
  Session session;
  Scene scene = load_to_trace(a.scene);
  if (!a.time.empty()) set_time(scene, parse_time(a.time));
  const Ray ray = a.ray.empty() ? pixel_ray(scene, a.pixel) : parse_ray(a.ray);
  const Stage& stage = session.stage(a.scene, std::move(scene));
  const Explanation e = explain(session, stage, ray, a.out);
  std::fputs(e.text.c_str(), stdout);
  return is_failure(e.judgement.verdict) ? 1 : 0;
}

}  // namespace

void add_explain_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<ExplainArguments>();
  CLI::App* sub = app.add_subcommand("explain", "Tell of one ray what both tracers and exact arithmetic answer");
  sub->add_option("SCENE", a->scene, "Scene file or generator")->required();
  auto* ray = sub->add_option(
      "--ray", a->ray, "OX,OY,OZ,DX,DY,DZ[,TMAX]; decimal or hex floats; write --ray=... where it begins with a minus");
  sub->add_option("--pixel", a->pixel, "X,Y: the ray through the centre of a pixel; 0,0 is the top left")
      ->excludes(ray);
  sub->add_option("--time", a->time, "Seconds: where the scene's animation stands; as at rest if not given");
  add_transform_out(*sub, a->out);
  commands.emplace_back(sub, [a] { return explain_ray(*a); });
}

}  // namespace plumbline
