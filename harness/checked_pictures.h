// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a user's own scene: the tracer's against the reference's, at a depth that fits the time that `check` has.
#pragma once

#include <cstdint>
#include <string>

#include "harness/catalogue.h"

namespace plumbline {

/// `drt.picture.<scene>`: a small picture with all effects, by the scene's own model, as the reference makes it. It is
/// skipped, with the reason, where even the fewest samples would take longer than asked.
Case checked_picture_case(const ListedScene& scene, const CheckedPictures& settings);

/// What became of the pictures of a run, a line for each case that is about them.
std::string pictures_text(const RunRecord& run);

}  // namespace plumbline
