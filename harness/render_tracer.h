// SPDX-License-Identifier: GPL-3.0-or-later
// What a file tells of a picture by the production renderer.
#pragma once

#include "harness/picture_file.h"
#include "tracer/renderer.h"

namespace plumbline {

/// How a picture was made: scene, settings, bake, driver.
PictureAttributes tracer_attributes(const Renderer& renderer, const GlContext& context, const std::string& scene,
                                    double time);

}  // namespace plumbline
