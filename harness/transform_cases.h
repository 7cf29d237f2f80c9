// SPDX-License-Identifier: GPL-3.0-or-later
// What the cases of transforms share.
#pragma once

#include <cstdint>

#include "harness/session.h"
#include "reports/record.h"

namespace plumbline {

/// What update_transforms and a full bake differ in: texels whose bits differ, or all of them where the sizes do.
std::uint64_t differing_texels(const GeometryImage& a, const GeometryImage& b);

/// A transform near a node's place at rest: turned, stretched and moved a little, by numbers that follow from the seed.
Transform nearby(const Transform& rest, double reach, std::uint64_t seed, std::uint64_t number);

}  // namespace plumbline
