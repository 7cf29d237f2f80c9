// SPDX-License-Identifier: GPL-3.0-or-later
// Workers: what they answer, throw and die of; runs whose cases crash, hang, or are killed at any moment.
#include "harness/worker.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>

#include "harness/deeper.h"
#include "harness/run.h"
#include "reports/journal.h"
#include "reports/json.h"
#include "reports/merge.h"
#include "scenes/error.h"
#include "scenes/random.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

Case made_up(const std::string& name, std::function<void(CaseContext&, CaseRecord&)> act) {
  Case c;
  c.name = "made_up." + name, c.feature = "made_up", c.proves = "Nothing: it is made up for a test.";
  c.run = [act = std::move(act)](CaseContext& context, const Case&, CaseRecord& record) { act(context, record); };
  return c;
}

RunOptions isolated_in(const std::filesystem::path& folder) {
  RunOptions options;
  options.out = folder, options.quiet = true, options.isolate = true;
  return options;
}

/// The record but for what differs from run to run: times.
std::string timeless(RunRecord run) {
  run.started.clear();
  run.seconds = 0.0;
  for (CaseRecord& c : run.cases) c.seconds = c.trace_seconds = 0.0;
  return run_to_json(run);
}

}  // namespace

TEST_CASE("A worker answers, throws what the job throws, and tells what it died of") {
  Worker worker([](const std::string& job, const JobProgress& progress) -> std::string {
    if (job == "input") throw InputError("wrong");
    if (job == "environment") throw EnvironmentError("missing");
    if (job == "other") throw std::logic_error("odd");
    if (job == "crash") std::abort();
    if (job == "exit") ::_exit(7);
    progress(0.5);
    return job + job;
  });
  Worker::Death death;
  double share = 0.0;
  const auto ask = [&](const std::string& job) {
    return worker.ask(
        job, 20.0, [&](double s) { share = s; }, death);
  };
  CHECK(ask("two ") == "two two ");
  CHECK(share == 0.5);
  const std::string large(3'000'000, 'x');
  CHECK(ask(large) == large + large);
  CHECK_THROWS_AS(ask("input"), InputError);
  CHECK_THROWS_AS(ask("environment"), EnvironmentError);
  CHECK_THROWS_WITH(ask("other"), "odd");
  CHECK(ask("") == "");
  CHECK_FALSE(ask("crash"));
  CHECK(death.how == "crashed: Aborted (signal 6)");
  CHECK_FALSE(ask("after"));
  CHECK(death.how == "gone");
}

TEST_CASE("A worker that is silent is killed, one that gives signs of life is not") {
  const auto slow = [](const std::string& job, const JobProgress& progress) -> std::string {
    for (int i = 0; i < 6; ++i) {
      ::usleep(100'000);
      if (job == "alive") progress(0.1 * i);
    }
    return "done";
  };
  Worker::Death death;
  CHECK(Worker(slow).ask(
            "alive", 0.4, [](double) {}, death) == "done");
  CHECK_FALSE(Worker(slow).ask(
      "silent", 0.4, [](double) {}, death));
  CHECK_THAT(death.how, Catch::StartsWith("hung: no sign of life for 0.4 s, with 0.0 s of processor time"));
  const auto endless = [](const std::string&, const JobProgress&) -> std::string {
    for (volatile int turns = 0;;) turns = turns + 1;
  };
  CHECK_FALSE(Worker(endless).ask(
      "", 1.0, [](double) {}, death));
  double used = 0.0;
  REQUIRE(std::sscanf(death.how.c_str(), "hung: no sign of life for 1 s, with %lf s", &used) == 1);
  CHECK((used > 0.1 && used < 2.0));  // of one thread, on a machine that others use too
}

TEST_CASE("Cases that crash, hang or exit are errors, and the others run on") {
  const TemporaryFolder folder;
  const auto fine = [](CaseContext&, CaseRecord&) {};
  RunOptions options = isolated_in(folder.path());
  options.jobs = GENERATE(1, 3);
  CAPTURE(options.jobs);
  options.silent_seconds = 1.0;
  const RunRecord run =
      run_cases({made_up("first", fine), made_up("crash", [](CaseContext&, CaseRecord&) { ::raise(SIGSEGV); }),
                 made_up("second", fine),
                 made_up("hang",
                         [](CaseContext&, CaseRecord&) {
                           for (;;) ::pause();
                         }),
                 made_up("third", fine), made_up("exit", [](CaseContext&, CaseRecord&) { ::_exit(3); }),
                 made_up("throw", [](CaseContext&, CaseRecord&) { throw EnvironmentError("the driver is gone"); }),
                 made_up("last", fine)},
                options);
  REQUIRE(run.cases.size() == 8);
  for (const std::size_t good : {0, 2, 4, 7}) CHECK(run.cases[good].status == CaseStatus::passed);
  for (const std::size_t bad : {1, 3, 5, 6}) CHECK(run.cases[bad].status == CaseStatus::error);
  CHECK_THAT(run.cases[1].message, Catch::Contains("crashed: Segmentation fault"));
  CHECK_THAT(run.cases[3].message, Catch::Contains("hung"));
  CHECK_THAT(run.cases[5].message, Catch::Contains("ended with exit status 3"));
  CHECK(run.cases[6].message == "the driver is gone");
  CHECK(read_run(folder.path()).cases.size() == 8);
  CHECK(exit_status(run) == 1);
}

TEST_CASE("Killed at 20 random moments and resumed, a run's record equals that of an undisturbed one") {
  const TemporaryFolder folder;
  std::vector<Case> cases;
  for (int i = 0; i < 60; ++i)
    cases.push_back(made_up("case_" + std::to_string(i), [](CaseContext& context, CaseRecord& record) {
      ::usleep(3000);
      record.rays = 8;
      record.verdicts["agree"] = 8;
      record.message = std::string(20'000, 'm') + std::to_string(mix64(record.seed ^ context.seed));
    }));
  RunOptions options = isolated_in(folder.path() / "undisturbed");
  const std::string undisturbed = timeless(run_cases(cases, options));
  options.out = folder.path() / "killed";
  options.jobs = 3;  // cases then end in any order
  std::size_t most_lost = 0, kept = 0;
  for (std::uint64_t k = 0; k < 20; ++k) {
    options.resume = k > 0;
    const pid_t runner = ::fork();
    REQUIRE(runner >= 0);
    if (runner == 0) {
      run_cases(cases, options);
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(20'000 + mix64(k) % 60'000));
    ::kill(runner, SIGKILL);
    int status = 0;
    ::waitpid(runner, &status, 0);
    const std::size_t now = has_journal(options.out) ? read_run(options.out).cases.size() : 0;
    most_lost = std::max(most_lost, kept > now ? kept - now : 0);
    kept = now;
  }
  CHECK(most_lost == 0);  // what was recorded stays recorded
  options.resume = true;
  CHECK(timeless(run_cases(cases, options)) == undisturbed);
  CHECK(timeless(read_run(options.out)) == undisturbed);
}

TEST_CASE("What is left of a budget goes where it buys most, with other rays, and counts") {
  const TemporaryFolder folder;
  const auto rays = [](std::uint64_t count, unsigned milliseconds) {
    return [=](CaseContext& context, CaseRecord& record) {
      ::usleep(1000 * milliseconds);
      record.rays = count;
      record.verdicts["agree"] = count;
      record.message = std::to_string(context.seed);
    };
  };
  std::vector<Case> cases = {made_up("few", rays(10, 10)), made_up("many", rays(100'000, 10)),
                             made_up("dear", rays(10, 200)), made_up("same", rays(0, 10))};
  for (std::size_t i = 0; i < 3; ++i) cases[i].rays = 1;
  RunOptions options = isolated_in(folder.path());
  options.budget_seconds = 1.0;
  const RunRecord run = run_cases(cases, options);
  REQUIRE(run.cases.size() == 4);
  CHECK(run.seconds < 2.0);
  CHECK(passes_of(run.cases[0]) > 3);
  CHECK(run.cases[0].rays == 10 * (1 + passes_of(run.cases[0])));
  CHECK(passes_of(run.cases[0]) > passes_of(run.cases[1]));
  CHECK(passes_of(run.cases[0]) > passes_of(run.cases[2]));
  CHECK(passes_of(run.cases[3]) == 0);
}

TEST_CASE("A further pass that fails fails the case, with the seed that repeats it") {
  CaseRecord record, next;
  record.rays = record.verdicts["agree"] = 10;
  record.figures = {{"mean", "z", 1.0}, {"tail", "p", 0.5}};
  next = record;
  next.replay = "with another seed", next.message = "lost", next.status = CaseStatus::failed;
  next.verdicts = {{"agree", 9}, {"tracer_wrong", 1}};
  next.figures[0].value = 2.0;
  add_pass(record, next);
  CHECK(record.status == CaseStatus::failed);
  CHECK(record.replay == "with another seed");
  CHECK(record.message == "in a further pass: lost");
  CHECK(record.rays == 20);
  CHECK(record.verdicts["agree"] == 19);
  CHECK(record.figures[0].value == Approx(3.0 / std::sqrt(2.0)));
  CHECK(record.figures[1].value == Approx(0.5));
  CHECK(passes_of(record) == 1);
  CHECK(pass_seed(7, 0) == 7);
  CHECK(pass_seed(7, 1) != pass_seed(7, 2));
}
