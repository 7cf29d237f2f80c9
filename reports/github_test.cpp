// SPDX-License-Identifier: MIT
// Annotations: escaped as GitHub documents, no more than it shows, one line each; a Markdown page that stays short.
#include "reports/github.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <sstream>

#include "reports/example_run.h"
#include "reports/summary.h"
#include "reports/text_summary.h"

namespace plumbline {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// 1,500 cases of 75 families, of which the first so many of what was judged fail.
RunRecord large_run(std::size_t failing) {
  RunRecord run = example_run({.families = 75, .scenes = 20, .rays_per_case = 0, .failing = false});
  for (CaseRecord& record : run.cases) {
    if (failing == 0 || record.rays == 0) continue;
    --failing;
    record.status = CaseStatus::failed;
    record.verdicts["tracer_wrong"] = 1;
    --record.verdicts["agree"];
    record.message = "1 ray is tracer_wrong.";
  }
  return run;
}

}  // namespace

TEST_CASE("github: messages and properties are escaped as its runner decodes them") {
  CHECK(github_message("50 % of a,b: c\r\nnext") == "50 %25 of a,b: c%0D%0Anext");
  CHECK(github_property("50 % of a,b: c\r\nnext") == "50 %25 of a%2Cb%3A c%0D%0Anext");
  CHECK(github_message("%0A") == "%250A");  // what was encoded before is text
  CHECK(github_message("tab\tesc\x1b[31m") == "tab esc [31m");
  CHECK(github_message("a \xff b") == "a \xef\xbf\xbd b");
}

TEST_CASE("github: a failing case is an error with its command, the totals are a notice") {
  const std::vector<std::string> lines = lines_of(github_annotations(example_run()));
  REQUIRE(lines.size() == 4);
  CHECK(lines[1].starts_with("::error title=hits.random_chords.balls_4::3 rays are tracer_wrong; "));
  CHECK_THAT(lines[1], Catch::Contains("%0Areplay: plumbline run hits.random_chords.balls_4 --seed "));
  CHECK(lines[3] == "::notice title=Plumbline::Failed: 3 of 24 cases. 11 rays are judged leak, 3 tracer_wrong.");
  CHECK(lines_of(github_annotations(example_run({.failing = false}))).size() == 1);
}

TEST_CASE("github: no more errors than are shown, the rest is counted") {
  for (const std::size_t failing : {9u, 10u, 11u, 40u}) {
    const std::vector<std::string> lines = lines_of(github_annotations(large_run(failing)));
    CHECK(lines.size() == std::min(failing, kMostGithubErrors) + 1);
    CHECK((lines.back().find(" of these are in the report only.") != std::string::npos) == (failing > 10));
  }
  CHECK_THAT(github_annotations(large_run(40)), Catch::Contains("30 of these are in the report only."));
}

TEST_CASE("github: hostile names stay within their command") {
  RunRecord run = example_run();
  for (CaseRecord& record : run.cases)
    record.name = record.message = record.replay = kNastyText + std::string("\n::error::x");
  for (const std::string& line : lines_of(github_annotations(run))) {
    const bool known = line.starts_with("::error title=") || line.starts_with("::notice title=Plumbline::");
    CHECK(known);
    CHECK(std::none_of(line.begin(), line.end(), [](unsigned char c) { return c < 0x20; }));
  }
}

TEST_CASE("markdown: 1,500 cases are at most 60 lines, however many fail") {
  for (const std::size_t failing : {0u, 3u, 1400u}) {
    const RunRecord run = large_run(failing);
    REQUIRE(run.cases.size() > 1500);
    const std::string text = markdown_summary(run);
    INFO(text);
    CHECK(lines_of(text).size() <= 60);
    CHECK(text.size() < 8000);
    CHECK((text.find("more cases in the report") != std::string::npos) == (failing > 10));
  }
  // Rows that are left out are added up, failing families are not left out.
  RunRecord run = large_run(0);
  run.cases.back().verdicts["leak"] = 5;
  const std::string text = markdown_summary(run);
  CHECK_THAT(text, Catch::Contains("| family\\_74 |"));
  CHECK_THAT(text, Catch::Contains("| (55 others) |"));
  CHECK_THAT(text, Catch::Contains("| all | 1,4"));
}

}  // namespace plumbline
