// SPDX-License-Identifier: GPL-3.0-or-later
// Cases that are known to fail, with the reason and the day until which that is accepted: a list that cannot grow old
// unseen.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/record.h"

namespace plumbline {

struct ExpectedFailure {
  std::string cases;   ///< a name or a pattern, as `run` takes them
  std::string reason;  ///< one sentence
  std::string until;   ///< the last day, "2027-01-31"
  std::string driver;  ///< only where the driver's name or version contains it; empty: always
};

/// The list that comes with Plumbline.
std::filesystem::path expected_failures_file();

/// Reads a list: JSON, an array of objects with the keys cases, reason, until and, where wanted, driver. Throws
/// InputError for anything else.
std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& file);

/// Judges a case that has ended by the list. One that failed as expected is skipped and says why; one that passes
/// although it is expected to fail has failed, and so has one whose day is over. `today` as "2026-11-23".
void judge_by_expectation(const std::vector<ExpectedFailure>& expected, const std::string& driver,
                          const std::string& today, CaseRecord& record);

}  // namespace plumbline
