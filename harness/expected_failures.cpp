// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/expected_failures.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/catalogue.h"
#include "reports/files.h"
#include "reports/summary.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// "2027-01-31": days compare as their text does.
bool is_day(const std::string& text) {
  if (text.size() != 10) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (i == 4 || i == 7 ? text[i] != '-' : text[i] < '0' || text[i] > '9') return false;
  return text.substr(5, 2) >= "01" && text.substr(5, 2) <= "12" && text.substr(8) >= "01" && text.substr(8) <= "31";
}

}  // namespace

std::filesystem::path expected_failures_file() { return PLUMBLINE_EXPECTED_FAILURES; }

std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& file) {
  const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
  const std::string name = file.string();
  if (!json.is_array())
    throw InputError(name + ": expected a JSON array of objects with the keys cases, reason and until");
  std::vector<ExpectedFailure> list;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto refuse = [&](const std::string& why) {
      throw InputError(name + ": entry " + std::to_string(i) + ": " + why);
    };
    if (!json[i].is_object()) refuse("expected an object");
    ExpectedFailure& entry = list.emplace_back();
    for (const auto& [key, value] : json[i].items()) {
      std::string* field = key == "cases"    ? &entry.cases
                           : key == "reason" ? &entry.reason
                           : key == "until"  ? &entry.until
                           : key == "driver" ? &entry.driver
                                             : nullptr;
      if (!field) refuse("there is no key \"" + key + "\"; keys are cases, reason, until, driver");
      if (!value.is_string()) refuse("\"" + key + "\" is text");
      *field = value.get<std::string>();
    }
    if (entry.cases.empty()) refuse("\"cases\" names the cases that are expected to fail");
    if (entry.reason.empty()) refuse("\"reason\" says in a sentence why");
    if (!is_day(entry.until)) refuse("\"until\" is the last day on which that is accepted, such as 2027-01-31");
  }
  return list;
}

void judge_by_expectation(const std::vector<ExpectedFailure>& expected, const std::string& driver,
                          const std::string& today, CaseRecord& record) {
  const auto entry = std::find_if(expected.begin(), expected.end(), [&](const ExpectedFailure& e) {
    return selects(e.cases, record.name) && driver.find(e.driver) != std::string::npos;
  });
  const CaseStatus came = outcome(record);
  if (entry == expected.end() || came == CaseStatus::skipped) return;
  const std::string was = message_of(record);
  if (came == CaseStatus::passed) {
    record.status = CaseStatus::failed;
    record.message = "passes, though it is expected to fail (" + entry->reason + "): take \"" + entry->cases +
                     "\" off the list of expected failures";
  } else if (today > entry->until) {
    record.message = "was expected to fail until " + entry->until + ", which is over (" + entry->reason + "): " + was;
  } else {
    record.status = CaseStatus::skipped;
    record.message = "expected to fail until " + entry->until + " (" + entry->reason + "): " + was;
  }
}

}  // namespace plumbline
