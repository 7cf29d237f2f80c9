// SPDX-License-Identifier: GPL-3.0-or-later
// Runs one case after the other in a process of their own: a case that crashes, hangs or loses the driver is an error,
// and the next one gets a new process.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "harness/run.h"
#include "harness/worker.h"

namespace plumbline {

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

  /// Runs cases[index] with the run's seed, or another. Never throws for what the case does.
  CaseRecord run(std::size_t index, std::uint64_t seed, const JobProgress& progress);

 private:
  std::string serve(const std::string& job, const JobProgress& progress);
  CaseRecord run_here(std::size_t index, std::uint64_t seed, const JobProgress& progress);

  const std::vector<Case>& cases_;
  const RunOptions& options_;
  std::unique_ptr<Session> session_;  ///< of this process, where cases are not isolated, or of the worker
  std::unique_ptr<Worker> worker_;
};

}  // namespace plumbline
