// SPDX-License-Identifier: MIT
// Shards make the run that they were cut from.
#include "reports/merge.h"

#include <catch2/catch.hpp>

#include "reports/example_run.h"
#include "reports/html.h"
#include "reports/journal.h"
#include "reports/json.h"
#include "reports/summary.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// Two shards of a run; both question the driver (its first four cases).
std::vector<RunRecord> shards_of(const RunRecord& run) {
  std::vector<RunRecord> parts(2, run);
  for (std::size_t k = 0; k < 2; ++k) {
    parts[k].cases.clear();
    for (std::size_t i = 0; i < run.cases.size(); ++i)
      if (i < 4 || i % 2 == k) parts[k].cases.push_back(run.cases[i]);
    parts[k].planned_cases = parts[k].cases.size();
  }
  parts[1].seconds = run.seconds - 100.0;
  return parts;
}

}  // namespace

TEST_CASE("merge: shards make the run again") {
  const RunRecord run = example_run();
  const RunRecord merged = merge_runs(shards_of(run));
  CHECK(merged.cases.size() == run.cases.size());
  CHECK(merged.planned_cases == run.planned_cases);
  CHECK(merged.seconds == run.seconds);
  CHECK(headline(summarize(merged)) == headline(summarize(run)));
  CHECK(summarize(merged).verdicts == summarize(run).verdicts);
}

TEST_CASE("merge: a failure is kept before a pass, a shard cut short is seen") {
  auto parts = shards_of(example_run({.failing = false}));
  CHECK(summarize(merge_runs(parts)).ok());
  parts[1].cases[2].status = CaseStatus::failed;
  CHECK(summarize(merge_runs(parts)).failed == 1);
  std::swap(parts[0], parts[1]);
  CHECK(summarize(merge_runs(parts)).failed == 1);
  parts[1].cases.pop_back();
  CHECK(summarize(merge_runs(parts)).unfinished == 1);
}

TEST_CASE("merge: parts of different runs are refused") {
  for (const auto change :
       {+[](RunRecord& r) { r.seed += 1; }, +[](RunRecord& r) { r.commit = "other"; },
        +[](RunRecord& r) { r.driver_version = "other"; }, +[](RunRecord& r) { r.version = "other"; }}) {
    auto parts = shards_of(example_run());
    change(parts[1]);
    CHECK_THROWS_AS(merge_runs(parts), InputError);
  }
  CHECK_THROWS_AS(merge_runs({}), InputError);
}

TEST_CASE("merge: folders, with their pictures, finished or not") {
  TemporaryFolder folder;
  auto parts = shards_of(example_run({.families = 1, .scenes = 2}));
  add_example_pictures(parts[0], folder.path / "a");
  write_report(parts[0], folder.path / "a");
  Journal journal = Journal::begin(folder.path / "b", parts[1]);
  for (const CaseRecord& record : parts[1].cases) journal.append(record);
  merge_reports({folder.path / "a", folder.path / "b"}, folder.path / "out");
  CHECK(read_run(folder.path / "out").cases.size() == 7);
  CHECK(std::filesystem::exists(folder.path / "out" / "index.html"));
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "out" / "pictures"))
    pictures += std::filesystem::file_size(entry) ==
                std::filesystem::file_size(folder.path / "a" / "pictures" / entry.path().filename());
  CHECK(pictures == 3);
  CHECK_THROWS_AS(read_run(folder.path / "none"), InputError);
  CHECK_THROWS_AS(merge_reports({folder.path}, folder.path / "out"), InputError);
}

}  // namespace plumbline
