// SPDX-License-Identifier: GPL-3.0-or-later
// Where more time buys most, once every case has been asked: which cases to ask again with other rays, and what both
// answers come to.
#pragma once

#include <cstdint>
#include <vector>

#include "harness/catalogue.h"
#include "reports/record.h"

namespace plumbline {

/// The seed of the pass after the first: 1, 2, ...
std::uint64_t pass_seed(std::uint64_t run_seed, std::uint64_t pass);

/// How often a record's case was asked again.
std::uint64_t passes_of(const CaseRecord& record);

/// The better half of the cases that can be asked again, by what a second of them buys; numbers in `cases`, in its
/// order, so that each scene is loaded once. `records` has one for each that has run, under its name.
std::vector<std::size_t> worth_another_pass(const std::vector<Case>& cases, const std::vector<CaseRecord>& records);

/// Adds the next pass's answer to those before: counts and times are summed, statistics (units "z" and "p") pooled, the
/// worse status holds, with the command that repeats it.
void add_pass(CaseRecord& record, CaseRecord next);

}  // namespace plumbline
