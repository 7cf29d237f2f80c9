// SPDX-License-Identifier: GPL-3.0-or-later
// The rays that bundles are asked with, for cases and faults.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/rays.h"

namespace plumbline {

/// Rays in the order in which bundles take them: `each` camera rays and `each` chords first, then rays of all families
/// in turn, so that undefined rays, those from far away and those that are seen edge-on share bundles with ordinary
/// ones.
std::vector<Ray> bundled_rays(const RaySource& source, std::uint64_t seed, std::size_t each);

}  // namespace plumbline
