// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/case_runner.h"

#include <cstdlib>

#include "harness/clock.h"
#include "reports/json.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// The record of a case before it has run.
CaseRecord begun(const Case& c, std::uint64_t seed, const RunOptions& options) {
  CaseRecord record;
  record.name = c.name, record.feature = c.feature, record.scene = c.scene, record.family = c.family;
  record.proves = c.proves, record.paper = c.paper;
  record.seed = case_seed(seed, c.name);
  record.replay = options.replay + " " + c.name + " --seed " + std::to_string(seed) +
                  (c.rays ? " --rays " + std::to_string(c.rays) : "");
  return record;
}

constexpr const char* kAskDriver = "driver";

}  // namespace

CaseRunner::CaseRunner(const std::vector<Case>& cases, const RunOptions& options) : cases_(cases), options_(options) {}
CaseRunner::~CaseRunner() = default;

CaseRecord CaseRunner::run_here(std::size_t index, std::uint64_t seed, const JobProgress& progress) {
  const Case& c = cases_.at(index);
  CaseRecord record = begun(c, seed, options_);
  const auto start = Clock::now();
  try {
    if (!session_) session_ = std::make_unique<Session>();
    CaseContext context{*session_, seed, options_.out, progress};
    c.run(context, c, record);
  } catch (const std::exception& error) {
    record.status = CaseStatus::error;
    record.message = error.what();
    session_.reset();  // whatever it was, the next case begins afresh
  }
  record.seconds = seconds_since(start);
  return record;
}

std::string CaseRunner::serve(const std::string& job, const JobProgress& progress) {
  if (job == kAskDriver) {
    if (!session_) session_ = std::make_unique<Session>();
    return session_->context().renderer() + "\n" + session_->context().version();
  }
  char* end = nullptr;
  const auto index = static_cast<std::size_t>(std::strtoull(job.c_str(), &end, 10));
  return case_to_json(run_here(index, std::strtoull(end, nullptr, 10), progress));
}

CaseRunner::DriverName CaseRunner::driver() {
  std::string text;
  if (options_.isolate) {
    if (!worker_)
      worker_ =
          std::make_unique<Worker>([this](const std::string& job, const JobProgress& p) { return serve(job, p); });
    Worker::Death death;
    const auto answer = worker_->ask(
        kAskDriver, options_.silent_seconds, [](double) {}, death);
    if (!answer) {
      worker_.reset();
      throw EnvironmentError("the GL driver cannot be started: its process " + death.how);
    }
    text = *answer;
  } else {
    text = serve(kAskDriver, [](double) {});
  }
  const std::size_t line = text.find('\n');
  return {text.substr(0, line), text.substr(line + 1)};
}

CaseRecord CaseRunner::run(std::size_t index, std::uint64_t seed, const JobProgress& progress) {
  if (!options_.isolate) return run_here(index, seed, progress);
  CaseRecord record = begun(cases_.at(index), seed, options_);
  const auto start = Clock::now();
  try {
    if (!worker_)
      worker_ =
          std::make_unique<Worker>([this](const std::string& job, const JobProgress& p) { return serve(job, p); });
    Worker::Death death;
    const auto answer =
        worker_->ask(std::to_string(index) + " " + std::to_string(seed), options_.silent_seconds, progress, death);
    if (answer) {
      record = case_from_json(*answer, record.name, 1);
    } else {
      record.status = CaseStatus::error;
      record.message = "the case " + death.how;
    }
  } catch (const std::exception& error) {
    record.status = CaseStatus::error;
    record.message = error.what();
  }
  if (record.status == CaseStatus::error) {
    worker_.reset();
    record.seconds = seconds_since(start);
  }
  return record;
}

}  // namespace plumbline
