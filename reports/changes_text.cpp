// SPDX-License-Identifier: MIT
#include "reports/changes_text.h"

#include <algorithm>

#include "reports/format.h"

namespace plumbline {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Columns as wide as their widest cell, the first to the left, numbers to the right.
std::string table_text(const Rows& rows, const std::vector<bool>& is_number) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths.resize(std::max(widths.size(), i + 1), 0);
      widths[i] = std::max(widths[i], row[i].size());
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string pad(widths[i] - row[i].size(), ' ');
      line += (i ? "  " : "") + (i < is_number.size() && is_number[i] ? pad + row[i] : row[i] + pad);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string short_time(const std::string& iso) {
  return iso.size() >= 16 && iso[10] == 'T' ? iso.substr(0, 10) + " " + iso.substr(11, 5) : iso;
}

}  // namespace

std::string changes_text(const RunChanges& changes) {
  if (changes.first_run) return "The first run of this history: nothing to compare with.\n";
  std::string text;
  const auto section = [&](const std::string& what, const auto& list, const auto& line) {
    if (list.empty()) return;
    text += what + " (" + grouped(list.size()) + ")\n";
    for (const auto& item : list) text += "  " + line(item) + "\n";
  };
  const auto name = [&](const std::string& case_name) {
    const auto since = std::find_if(changes.failing_since.begin(), changes.failing_since.end(),
                                    [&](const FailingSince& f) { return f.name == case_name; });
    if (since == changes.failing_since.end()) return case_name;
    return case_name + ": " +
           (since->passed.empty()
                ? "never passed"
                : "last passed " + short_time(since->passed) + " UTC" +
                      (since->passed_commit.empty() ? "" : " at " + since->passed_commit.substr(0, 10))) +
           ", failing for " + counted(since->runs, "run");
  };
  const auto plain = [](const std::string& line) { return line; };
  section("newly failing", changes.newly_failing, name);
  section("still failing", changes.still_failing, name);
  section("newly passing", changes.newly_passing, plain);
  std::vector<PooledFigure> found;
  for (const PooledFigure& figure : changes.pooled)
    if (figure.found()) found.push_back(figure);
  section("drifting the same way night after night", found, [](const PooledFigure& f) {
    return f.case_name + ", " + f.figure + ": z = " + value_text(f.z) + " over " + counted(f.nights, "night") +
           " (p = " + value_text(f.p) + ")";
  });
  section("slower than noise explains", changes.slower, [](const SlowerCase& c) {
    return c.name + ": " + duration(c.seconds) + ", " + duration(c.usual) + " in " + counted(c.runs, "run") + " before";
  });
  section("new cases", changes.new_cases, plain);
  section("no longer asked", changes.gone_cases, plain);
  section("new around it", changes.surroundings, plain);
  return text.empty() ? "nothing changed\n" : text;
}

std::string runs_text(const std::vector<PastRun>& newest_first) {
  Rows rows = {{"started (UTC)", "result", "cases", "failed", "rays", "time", "seed", "commit", "driver"}};
  for (auto run = newest_first.rbegin(); run != newest_first.rend(); ++run) {
    const RunSummary& s = run->summary;
    const char* result = s.ok() ? "passed" : s.failed || s.without_verdict ? "FAILED" : "incomplete";
    rows.push_back({short_time(run->started), result, grouped(s.cases), grouped(s.failed), short_count(s.rays),
                    duration(run->seconds), std::to_string(run->seed), run->commit.substr(0, 10), run->driver_version});
  }
  return table_text(rows, {false, false, true, true, true, true, true});
}

std::string answers_text(const std::vector<PastCase>& newest_first) {
  Rows rows = {{"started (UTC)", "status", "rays", "time", "seed", "commit"}};
  std::vector<std::string> figures;
  for (const PastCase& answer : newest_first)
    for (const Figure& figure : answer.figures)
      if (std::find(figures.begin(), figures.end(), figure.name) == figures.end()) figures.push_back(figure.name);
  rows[0].insert(rows[0].end(), figures.begin(), figures.end());
  rows[0].push_back("message");
  for (auto answer = newest_first.rbegin(); answer != newest_first.rend(); ++answer) {
    auto& row = rows.emplace_back();
    row = {short_time(answer->started), std::string(status_name(answer->status)), short_count(answer->rays),
           duration(answer->seconds),   std::to_string(answer->run_seed),         answer->commit.substr(0, 10)};
    for (const std::string& name : figures) {
      const auto figure =
          std::find_if(answer->figures.begin(), answer->figures.end(), [&](const Figure& f) { return f.name == name; });
      row.push_back(figure == answer->figures.end() ? "" : value_text(figure->value));
    }
    row.push_back(answer->message);
  }
  return table_text(rows, {false, false, true, true, true});
}

}  // namespace plumbline
