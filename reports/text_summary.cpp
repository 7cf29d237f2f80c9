// SPDX-License-Identifier: MIT
// See text_summary.h.
#include "reports/text_summary.h"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "reports/files.h"
#include "reports/format.h"
#include "reports/summary.h"

namespace plumbline {
namespace {

// A page for a chat message: so many failing cases and families, the rest is counted.
constexpr std::size_t kMarkdownFailures = 10, kMarkdownFamilies = 20;

/// The families that are shown: at most `most`, those with rays that fail first, in the run's order.
std::set<std::string> shown_families(const RunRecord& run, std::size_t most) {
  const std::vector<std::string> families = families_of(run);
  std::set<std::string> failing, shown;
  for (const CaseRecord& record : run.cases)
    for (const auto& [name, count] : record.verdicts)
      if (count && verdict_always_fails(name)) failing.insert(record.family);
  for (const bool wanted : {true, false})
    for (const std::string& family : families)
      if (failing.contains(family) == wanted && shown.size() < most) shown.insert(family);
  return shown;
}

/// Cells of text, the first row being the heading; empty where no ray was judged.
std::vector<std::vector<std::string>> verdict_table(const RunRecord& run,
                                                    std::size_t most = std::numeric_limits<std::size_t>::max()) {
  const RunSummary total = summarize(run);
  if (total.rays == 0) return {};
  const std::vector<std::string> verdicts = verdicts_in_order(total.verdicts);
  std::vector<std::vector<std::string>> rows = {{"family", "cases", "rays"}};
  rows[0].insert(rows[0].end(), verdicts.begin(), verdicts.end());
  if (total.without_verdict) rows[0].emplace_back("none");

  const auto add_row = [&](const std::string& label, const auto& belongs) {
    std::uint64_t cases = 0, rays = 0, without = 0;
    VerdictCounts counts;
    for (const CaseRecord& record : run.cases) {
      if (record.rays == 0 || !belongs(record)) continue;
      ++cases;
      rays += record.rays;
      without += rays_without_verdict(record);
      for (const auto& [name, count] : record.verdicts) counts[name] += count;
    }
    if (cases == 0) return;
    std::vector<std::string> row = {label, grouped(cases), grouped(rays)};
    for (const std::string& name : verdicts) row.push_back(counts[name] ? grouped(counts[name]) : "");
    if (total.without_verdict) row.push_back(without ? grouped(without) : "");
    rows.push_back(std::move(row));
  };
  const std::vector<std::string> families = families_of(run);
  const std::set<std::string> shown = shown_families(run, most);
  for (const std::string& family : families)
    if (shown.contains(family)) add_row(family, [&](const CaseRecord& record) { return record.family == family; });
  if (shown.size() < families.size())
    add_row("(" + grouped(families.size() - shown.size()) + " others)",
            [&](const CaseRecord& record) { return !record.family.empty() && !shown.contains(record.family); });
  add_row("(no family)", [](const CaseRecord& record) { return record.family.empty(); });
  add_row("all", [](const CaseRecord&) { return true; });
  return rows;
}

std::vector<const CaseRecord*> failures_of(const RunRecord& run) {
  std::vector<const CaseRecord*> failures;
  for (const CaseRecord& record : run.cases)
    if (is_failure(outcome(record))) failures.push_back(&record);
  return failures;
}

/// For a terminal: a control character in a name or message must not reach it.
std::string printable(std::string_view text) {
  std::string out = valid_utf8(text);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return out;
}

/// For a Markdown table cell or list item.
std::string markdown(std::string_view text) {
  std::string out;
  for (const char c : printable(text)) {
    if (c == '|' || c == '`' || c == '*' || c == '_' || c == '<' || c == '[' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

/// A code span whose fence is longer than any run of backticks inside.
std::string code(std::string_view text) {
  const std::string clean = printable(text);
  std::size_t longest = 0, run = 0;
  for (const char c : clean) longest = std::max(longest, run = c == '`' ? run + 1 : 0);
  const std::string fence(longest + 1, '`'), pad = longest ? " " : "";
  return fence + pad + clean + pad + fence;
}

}  // namespace

std::string text_summary(const RunRecord& run, const TextOptions& options) {
  const RunSummary total = summarize(run);
  const auto paint = [&](const char* code_number, const std::string& text) {
    return options.color ? "\x1b[" + std::string(code_number) + "m" + text + "\x1b[0m" : text;
  };
  std::string out;

  const auto table = verdict_table(run);
  if (!table.empty()) {
    std::vector<std::size_t> widths(table[0].size(), 0);
    for (const auto& row : table)
      for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    for (std::size_t r = 0; r < table.size(); ++r) {
      std::string line;
      for (std::size_t i = 0; i < table[r].size(); ++i) {
        const std::string cell = printable(table[r][i]);
        const std::string pad(widths[i] - std::min(widths[i], cell.size()), ' ');
        line += i == 0 ? cell + pad : "  " + pad + cell;
      }
      line.erase(line.find_last_not_of(' ') + 1);
      if (r + 1 == table.size()) out += std::string(line.size(), '-') + "\n";
      out += (r == 0 ? paint("1", line) : line) + "\n";
    }
    out += "\n";
  }

  out += "driver: " + printable(run.driver_renderer) + ", " + printable(run.driver_version) + "\n";
  for (const DriverFinding& finding : run.findings)
    if (finding.found)
      out += "  it has the fault " + paint("33", printable(finding.name)) + ": " + printable(finding.detail) + "\n";

  const auto failures = failures_of(run);
  if (!failures.empty()) out += "\n";
  for (std::size_t i = 0; i < failures.size() && i < options.failures; ++i) {
    const CaseRecord& record = *failures[i];
    out += paint("31;1", "FAILED") + " " + printable(record.name) + ": " + printable(message_of(record)) + "\n";
    if (!record.replay.empty()) out += "       " + printable(record.replay) + "\n";
  }
  if (failures.size() > options.failures)
    out += "       and " + counted(failures.size() - options.failures, "more case") + " in the report\n";

  out += "\n" + paint(total.ok() ? "32;1" : "31;1", headline(total));
  if (const auto found = total.verdicts.find("reference_wrong"); found != total.verdicts.end() && found->second)
    out += "\nThe reference was wrong on " + counted(found->second, "ray") + ": listed with proof in the report.";
  out += "\nseed " + std::to_string(run.seed) + ", " + duration(run.seconds) + "\n";
  return out;
}

std::string markdown_summary(const RunRecord& run) {
  const RunSummary total = summarize(run);
  std::string out = "# " + markdown(headline(total)) + "\n\n";
  out += "Plumbline " + markdown(run.version) + (run.commit.empty() ? "" : " at " + code(run.commit)) + ", " +
         markdown(run.started) + ", " + duration(run.seconds) + ", seed " + std::to_string(run.seed) +
         ". Driver: " + markdown(run.driver_renderer) + ", " + markdown(run.driver_version) + ".\n";
  for (const DriverFinding& finding : run.findings)
    if (finding.found)
      out += "\n- The driver has the fault **" + markdown(finding.name) + "**: " + markdown(finding.detail);
  const auto failures = failures_of(run);
  if (!failures.empty()) {
    out += "\n\n## What failed\n";
    for (std::size_t i = 0; i < failures.size() && i < kMarkdownFailures; ++i) {
      const CaseRecord& record = *failures[i];
      out += "\n- **" + markdown(record.name) + "**: " + markdown(message_of(record));
      if (!record.replay.empty()) out += "  \n  " + code(record.replay);
    }
    if (failures.size() > kMarkdownFailures)
      out += "\n- and " + counted(failures.size() - kMarkdownFailures, "more case") + " in the report";
  }
  const auto table = verdict_table(run, kMarkdownFamilies);
  if (!table.empty()) out += "\n\n## Verdicts by family (rays)\n\n";
  for (std::size_t r = 0; r < table.size(); ++r) {
    out += "|";
    for (const std::string& cell : table[r]) out += " " + markdown(cell) + " |";
    out += "\n";
    if (r != 0) continue;
    out += "|---|";
    for (std::size_t i = 1; i < table[0].size(); ++i) out += "--:|";
    out += "\n";
  }
  return out + (table.empty() ? "\n" : "");
}

void write_markdown(const RunRecord& run, const std::filesystem::path& file) {
  write_text(file, markdown_summary(run));
}

}  // namespace plumbline
