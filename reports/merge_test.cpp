// SPDX-License-Identifier: MIT
// Shards make the run that they were cut from.
#include "reports/merge.h"

#include <catch2/catch.hpp>

#include "reports/example_run.h"
#include "reports/files.h"
#include "reports/html.h"
#include "reports/journal.h"
#include "reports/json.h"
#include "reports/sha256.h"
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

TEST_CASE("merge: the parts of a run that was cut are all there, each once, and make the run again") {
  const RunRecord run = example_run();
  const auto cut = [&] {
    auto parts = shards_of(run);
    for (int k = 0; k < 2; ++k) parts[static_cast<std::size_t>(k)].shard = {k + 1, 2, run.cases.size(), "whole"};
    return parts;
  };
  auto parts = cut();
  std::swap(parts[0], parts[1]);
  const RunRecord merged = merge_runs(parts);
  CHECK(merged.cases.size() == run.cases.size());
  CHECK(merged.planned_cases == run.cases.size());
  CHECK(merged.cases[4].name == run.cases[4].name);
  CHECK(merged.shard.of == 0);
  for (const auto& [change, why] : std::vector<std::pair<void (*)(std::vector<RunRecord>&), std::string>>{
           {[](std::vector<RunRecord>& p) { p.pop_back(); }, "part 2 of 2 is missing"},
           {[](std::vector<RunRecord>& p) { p[1] = p[0]; }, "part 1 is there twice"},
           {[](std::vector<RunRecord>& p) { p[1].shard.whole = "other"; }, "not cut from the same run"},
           {[](std::vector<RunRecord>& p) { p[1].shard = {}; }, "not cut from the same run"},
           {[](std::vector<RunRecord>& p) { p[1].shard.number = 3; }, "no part 3 of 2"}}) {
    auto wrong = cut();
    change(wrong);
    CHECK_THROWS_WITH(merge_runs(wrong), Catch::Contains(why));
  }
}

TEST_CASE("merge: a part that was truncated or changed is refused, wherever that is") {
  TemporaryFolder folder;
  const auto parts = shards_of(example_run({.families = 2, .scenes = 2}));
  for (std::size_t k = 0; k < 2; ++k) write_results(parts[k], folder.path / std::to_string(k) / "results.json");
  const auto merge = [&] { return merge_reports({folder.path / "0", folder.path / "1"}, folder.path / "out"); };
  CHECK(merge().cases.size() == example_run({.families = 2, .scenes = 2}).cases.size());
  const auto file = folder.path / "1" / "results.json";
  const std::string whole = read_text(file);
  for (std::size_t length = 0; length < whole.size(); length += 997) {
    write_text(file, whole.substr(0, length));
    CHECK_THROWS_AS(merge(), InputError);
  }
  for (std::size_t at = 500; at < whole.size(); at += 1009) {
    std::string changed = whole;
    changed[at] = changed[at] == '1' ? '2' : '1';
    write_text(file, changed);
    CHECK_THROWS_AS(merge(), InputError);
  }
  const std::size_t digest = whole.rfind(",\n \"digest\"");
  REQUIRE(digest != std::string::npos);
  write_text(file, whole.substr(0, digest) + "\n}\n");
  CHECK_THROWS_WITH(merge(), Catch::Contains("has no digest"));
  write_text(file, whole);
  CHECK_NOTHROW(merge());
}

TEST_CASE("sha256: the standard's own examples") {
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(sha256(std::string(1'000'000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("merge: folders, with their pictures, finished or not") {
  TemporaryFolder folder;
  auto parts = shards_of(example_run({.families = 1, .scenes = 2}));
  add_example_pictures(parts[0], folder.path / "a");
  write_report(parts[0], folder.path / "a");
  Journal journal = Journal::begin(folder.path / "b", parts[1]);
  for (const CaseRecord& record : parts[1].cases) journal.append(record);
  CHECK_THROWS_WITH(merge_reports({folder.path / "a", folder.path / "b"}, folder.path / "out"),
                    Catch::Contains("cut short"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "out"));
  write_report(parts[1], folder.path / "b");
  merge_reports({folder.path / "a", folder.path / "b"}, folder.path / "out");
  CHECK(read_run(folder.path / "out").cases.size() == 7);
  CHECK(std::filesystem::exists(folder.path / "out" / "index.html"));
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "out" / "pictures"))
    pictures += std::filesystem::file_size(entry) ==
                std::filesystem::file_size(folder.path / "a" / "pictures" / entry.path().filename());
  CHECK(pictures == 9);  // six pictures, three of them with values
  CHECK_THROWS_AS(read_run(folder.path / "none"), InputError);
  CHECK_THROWS_AS(merge_reports({folder.path}, folder.path / "out"), InputError);
}

}  // namespace plumbline
