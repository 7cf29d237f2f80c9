// SPDX-License-Identifier: GPL-3.0-or-later
// What each case costs, as measured, and the catalogue cut by it into parts for many machines.
#pragma once

#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "reports/record.h"

namespace plumbline {

/// Seconds that a case will take: by the measurements that come with Plumbline (case_costs.txt), in proportion to its
/// rays; where there is none, by its rays alone. The same on every machine.
double cost_of(const Case& c);

/// The I-th of N parts, I from 1: cases in a row whose costs sum up to about the same in every part, so that each scene
/// is loaded by few. Cases that question the driver are in every part: each machine has its own.
std::vector<Case> shard_of(const std::vector<Case>& cases, int shard, int shards);

/// The lines of case_costs.txt for what a run took.
std::string costs_text(const RunRecord& run);

}  // namespace plumbline
