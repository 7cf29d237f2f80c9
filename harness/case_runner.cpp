// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/case_runner.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>

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

/// A worker, and the job that it has.
struct CaseRunner::Place {
  std::unique_ptr<Worker> worker;
  std::optional<CaseJob> job;
  double share = 0.0;  ///< of it that is done
  Clock::time_point start{};
};

CaseRunner::CaseRunner(const std::vector<Case>& cases, const RunOptions& options) : cases_(cases), options_(options) {
  for (int i = 0; i < (options.isolate ? std::max(1, options.jobs) : 1); ++i)
    places_.push_back(std::make_unique<Place>());
}
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
    std::unique_ptr<Worker>& worker = places_.front()->worker;
    worker = std::make_unique<Worker>([this](const std::string& job, const JobProgress& p) { return serve(job, p); });
    Worker::Death death;
    const auto answer = worker->ask(
        kAskDriver, options_.silent_seconds, [](double) {}, death);
    if (!answer) {
      worker.reset();
      throw EnvironmentError("the GL driver cannot be started: its process " + death.how);
    }
    text = *answer;
  } else {
    text = serve(kAskDriver, [](double) {});
  }
  const std::size_t line = text.find('\n');
  return {text.substr(0, line), text.substr(line + 1)};
}

void CaseRunner::begin(Place& place, const CaseJob& job) {
  place.job = job, place.share = 0.0, place.start = Clock::now();
  if (!place.worker)
    place.worker =
        std::make_unique<Worker>([this](const std::string& text, const JobProgress& p) { return serve(text, p); });
  place.worker->give(std::to_string(job.index) + " " + std::to_string(job.seed), options_.silent_seconds);
}

/// Takes what the worker has to tell; true where that ends the job.
bool CaseRunner::has_ended(Place& place, const JobProgress& progress, CaseRecord& record) {
  record = begun(cases_.at(place.job->index), place.job->seed, options_);
  try {
    std::string answer;
    Worker::Death death;
    switch (place.worker->news(progress, answer, death)) {
      case Worker::News::none:
      case Worker::News::alive:
        return false;
      case Worker::News::answer:
        record = case_from_json(answer, record.name, 1);
        break;
      case Worker::News::death:
        record.status = CaseStatus::error;
        record.message = "the case " + death.how;
    }
  } catch (const std::exception& error) {
    record.status = CaseStatus::error;
    record.message = error.what();
  }
  if (record.status == CaseStatus::error) {
    place.worker.reset();
    record.seconds = seconds_since(place.start);
  }
  place.job.reset();
  return true;
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
  std::vector<bool> begun(jobs.size(), false);
  std::vector<std::optional<std::size_t>> last(places_.size());
  std::size_t left = jobs.size();
  const auto tell = [&](const CaseJob& job) {
    double done = static_cast<double>(jobs.size() - left);
    for (const auto& place : places_)
      if (place->job) done += place->share - 1.0;
    events.progress(job, done / static_cast<double>(jobs.size()));
  };
  for (;;) {
    std::vector<Worker*> busy;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      Place& place = *places_[k];
      while (!place.job && left > 0) {
        std::set<std::string> scenes_of_others;
        for (const auto& other : places_)
          if (other->job) scenes_of_others.insert(cases_[other->job->index].scene);
        const std::size_t position = job_for(jobs, cases_, begun, last[k], scenes_of_others);
        begun[position] = true, --left;
        if (!events.may_begin(jobs[position])) continue;
        last[k] = position;
        begin(place, jobs[position]);
        tell(jobs[position]);
      }
      if (place.job) busy.push_back(place.worker.get());
    }
    if (busy.empty()) return;
    Worker::wait(busy);
    for (const auto& place : places_) {
      if (!place->job) continue;
      const CaseJob job = *place->job;
      const auto progress = [&](double share) {
        place->share = share;
        tell(job);
      };
      CaseRecord record;
      if (has_ended(*place, progress, record)) events.ended(job, std::move(record));
    }
  }
}

}  // namespace plumbline
