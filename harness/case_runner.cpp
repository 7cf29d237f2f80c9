// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/case_runner.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>
#include <utility>

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

/// The driver keeps what it has compiled for every program and state, some gigabytes after a night's programs. A
/// process that holds more than this is replaced between two cases.
constexpr std::uint64_t kMostResident = std::uint64_t{3} << 29;

}  // namespace

CaseRunner::CaseRunner(const std::vector<Case>& cases, const RunOptions& options)
    : cases_(cases),
      options_(options),
      pool_(static_cast<std::size_t>(std::max(1, options.jobs)),
            [this](const std::string& job, const JobProgress& progress) { return serve(job, progress); }) {}
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
    bool is_asked = false;
    const auto ask_once = [&](std::size_t) -> std::optional<WorkerPool::Job> {
      if (std::exchange(is_asked, true)) return std::nullopt;
      return WorkerPool::Job{kAskDriver, options_.silent_seconds};
    };
    pool_.run({ask_once, [](std::size_t, double) {},
               [&](std::size_t, const WorkerPool::End& end) {
                 if (end.is_dead) throw EnvironmentError("the GL driver cannot be started: its process " + end.failure);
                 if (!end.failure.empty()) throw EnvironmentError(end.failure);
                 text = end.answer;
                 return true;
               }});
  } else {
    text = serve(kAskDriver, [](double) {});
  }
  const std::size_t line = text.find('\n');
  return {text.substr(0, line), text.substr(line + 1)};
}

CaseRecord CaseRunner::record_of(const CaseJob& job, const WorkerPool::End& end) const {
  CaseRecord record = begun(cases_.at(job.index), job.seed, options_);
  std::string failure = (end.is_dead ? "the case " : "") + end.failure;
  if (end.failure.empty()) {
    try {
      return case_from_json(end.answer, record.name, 1);
    } catch (const std::exception& error) {
      failure = error.what();
    }
  }
  record.status = CaseStatus::error;
  record.message = failure;
  record.seconds = end.seconds;
  return record;
}

namespace {

/// Which of the jobs not begun a place takes: the next one after its last where that is of the same scene; else the
/// first whose scene no other place is at; else the first.
std::size_t job_for(const std::vector<CaseJob>& jobs, const std::vector<Case>& cases, const std::vector<bool>& begun,
                    std::optional<std::size_t> last, const std::set<std::string>& scenes_of_others) {
  const auto scene = [&](std::size_t position) -> const std::string& { return cases[jobs[position].index].scene; };
  if (last && *last + 1 < jobs.size() && !begun[*last + 1] && scene(*last + 1) == scene(*last)) return *last + 1;
  std::size_t first = jobs.size();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (begun[i]) continue;
    if (scenes_of_others.count(scene(i)) == 0) return i;
    first = std::min(first, i);
  }
  return first;
}

}  // namespace

void CaseRunner::run_one_by_one(const std::vector<CaseJob>& jobs, const JobEvents& events) {
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!events.may_begin(jobs[i])) continue;
    const auto progress = [&](double share) {
      events.progress(jobs[i], (static_cast<double>(i) + share) / static_cast<double>(jobs.size()));
    };
    progress(0.0);
    events.ended(jobs[i], run_here(jobs[i].index, jobs[i].seed, progress));
  }
}

void CaseRunner::run(const std::vector<CaseJob>& jobs, const JobEvents& events) {
  if (!options_.isolate) {
    run_one_by_one(jobs, events);
    return;
  }
  struct Place {
    std::optional<std::size_t> position;  ///< of its job among all of them, or of the last one
    bool is_busy = false;
    double share = 0.0;  ///< of the job that is done
  };
  std::vector<Place> places(static_cast<std::size_t>(std::max(1, options_.jobs)));
  std::vector<bool> begun(jobs.size(), false);
  std::size_t left = jobs.size();
  const auto tell = [&](std::size_t place) {
    double done = static_cast<double>(jobs.size() - left);
    for (const Place& p : places)
      if (p.is_busy) done += p.share - 1.0;
    events.progress(jobs[*places[place].position], done / static_cast<double>(jobs.size()));
  };
  const auto next = [&](std::size_t place) -> std::optional<WorkerPool::Job> {
    while (left > 0) {
      std::set<std::string> scenes_of_others;
      for (const Place& other : places)
        if (other.is_busy) scenes_of_others.insert(cases_[jobs[*other.position].index].scene);
      const std::size_t position = job_for(jobs, cases_, begun, places[place].position, scenes_of_others);
      begun[position] = true, --left;
      const CaseJob& job = jobs[position];
      if (!events.may_begin(job)) continue;
      places[place] = {position, true, 0.0};
      tell(place);
      return WorkerPool::Job{std::to_string(job.index) + " " + std::to_string(job.seed), options_.silent_seconds};
    }
    return std::nullopt;
  };
  pool_.run({next,
             [&](std::size_t place, double share) {
               places[place].share = share;
               tell(place);
             },
             [&](std::size_t place, const WorkerPool::End& end) {
               places[place].is_busy = false;
               const CaseJob& job = jobs[*places[place].position];
               CaseRecord record = record_of(job, end);
               // Else the next case begins afresh.
               const bool goes_on = record.status != CaseStatus::error && end.resident_bytes < kMostResident;
               events.ended(job, std::move(record));
               return goes_on;
             }});
}

}  // namespace plumbline
