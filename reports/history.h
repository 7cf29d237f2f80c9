// SPDX-License-Identifier: MIT
// The history of runs: a small database that keeps each run's totals, and each case's status, verdict counts, figures
// and seconds, so that a report can say what changed. The only file that names SQLite is history.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "reports/record.h"
#include "reports/summary.h"

namespace plumbline {

/// One stored run.
struct PastRun {
  std::string started, version, commit;
  std::uint64_t seed = 0;
  double seconds = 0.0;
  RunSummary summary;
};

/// How a run differs from those before it. Each case is held against its own last answer, so that runs of different
/// subsets can follow one another. Names in the order of the run.
struct RunChanges {
  bool first_run = false;                  ///< the history was empty: nothing to compare with
  std::string since;                       ///< when the last run started
  std::vector<std::string> newly_failing;  ///< passed before, fails now
  std::vector<std::string> newly_passing;  ///< failed before, passes now
  std::vector<std::string> still_failing;
  std::vector<std::string> new_cases;   ///< never asked before
  std::vector<std::string> gone_cases;  ///< in the last run, not in this one
};

/// What one case answered in one stored run.
struct PastCase {
  std::string started;  ///< of its run
  CaseStatus status = CaseStatus::passed;
  std::uint64_t rays = 0;
  double seconds = 0.0;
  std::string message;
  VerdictCounts verdicts;
  std::vector<Figure> figures;
};

/// Owns the open database. Throws InputError where the file is damaged, not ours, or of a newer version, and
/// EnvironmentError where the disk refuses or another program holds it for more than ten seconds.
class History {
 public:
  /// Opens `file`, or makes it (and its folder) where it is missing.
  explicit History(const std::filesystem::path& file);
  ~History();
  History(History&&) noexcept;
  History& operator=(History&&) noexcept;

  /// All of the run or nothing of it. The same run (same start, seed and commit) is stored once: a second time replaces
  /// it.
  void append_run(const RunRecord& run);

  /// The last `count` runs, newest first.
  std::vector<PastRun> last_runs(std::size_t count) const;
  /// The last `count` answers of one case, newest first.
  std::vector<PastCase> last_answers(const std::string& case_name, std::size_t count) const;
  /// Compares `run` with what is stored; a stored copy of `run` itself is left out.
  RunChanges changes_since_last(const RunRecord& run) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
