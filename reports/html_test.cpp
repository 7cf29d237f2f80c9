// SPDX-License-Identifier: MIT
// The page holds what the record holds, nothing from outside, and stays small.
#include "reports/html.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "reports/example_run.h"
#include "reports/files.h"
#include "reports/format.h"
#include "reports/html_parts.h"

namespace plumbline {
namespace {

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

/// What stands between each `mark` and the next quote.
std::vector<std::string> values_after(const std::string& text, const std::string& mark) {
  std::vector<std::string> values;
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;) {
    at += mark.size();
    values.push_back(text.substr(at, text.find('"', at) - at));
  }
  return values;
}

std::string page_of(const RunRecord& run, const ReportOptions& options = {}) { return report_html(run, ".", options); }

/// What report.js does: the fields of every packed ray.
std::vector<std::vector<std::string>> unpacked(const RunRecord& run) {
  const auto data = nlohmann::json::parse(page::packed_rays(run, page::case_ids(run)));
  std::vector<std::vector<std::string>> rays;
  for (const auto& packed : data["rays"]) {
    std::string numbers = packed[2], text;
    for (const char c : data["texts"][packed[1].get<std::size_t>()].get<std::string>()) {
      if (c != '\1' && c != '\4') {
        text += c;
        continue;
      }
      const std::size_t end = std::min(numbers.find(' '), numbers.size());
      std::string word = numbers.substr(0, end);
      if (c == '\4') word.insert(word[0] == '-' ? 1 : 0, "0x1.");
      text += word;
      numbers.erase(0, end + 1);
    }
    std::vector<std::string> fields(1);
    for (const char c : text) {
      if (c == '\n')
        fields.emplace_back();
      else
        fields.back() += c;
    }
    for (const auto& [mark, value] : {std::pair{'\2', fields.at(2)}, std::pair{'\3', fields.at(3)}})
      if (const auto at = fields[11].find(mark); at != std::string::npos) fields[11].replace(at, 1, value);
    fields.insert(fields.begin(), data["names"][packed[0].get<std::size_t>()].get<std::string>());
    rays.push_back(fields);
  }
  return rays;
}

}  // namespace

TEST_CASE("html: the first thing said is the verdict") {
  const std::string failed = page_of(example_run());
  CHECK_THAT(failed, Catch::Contains("<h1>Failed: 3 of 24 cases. 11 rays are judged leak, 3 tracer_wrong.</h1>"));
  CHECK_THAT(failed, Catch::Contains("<h2>What failed</h2>"));
  const std::string passed = page_of(example_run({.failing = false}));
  CHECK_THAT(passed,
             Catch::Contains("<h1>Passed: 1,453,500 rays in 24 cases, no ray without a verdict; 1 case skipped.</h1>"));
  CHECK(passed.find("What failed") == std::string::npos);
}

TEST_CASE("html: every case has its section and every link its target") {
  const RunRecord run = example_run();
  const std::string html = page_of(run);
  std::set<std::string> ids;
  const std::string markup = html.substr(0, html.find("<script type=\"application/json\""));
  for (const std::string& id : values_after(markup, " id=\"")) CHECK(ids.insert(id).second);
  const std::vector<std::string> links = values_after(markup, "href=\"#");
  for (const std::string& link : links) {
    INFO(link);
    CHECK(ids.contains(link));
  }
  CHECK(links.size() > run.cases.size());
  CHECK(occurrences(markup, "<details id=\"case-") == run.cases.size());
  // In both matrices.
  CHECK(occurrences(markup, "<td class=\"s-failed\">") == 2 * 2);
  CHECK(occurrences(markup, "<td class=\"s-error\">") == 2 * 1);
  CHECK_THAT(markup, Catch::Contains("aria-label=\"hits on balls_4: 5 cases, 1 of them failed, "));
  CHECK_THAT(markup, Catch::Contains("aria-label=\"driver: 4 cases, passed\""));
  for (const char* element :
       {"section", "table", "details", "ul", "ol", "dl", "figure", "div", "span", "p", "svg", "td", "th", "tr"}) {
    INFO(element);
    const std::string open = std::string("<") + element;
    CHECK(occurrences(markup, open + ">") + occurrences(markup, open + " ") ==
          occurrences(markup, std::string("</") + element + ">"));
  }
}

TEST_CASE("html: nothing is loaded from anywhere") {
  const std::string html = page_of(example_run());
  const std::string icon = "http://www.w3.org/2000/svg";  // a namespace, never fetched
  CHECK(occurrences(html, "http://") == occurrences(html, icon));
  for (const char* word : {"https://", "@import", "<link rel=\"stylesheet", "<script src", "fetch(", "XMLHttpRequest"})
    CHECK(html.find(word) == std::string::npos);
}

TEST_CASE("html: hostile names stay text") {
  RunRecord run = example_run();
  for (std::string* text : {&run.commit, &run.command, &run.started, &run.driver_renderer, &run.findings[0].name,
                            &run.findings[0].detail, &run.machine, &run.version})
    *text = kNastyText;
  CaseRecord& record = run.cases[5];
  record.status = CaseStatus::failed;
  record.verdicts[kNastyText] = 0;
  record.pictures = {
      {"javascript:alert(1)", kNastyText, kNastyText, 1, 1, {0, 1, kNastyText, {"red;}</style>"}}, {}, kNastyText}};
  record.figures = {{kNastyText, kNastyText, 1.0}};
  for (std::string* text : {&record.name, &record.feature, &record.scene, &record.family, &record.proves, &record.paper,
                            &record.message, &record.replay})
    *text = kNastyText;
  record.worst.push_back({kNastyText, 1, kNastyText, kNastyText, kNastyText, kNastyText, kNastyText, kNastyText,
                          kNastyText, 0, 0, kNastyText});
  const std::string html = page_of(run);
  CHECK(html.find("<b a=") == std::string::npos);
  CHECK(html.find("{{main}}") != std::string::npos);  // as text, not filled in
  CHECK(html.find("javascript:") == std::string::npos);
  CHECK(html.find("red;}") == std::string::npos);
  CHECK(occurrences(html, "</script>") == 3);
  CHECK(occurrences(html, "<main") == 1);
  CHECK(valid_utf8(html) == html);
  CHECK(html.find('\x1b') == std::string::npos);
}

TEST_CASE("html: packed rays are the rays") {
  const RunRecord run = example_run({.rays_per_case = 9});
  const auto rays = unpacked(run);
  std::size_t next = 0;
  for (const CaseRecord& record : run.cases) {
    for (const RayRecord& ray : record.worst) {
      const auto& fields = rays.at(next++);
      REQUIRE(fields.size() == 15);
      CHECK(fields[0] == record.name);
      CHECK(fields[1] == ray.verdict);
      CHECK(fields[2] == std::to_string(ray.index));
      CHECK(fields[3] == ray.origin);
      CHECK(fields[4] == ray.direction);
      CHECK(fields[6] == ray.tracer);
      CHECK(fields[9] == ray.reason);
      CHECK(fields[12] == ray.replay);
      CHECK(fields[13] == ray.layer);
      CHECK(fields[14] == ray.explanation);
    }
  }
  CHECK(next == rays.size());
  CHECK(next > 100);
}

TEST_CASE("html: 500 cases and 5,000 rays stay below 1.5 MB") {
  const RunRecord run = example_run({.families = 25, .scenes = 20, .rays_per_case = 10});
  REQUIRE(run.cases.size() >= 500);
  CHECK(unpacked(run).size() >= 4800);
  const std::size_t bytes = page_of(run).size();
  INFO(bytes << " bytes");
  CHECK(bytes < 1500000);
}

TEST_CASE("html: what changed stands on the first screen") {
  const RunRecord run = example_run();
  ReportOptions options;
  RunChanges& changes = options.changes.emplace();
  changes.since = "2026-11-21T03:00:00Z";
  changes.newly_failing = {run.cases.back().name};
  changes.newly_passing = {"hits.gone"};
  changes.failing_since = {{run.cases.back().name, "2026-11-19T03:00:00Z", "0123456789abcdef", 3}};
  changes.slower = {{"hits.slow", 3.0, 2.0, 9}};
  changes.surroundings = {"Embree: 4.3, was <3>"};
  changes.pooled = {{"drt.biased", "mean", 30, 6.5, 1e-10, 1e-6}, {"drt.fine", "mean", 30, 0.5, 0.6, 1e-6}};
  options.past.resize(1);
  options.past[0].started = "2026-11-21T03:00:00Z";
  const std::string html = page_of(run, options);
  CHECK_THAT(html, Catch::Contains("newly failing (1):</b> <a href=\"#case-" + run.cases.back().name));
  CHECK_THAT(html, Catch::Contains("newly passing (1):</b> hits.gone"));
  CHECK_THAT(html, Catch::Contains("2026-11-21 03:00 UTC"));
  CHECK_THAT(html, Catch::Contains("last passed 2026-11-19 03:00 UTC at <code>0123456789</code>, failing for 3 runs"));
  CHECK_THAT(html, Catch::Contains("hits.slow: 3.0 s, 2.0 s before"));
  CHECK_THAT(html, Catch::Contains("Embree: 4.3, was &lt;3&gt;"));
  CHECK_THAT(html, Catch::Contains("drt.biased"));
  CHECK_THAT(html, !Catch::Contains("drt.fine"));
  CHECK(html.find("id=\"changes\"") < html.find("id=\"matrix\""));
}

TEST_CASE("html: a run without cases is a page that says so") {
  const std::string html = page_of(RunRecord{});
  CHECK_THAT(html, Catch::Contains("Nothing was tested"));
  CHECK(html.find("hero good") == std::string::npos);
}

TEST_CASE("html: the report is written whole, pictures inside or beside") {
  TemporaryFolder folder;
  RunRecord run = example_run({.families = 1, .scenes = 1});
  add_example_pictures(run, folder.path);
  write_report(run, folder.path);
  for (const char* name : {"index.html", "results.json", "junit.xml", "report.md"})
    CHECK(std::filesystem::file_size(folder.path / name) > 100);
  const std::string beside = read_text(folder.path / "index.html");
  CHECK_THAT(beside, Catch::Contains("src=\"pictures/hits.camera.balls_3.steps.png\""));
  const std::string inside = report_html(run, folder.path, {.embed_pictures = true, .changes = {}, .past = {}});
  CHECK(occurrences(inside, "src=\"data:image/png;base64,iVBORw0KGgo") == 6);
  CHECK(occurrences(inside, "data-values=\"data:text/javascript;base64,") == 3);
  for (const char* beside_it : {" src=\"pictures/", "data-values=\"pictures/"})
    CHECK(inside.find(beside_it) == std::string::npos);
  CHECK_THAT(beside, Catch::Contains("data-values=\"pictures/hits.camera.balls_3.tracer.values.js\""));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path))
    CHECK(entry.path().string().find(".part") == std::string::npos);
}

// To look at the page: PLUMBLINE_EXAMPLE=FOLDER build/.../reports_test "[.example]"
TEST_CASE("html: the example report", "[.example]") {
  const char* target = std::getenv("PLUMBLINE_EXAMPLE");
  REQUIRE(target != nullptr);
  RunRecord run = example_run({.families = 15, .scenes = 20, .rays_per_case = 16});
  add_example_pictures(run, target);
  add_example_explanations(run, target);
  ReportOptions options;
  RunChanges& changes = options.changes.emplace();
  changes.since = changes.last_pass = "2026-11-21T03:00:00Z";
  changes.newly_failing = {"hits.random_chords.balls_4"};
  changes.newly_passing = {"hits.camera.bunny"};
  changes.still_failing = {"hits.aimed_edges.tetra_6"};
  changes.failing_since = {{"hits.random_chords.balls_4", "2026-11-21T03:00:00Z", "0123456789ab", 1},
                           {"hits.aimed_edges.tetra_6", "2026-11-18T03:00:00Z", "0123456789ab", 4}};
  changes.surroundings = {"Embree: 3.13.5, was 3.13.4"};
  changes.slower = {{"hits.camera.bunny", 3.1, 2.0, 9}};
  changes.pooled = {{"drt.independent.dof.bunny", "mean of the image", 30, 6.5, 1e-10, 1e-6}};
  for (int day = 21; day > 11; --day) {
    PastRun past;
    past.started = "2026-11-" + std::to_string(day) + "T03:00:00Z";
    past.commit = "0123456789ab";
    past.seconds = 540.0 + day;
    past.summary = {305, 304, day % 7 == 0 ? 1u : 0u, 0, 1, 22873500, 0, 0, {}};
    options.past.push_back(past);
  }
  write_report(run, target, options);
}

}  // namespace plumbline
