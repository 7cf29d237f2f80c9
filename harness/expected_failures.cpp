// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/expected_failures.h"

#include <algorithm>

#include "harness/catalogue.h"
#include "harness/json_entries.h"
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
  std::vector<ExpectedFailure> list;
  for (const JsonEntry& read : read_json_entries(file, {"cases", "reason", "until", "driver"})) {
    const ExpectedFailure& entry = list.emplace_back(
        ExpectedFailure{read.text("cases"), read.text("reason"), read.text("until"), read.text("driver")});
    if (entry.cases.empty()) read.refuse("\"cases\" names the cases that are expected to fail");
    if (entry.reason.empty()) read.refuse("\"reason\" says in a sentence why");
    if (!is_day(entry.until)) read.refuse("\"until\" is the last day on which that is accepted, such as 2027-01-31");
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
