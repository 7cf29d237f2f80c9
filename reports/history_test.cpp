// SPDX-License-Identifier: MIT
// The history keeps runs, compares them case by case, and refuses files that are not its own.
#include "reports/history.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "reports/example_run.h"
#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

RunRecord run_of(const std::string& started, const std::vector<std::pair<std::string, CaseStatus>>& cases) {
  RunRecord run;
  run.started = started;
  run.seed = 18446744073709551615ull;
  for (const auto& [name, status] : cases) {
    CaseRecord& record = run.cases.emplace_back();
    record.name = name;
    record.status = status;
  }
  return run;
}

constexpr auto kPassed = CaseStatus::passed, kFailed = CaseStatus::failed, kSkipped = CaseStatus::skipped,
               kError = CaseStatus::error;
using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("history: runs come back, newest first, after closing the file") {
  TemporaryFolder folder;
  const auto file = folder.path / "made" / "history.sqlite";
  RunRecord run = example_run();
  run.cases.back().figures = {{"ratio", "1", 0.5, 0.4, 0.6, 7}, {"none", "s", std::nan("")}};
  run.seconds = std::nan("");
  {
    History history(file);
    CHECK(history.last_runs(5).empty());
    history.append_run(run_of("2026-11-21T03:00:00Z", {{"a", kPassed}}));
    history.append_run(run);
    history.append_run(run);  // a report written twice is one run
  }
  const History history(file);
  const auto runs = history.last_runs(5);
  REQUIRE(runs.size() == 2);
  CHECK(runs[0].started == run.started);
  CHECK(runs[0].seed == run.seed);
  CHECK(runs[1].seed == 18446744073709551615ull);
  CHECK(runs[0].summary.rays == summarize(run).rays);
  CHECK(runs[0].summary.failed == 3);
  CHECK(runs[0].summary.verdicts == summarize(run).verdicts);
  CHECK_FALSE(runs[0].summary.ok());
  CHECK(runs[1].summary.ok());
  CHECK(history.last_runs(1).size() == 1);

  const auto answers = history.last_answers(run.cases.back().name, 9);
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].status == run.cases.back().status);
  CHECK(answers[0].verdicts == run.cases.back().verdicts);
  CHECK(answers[0].seconds == run.cases.back().seconds);
  REQUIRE(answers[0].figures.size() == 2);
  CHECK(answers[0].figures[0].rounds == 7);
  CHECK(std::isnan(answers[0].figures[1].value));
}

TEST_CASE("history: each case is held against its own last answer") {
  TemporaryFolder folder;
  History history(folder.path / "history.sqlite");
  const RunRecord today = run_of("2026-11-22T03:00:00Z", {{"breaks", kFailed},
                                                          {"heals", kPassed},
                                                          {"stays_bad", kError},
                                                          {"fine", kPassed},
                                                          {"new", kFailed},
                                                          {"not_asked_last", kFailed},
                                                          {"skipped_last", kPassed}});
  CHECK(history.changes_since_last(today).first_run);
  history.append_run(
      run_of("2026-11-20T03:00:00Z", {{"not_asked_last", kPassed}, {"skipped_last", kFailed}, {"breaks", kFailed}}));
  history.append_run(run_of("2026-11-21T03:00:00Z", {{"breaks", kPassed},
                                                     {"heals", kFailed},
                                                     {"stays_bad", kFailed},
                                                     {"fine", kPassed},
                                                     {"skipped_last", kSkipped},
                                                     {"gone", kPassed}}));
  for (int stored = 0; stored < 2; ++stored) {
    const RunChanges changes = history.changes_since_last(today);
    CHECK_FALSE(changes.first_run);
    CHECK(changes.since == "2026-11-21T03:00:00Z");
    CHECK(changes.newly_failing == Names{"breaks", "not_asked_last"});
    CHECK(changes.newly_passing == Names{"heals", "skipped_last"});
    CHECK(changes.still_failing == Names{"stays_bad"});
    CHECK(changes.new_cases == Names{"new"});
    CHECK(changes.gone_cases == Names{"gone"});
    history.append_run(today);  // the run itself is not what it is compared with
  }
}

TEST_CASE("history: a run is stored whole or not at all") {
  TemporaryFolder folder;
  History history(folder.path / "history.sqlite");
  CHECK_THROWS_AS(history.append_run(run_of("2026-11-22T03:00:00Z", {{"twice", kPassed}, {"twice", kPassed}})),
                  InputError);
  CHECK(history.last_runs(9).empty());
  history.append_run(run_of("2026-11-22T03:00:00Z", {{"once", kPassed}}));
  CHECK(history.last_runs(9).size() == 1);
}

TEST_CASE("history: driver, libraries and machine are kept, and what is new among them is told") {
  TemporaryFolder folder;
  History history(folder.path / "history.sqlite");
  RunRecord run = example_run();
  run.libraries = {{"Embree", "3.13.5"}, {"CGAL", "5.5.1"}};
  history.append_run(run);
  const PastRun back = history.last_runs(1).at(0);
  CHECK(back.libraries == run.libraries);
  CHECK(back.driver_renderer == run.driver_renderer);
  CHECK(back.driver_version == run.driver_version);
  CHECK(back.machine == run.machine);
  CHECK(back.command == run.command);
  const RunRecord before = run;
  run.started = "2030-01-01T00:00:00Z";
  CHECK(history.changes_since_last(run).surroundings.empty());
  run.libraries["Embree"] = "4.3";
  run.driver_version = "Mesa 25";
  for (int stored = 0; stored < 2; ++stored) {
    CHECK(history.changes_since_last(run).surroundings ==
          Names{"driver's version: Mesa 25, was " + before.driver_version, "Embree: 4.3, was 3.13.5"});
    history.append_run(run);
  }
  CHECK(changes_between(before, run).surroundings.size() == 2);
}

TEST_CASE("history: a failing case is told since when, a run which one passed last") {
  TemporaryFolder folder;
  History history(folder.path / "history.sqlite");
  RunRecord good = run_of("2026-11-18T03:00:00Z", {{"a", kPassed}, {"b", kPassed}});
  good.commit = "good";
  history.append_run(good);
  history.append_run(run_of("2026-11-19T03:00:00Z", {{"a", kFailed}, {"b", kPassed}, {"never", kError}}));
  history.append_run(run_of("2026-11-20T03:00:00Z", {{"a", kSkipped}, {"b", kPassed}}));
  const RunChanges changes =
      history.changes_since_last(run_of("2026-11-21T03:00:00Z", {{"a", kFailed}, {"b", kPassed}, {"never", kFailed}}));
  CHECK(changes.last_pass == "2026-11-20T03:00:00Z");
  REQUIRE(changes.failing_since.size() == 2);
  CHECK(changes.failing_since[0].passed == "2026-11-18T03:00:00Z");
  CHECK(changes.failing_since[0].passed_commit == "good");
  CHECK(changes.failing_since[0].runs == 2);  // the run that skipped it says nothing
  CHECK(changes.failing_since[1].passed.empty());
  CHECK(changes.failing_since[1].runs == 2);
}

TEST_CASE("history: two runs at hand are compared as a run with its past") {
  const RunRecord before =
      run_of("2026-11-20T03:00:00Z", {{"a", kPassed}, {"b", kFailed}, {"c", kFailed}, {"d", kPassed}});
  const RunRecord after =
      run_of("2026-11-21T03:00:00Z", {{"a", kError}, {"b", kPassed}, {"c", kFailed}, {"e", kPassed}});
  const RunChanges changes = changes_between(before, after);
  CHECK(changes.newly_failing == Names{"a"});
  CHECK(changes.newly_passing == Names{"b"});
  CHECK(changes.still_failing == Names{"c"});
  CHECK(changes.new_cases == Names{"e"});
  CHECK(changes.gone_cases == Names{"d"});
  CHECK(changes.last_pass.empty());
}

TEST_CASE("history: tables of version 1 are brought up to date, with all they hold") {
  TemporaryFolder folder;
  const auto file = folder.path / "history.sqlite";
  {
    // As the first plumbline wrote it.
    const Database old(file);
    old.execute(R"sql(
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
INSERT INTO run VALUES (1, '2026-11-20T03:00:00Z', '7', 'abc', '0.1.0', 12.5, 1, 1, 0, 0, 0, 99, 0, 0);
INSERT INTO answer VALUES (1, 1, 'hits.camera', 'passed', 99, 1.5, 'kept');
INSERT INTO verdict VALUES (1, 'agree', 99);
INSERT INTO figure VALUES (1, 0, 'cells', '', 3.5, 0, 0, 0);
PRAGMA application_id = 1349285229; PRAGMA user_version = 1;)sql");
  }
  for (int opened = 0; opened < 2; ++opened) {
    const History history(file);
    const PastRun run = history.last_runs(9).at(0);
    CHECK(run.seed == 7);
    CHECK(run.seconds == 12.5);
    CHECK(run.summary.ok());
    CHECK(run.machine.empty());
    const PastCase answer = history.last_answers("hits.camera", 9).at(0);
    CHECK(answer.message == "kept");
    CHECK(answer.verdicts.at("agree") == 99);
    CHECK(answer.figures.at(0).value == 3.5);
  }
  History history(file);
  history.append_run(run_of("2026-11-22T03:00:00Z", {{"hits.camera", kFailed}}));
  const RunChanges changes = history.changes_since_last(run_of("2026-11-23T03:00:00Z", {{"hits.camera", kFailed}}));
  CHECK(changes.failing_since.at(0).passed_commit == "abc");
  CHECK(changes.surroundings.size() == 0);
}

TEST_CASE("history: what is not a history is refused and left alone") {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& why) {
    write_text(folder.path / name, text);
    CHECK_THROWS_AS(History(folder.path / name), InputError);
    CHECK_THROWS_WITH(History(folder.path / name), Catch::Contains(name) && Catch::Contains(why));
    CHECK(read_text(folder.path / name) == text);
  };
  refused("text.sqlite", std::string(5000, 'x'), "not a history");
  refused("short.sqlite", "x", "not a history");
  History(folder.path / "good.sqlite").append_run(example_run());
  const std::string good = read_text(folder.path / "good.sqlite");
  // SQLite's header: user_version at bytes 60 to 63, application_id at 68 to 71, big-endian.
  std::string newer = good, foreign = good, cut = good.substr(0, good.size() / 2);
  newer[63] = 3;
  foreign[70] = 0;
  refused("newer.sqlite", newer, "use the plumbline that wrote it");
  refused("foreign.sqlite", foreign, "not a history of plumbline's");
  write_text(folder.path / "cut.sqlite", cut);
  CHECK_THROWS_AS(History(folder.path / "cut.sqlite").append_run(example_run()), InputError);
  CHECK_THROWS_AS(History(folder.path), InputError);
  CHECK_THROWS_AS(History(folder.path / "good.sqlite" / "inside"), EnvironmentError);
}

}  // namespace plumbline
