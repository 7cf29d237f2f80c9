// SPDX-License-Identifier: MIT
// The history of runs: a small database that keeps each run's totals, driver, libraries and machine, and each case's
// status, verdict counts, figures and times, so that a report can say what changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reports/database.h"
#include "reports/record.h"
#include "reports/summary.h"

namespace plumbline {

/// One stored run.
struct PastRun {
  std::string started, version, commit;
  std::uint64_t seed = 0;
  double seconds = 0.0;
  std::string driver_renderer, driver_version, machine, command;  ///< empty in runs stored before they were kept
  std::map<std::string, std::string> libraries;                   ///< name to version
  RunSummary summary;
};

/// When a case that fails now was right last.
struct FailingSince {
  std::string name;
  std::string passed, passed_commit;  ///< of the last run in which it passed; empty: never, as far as is known
  std::size_t runs = 1;               ///< that it has failed in since, this one included
};

/// A case that took longer than its own past explains.
struct SlowerCase {
  std::string name;
  double seconds = 0.0, usual = 0.0;  ///< now; the geometric mean of before, at the speed of this night
  std::size_t runs = 0;               ///< that `usual` was taken from
};

/// A statistic of a case, pooled over nights.
struct PooledFigure {
  std::string case_name, figure;
  std::size_t nights = 0;
  double z = 0.0;          ///< sum of the nights' z over the square root of their number
  double p = 1.0;          ///< of z or a more extreme one, if nothing is wrong
  double threshold = 0.0;  ///< p below it is found
  bool found() const { return p < threshold; }
};

/// How a run differs from those before it. Each case is held against its own last answer, so that runs of different
/// subsets can follow one another. Names in the order of the run.
struct RunChanges {
  bool first_run = false;                  ///< the history was empty: nothing to compare with
  std::string since;                       ///< when the last run started
  std::string last_pass;                   ///< when the last run that passed as a whole started; empty: there is none
  std::vector<std::string> newly_failing;  ///< passed before, fails now
  std::vector<std::string> newly_passing;  ///< failed before, passes now
  std::vector<std::string> still_failing;
  std::vector<std::string> new_cases;       ///< never asked before
  std::vector<std::string> gone_cases;      ///< in the last run, not in this one
  std::vector<FailingSince> failing_since;  ///< every failing case that was asked before
  std::vector<std::string> surroundings;    ///< "Embree: 3.13.5, was 3.13.4": what else is new since the last run
  std::vector<SlowerCase> slower;           ///< filled by harness/nights.h
  double night_speed = 1.0;                 ///< how much longer cases took than usual, in the middle; likewise
  std::vector<PooledFigure> pooled;         ///< likewise: every statistic, found or not
};

/// What one case answered in one stored run.
struct PastCase {
  std::string started, commit;  ///< of its run
  std::string machine, driver;  ///< likewise; the driver with its version
  std::uint64_t run_seed = 0;
  CaseStatus status = CaseStatus::passed;
  std::uint64_t rays = 0;
  double seconds = 0.0;
  std::string message;
  VerdictCounts verdicts;
  std::vector<Figure> figures;
};

/// Owns the open database. Throws InputError where the file is damaged, not ours, or of a newer version, and is left as
/// it is then; EnvironmentError where the disk refuses or another program holds it for more than ten seconds.
class History {
 public:
  static constexpr std::uint64_t kSchema = 2;  ///< version of the tables

  /// Opens `file`, or makes it (and its folder) where it is missing. Tables of an older version are brought up to
  /// kSchema, all of them or none.
  explicit History(const std::filesystem::path& file);

  /// All of the run or nothing of it. The same run (same start, seed and commit) is stored once: a second time replaces
  /// it.
  void append_run(const RunRecord& run);

  /// The last `count` runs, newest first.
  std::vector<PastRun> last_runs(std::size_t count) const;
  /// The last `count` answers of one case, newest first; those of `except` are left out.
  std::vector<PastCase> last_answers(const std::string& case_name, std::size_t count,
                                     const RunRecord* except = nullptr) const;
  /// Names of all cases that were ever asked, in alphabetical order.
  std::vector<std::string> case_names() const;
  /// Compares `run` with what is stored; a stored copy of `run` itself is left out.
  RunChanges changes_since_last(const RunRecord& run) const;

 private:
  Database database_;
};

/// What differs between two runs that are both at hand; `since` and `last_pass` are of `before`.
RunChanges changes_between(const RunRecord& before, const RunRecord& after);

}  // namespace plumbline
