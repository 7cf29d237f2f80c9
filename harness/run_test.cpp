// SPDX-License-Identifier: GPL-3.0-or-later
// Runs: what is recorded, what a resumed run does again, and what its exit status is.
#include "harness/run.h"

#include <unistd.h>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "reports/files.h"
#include "reports/journal.h"
#include "scenes/error.h"

using namespace plumbline;

namespace {

/// A case that counts how often it ran and does as told.
Case made_up(const std::string& name, int& runs, CaseStatus status = CaseStatus::passed) {
  Case c;
  c.name = name, c.feature = "made_up", c.proves = "Nothing: it is made up for a test.";
  c.run = [&runs, status](CaseContext&, const Case&, CaseRecord& record) {
    ++runs;
    if (status == CaseStatus::error) throw std::runtime_error("the case broke");
    record.status = status;
    record.rays = 4;
    record.verdicts["agree"] = 4;
  };
  return c;
}

/// A folder of its own for each test, removed at the end.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plumbline_run_test_" + std::to_string(::getpid()));
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

RunOptions options_in(const Folder& folder) {
  RunOptions o;
  o.out = folder.path, o.quiet = true;
  return o;
}

}  // namespace

TEST_CASE("A failing case and a throwing case fail the run, and the others run on") {
  const Folder folder;
  int good = 0, bad = 0, broken = 0;
  const RunRecord run = run_cases({made_up("made_up.broken", broken, CaseStatus::error),
                                   made_up("made_up.bad", bad, CaseStatus::failed), made_up("made_up.good", good)},
                                  options_in(folder));
  CHECK(good == 1);
  REQUIRE(run.cases.size() == 3);
  CHECK(run.cases[0].status == CaseStatus::error);
  CHECK(run.cases[0].message == "the case broke");
  CHECK(exit_status(run) == 1);
  CHECK(exit_status(run_cases({made_up("made_up.good", good)}, options_in(folder))) == 0);
  for (const char* file : {"index.html", "results.json", "junit.xml", "report.md", "cases.jsonl"})
    CHECK(std::filesystem::exists(folder.path / file));
}

TEST_CASE("A resumed run does only what is left, and refuses another run's folder") {
  const Folder folder;
  int a = 0, b = 0;
  RunOptions options = options_in(folder);
  options.budget_seconds = 1e-9;
  Case slow = made_up("made_up.a", a);
  CHECK(exit_status(run_cases({slow, made_up("made_up.b", b)}, options)) == 1);  // cases left out are no success
  CHECK(a + b == 0);
  options.budget_seconds = 0.0;
  options.resume = true;
  CHECK(exit_status(run_cases({slow, made_up("made_up.b", b)}, options)) == 0);
  CHECK((a == 1 && b == 1));
  CHECK(run_cases({slow, made_up("made_up.b", b)}, options).cases.size() == 2);
  CHECK((a == 1 && b == 1));
  options.seed = 99;
  CHECK_THROWS_AS(run_cases({slow, made_up("made_up.b", b)}, options), InputError);
}

TEST_CASE("Shards take every case once") {
  const Folder folder;
  int runs = 0;
  std::vector<Case> cases;
  for (int i = 0; i < 7; ++i) cases.push_back(made_up("made_up.case_" + std::to_string(i), runs));
  std::set<std::string> names;
  for (int shard = 1; shard <= 3; ++shard) {
    RunOptions options = options_in(folder);
    options.shard = shard, options.shards = 3;
    for (const CaseRecord& c : run_cases(cases, options).cases) names.insert(c.name);
  }
  CHECK(runs == 7);
  CHECK(names.size() == 7);
}

TEST_CASE("The same seed repeats a case bit for bit, another seed does not") {
  const Folder folder;
  CatalogueOptions small;
  small.scenes = {{"creature", "creature", true}};
  small.hits_rays = 2000;
  const std::vector<Case> cases = select_cases(make_catalogue(small), {"hits.aimed_edges"});
  const auto worst_of = [&](std::uint64_t seed) {
    RunOptions options = options_in(folder);
    options.seed = seed;
    const RunRecord run = run_cases(cases, options);
    std::string text;
    for (const RayRecord& r : run.cases.at(0).worst) text += r.origin + r.direction + r.tracer + r.reason + "\n";
    return text;
  };
  const std::string first = worst_of(5);
  CHECK_FALSE(first.empty());
  CHECK(worst_of(5) == first);
  CHECK(worst_of(6) != first);
}

TEST_CASE("A run for GitHub appends its summary to the step's, behind what is there") {
  const Folder folder;
  std::filesystem::create_directories(folder.path);
  const std::string file = (folder.path / "summary.md").string();
  write_text(file, "before\n");
  const char* earlier = std::getenv("GITHUB_STEP_SUMMARY");
  const std::string kept = earlier ? earlier : "";
  ::setenv("GITHUB_STEP_SUMMARY", file.c_str(), 1);
  int runs = 0;
  RunOptions options = options_in(folder);
  options.github = true;
  const RunRecord run = run_cases({made_up("made_up.bad", runs, CaseStatus::failed)}, options);
  earlier ? ::setenv("GITHUB_STEP_SUMMARY", kept.c_str(), 1) : ::unsetenv("GITHUB_STEP_SUMMARY");
  CHECK(read_text(file) == "before\n" + read_text(options.out / "report.md") + "\n");
  CHECK(read_text(file).find("made\\_up.bad") != std::string::npos);
}
