// SPDX-License-Identifier: MIT
// See summary.h.
#include "reports/summary.h"

#include <algorithm>
#include <unordered_set>

#include "reports/format.h"

namespace plumbline {
namespace {

std::vector<std::string> distinct(const RunRecord& run, std::string CaseRecord::*field) {
  std::vector<std::string> values;
  std::unordered_set<std::string> seen;
  for (const CaseRecord& record : run.cases)
    if (!(record.*field).empty() && seen.insert(record.*field).second) values.push_back(record.*field);
  return values;
}

}  // namespace

const std::vector<VerdictInfo>& verdict_infos() {
  static const std::vector<VerdictInfo> infos = {
      {"agree", "Both hit the same primitive and every value is within its bound, or both miss.", false},
      {"tie", "They hit different primitives, and exact arithmetic says that both are nearest.", false},
      {"grazing", "Exact arithmetic decides, by less than 32-bit evaluation can resolve.", false},
      {"reference_wrong", "Exact arithmetic says that the reference erred.", false},
      {"undefined", "The ray has no answer: NaN, infinite, or without direction.", false},
      {"leak", "The ray slipped through a shared edge or corner of a closed surface.", true},
      {"tracer_wrong", "Exact arithmetic says that the tracer erred.", true},
      {"capped", "Traversal did not end within the number of cells.", true},
  };
  return infos;
}

std::vector<std::string> verdicts_in_order(const VerdictCounts& counts) {
  std::vector<std::string> names;
  for (const VerdictInfo& info : verdict_infos()) {
    const auto found = counts.find(std::string(info.name));
    if (found != counts.end() && found->second > 0) names.emplace_back(info.name);
  }
  for (const auto& [name, count] : counts)
    if (count > 0 && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

bool verdict_always_fails(std::string_view verdict) {
  const auto& infos = verdict_infos();
  const auto found = std::find_if(infos.begin(), infos.end(), [&](const VerdictInfo& i) { return i.name == verdict; });
  return found != infos.end() && found->always_fails;
}

std::string_view status_name(CaseStatus status) {
  switch (status) {
    case CaseStatus::passed:
      return "passed";
    case CaseStatus::failed:
      return "failed";
    case CaseStatus::error:
      return "error";
    case CaseStatus::skipped:
      return "skipped";
  }
  return "error";
}

std::uint64_t rays_without_verdict(const CaseRecord& record) {
  std::uint64_t judged = 0;
  for (const auto& [name, count] : record.verdicts) judged += count;
  return record.rays > judged ? record.rays - judged : 0;
}

std::uint64_t failing_rays(const CaseRecord& record) {
  std::uint64_t rays = 0;
  for (const auto& [name, count] : record.verdicts)
    if (verdict_always_fails(name)) rays += count;
  return rays;
}

CaseStatus outcome(const CaseRecord& record) {
  return record.status == CaseStatus::passed && rays_without_verdict(record) > 0 ? CaseStatus::failed : record.status;
}

std::string message_of(const CaseRecord& record) {
  std::string text = record.message;
  if (const std::uint64_t missing = rays_without_verdict(record))
    text += (text.empty() ? "" : "; ") + counted(missing, "ray") + " without a verdict";
  return text.empty() && is_failure(record.status) ? std::string(status_name(record.status)) : text;
}

RunSummary summarize(const RunRecord& run) {
  RunSummary summary;
  summary.cases = run.cases.size();
  for (const CaseRecord& record : run.cases) {
    const CaseStatus status = outcome(record);
    summary.passed += status == CaseStatus::passed;
    summary.failed += is_failure(status);
    summary.errors += status == CaseStatus::error;
    summary.skipped += status == CaseStatus::skipped;
    summary.rays += record.rays;
    summary.without_verdict += rays_without_verdict(record);
    for (const auto& [name, count] : record.verdicts) summary.verdicts[name] += count;
  }
  if (run.planned_cases > summary.cases) summary.unfinished = run.planned_cases - summary.cases;
  return summary;
}

std::string headline(const RunSummary& summary) {
  std::string cases = counted(summary.cases - summary.skipped, "case");
  if (summary.ok()) {
    std::string text =
        "Passed: " +
        (summary.rays ? counted(summary.rays, "ray") + " in " + cases + ", no ray without a verdict" : cases);
    if (summary.skipped) text += "; " + counted(summary.skipped, "case") + " skipped";
    return text + ".";
  }
  if (summary.failed) {
    std::string text = "Failed: " + grouped(summary.failed) + " of " + cases + ".";
    std::string rays;
    for (const std::string& name : verdicts_in_order(summary.verdicts)) {
      if (!verdict_always_fails(name)) continue;
      const std::uint64_t count = summary.verdicts.at(name);
      rays += rays.empty() ? " " + counted(count, "ray") + (count == 1 ? " is judged " : " are judged ")
                           : ", " + grouped(count) + " ";
      rays += name;
    }
    if (!rays.empty()) text += rays + ".";
    if (summary.without_verdict) text += " " + counted(summary.without_verdict, "ray") + " without a verdict.";
    if (summary.unfinished) text += " " + counted(summary.unfinished, "case") + " never ended.";
    return text;
  }
  if (summary.unfinished)
    return "Incomplete: " + grouped(summary.cases) + " of " + grouped(summary.cases + summary.unfinished) +
           " cases ended, none of them failed.";
  return summary.cases ? "Nothing was tested: all " + counted(summary.skipped, "case") + " skipped."
                       : "Nothing was tested: the run has no cases.";
}

std::vector<std::string> families_of(const RunRecord& run) { return distinct(run, &CaseRecord::family); }
std::vector<std::string> scenes_of(const RunRecord& run) { return distinct(run, &CaseRecord::scene); }
std::vector<std::string> features_of(const RunRecord& run) { return distinct(run, &CaseRecord::feature); }

}  // namespace plumbline
