// SPDX-License-Identifier: MIT
// What changed between runs, and the runs of a history, as text for a terminal.
#pragma once

#include <string>
#include <vector>

#include "reports/history.h"

namespace plumbline {

/// Each kind of change with the cases that it befell; "nothing changed" where none did.
std::string changes_text(const RunChanges& changes);

/// A line for each run, the latest last.
std::string runs_text(const std::vector<PastRun>& newest_first);

/// A line for each answer of a case, the latest last, and its figures in columns.
std::string answers_text(const std::vector<PastCase>& newest_first);

}  // namespace plumbline
