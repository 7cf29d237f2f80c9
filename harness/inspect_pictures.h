// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of an inspected image: the image itself by kind of texel, and what the camera's rays met.
#pragma once

#include <span>
#include <vector>

#include "harness/inspect.h"

namespace plumbline {

/// The geometry image, each texel in the colour of its kind: enlarged where it is small, and where it is large each
/// pixel in the colour of the kind that most of its texels have.
void paint_image(const InspectTask& task, std::span<const TexelKind> kinds, std::vector<PictureRecord>& pictures);

/// Steps, primitive tests, depth and overlap of every pixel.
void paint_rays(const InspectTask& task, const InspectedImage& inspected, std::span<const Ray> rays,
                std::span<const Hit> hits, std::vector<PictureRecord>& pictures);

}  // namespace plumbline
