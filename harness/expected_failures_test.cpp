// SPDX-License-Identifier: GPL-3.0-or-later
// Expected failures: accepted for their time, reported when they pass or run out.
#include "harness/expected_failures.h"

#include <catch2/catch.hpp>

#include "harness/catalogue.h"
#include "harness/run.h"
#include "reports/summary.h"
#include "scenes/error.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {
CaseRecord ended(const std::string& name, CaseStatus status) {
  CaseRecord record;
  record.name = name, record.status = status, record.message = "as it was";
  return record;
}
const std::vector<ExpectedFailure> kList = {{"hits.far", "A known bug.", "2026-12-31", ""},
                                            {"bake.*", "Of one driver.", "2026-12-31", "Mesa 22"}};
CaseRecord judged(CaseRecord record, const std::string& today, const std::string& driver = "Mesa 22.3.6") {
  judge_by_expectation(kList, driver, today, record);
  return record;
}
}  // namespace

TEST_CASE("An expected failure is skipped with its reason, until its day is over") {
  for (const CaseStatus status : {CaseStatus::failed, CaseStatus::error}) {
    const CaseRecord accepted = judged(ended("hits.far.creature", status), "2026-12-31");
    CHECK(accepted.status == CaseStatus::skipped);
    CHECK(accepted.message == "expected to fail until 2026-12-31 (A known bug.): as it was");
    const CaseRecord over = judged(ended("hits.far.creature", status), "2027-01-01");
    CHECK(over.status == status);
    CHECK_THAT(over.message, Catch::Contains("which is over"));
  }
  CHECK(judged(ended("hits.farther", CaseStatus::failed), "2026-12-31").status == CaseStatus::failed);
  CHECK(judged(ended("bake.file.x", CaseStatus::failed), "2026-12-31").status == CaseStatus::skipped);
  CHECK(judged(ended("bake.file.x", CaseStatus::failed), "2026-12-31", "Mesa 25").status == CaseStatus::failed);
}

TEST_CASE("A case that passes although it is expected to fail has failed") {
  for (const char* today : {"2026-12-01", "2027-12-01"}) {
    const CaseRecord passes = judged(ended("hits.far.creature", CaseStatus::passed), today);
    CHECK(passes.status == CaseStatus::failed);
    CHECK_THAT(passes.message, Catch::Contains("take \"hits.far\" off the list"));
  }
  // Rays without a verdict are a failure, whatever the status says.
  CaseRecord silent = ended("hits.far.creature", CaseStatus::passed);
  silent.rays = 5;
  CHECK(judged(silent, "2026-12-01").status == CaseStatus::skipped);
  CHECK(judged(ended("hits.far.creature", CaseStatus::skipped), "2026-12-01").message == "as it was");
}

TEST_CASE("A list of expected failures is read, or refused with what is wrong") {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) { return read_expected_failures(folder.write("list.json", text)); };
  CHECK(read("[]").empty());
  const auto list = read(R"([{"cases": "a.*", "reason": "Why.", "until": "2027-01-31", "driver": "x"}])");
  REQUIRE(list.size() == 1);
  CHECK(list[0].until == "2027-01-31");
  CHECK(list[0].driver == "x");
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"{", "JSON array"},
           {"[1]", "entry 0: expected an object"},
           {R"([{"cases": "a", "until": "2027-01-31"}])", "\"reason\""},
           {R"([{"cases": "a", "reason": "b", "until": "2027-13-31"}])", "\"until\""},
           {R"([{"cases": "a", "reason": "b", "until": "soon"}])", "\"until\""},
           {R"([{"cases": "a", "reason": "b", "until": 3}])", "is text"},
           {R"([{"case": "a"}])", "there is no key \"case\""}})
    CHECK_THROWS_WITH(read(text), Catch::Contains("list.json") && Catch::Contains(why));
}

TEST_CASE("Every expected failure that comes with Plumbline names a case") {
  CatalogueOptions options;
  options.scenes = own_scenes();
  for (ListedScene& s : placed_scenes()) options.scenes.push_back(std::move(s));
  for (ListedScene& s : real_scenes()) options.scenes.push_back(std::move(s));
  options.whole = true;
  const std::vector<Case> cases = make_catalogue(options);
  for (const ExpectedFailure& entry : read_expected_failures(expected_failures_file()))
    CHECK_FALSE(select_cases(cases, {entry.cases}).empty());
}
