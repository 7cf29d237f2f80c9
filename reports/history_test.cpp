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

TEST_CASE("history: what is not a history is refused and left alone") {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& why) {
    write_text(folder.path / name, text);
    CHECK_THROWS_AS(History(folder.path / name), InputError);
    CHECK_THROWS_WITH(History(folder.path / name), Catch::Contains(name) && Catch::Contains(why));
    CHECK(read_text(folder.path / name) == text);
  };
  refused("text.sqlite", std::string(5000, 'x'), "not a history");
  History(folder.path / "good.sqlite").append_run(example_run());
  const std::string good = read_text(folder.path / "good.sqlite");
  // SQLite's header: user_version at bytes 60 to 63, application_id at 68 to 71, big-endian.
  std::string newer = good, foreign = good, cut = good.substr(0, good.size() / 2);
  newer[63] = 2;
  foreign[70] = 0;
  refused("newer.sqlite", newer, "use the plumbline that wrote it");
  refused("foreign.sqlite", foreign, "not a history of plumbline's");
  write_text(folder.path / "cut.sqlite", cut);
  CHECK_THROWS_AS(History(folder.path / "cut.sqlite").append_run(example_run()), InputError);
  CHECK_THROWS_AS(History(folder.path), InputError);
  CHECK_THROWS_AS(History(folder.path / "good.sqlite" / "inside"), EnvironmentError);
}

}  // namespace plumbline
