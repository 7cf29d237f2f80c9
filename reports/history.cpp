// SPDX-License-Identifier: MIT
// See history.h. Tables: run, library of a run, answer (a case in a run), verdict and figure of an answer.
#include "reports/history.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>

#include "scenes/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kApplicationId = 0x506c756d;  // "Plum": tells our databases from others

/// Step i brings version i to version i + 1; a new file takes all of them. A step that has been released is never
/// changed.
constexpr std::array<const char*, History::kSchema> kSteps = {R"sql(
CREATE TABLE run (
  id INTEGER PRIMARY KEY, started TEXT NOT NULL, seed TEXT NOT NULL, commit_id TEXT NOT NULL, version TEXT NOT NULL,
  seconds REAL NOT NULL, cases INTEGER NOT NULL, passed INTEGER NOT NULL, failed INTEGER NOT NULL, errors INTEGER NOT NULL,
  skipped INTEGER NOT NULL, rays INTEGER NOT NULL, without_verdict INTEGER NOT NULL, unfinished INTEGER NOT NULL,
  UNIQUE (started, seed, commit_id));
CREATE TABLE answer (
  id INTEGER PRIMARY KEY, run_id INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE, name TEXT NOT NULL,
  status TEXT NOT NULL, rays INTEGER NOT NULL, seconds REAL NOT NULL, message TEXT NOT NULL, UNIQUE (run_id, name));
CREATE INDEX answer_by_name ON answer (name, run_id);
CREATE TABLE verdict (
  answer_id INTEGER NOT NULL REFERENCES answer (id) ON DELETE CASCADE, name TEXT NOT NULL, rays INTEGER NOT NULL,
  PRIMARY KEY (answer_id, name)) WITHOUT ROWID;
CREATE TABLE figure (
  answer_id INTEGER NOT NULL REFERENCES answer (id) ON DELETE CASCADE, position INTEGER NOT NULL, name TEXT NOT NULL,
  unit TEXT NOT NULL, value REAL, low REAL, high REAL, rounds INTEGER NOT NULL,
  PRIMARY KEY (answer_id, position)) WITHOUT ROWID;
)sql",
                                                              R"sql(
ALTER TABLE run ADD COLUMN command TEXT NOT NULL DEFAULT '';
ALTER TABLE run ADD COLUMN machine TEXT NOT NULL DEFAULT '';
ALTER TABLE run ADD COLUMN driver_renderer TEXT NOT NULL DEFAULT '';
ALTER TABLE run ADD COLUMN driver_version TEXT NOT NULL DEFAULT '';
ALTER TABLE answer ADD COLUMN seed TEXT NOT NULL DEFAULT '';
ALTER TABLE answer ADD COLUMN trace_seconds REAL NOT NULL DEFAULT 0;
CREATE TABLE library (
  run_id INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE, name TEXT NOT NULL, version TEXT NOT NULL,
  PRIMARY KEY (run_id, name)) WITHOUT ROWID;
)sql"};

CaseStatus status_from(std::string_view name) {
  for (const CaseStatus status : {CaseStatus::passed, CaseStatus::failed, CaseStatus::skipped})
    if (name == status_name(status)) return status;
  return CaseStatus::error;
}

/// A time that lasted NaN seconds is no time: the tables want a number.
double number_or_zero(double value) { return value == value ? value : 0.0; }

void bind_identity(Statement& statement, const RunRecord& run) {
  statement.bind(run.started).bind(std::to_string(run.seed)).bind(run.commit);
}
const std::string kNotThis = "NOT (started = ?1 AND run.seed = ?2 AND commit_id = ?3)";

void note_surroundings(const std::string& what, const std::string& before, const std::string& now,
                       std::vector<std::string>& list) {
  // Runs stored before this was kept say nothing.
  if (!before.empty() && before != now) list.push_back(what + ": " + (now.empty() ? "none" : now) + ", was " + before);
}

struct Surroundings {
  std::string version, commit, renderer, driver, machine;
  std::map<std::string, std::string> libraries;
};

std::vector<std::string> new_surroundings(const Surroundings& before, const Surroundings& now) {
  std::vector<std::string> list;
  note_surroundings("Plumbline", before.version, now.version, list);
  note_surroundings("commit", before.commit, now.commit, list);
  note_surroundings("driver", before.renderer, now.renderer, list);
  note_surroundings("driver's version", before.driver, now.driver, list);
  note_surroundings("machine", before.machine, now.machine, list);
  for (const auto& [name, version] : now.libraries)
    if (const auto old = before.libraries.find(name); old != before.libraries.end())
      note_surroundings(name, old->second, version, list);
  return list;
}

Surroundings surroundings_of(const RunRecord& run) {
  return {run.version, run.commit, run.driver_renderer, run.driver_version, run.machine, run.libraries};
}
Surroundings surroundings_of(const PastRun& run) {
  return {run.version, run.commit, run.driver_renderer, run.driver_version, run.machine, run.libraries};
}

/// Whether a case failed when it was last asked; a skipped case says nothing and is not in it.
using FailedBefore = std::map<std::string, bool>;

void compare_cases(const RunRecord& run, const FailedBefore& failed_before, const std::set<std::string>& ever,
                   RunChanges& changes) {
  for (const CaseRecord& record : run.cases) {
    if (!ever.contains(record.name)) changes.new_cases.push_back(record.name);
    const auto before = failed_before.find(record.name);
    if (before == failed_before.end()) continue;
    const CaseStatus status = outcome(record);
    if (is_failure(status)) (before->second ? changes.still_failing : changes.newly_failing).push_back(record.name);
    if (status == CaseStatus::passed && before->second) changes.newly_passing.push_back(record.name);
  }
}

}  // namespace

History::History(const fs::path& file) : database_(file) {
  database_.execute("PRAGMA foreign_keys = ON");
  Transaction transaction(database_);
  const bool is_new = database_.number("SELECT count(*) FROM sqlite_master") == 0;
  if (!is_new && database_.number("PRAGMA application_id") != kApplicationId)
    throw InputError(file.string() + ": a database, but not a history of plumbline's; give another file");
  const std::uint64_t version = is_new ? 0 : database_.number("PRAGMA user_version");
  if (version > kSchema || (!is_new && version == 0))
    throw InputError(file.string() + ": history of version " + std::to_string(version) +
                     ", this plumbline knows versions 1 to " + std::to_string(kSchema) +
                     "; use the plumbline that wrote it, or give another file");
  for (std::uint64_t step = version; step < kSchema; ++step) database_.execute(kSteps[step]);
  if (version < kSchema) {
    database_.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
    database_.execute("PRAGMA user_version = " + std::to_string(kSchema));
  }
  transaction.commit();
}

void History::append_run(const RunRecord& run) {
  const RunSummary total = summarize(run);
  Transaction transaction(database_);
  Statement same(database_, "DELETE FROM run WHERE started = ? AND seed = ? AND commit_id = ?");
  bind_identity(same, run);
  same.run();
  Statement row(database_,
                "INSERT INTO run (started, seed, commit_id, version, command, machine, driver_renderer, "
                "driver_version, seconds, cases, passed, failed, errors, skipped, rays, without_verdict, unfinished) "
                "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  bind_identity(row, run);
  for (const std::string& text : {run.version, run.command, run.machine, run.driver_renderer, run.driver_version})
    row.bind(text);
  row.bind(number_or_zero(run.seconds));
  for (const std::uint64_t count : {total.cases, total.passed, total.failed, total.errors, total.skipped, total.rays,
                                    total.without_verdict, total.unfinished})
    row.bind(count);
  row.run();
  const std::uint64_t run_id = database_.last_row();
  Statement library(database_, "INSERT INTO library (run_id, name, version) VALUES (?, ?, ?)");
  for (const auto& [name, version] : run.libraries) library.bind(run_id).bind(name).bind(version).run();

  Statement answer(database_,
                   "INSERT INTO answer (run_id, name, status, rays, seconds, trace_seconds, seed, message) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  Statement verdict(database_, "INSERT INTO verdict (answer_id, name, rays) VALUES (?, ?, ?)");
  Statement figure(database_,
                   "INSERT INTO figure (answer_id, position, name, unit, value, low, high, rounds) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const CaseRecord& record : run.cases) {
    answer.bind(run_id).bind(record.name).bind(status_name(outcome(record))).bind(record.rays);
    answer.bind(number_or_zero(record.seconds)).bind(number_or_zero(record.trace_seconds));
    answer.bind(std::to_string(record.seed)).bind(record.message).run();
    const std::uint64_t id = database_.last_row();
    for (const auto& [name, rays] : record.verdicts) verdict.bind(id).bind(name).bind(rays).run();
    std::uint64_t position = 0;
    for (const Figure& f : record.figures) {
      figure.bind(id).bind(position++).bind(f.name).bind(f.unit).bind(f.value).bind(f.low).bind(f.high);
      figure.bind(static_cast<std::uint64_t>(std::max(0, f.rounds))).run();
    }
  }
  transaction.commit();
}

std::vector<PastRun> History::last_runs(std::size_t count) const {
  std::vector<PastRun> runs;
  Statement query(database_,
                  "SELECT id, started, version, commit_id, command, machine, driver_renderer, driver_version, seed, "
                  "seconds, cases, passed, failed, errors, skipped, rays, without_verdict, unfinished "
                  "FROM run ORDER BY started DESC, id DESC LIMIT ?");
  query.bind(static_cast<std::uint64_t>(count));
  while (query.step()) {
    const std::uint64_t id = query.count();
    PastRun& run = runs.emplace_back();
    for (std::string* field : {&run.started, &run.version, &run.commit, &run.command, &run.machine,
                               &run.driver_renderer, &run.driver_version})
      *field = query.text();
    run.seed = std::strtoull(query.text().c_str(), nullptr, 10);
    run.seconds = query.real();
    RunSummary& total = run.summary;
    for (std::uint64_t* field : {&total.cases, &total.passed, &total.failed, &total.errors, &total.skipped, &total.rays,
                                 &total.without_verdict, &total.unfinished})
      *field = query.count();
    Statement verdicts(database_,
                       "SELECT verdict.name, sum(verdict.rays) FROM verdict JOIN answer ON answer.id = answer_id "
                       "WHERE run_id = ? GROUP BY verdict.name");
    verdicts.bind(id);
    while (verdicts.step()) {
      const std::string name = verdicts.text();
      total.verdicts[name] = verdicts.count();
    }
    Statement libraries(database_, "SELECT name, version FROM library WHERE run_id = ?");
    libraries.bind(id);
    while (libraries.step()) {
      const std::string name = libraries.text();
      run.libraries[name] = libraries.text();
    }
  }
  return runs;
}

std::vector<PastCase> History::last_answers(const std::string& case_name, std::size_t count,
                                            const RunRecord* except) const {
  static const RunRecord kNone;
  std::vector<PastCase> answers;
  Statement query(database_,
                  "SELECT answer.id, started, commit_id, machine, driver_renderer || ', ' || driver_version, run.seed, "
                  "status, answer.rays, answer.seconds, message FROM answer JOIN run ON run.id = run_id WHERE " +
                      kNotThis + " AND name = ?4 ORDER BY started DESC, run.id DESC LIMIT ?5");
  bind_identity(query, except ? *except : kNone);
  query.bind(case_name).bind(static_cast<std::uint64_t>(count));
  Statement figures(database_,
                    "SELECT name, unit, value, low, high, rounds FROM figure WHERE answer_id = ? ORDER BY position");
  while (query.step()) {
    const std::uint64_t id = query.count();
    PastCase& answer = answers.emplace_back();
    for (std::string* field : {&answer.started, &answer.commit, &answer.machine, &answer.driver}) *field = query.text();
    answer.run_seed = std::strtoull(query.text().c_str(), nullptr, 10);
    answer.status = status_from(query.text());
    answer.rays = query.count();
    answer.seconds = query.real();
    answer.message = query.text();
    Statement verdicts(database_, "SELECT name, rays FROM verdict WHERE answer_id = ?");
    verdicts.bind(id);
    while (verdicts.step()) {
      const std::string name = verdicts.text();
      answer.verdicts[name] = verdicts.count();
    }
    figures.bind(id);
    while (figures.step()) {
      Figure& figure = answer.figures.emplace_back();
      figure.name = figures.text();
      figure.unit = figures.text();
      figure.value = figures.real();
      figure.low = figures.real();
      figure.high = figures.real();
      figure.rounds = static_cast<int>(figures.count());
    }
    figures.run();
  }
  return answers;
}

std::vector<std::string> History::case_names() const {
  std::vector<std::string> names;
  Statement query(database_, "SELECT DISTINCT name FROM answer ORDER BY name");
  while (query.step()) names.push_back(query.text());
  return names;
}

RunChanges History::changes_since_last(const RunRecord& run) const {
  RunChanges changes;
  std::uint64_t last_id = 0;
  {
    Statement last(database_,
                   "SELECT id, started FROM run WHERE " + kNotThis + " ORDER BY started DESC, id DESC LIMIT 1");
    bind_identity(last, run);
    if (!last.step()) {
      changes.first_run = true;
      return changes;
    }
    last_id = last.count();
    changes.since = last.text();
  }
  // A last run that is this one is followed by the one that it is compared with.
  for (const PastRun& past : last_runs(2))
    if (past.started == changes.since) {
      changes.surroundings = new_surroundings(surroundings_of(past), surroundings_of(run));
      break;
    }
  {
    Statement pass(database_, "SELECT started FROM run WHERE " + kNotThis +
                                  " AND failed = 0 AND without_verdict = 0 AND unfinished = 0 AND passed > 0 "
                                  "ORDER BY started DESC, id DESC LIMIT 1");
    bind_identity(pass, run);
    if (pass.step()) changes.last_pass = pass.text();
  }

  FailedBefore failed_before;
  std::set<std::string> ever;
  std::map<std::string, FailingSince> since;
  {
    // Later rows replace earlier ones.
    Statement answers(
        database_, "SELECT name, status, started, commit_id FROM answer JOIN run ON run.id = run_id WHERE " + kNotThis +
                       " ORDER BY started, run.id");
    bind_identity(answers, run);
    while (answers.step()) {
      const std::string name = answers.text();
      const CaseStatus status = status_from(answers.text());
      ever.insert(name);
      if (status == CaseStatus::skipped) continue;
      failed_before[name] = is_failure(status);
      FailingSince& past = since[name];
      if (is_failure(status)) {
        ++past.runs;
      } else {
        past = {};
        past.passed = answers.text();
        past.passed_commit = answers.text();
      }
    }
  }
  compare_cases(run, failed_before, ever, changes);
  std::set<std::string> now;
  for (const CaseRecord& record : run.cases) {
    now.insert(record.name);
    const auto past = since.find(record.name);
    if (!is_failure(outcome(record)) || past == since.end()) continue;
    changes.failing_since.push_back(past->second);
    changes.failing_since.back().name = record.name;
  }
  Statement last_cases(database_, "SELECT name FROM answer WHERE run_id = ? ORDER BY id");
  last_cases.bind(last_id);
  while (last_cases.step())
    if (const std::string name = last_cases.text(); !now.contains(name)) changes.gone_cases.push_back(name);
  return changes;
}

RunChanges changes_between(const RunRecord& before, const RunRecord& after) {
  RunChanges changes;
  changes.since = before.started;
  if (summarize(before).ok()) changes.last_pass = before.started;
  changes.surroundings = new_surroundings(surroundings_of(before), surroundings_of(after));
  FailedBefore failed_before;
  std::set<std::string> ever, now;
  for (const CaseRecord& record : before.cases) {
    ever.insert(record.name);
    if (const CaseStatus status = outcome(record); status != CaseStatus::skipped)
      failed_before[record.name] = is_failure(status);
  }
  compare_cases(after, failed_before, ever, changes);
  for (const CaseRecord& record : after.cases) now.insert(record.name);
  for (const CaseRecord& record : before.cases)
    if (!now.contains(record.name)) changes.gone_cases.push_back(record.name);
  return changes;
}

}  // namespace plumbline
