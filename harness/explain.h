// SPDX-License-Identifier: GPL-3.0-or-later
// One ray, told in full: what the tracer answers, what a loop over all primitives answers, what Embree answers, what
// exact arithmetic says, and the verdict.
#pragma once

#include <string>

#include "harness/session.h"

namespace plumbline {

/// Reads "ox,oy,oz,dx,dy,dz" or with ",t_max" behind it; decimal or hex floats. Throws InputError for anything else.
Ray parse_ray(const std::string& text);

/// The ray through the centre of pixel "x,y" of the scene's camera. Throws InputError for a pixel outside the picture.
Ray pixel_ray(const Scene& scene, const std::string& text);

struct Explanation {
  Judgement judgement;
  std::string text;  ///< for people, several lines
};
/// `out`: the variant of the tracer that is asked.
Explanation explain(Session& session, const Stage& stage, const Ray& ray,
                    TransformOut out = BakeOptions{}.transform_out);

}  // namespace plumbline
