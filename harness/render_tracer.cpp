// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/render_tracer.h"

namespace plumbline {

PictureAttributes tracer_attributes(const Renderer& renderer, const GlContext& context, const std::string& scene,
                                    double time) {
  const RenderSettings& used = renderer.settings();
  PictureAttributes attributes =
      picture_attributes("tracer", scene, used.first_frame, used.frames, used.seed, time, *used.effects);
  const BakeOptions& bake = used.bake;
  attributes["plumbline.random"] = name_of(used.random);
  attributes["plumbline.bundle"] = used.bundle.rays;
  attributes["plumbline.variant"] =
      std::string("layout=") + name_of(bake.layout) + ",bounds=" + name_of(bake.bounds) +
      ",links=" + name_of(bake.links) + ",transform-out=" + name_of(bake.transform_out) +
      ",transform-list=" + name_of(bake.transform_list) + ",image-width=" + std::to_string(bake.width) +
      ",leaf-size=" + std::to_string(bake.tree.leaf_size) + ",tree-width=" + std::to_string(bake.tree.width);
  attributes["plumbline.driver"] = context.renderer() + ", " + context.version();
  return attributes;
}

}  // namespace plumbline
