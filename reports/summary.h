// SPDX-License-Identifier: MIT
// What a run comes to: totals, and the one sentence that says it. Every face of the record (page, terminal, JSON) uses
// these.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "reports/record.h"

namespace plumbline {

struct VerdictInfo {
  std::string_view name, meaning;  ///< the meaning in one short sentence
  bool always_fails;               ///< one such ray fails its case
};
/// The verdicts of a comparison, in the order of display: from harmless to grave.
const std::vector<VerdictInfo>& verdict_infos();
/// The names that occur in `counts` with a count above 0, in the order of display; unknown names last.
std::vector<std::string> verdicts_in_order(const VerdictCounts& counts);
bool verdict_always_fails(std::string_view verdict);

std::string_view status_name(CaseStatus status);  ///< "passed"
/// What the case comes to: its status, but `failed` where it says passed and some of its rays got no verdict.
CaseStatus outcome(const CaseRecord& record);
inline bool is_failure(CaseStatus status) { return status == CaseStatus::failed || status == CaseStatus::error; }

struct RunSummary {
  std::uint64_t cases = 0;
  std::uint64_t passed = 0;
  std::uint64_t failed = 0;  ///< those that ended in an error included: cases = passed + failed + skipped
  std::uint64_t errors = 0;  ///< of the failed ones
  std::uint64_t skipped = 0;
  std::uint64_t rays = 0;
  std::uint64_t without_verdict = 0;  ///< rays that got none: always a fault of the harness
  std::uint64_t unfinished = 0;       ///< planned cases that never ended
  VerdictCounts verdicts;
  bool ok() const { return failed == 0 && without_verdict == 0 && unfinished == 0 && passed > 0; }
};
RunSummary summarize(const RunRecord& run);
/// Rays of one case that got no verdict.
std::uint64_t rays_without_verdict(const CaseRecord& record);
/// Rays of one case whose verdict alone fails it (leak, tracer_wrong, capped).
std::uint64_t failing_rays(const CaseRecord& record);
/// The message of the case, with the rays that got no verdict added; never empty for a failure.
std::string message_of(const CaseRecord& record);

/// "Passed: 20,480,000 rays in 268 cases, no ray without a verdict."
/// "Failed: 3 of 268 cases. 12 rays are judged tracer_wrong, 1 capped."
std::string headline(const RunSummary& summary);

/// Values in the order of their first appearance, empty ones left out.
std::vector<std::string> families_of(const RunRecord& run);
std::vector<std::string> scenes_of(const RunRecord& run);
std::vector<std::string> features_of(const RunRecord& run);

}  // namespace plumbline
