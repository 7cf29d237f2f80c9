// SPDX-License-Identifier: GPL-3.0-or-later
// What many nights tell together and one does not: a bias too small for one night, and a case that became slower than
// its own noise explains.
#pragma once

#include <cstddef>
#include <vector>

#include "reports/history.h"

namespace plumbline {

/// Units by which a figure of a case says that it is a statistic, fit to be pooled: `z` is normal with mean 0 and
/// variance 1 if nothing is wrong, signed; `p` is uniform then, and small when something is wrong.
inline constexpr const char* kUnitZ = "z";
inline constexpr const char* kUnitP = "p";

inline constexpr std::size_t kPooledNights = 30;  ///< the last so many are pooled
inline constexpr std::size_t kFewestRuns = 5;     ///< that a case's usual time is taken from

/// Stouffer's sum for each statistic of `run`, over this run and the last nights that `history` holds. A night whose
/// seed was there already is the same draw again and does not count. NaN makes p 0: it is found.
std::vector<PooledFigure> pooled_figures(const RunRecord& run, const History& history);

/// Stouffer's sum of z over its nights; `figures` is how many such sums are looked at each night.
PooledFigure pooled(const std::vector<double>& z, bool two_sided, std::size_t figures);

/// The z of a p-value; infinite at 0 and 1.
double z_of_p(double p);

/// The cases of `run` that became slower, and by how much the whole night was slower, into `changes`. Held against runs
/// that passed, with as many rays, on the same machine and driver.
void find_slower(const RunRecord& run, const History& history, RunChanges& changes);

/// All of it.
RunChanges changes_since(const RunRecord& run, const History& history);

}  // namespace plumbline
