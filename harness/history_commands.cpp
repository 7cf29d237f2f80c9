// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that take up finished runs: `history`, `merge`, and `report`, which writes a run's pages again or tells
// two runs apart.
#include <cstdio>
#include <memory>

#include "harness/commands.h"
#include "harness/nights.h"
#include "harness/run.h"
#include "reports/changes_text.h"
#include "reports/format.h"
#include "reports/html.h"
#include "reports/merge.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

struct HistoryArguments {
  std::string file = "plumbline-history.sqlite";
  std::string case_name;
  std::size_t count = 30;
};

int show_history(const HistoryArguments& a) {
  std::error_code error;
  if (!fs::exists(a.file, error))
    throw InputError(a.file + ": no such file; `plumbline nightly` keeps a history, --history FILE names another");
  const History history(a.file);
  if (!a.case_name.empty()) {
    const std::vector<PastCase> answers = history.last_answers(a.case_name, a.count);
    if (!answers.empty()) {
      std::fputs(answers_text(answers).c_str(), stdout);
      return 0;
    }
    std::string alike;
    for (const std::string& name : history.case_names())
      if (name.find(a.case_name) != std::string::npos && alike.size() < 200)
        alike += (alike.empty() ? "" : ", ") + name;
    throw InputError("no run in " + a.file + " asked the case '" + a.case_name + "'" +
                     (alike.empty() ? "; `plumbline list` names cases" : "; there are " + alike));
  }
  const std::vector<PastRun> runs = history.last_runs(a.count);
  std::fputs(runs.empty() ? "no runs yet\n" : runs_text(runs).c_str(), stdout);
  return 0;
}

struct ReportArguments {
  std::string folder;
  std::vector<std::string> diff;
  bool github = false;
};

int report(const ReportArguments& a) {
  if (a.diff.empty()) {
    if (a.folder.empty())
      throw InputError("say which run: `plumbline report DIR`, or `plumbline report --diff BEFORE AFTER`");
    const RunRecord run = read_run(a.folder);
    write_report(run, a.folder);
    std::printf("Report: %s\n", (fs::path(a.folder) / "index.html").string().c_str());
    if (a.github) tell_github(run);
    return 0;
  }
  const RunRecord before = read_run(a.diff[0]), after = read_run(a.diff[1]);
  const RunChanges changes = changes_between(before, after);
  std::printf("before: %s, seed %llu: %s\nafter:  %s, seed %llu: %s\n\n%s", before.started.c_str(),
              static_cast<unsigned long long>(before.seed), headline(summarize(before)).c_str(), after.started.c_str(),
              static_cast<unsigned long long>(after.seed), headline(summarize(after)).c_str(),
              changes_text(changes).c_str());
  return changes.newly_failing.empty() ? 0 : 1;
}

struct MergeArguments {
  std::vector<std::string> folders;
  RunOptions options;
  std::string history = "none";
};

int merge(MergeArguments a) {
  if (a.history != "none") {
    History{a.history};  // before anything is written
    a.options.history = a.history;
  }
  RunRecord run = merge_reports({a.folders.begin(), a.folders.end()}, a.options.out);
  finish_run(run, a.options);
  return exit_status(run);
}

}  // namespace

void add_history_commands(CLI::App& app, Commands& commands) {
  const auto h = std::make_shared<HistoryArguments>();
  CLI::App* history = app.add_subcommand("history", "Show earlier runs, or what one case answered in them");
  history->add_option("CASE", h->case_name, "A case by its whole name: each of its answers, with figures");
  history->add_option("--history", h->file, "Database of earlier runs")->capture_default_str();
  history->add_option("--count", h->count, "How many runs")->check(CLI::Range(1, 1'000'000))->capture_default_str();
  commands.emplace_back(history, [h] { return show_history(*h); });

  const auto r = std::make_shared<ReportArguments>();
  CLI::App* sub = app.add_subcommand("report", "Write the report of a run again from its record, or compare two runs");
  sub->add_option("DIR", r->folder, "The run's folder");
  sub->add_flag("--github", r->github, kGithubHelp);
  sub->add_option("--diff", r->diff, "BEFORE AFTER: folders of two runs; tells what changed, 1 if a case fails newly")
      ->expected(2);
  commands.emplace_back(sub, [r] { return report(*r); });

  const auto m = std::make_shared<MergeArguments>();
  CLI::App* merge_sub = app.add_subcommand("merge", "Make one run and one report of the parts that --shard cut");
  merge_sub->add_option("DIR", m->folders, "Folders of all parts")->required();
  merge_sub->add_option("--out", m->options.out, "Folder for the report")->capture_default_str();
  merge_sub->add_flag("--github", m->options.github, kGithubHelp);
  merge_sub->add_option("--history", m->history, "Database of earlier runs, or `none`")->capture_default_str();
  commands.emplace_back(merge_sub, [m] { return merge(*m); });
}

}  // namespace plumbline
