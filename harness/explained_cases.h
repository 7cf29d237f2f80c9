// SPDX-License-Identifier: GPL-3.0-or-later
// Failing rays of a case: the layer that failed each, and a page that explains it.
#pragma once

#include <string>

#include "harness/catalogue.h"
#include "harness/explain.h"
#include "harness/verdict.h"
#include "reports/record.h"

namespace plumbline {

/// Pages written for one case at most; its message says so where there are more failing rays.
inline constexpr std::size_t kMostPages = 8;

/// The default tracer on a stage, or that of the other way out of transforms.
Examined examined_of(const Stage& stage, TransformOut out = BakeOptions{}.transform_out);

/// Explains the failing rays that a tally keeps and that are not explained yet: names each one's layer, adds where it
/// was lost to its reason, and writes the first kMostPages into the run's folder as explanations/CASE-INDEX.html.
/// `replay` is the command that explains a ray, but for its --ray, or the one that repeats the case where rays have
/// none of their own.
void explain_failing(CaseContext& context, const Examined& examined, const std::string& case_name,
                     const std::string& replay, Tally& tally);

/// The same of rays that a case keeps as records, from `first` on.
void explain_failing(CaseContext& context, const Examined& examined, CaseRecord& record, std::size_t first);

/// Adds to the message of a case how many of its failing rays each layer lost: "3 rays lost: bounds 2, links 1".
void count_layers(CaseRecord& record);

}  // namespace plumbline
