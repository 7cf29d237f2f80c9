// SPDX-License-Identifier: MIT
// How much of the space of a bounding volume its children share: volumes of intersections in closed form.
#pragma once

#include <span>

#include "tracer/image_view.h"

namespace plumbline {

/// The volume of a ball or a box.
double volume_of(const Volume& volume);

/// The volume that two volumes of the same kind share. Two balls share a lens: with distance d between the centres of
/// radii a and b, |a - b| < d < a + b, it is pi (a + b - d)^2 (d^2 + 2 d (a + b) - 3 (a - b)^2) / (12 d).
double shared_volume(const Volume& a, const Volume& b);

/// The sum of what every two of the children share, over the parent's volume: 0 where they are apart, and more than 1
/// where many lie upon one another. NaN for a parent without volume, and where there are more than 256 children and too
/// many pairs of them to look at: more than 256 for each child have a part of the x axis in common.
double sibling_overlap(const Volume& parent, std::span<const Volume> children);

}  // namespace plumbline
