// SPDX-License-Identifier: GPL-3.0-or-later
// Captured walks as records that can be written down, and back.
#pragma once

#include <string>

#include "reports/explanation.h"
#include "tracer/walk_analysis.h"
#include "tracer/walk_trace.h"

namespace plumbline {

/// The way that the walk took at a step, one of kWalkReasons. `has_hit`: a hit was found before it.
std::string way_taken(const WalkStep& step, bool has_hit);

/// A step, without what the rest of the walk tells of it.
StepRecord record_of(const WalkStep& step, bool has_hit = false);

/// Fills start, steps, total_steps, skipped and driver_agrees, and marks the steps that are shown first. `loss` tells
/// the chain and the step at fault. Of more than `most` steps the notable ones are kept, and of the others the first.
void record_walk(const Walk& walk, const Loss& loss, std::size_t most, ExplanationRecord& record);

/// The steps of a record as they were captured; the hit is not among them. Throws InputError for names that a walk does
/// not have.
Walk walk_of(const ExplanationRecord& record, const std::string& file);

/// What makes two images' walks comparable step by step: layout, bounds, sizes.
std::string shape_of(const GeometryImage& image);

}  // namespace plumbline
