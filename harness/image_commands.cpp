// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that deal with geometry images: bake.
#include <cstdio>
#include <memory>

#include "harness/commands.h"
#include "tracer/geometry_image.h"

namespace plumbline {
namespace {

struct BakeArguments {
  std::string scene, output;
  BakeOptions options;
};

int bake_scene(const BakeArguments& a) {
  const Scene scene = load_to_trace(a.scene);
  const GeometryImage image = bake(scene, a.options);
  write_geometry_image(image, a.output);
  std::printf("%s: %d x %d texels, %u cells, %u primitives\n", a.output.c_str(), image.width, image.height,
              image.cell_count, scene.primitive_count());
  return 0;
}

}  // namespace

void add_bake_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<BakeArguments>();
  CLI::App* sub = app.add_subcommand("bake", "Write a scene's geometry image as OpenEXR");
  sub->add_option("SCENE", a->scene, "Scene file or generator")->required();
  sub->add_option("-o,--output", a->output, "TREE.exr")->required();
  add_bake_options(*sub, a->options);
  commands.emplace_back(sub, [a] { return bake_scene(*a); });
}

}  // namespace plumbline
