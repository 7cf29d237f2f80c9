// SPDX-License-Identifier: MIT
// Textures that are computed, so that shipped scenes need no image files: "checker:8", "stripes:16", "waves:4",
// "cobbles:8".
#pragma once

#include <string_view>

#include "scenes/scene.h"

namespace plumbline {

/// Whether a name is meant for generate_texture: what stands before a colon, or the whole, is one of ours.
bool is_generated_texture(std::string_view name);

/// A texture by its name and the number of its pieces along a side, 1 to 64 (8 where none is named). It repeats without
/// a seam; its path is the name. Values are linear, in [0, 1], one texture for colours and heights alike.
///
/// checker: squares of 0.25 and 1 (the number of pieces must be even). stripes: upright ones, 0 and 1 (even too), of 16
/// texels each. waves: heights (1 - cos(2 pi n u)) / 2. cobbles: round stones in rows, each of a height of its own, in
/// gaps of 0.
///
/// Throws InputError for a number that is none or out of range.
Texture generate_texture(std::string_view name);

}  // namespace plumbline
