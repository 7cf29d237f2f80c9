// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of distributed ray tracing, seeded into the reference one at a time, each with a nightly case that must find
// it.
#pragma once

#include <string>
#include <vector>

#include "harness/independent.h"
#include "harness/picture_changes.h"

namespace plumbline {

struct PictureFault {
  PictureChange change;              ///< its name is the fault's
  std::string what;                  ///< one sentence
  std::string scene;                 ///< of the case that shows it
  std::vector<std::string> effects;  ///< likewise
  std::uint32_t frames = 32;         ///< of each batch of that case
};

/// Every fault, in a fixed order.
std::vector<PictureFault> picture_faults();

/// The comparison of that case, with the reference's physical model.
PictureComparison compare_with_fault(const PictureFault& fault, std::uint64_t seed);

}  // namespace plumbline
