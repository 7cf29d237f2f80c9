// SPDX-License-Identifier: GPL-3.0-or-later
// The production renderer as a source of samples for statistics.
#pragma once

#include "harness/picture_engine.h"
#include "tracer/renderer.h"

namespace plumbline {

/// The size, effects, seed and time of `settings` are replaced by those that factories give; the rest is the tracer's
/// own: source of random numbers, bundles, bake, patches. Each engine has a GL context of its own.
MakePictureEngine tracer_engines(RenderSettings own = {});
/// Engines that see an edited copy of the scene that they are given.
MakePictureEngine edited_engines(MakePictureEngine make, std::function<void(Scene&)> edit);
std::unique_ptr<PictureEngine> make_tracer_engine(const Scene& scene, const PictureSettings& settings);

}  // namespace plumbline
