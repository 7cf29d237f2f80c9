// SPDX-License-Identifier: MIT
// See junit.h.
#include "reports/junit.h"

#include <cmath>
#include <vector>

#include "reports/files.h"
#include "reports/format.h"
#include "reports/summary.h"

namespace plumbline {
namespace {

std::string attribute(const char* name, std::string_view value) {
  return " " + std::string(name) + "=\"" + xml_escape(value) + "\"";
}

std::string property(std::string_view name, std::string_view value) {
  return "      <property" + attribute("name", name) + attribute("value", value) + "/>\n";
}

std::string seconds_text(double seconds) { return fixed(std::isfinite(seconds) ? seconds : 0.0, 3); }

std::string counts_text(const VerdictCounts& verdicts) {
  std::string text;
  for (const std::string& name : verdicts_in_order(verdicts))
    text += (text.empty() ? "" : ", ") + name + " " + grouped(verdicts.at(name));
  return text;
}

/// What a reader needs to see and to type, as plain text.
std::string details(const CaseRecord& record) {
  std::string text;
  if (const std::string message = message_of(record); !message.empty()) text += message + "\n";
  if (!record.proves.empty()) text += "proves: " + record.proves + "\n";
  if (record.rays) text += "rays: " + grouped(record.rays) + "; verdicts: " + counts_text(record.verdicts) + "\n";
  text += "seed: " + std::to_string(record.seed) + "\n";
  if (!record.replay.empty()) text += "replay: " + record.replay + "\n";
  return text;
}

std::string test_case(const CaseRecord& record, const std::filesystem::path& folder) {
  std::string xml = "    <testcase" + attribute("name", record.name) +
                    attribute("classname", "plumbline." + record.feature) +
                    attribute("time", seconds_text(record.seconds)) + ">\n";
  if (record.status == CaseStatus::skipped) {
    xml += "      <skipped" + attribute("message", record.message) + "/>\n";
  } else if (is_failure(outcome(record))) {
    const bool error = record.status == CaseStatus::error;
    const std::string tag = error ? "error" : "failure";
    std::string kinds;
    for (const std::string& name : verdicts_in_order(record.verdicts))
      if (verdict_always_fails(name)) kinds += (kinds.empty() ? "" : ",") + name;
    xml += "      <" + tag + attribute("message", message_of(record)) +
           attribute("type", error           ? "error"
                             : kinds.empty() ? "failed"
                                             : kinds) +
           ">" + xml_escape(details(record)) + "</" + tag + ">\n";
  }
  std::string out = details(record);
  for (const PictureRecord& picture : record.pictures)
    out += "[[ATTACHMENT|" + (folder / picture.path).string() + "]]\n";
  xml += "      <system-out>" + xml_escape(out) + "</system-out>\n    </testcase>\n";
  return xml;
}

struct Totals {
  std::uint64_t tests = 0, failures = 0, errors = 0, skipped = 0;
  double seconds = 0.0;
};

std::string attributes_of(const Totals& total) {
  return attribute("tests", std::to_string(total.tests)) + attribute("failures", std::to_string(total.failures)) +
         attribute("errors", std::to_string(total.errors)) + attribute("skipped", std::to_string(total.skipped)) +
         attribute("time", seconds_text(total.seconds));
}

}  // namespace

std::string junit_xml(const RunRecord& run, const std::filesystem::path& folder) {
  std::vector<std::string> features = features_of(run);
  for (const CaseRecord& record : run.cases)
    if (record.feature.empty()) {
      features.emplace_back();
      break;
    }
  // xs:dateTime without a zone is what both readers take.
  std::string timestamp = run.started;
  if (!timestamp.empty() && timestamp.back() == 'Z') timestamp.pop_back();

  Totals all;
  std::string suites;
  for (const std::string& feature : features) {
    Totals total;
    std::string cases;
    for (const CaseRecord& record : run.cases) {
      if (record.feature != feature) continue;
      ++total.tests;
      total.errors += record.status == CaseStatus::error;
      total.skipped += record.status == CaseStatus::skipped;
      total.failures += outcome(record) == CaseStatus::failed;
      if (std::isfinite(record.seconds)) total.seconds += record.seconds;
      cases += test_case(record, folder);
    }
    suites += "  <testsuite" + attribute("name", feature.empty() ? "other" : feature) + attributes_of(total);
    if (!timestamp.empty()) suites += attribute("timestamp", timestamp);
    suites += ">\n    <properties>\n" + property("version", run.version) + property("commit", run.commit) +
              property("command", run.command) + property("seed", std::to_string(run.seed)) +
              property("driver.renderer", run.driver_renderer) + property("driver.version", run.driver_version);
    for (const DriverFinding& finding : run.findings)
      suites += property("driver.finding." + finding.name, finding.found ? "found: " + finding.detail : "not found");
    suites += property("machine", run.machine) + "    </properties>\n" + cases + "  </testsuite>\n";
    all.tests += total.tests, all.failures += total.failures, all.errors += total.errors, all.skipped += total.skipped;
    all.seconds += total.seconds;
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"plumbline\"" + attributes_of(all) + ">\n" +
         suites + "</testsuites>\n";
}

void write_junit(const RunRecord& run, const std::filesystem::path& file) {
  const std::filesystem::path whole = std::filesystem::absolute(file).lexically_normal().parent_path();
  const std::filesystem::path below = whole.lexically_relative(std::filesystem::current_path());
  const bool is_below = !below.empty() && *below.begin() != "..";
  write_text(file, junit_xml(run, is_below ? (below == "." ? std::filesystem::path() : below) : whole));
}

}  // namespace plumbline
