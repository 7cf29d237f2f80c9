// SPDX-License-Identifier: GPL-3.0-or-later
// Runs cases, records each when it ends, and writes the report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "harness/expected_failures.h"
#include "reports/record.h"

namespace plumbline {

struct RunOptions {
  std::string command;  ///< as typed, for the record
  std::uint64_t seed = 1;
  std::filesystem::path out = "out";
  int shard = 1, shards = 1;  ///< runs the shard-th of so many parts: see shards.h
  bool resume = false;        ///< go on with the run in `out`: cases that ended there are not run again
  /// 0: none. Cases not begun when it is spent are left out and said to be; what is left of it after all of them goes
  /// into further passes (deeper.h).
  double budget_seconds = 0.0;
  /// Cases run in a process of their own, so that one that crashes or hangs is an error and the others run on. Not
  /// where this process has threads or a GL context already.
  bool isolate = false;
  int jobs = 1;                           ///< cases that run at once, where they are isolated
  double silent_seconds = 240.0;          ///< an isolated case that gives no sign of life for so long hangs
  std::filesystem::path history;          ///< database of earlier runs; empty: none
  std::vector<ExpectedFailure> expected;  ///< cases that are known to fail
  /// GitHub Actions: annotations on standard output, and report.md appended to the file that GITHUB_STEP_SUMMARY names.
  bool github = false;
  bool quiet = false;                      ///< no progress, no summary
  std::string replay = "./plumbline run";  ///< what a case's name is put behind to repeat it
};

/// Runs the cases and writes cases.jsonl (as it goes), results.json, junit.xml, report.md and index.html into
/// options.out. A case that throws is recorded as an error and the others run on. Throws InputError where --resume
/// meets another run.
RunRecord run_cases(const std::vector<Case>& cases, const RunOptions& options);

/// The end of a run: its place in the history (options.history), its report in options.out, the summary on the
/// terminal.
void finish_run(RunRecord& run, const RunOptions& options);

/// What RunOptions::github asks for, once the report is written.
void tell_github(const RunRecord& run);

/// 0 where everything passed, 1 where a case failed, ended in an error or was left out.
int exit_status(const RunRecord& run);

/// What every run begins with: version, commit, seed, time, machine.
RunRecord begin_record(const RunOptions& options);

}  // namespace plumbline
