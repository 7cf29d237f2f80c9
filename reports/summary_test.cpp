// SPDX-License-Identifier: MIT
// Totals, the sentence that says them, numbers as people read them, and the terminal's summary.
#include "reports/summary.h"

#include <catch2/catch.hpp>
#include <limits>

#include "reports/example_run.h"
#include "reports/format.h"
#include "reports/text_summary.h"

namespace plumbline {

TEST_CASE("summary: a ray without a verdict fails a run that says it passed") {
  RunRecord run;
  run.cases.resize(2);
  run.cases[0].name = "a";
  run.cases[0].rays = 10;
  run.cases[0].verdicts = {{"agree", 10}};
  run.cases[1].name = "b";
  run.cases[1].rays = 10;
  run.cases[1].verdicts = {{"agree", 7}, {"tie", 3}};
  CHECK(summarize(run).ok());
  CHECK(headline(summarize(run)) == "Passed: 20 rays in 2 cases, no ray without a verdict.");
  run.cases[1].verdicts["tie"] = 2;
  CHECK_FALSE(summarize(run).ok());
  CHECK(summarize(run).passed == 1);
  CHECK(headline(summarize(run)) == "Failed: 1 of 2 cases. 1 ray without a verdict.");
  CHECK_THAT(text_summary(run), Catch::Contains("FAILED b: 1 ray without a verdict"));
}

TEST_CASE("summary: nothing tested and not finished are not passed") {
  RunRecord run;
  CHECK_FALSE(summarize(run).ok());
  run.cases.resize(1);
  run.cases[0].status = CaseStatus::skipped;
  CHECK_FALSE(summarize(run).ok());
  CHECK(headline(summarize(run)) == "Nothing was tested: all 1 case skipped.");
  run.cases[0].status = CaseStatus::passed;
  run.planned_cases = 3;
  CHECK_FALSE(summarize(run).ok());
  CHECK(headline(summarize(run)) == "Incomplete: 1 of 3 cases ended, none of them failed.");
}

TEST_CASE("summary: totals of the example") {
  const RunSummary total = summarize(example_run());
  CHECK(total.cases == 25);
  CHECK(total.failed == 3);
  CHECK(total.errors == 1);
  CHECK(total.skipped == 1);
  CHECK(total.cases == total.passed + total.failed + total.skipped);
  CHECK(total.rays == 18 * 76500);
  CHECK(total.verdicts.at("leak") == 11);
  CHECK(verdicts_in_order({{"zebra", 1}, {"capped", 2}, {"agree", 3}, {"tie", 0}}) ==
        std::vector<std::string>{"agree", "capped", "zebra"});
}

TEST_CASE("text summary: failures with the command that repeats them, no colour unless asked") {
  const RunRecord run = example_run();
  const std::string text = text_summary(run);
  CHECK_THAT(text, Catch::Contains("FAILED hits.random_chords.balls_4: 3 rays are tracer_wrong"));
  CHECK_THAT(text, Catch::Contains("plumbline run hits.random_chords.balls_4 --seed "));
  CHECK_THAT(text, Catch::Contains("it has the fault loop_cap"));
  CHECK(text.find("float_round_trip") == std::string::npos);
  CHECK(text.find('\x1b') == std::string::npos);
  CHECK_THAT(text_summary(run, {.color = true}), Catch::Contains("\x1b[31;1mFAILED\x1b[0m"));
  CHECK_THAT(text_summary(run, {.failures = 1}), Catch::Contains("and 2 more cases"));
  CHECK_THAT(text, Catch::Contains("aimed_edges         4    306,000"));

  RunRecord nasty = run;
  nasty.cases.back().status = CaseStatus::failed;
  nasty.cases.back().message = kNastyText;
  CHECK(text_summary(nasty).find('\x1b') == std::string::npos);
  CHECK_THAT(markdown_summary(run),
             Catch::StartsWith("# Failed: 3 of 24 cases. 11 rays are judged leak, 3 tracer\\_wrong."));
  CHECK_THAT(markdown_summary(run), Catch::Contains("| aimed\\_edges | 4 | 306,000 |"));
}

TEST_CASE("format: numbers as people read them") {
  CHECK(grouped(0) == "0");
  CHECK(grouped(999) == "999");
  CHECK(grouped(1000) == "1,000");
  CHECK(grouped(20480000) == "20,480,000");
  CHECK(counted(1, "ray") == "1 ray");
  CHECK(short_count(999) == "999");
  CHECK(short_count(1000) == "1.0k");
  CHECK(short_count(76500) == "76.5k");
  CHECK(short_count(999499) == "999k");
  CHECK(short_count(999500) == "1.0M");
  CHECK(short_count(20480000) == "20.5M");
  CHECK(percent(1, 3) == "33 %");
  CHECK(percent(0, 3) == "0 %");
  CHECK(percent(3, 3) == "100 %");
  CHECK(percent(999999, 1000000) == "99.9999 %");
  CHECK(percent(1, 100000000) == "1.0e-06 %");
  CHECK(duration(0.0031) == "3 ms");
  CHECK(duration(0.9996) == "1.0 s");
  CHECK(duration(59.7) == "1 min 0 s");
  CHECK(duration(552.4) == "9 min 12 s");
  CHECK(duration(7500) == "2 h 5 min");
  CHECK(duration(std::numeric_limits<double>::quiet_NaN()) == "unknown");
  CHECK(value_text(0.55123) == "0.5512");
  CHECK(value_text(-5123456.0) == "-5,123,456");
  CHECK(value_text(1.2e-9) == "1.2e-09");
  CHECK(value_text(-std::numeric_limits<double>::infinity()) == "-inf");
}

TEST_CASE("format: text that is not UTF-8 becomes UTF-8") {
  const std::string bad = "\xef\xbf\xbd";
  CHECK(valid_utf8("caf\xc3\xa9 \xf0\x9f\x98\x80") == "caf\xc3\xa9 \xf0\x9f\x98\x80");
  CHECK(valid_utf8("a\xff"
                   "b") == "a" + bad + "b");
  CHECK(valid_utf8("\xc3") == bad);            // cut short
  CHECK(valid_utf8("\xc0\x80") == bad + bad);  // overlong
  CHECK(valid_utf8("\xe0\x80\x80") == bad + bad + bad);
  CHECK(valid_utf8("\xf0\x80\x80\x80") == bad + bad + bad + bad);
  CHECK(valid_utf8("\xed\xa0\x80") == bad + bad + bad);            // a surrogate
  CHECK(valid_utf8("\xf4\x90\x80\x80") == bad + bad + bad + bad);  // beyond U+10FFFF
  CHECK(xml_escape("\x01<&>\"\t\xef\xbf\xbe") == bad + "&lt;&amp;&gt;&quot;\t" + bad);
  CHECK(html_escape(std::string_view("\0'", 2)) == bad + "'");
}

}  // namespace plumbline
