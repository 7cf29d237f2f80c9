// SPDX-License-Identifier: GPL-3.0-or-later
// Runs cases in processes of their own, several at once: a case that crashes, hangs or loses the driver is an error,
// and the next one gets a new process.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "harness/run.h"
#include "harness/worker_pool.h"

namespace plumbline {

/// Cases by their number, each with the seed that it is to run with.
struct CaseJob {
  std::size_t index = 0;
  std::uint64_t seed = 0;
};

/// What becomes of jobs while they run. All are called from the thread that runs them.
struct JobEvents {
  std::function<bool(const CaseJob&)> may_begin;                   ///< false: the job is left out
  std::function<void(const CaseJob&, double share)> progress;      ///< 0 to 1, of all the jobs
  std::function<void(const CaseJob&, CaseRecord&& record)> ended;  ///< in the order in which they end
};

class CaseRunner {
 public:
  /// `cases` and `options` must outlive this.
  CaseRunner(const std::vector<Case>& cases, const RunOptions& options);
  ~CaseRunner();

  struct DriverName {
    std::string renderer, version;
  };
  /// Throws EnvironmentError where there is no driver.
  DriverName driver();

  /// Runs the jobs, options.jobs at once where cases are isolated. A process goes on with cases of its scene where it
  /// can, since building one takes longer than most cases. Never throws for what a case does.
  void run(const std::vector<CaseJob>& jobs, const JobEvents& events);

 private:
  std::string serve(const std::string& job, const JobProgress& progress);
  CaseRecord run_here(std::size_t index, std::uint64_t seed, const JobProgress& progress);

  void run_one_by_one(const std::vector<CaseJob>& jobs, const JobEvents& events);
  CaseRecord record_of(const CaseJob& job, const WorkerPool::End& end) const;

  const std::vector<Case>& cases_;
  const RunOptions& options_;
  std::unique_ptr<Session> session_;  ///< of this process, where cases are not isolated, or of the worker
  WorkerPool pool_;
};

}  // namespace plumbline
