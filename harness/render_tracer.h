// SPDX-License-Identifier: GPL-3.0-or-later
// The production renderer's picture as the file writers want it.
#pragma once

#include "harness/picture_file.h"
#include "tracer/renderer.h"

namespace plumbline {

PictureFile picture_file(RenderedPicture rendered);

/// How a picture was made: scene, settings, bake, driver.
PictureAttributes tracer_attributes(const Renderer& renderer, const GlContext& context, const std::string& scene,
                                    double time);

}  // namespace plumbline
