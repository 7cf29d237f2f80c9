// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a second buys. After n rays without a failure, a share of failing rays above 3/n would have shown itself with
// probability 0.95 (the rule of three). Another pass of k rays lowers that bound by 3/n - 3/(n + k) = 3 k / (n (n + k))
// and takes as long as the passes before did on average: cases with few or quick rays come first, and each pass moves
// its case back in the row.
#include "harness/deeper.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "harness/nights.h"
#include "reports/summary.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

constexpr const char* kPasses = "further passes";

double gain_per_second(const CaseRecord& record) {
  const auto n = static_cast<double>(record.rays);
  const double passes = 1.0 + static_cast<double>(passes_of(record));
  const double k = n / passes;
  return 3.0 * k / (n * (n + k)) / std::max(1e-3, record.seconds / passes);
}

Figure& passes_figure(CaseRecord& record) {
  for (Figure& figure : record.figures)
    if (figure.name == kPasses) return figure;
  Figure& figure = record.figures.emplace_back();
  figure.name = kPasses;
  return figure;
}

}  // namespace

std::uint64_t pass_seed(std::uint64_t run_seed, std::uint64_t pass) {
  return pass == 0 ? run_seed
                   : mix64(run_seed + 0x9e3779b97f4a7c15ull * pass) >> 2;  // at most 19 digits, as --seed takes
}

std::uint64_t passes_of(const CaseRecord& record) {
  for (const Figure& figure : record.figures)
    if (figure.name == kPasses) return static_cast<std::uint64_t>(figure.value);
  return 0;
}

std::vector<std::size_t> worth_another_pass(const std::vector<Case>& cases, const std::vector<CaseRecord>& records) {
  std::unordered_map<std::string, const CaseRecord*> by_name;
  for (const CaseRecord& record : records) by_name[record.name] = &record;
  std::vector<std::pair<double, std::size_t>> gains;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto found = by_name.find(cases[i].name);
    // Cases without rays answer the same again, and one that failed needs no more evidence.
    if (found == by_name.end() || cases[i].rays == 0 || found->second->rays == 0 ||
        outcome(*found->second) != CaseStatus::passed)
      continue;
    gains.emplace_back(-gain_per_second(*found->second), i);
  }
  std::sort(gains.begin(), gains.end());
  gains.resize((gains.size() + 1) / 2);
  std::vector<std::size_t> numbers;
  for (const auto& [gain, i] : gains) numbers.push_back(i);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

void add_pass(CaseRecord& record, CaseRecord next) {
  const auto before = 1.0 + static_cast<double>(passes_of(record));
  record.rays += next.rays;
  for (const auto& [verdict, rays] : next.verdicts) record.verdicts[verdict] += rays;
  record.seconds += next.seconds;
  record.trace_seconds += next.trace_seconds;
  record.max_margin_ratio = std::max(record.max_margin_ratio, next.max_margin_ratio);
  for (Figure& figure : record.figures) {
    const auto same = std::find_if(next.figures.begin(), next.figures.end(),
                                   [&](const Figure& f) { return f.name == figure.name && f.unit == figure.unit; });
    if (same == next.figures.end() || (figure.unit != kUnitZ && figure.unit != kUnitP)) continue;
    const bool is_p = figure.unit == kUnitP;
    const double old = is_p ? z_of_p(figure.value) : figure.value, more = is_p ? z_of_p(same->value) : same->value;
    const double z = (old * std::sqrt(before) + more) / std::sqrt(before + 1.0);
    figure.value = is_p ? pooled({z}, false, 1).p : z;
  }
  if (is_failure(outcome(next))) {
    record.status = next.status;
    record.message = "in a further pass: " + message_of(next);
    record.replay = next.replay;
    record.worst.insert(record.worst.begin(), std::make_move_iterator(next.worst.begin()),
                        std::make_move_iterator(next.worst.end()));
  }
  passes_figure(record).value += 1.0;
}

}  // namespace plumbline
