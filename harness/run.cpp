// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/run.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>
#include <thread>
#include <unordered_map>

#include "harness/case_runner.h"
#include "harness/clock.h"
#include "harness/deeper.h"
#include "harness/nights.h"
#include "harness/progress.h"
#include "harness/shards.h"
#include "harness/version.h"
#include "reports/changes_text.h"
#include "reports/format.h"
#include "reports/github.h"
#include "reports/history.h"
#include "reports/html.h"
#include "reports/journal.h"
#include "reports/sha256.h"
#include "reports/text_summary.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::string machine() {
  std::string model = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

/// The command that begins a run and the one that goes on with it differ in this alone.
std::string without_resume(std::string command) {
  if (const std::size_t at = command.find(" --resume"); at != std::string::npos) command.erase(at, 9);
  return command;
}

/// The driver's faults as the driver cases found them.
std::vector<DriverFinding> findings_of(const RunRecord& run) {
  std::vector<DriverFinding> findings;
  for (const CaseRecord& c : run.cases) {
    if (c.feature != "driver" || c.status == CaseStatus::error || c.figures.empty()) continue;
    findings.push_back({c.name.substr(c.name.find('.') + 1), c.figures.front().value != 0.0, c.message});
  }
  return findings;
}

/// Tells what a run asks from what another one does: names, rays and scenes of its cases.
std::string digest_of(const std::vector<Case>& cases) {
  std::string text;
  for (const Case& c : cases) text += c.name + " " + std::to_string(c.rays) + "\n";
  return sha256(text);
}

/// The statistics of all nights together, as a case of its own: a bias that only they show fails the run.
CaseRecord pooled_case(const std::vector<PooledFigure>& figures) {
  CaseRecord record;
  record.name = "history.pooled";
  record.feature = "history";
  record.proves = "No statistic leans to the same side night after night.";
  TableRecord& table = record.tables.emplace_back();
  table.title = "Statistics pooled over nights";
  table.columns = {"case", "statistic", "nights", "z", "p", "found below"};
  std::size_t found = 0;
  for (const PooledFigure& f : figures) {
    table.rows.push_back(
        {f.case_name, f.figure, std::to_string(f.nights), value_text(f.z), value_text(f.p), value_text(f.threshold)});
    if (!f.found()) continue;
    ++found;
    record.message += (found > 1 ? "; " : "") + f.case_name + ", " + f.figure + ": z = " + value_text(f.z) + " over " +
                      counted(f.nights, "night");
  }
  if (found > 0) record.status = CaseStatus::failed;
  if (found == 0) record.message = counted(figures.size(), "statistic") + " over up to 30 nights";
  return record;
}

}  // namespace

RunRecord begin_record(const RunOptions& options) {
  RunRecord run;
  run.version = version();
  run.commit = commit();
  run.command = options.command;
  run.seed = options.seed;
  run.started = utc_now();
  run.machine = machine();
  run.libraries = library_versions();
  return run;
}

RunRecord run_cases(const std::vector<Case>& all, const RunOptions& options) {
  const auto start = Clock::now();
  if (!options.history.empty())
    History{options.history};  // one that cannot be used is told before the night, not after
  const std::vector<Case> cases = options.shards > 1 ? shard_of(all, options.shard, options.shards) : all;
  CaseRunner runner(cases, options);
  RunRecord run = begin_record(options);
  run.planned_cases = cases.size();
  if (options.shards > 1) run.shard = {options.shard, options.shards, all.size(), digest_of(all)};
  const CaseRunner::DriverName driver = runner.driver();
  run.driver_renderer = driver.renderer;
  run.driver_version = driver.version;

  std::set<std::string> done;
  double spent_before = 0.0;
  // A run that was killed before it recorded anything has nothing to go on with.
  const bool resumes = options.resume && has_journal(options.out);
  if (options.resume && !resumes && !options.quiet)
    std::fprintf(stderr, "plumbline: no run in %s to go on with: it is begun\n", options.out.string().c_str());
  Journal journal = [&] {
    if (!resumes) {
      Journal begun = Journal::begin(options.out, run);
      // What an earlier run left must not stand for this one, should it be killed.
      for (const char* old : {"index.html", "results.json", "junit.xml", "report.md"}) {
        std::error_code ignored;
        std::filesystem::remove(options.out / old, ignored);
      }
      return begun;
    }
    RunRecord earlier;
    Journal opened = Journal::resume(options.out, earlier);
    if (earlier.seed != run.seed || earlier.commit != run.commit || earlier.planned_cases != run.planned_cases ||
        without_resume(earlier.command) != without_resume(run.command))
      throw InputError(options.out.string() + " holds another run (seed " + std::to_string(earlier.seed) + ", commit " +
                       earlier.commit + ", " + std::to_string(earlier.planned_cases) +
                       " cases); resume it with the command that began it, `" + earlier.command +
                       "`, or choose another --out");
    run.started = earlier.started;
    run.cases = earlier.cases;
    // Cases ran side by side: what they took together was spent in less.
    const double together = options.isolate ? std::max(1, options.jobs) : 1;
    for (const CaseRecord& c : run.cases) done.insert(c.name), spent_before += c.seconds / together;
    return opened;
  }();

  Progress progress;
  const auto spent = [&] { return spent_before + seconds_since(start); };
  const auto tell = [&](const CaseRecord& record) {
    if (options.quiet || (record.status != CaseStatus::failed && record.status != CaseStatus::error)) return;
    progress.clear();
    std::fprintf(stderr, "%s %s: %s\n  replay: %s\n", record.status == CaseStatus::failed ? "FAILED" : "ERROR",
                 record.name.c_str(), record.message.c_str(), record.replay.c_str());
  };
  std::unordered_map<std::string, std::size_t> number;  // of a case, by its name
  for (std::size_t i = 0; i < cases.size(); ++i) number.emplace(cases[i].name, i);
  std::vector<CaseJob> jobs;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (done.count(cases[i].name) == 0) jobs.push_back({i, options.seed});
  runner.run(jobs, {[&](const CaseJob&) { return options.budget_seconds <= 0.0 || spent() <= options.budget_seconds; },
                    [&](const CaseJob& job, double share) {
                      const double before = static_cast<double>(done.size());
                      const double all_share =
                          (before + share * static_cast<double>(jobs.size())) / static_cast<double>(cases.size());
                      if (!options.quiet) progress.show(all_share, cases[job.index].name);
                    },
                    [&](const CaseJob&, CaseRecord&& record) {
                      judge_by_expectation(options.expected, driver.renderer + ", " + driver.version,
                                           run.started.substr(0, 10), record);
                      tell(record);
                      journal.append(record);
                      run.cases.push_back(std::move(record));
                    }});
  // Cases end in any order; the record has that of the catalogue.
  std::sort(run.cases.begin(), run.cases.end(),
            [&](const CaseRecord& a, const CaseRecord& b) { return number.at(a.name) < number.at(b.name); });
  const auto deepen = [&](const std::vector<std::size_t>& numbers) {
    bool any = false;
    std::vector<CaseJob> passes;
    for (const std::size_t i : numbers) passes.push_back({i, pass_seed(options.seed, 1 + passes_of(run.cases[i]))});
    runner.run(passes, {[&](const CaseJob& job) {
                          const CaseRecord& record = run.cases[job.index];
                          const double cost = record.seconds / static_cast<double>(1 + passes_of(record));
                          return spent() + cost <= options.budget_seconds;
                        },
                        [&](const CaseJob& job, double) {
                          if (!options.quiet)
                            progress.show(spent() / options.budget_seconds, "more rays: " + cases[job.index].name);
                        },
                        [&](const CaseJob& job, CaseRecord&& next) {
                          CaseRecord& record = run.cases[job.index];
                          tell(next);
                          add_pass(record, std::move(next));
                          journal.append(record);
                          any = true;
                        }});
    return any;
  };
  // Further passes only where every case has had its first: then the number of a case is its place in the record.
  while (options.budget_seconds > 0.0 && run.cases.size() == cases.size() && spent() < options.budget_seconds &&
         deepen(worth_another_pass(cases, run.cases))) {
  }
  progress.clear();
  run.findings = findings_of(run);
  run.seconds = spent();

  finish_run(run, options);
  return run;
}

void finish_run(RunRecord& run, const RunOptions& options) {
  ReportOptions report;
  if (!options.history.empty()) {
    try {
      History history(options.history);
      report.changes = changes_since(run, history);
      report.past = history.last_runs(30);
      if (!report.changes->pooled.empty()) run.cases.push_back(pooled_case(report.changes->pooled));
      history.append_run(run);
    } catch (const std::exception& error) {  // the run's own report matters more
      std::fprintf(stderr, "plumbline: the history is left out: %s\n", error.what());
    }
  }
  write_report(run, options.out, report);
  if (!options.quiet) {
    if (report.changes && !report.changes->first_run)
      std::printf("Since the run of %s\n%s\n", report.changes->since.c_str(), changes_text(*report.changes).c_str());
    std::fputs(text_summary(run, {isatty(STDOUT_FILENO) != 0, 20}).c_str(), stdout);
    std::printf("Report: %s\n", (options.out / "index.html").string().c_str());
  }
  if (options.github) tell_github(run);
}

void tell_github(const RunRecord& run) {
  std::fputs(github_annotations(run).c_str(), stdout);
  const char* file = std::getenv("GITHUB_STEP_SUMMARY");
  if (file == nullptr || *file == '\0') return;
  std::ofstream summary(file, std::ios::app | std::ios::binary);
  summary << markdown_summary(run) << "\n";
  summary.close();
  if (!summary)  // the verdict matters more
    std::fprintf(stderr, "plumbline: the step summary is left out: %s cannot be written\n", file);
}

int exit_status(const RunRecord& run) { return summarize(run).ok() ? 0 : 1; }

}  // namespace plumbline
