// SPDX-License-Identifier: MIT
// See html.h. This file puts the page together and writes its first screen: the verdict, what failed, what changed.
#include "reports/html.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "reports/assets.h"
#include "reports/color.h"
#include "reports/files.h"
#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/json.h"
#include "reports/junit.h"
#include "reports/summary.h"
#include "reports/text_summary.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr std::size_t kShownFailures = 12;

/// "2026-11-22T03:00:00Z" as people write it.
std::string readable_time(const std::string& iso) {
  std::string text = iso;
  if (text.size() >= 16 && text[10] == 'T')
    text = text.substr(0, 10) + " " + text.substr(11, 5) + (text.back() == 'Z' ? " UTC" : "");
  return html_escape(text);
}

std::string tile(std::string_view name, const std::string& value, const std::string& note) {
  return "<div class=\"tile\"><dt>" + std::string(name) + "</dt><dd>" + value + "<small>" + note +
         "</small></dd></div>";
}

std::string tiles(const RunRecord& run, const RunSummary& total) {
  std::string html = "<dl class=\"tiles\">";
  html += tile("cases passed", grouped(total.passed),
               "of " + grouped(total.cases + total.unfinished) +
                   (total.skipped ? ", " + grouped(total.skipped) + " skipped" : ""));
  if (total.rays) {
    const auto count = [&](const char* name) {
      const auto found = total.verdicts.find(name);
      return found == total.verdicts.end() ? 0 : found->second;
    };
    html +=
        tile("rays judged", grouped(total.rays - total.without_verdict),
             total.without_verdict ? grouped(total.without_verdict) + " without a verdict" : "none without a verdict");
    html += tile("agree", percent(count("agree"), total.rays),
                 grouped(total.rays - count("agree")) + " do not simply agree");
    html += tile("tracer wrong", grouped(count("tracer_wrong") + count("leak") + count("capped")),
                 "tracer_wrong, leak or capped");
    html += tile("reference wrong", grouped(count("reference_wrong")),
                 count("reference_wrong") ? "<a href=\"#reference\">with proof</a>" : "rays");
  }
  const auto faults =
      std::count_if(run.findings.begin(), run.findings.end(), [](const DriverFinding& f) { return f.found; });
  if (!run.findings.empty())
    html += tile("driver faults", std::to_string(faults),
                 "<a href=\"#driver\">of " + std::to_string(run.findings.size()) + " asked about</a>");
  html += tile(
      "time", duration(run.seconds),
      total.rays && run.seconds > 0.0
          ? short_count(static_cast<std::uint64_t>(static_cast<double>(total.rays) / run.seconds)) + " rays/s, all in"
          : "");
  return html + "</dl>";
}

std::string failures(const RunRecord& run, const std::vector<std::string>& ids) {
  std::string html;
  std::size_t count = 0;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const CaseRecord& record = run.cases[i];
    if (!is_failure(outcome(record)) || ++count > kShownFailures) continue;
    html += "<li><a href=\"#" + ids[i] + "\">" + html_escape(record.name) + "</a> <span>" +
            html_escape(message_of(record)) + "</span>" +
            (record.replay.empty() ? "" : page::command_box(record.replay)) + "</li>";
  }
  if (count == 0) return "";
  if (count > kShownFailures)
    html += "<li>and " + counted(count - kShownFailures, "more case") + " <a href=\"#cases\">below</a></li>";
  return "<section class=\"card failures\"><h2>What failed</h2><ol>" + html + "</ol></section>";
}

std::string commit_html(const std::string& commit) {
  return commit.empty() ? "" : " at <code>" + html_escape(commit.substr(0, 10)) + "</code>";
}

std::string changes_html(const RunRecord& run, const std::vector<std::string>& ids, const ReportOptions& options) {
  if (!options.changes) return "";
  const RunChanges& changes = *options.changes;
  if (changes.first_run) return "<p>This is the first run of this history: nothing to compare with.</p>";
  std::unordered_map<std::string_view, std::size_t> index;
  for (std::size_t i = 0; i < run.cases.size(); ++i) index.emplace(run.cases[i].name, i);
  const auto names = [&](const std::vector<std::string>& list) {
    std::string html;
    for (std::size_t i = 0; i < list.size() && i < kShownFailures; ++i) {
      const auto found = index.find(list[i]);
      const std::string name = html_escape(list[i]);
      html +=
          (i ? ", " : "") + (found == index.end() ? name : "<a href=\"#" + ids[found->second] + "\">" + name + "</a>");
    }
    return list.size() > kShownFailures ? html + " and " + grouped(list.size() - kShownFailures) + " more" : html;
  };
  std::string html;
  const auto line = [&](const char* mark, const char* what, const std::vector<std::string>& list) {
    if (!list.empty())
      html += std::string("<li class=\"") + mark + "\"><b>" + what + " (" + grouped(list.size()) + "):</b> " +
              names(list) + "</li>";
  };
  line("bad", "newly failing", changes.newly_failing);
  line("bad", "still failing", changes.still_failing);
  line("good", "newly passing", changes.newly_passing);
  line("", "new cases", changes.new_cases);
  line("", "no longer asked", changes.gone_cases);
  const auto items = [&](const char* mark, const char* what, const auto& list, const auto& text) {
    if (list.empty()) return;
    html += std::string("<li class=\"") + mark + "\"><b>" + what + " (" + grouped(list.size()) + "):</b> ";
    for (std::size_t i = 0; i < list.size() && i < kShownFailures; ++i) html += (i ? "; " : "") + text(list[i]);
    html += (list.size() > kShownFailures ? " and " + grouped(list.size() - kShownFailures) + " more" : "") + "</li>";
  };
  std::vector<PooledFigure> found;
  for (const PooledFigure& figure : changes.pooled)
    if (figure.found()) found.push_back(figure);
  items("bad", "drifting the same way night after night", found, [&](const PooledFigure& f) {
    return names({f.case_name}) + ", " + html_escape(f.figure) + ": z = " + value_text(f.z) + " over " +
           counted(f.nights, "night") + " (p = " + value_text(f.p) + ")";
  });
  items("bad", "since when", changes.failing_since, [&](const FailingSince& f) {
    return names({f.name}) + " " +
           (f.passed.empty() ? "never passed"
                             : "last passed " + readable_time(f.passed) + commit_html(f.passed_commit)) +
           ", failing for " + counted(f.runs, "run");
  });
  items("bad", "slower than noise explains", changes.slower, [&](const SlowerCase& c) {
    return names({c.name}) + ": " + duration(c.seconds) + ", " + duration(c.usual) + " before";
  });
  items("", "new around it", changes.surroundings, [](const std::string& text) { return html_escape(text); });
  const std::string pass =
      changes.last_pass.empty() ? "no run passed before" : "the last that passed: " + readable_time(changes.last_pass);
  return "<p>Compared with the run of " + readable_time(changes.since) + " (" + pass +
         "):" + (html.empty() ? " nothing changed.</p>" : "</p><ul class=\"changes\">" + html + "</ul>");
}

std::string past_runs(const ReportOptions& options) {
  if (options.past.empty()) return "";
  std::string strip, rows;
  for (const PastRun& past : options.past) {
    const CaseStatus status = past.summary.ok() ? CaseStatus::passed : CaseStatus::failed;
    const std::string mark =
        "<span class=\"s-" + std::string(status_name(status)) + "\">" + std::string(page::glyph(status)) + "</span>";
    strip = mark + strip;
    rows += "<tr><th scope=\"row\">" + readable_time(past.started) + "</th><td>" + mark + " " +
            std::string(status_name(status)) + "</td><td class=\"n\">" + grouped(past.summary.passed) + " of " +
            grouped(past.summary.cases + past.summary.unfinished) + "</td><td class=\"n\">" +
            grouped(past.summary.rays) + "</td><td class=\"n\">" + duration(past.seconds) + "</td><td><code>" +
            html_escape(past.commit.substr(0, 10)) + "</code></td></tr>";
  }
  return "<details class=\"past\"><summary>Earlier runs, the latest last: <span class=\"strip\">" + strip +
         "</span></summary>" +
         page::framed_table("Earlier runs", "", "past-runs",
                            {{"started"}, {"result"}, {"cases passed", "n"}, {"rays", "n"}, {"time", "n"}, {"commit"}},
                            rows) +
         "</details>";
}

std::string driver_html(const RunRecord& run) {
  if (run.driver_renderer.empty() && run.findings.empty()) return "";
  std::vector<const DriverFinding*> ordered;
  for (const bool found : {true, false})
    for (const DriverFinding& finding : run.findings)
      if (finding.found == found) ordered.push_back(&finding);
  const auto faults = static_cast<std::uint64_t>(
      std::count_if(run.findings.begin(), run.findings.end(), [](const DriverFinding& f) { return f.found; }));
  std::string html = "<section id=\"driver\" class=\"card\"><h2>Driver</h2><p>" + html_escape(run.driver_renderer) +
                     ", " + html_escape(run.driver_version) + ".";
  if (!run.findings.empty())
    html += faults ? " <b>It has " + counted(faults, "known fault") +
                         "</b>; the production shaders are written to be right on it all the same."
                   : " It has none of the known faults.";
  html += "</p>";
  if (!ordered.empty()) {
    std::string rows;
    for (const DriverFinding* finding : ordered)
      rows += "<tr><th scope=\"row\">" + html_escape(finding->name) + "</th><td>" +
              (finding->found ? "<span class=\"found\">▲ found</span>" : "<span class=\"soft\">absent</span>") +
              "</td><td>" + html_escape(finding->detail) + "</td></tr>";
    html += page::framed_table("Faults of the driver", "", "findings",
                               {{"fault"}, {"here"}, {"what was expected, what came"}}, rows);
  }
  return html + "</section>";
}

/// The rays that the page's script lists: the reference's errors, then all of them.
std::string ray_sections(const RunRecord& run, const RunSummary& total) {
  std::uint64_t shown = 0, reference_shown = 0;
  for (const CaseRecord& record : run.cases) {
    shown += record.worst.size();
    for (const RayRecord& ray : record.worst) reference_shown += ray.verdict == "reference_wrong";
  }
  const auto found = total.verdicts.find("reference_wrong");
  const std::uint64_t wrong = found == total.verdicts.end() ? 0 : found->second;
  std::string html;
  if (wrong || reference_shown)
    html +=
        "<section id=\"reference\" class=\"card\"><h2>Where the reference was wrong</h2><p>Exact arithmetic takes a "
        "ray's "
        "floats as exact numbers and says that the reference erred on " +
        counted(std::max(wrong, reference_shown), "ray") + "; " +
        (reference_shown >= wrong ? "all are" : grouped(reference_shown) + " of them are") +
        " listed. This fails no case. The exact answer is the proof: the command of the row repeats it.</p>"
        "<div class=\"rays\" data-verdict=\"reference_wrong\"></div></section>";
  if (shown)
    html +=
        "<section id=\"rays\" class=\"card\"><h2>Rays worth looking at</h2><p>The worst rays of each verdict, from all "
        "cases: " +
        counted(shown, "ray") +
        ". Numbers are hex floats, so that a ray is repeated bit for bit.</p>"
        "<div class=\"rays\" data-all></div></section>";
  return html;
}

std::string libraries_html(const RunRecord& run) {
  std::string html = "<footer><p>Seed " + std::to_string(run.seed) +
                     ". The same data: <a href=\"results.json\">results.json</a>, "
                     "<a href=\"junit.xml\">junit.xml</a>, <a href=\"report.md\">report.md</a>.</p><p>";
  if (!run.machine.empty()) html += html_escape(run.machine) + ". ";
  for (const auto& [name, version] : run.libraries) html += html_escape(name) + " " + html_escape(version) + ". ";
  return html + "</p></footer>";
}

/// The verdicts' colours, once for pictures and page.
std::string palette_rules() {
  std::string css;
  const auto rule = [&](std::string_view name, Rgb color) {
    css += ".v-" + std::string(name) + "{background:" + hex_color(color) + ";fill:" + hex_color(color) + "}\n";
  };
  for (const VerdictInfo& info : verdict_infos()) rule(info.name, verdict_color(info.name));
  rule("other", verdict_color(""));
  return css;
}

}  // namespace

namespace page {

std::string filled(std::string_view text, const std::unordered_map<std::string_view, std::string>& values) {
  std::string out;
  for (std::size_t at; (at = text.find("{{")) != std::string_view::npos;) {
    const std::size_t end = text.find("}}", at);
    PLUMBLINE_ASSERT(end != std::string_view::npos);
    const auto value = values.find(text.substr(at + 2, end - at - 2));
    PLUMBLINE_ASSERT(value != values.end());
    out += text.substr(0, at);
    out += value->second;
    text.remove_prefix(end + 2);
  }
  return out += text;
}

std::string overview(const RunRecord& run, const std::vector<std::string>& ids, const ReportOptions& options) {
  const RunSummary total = summarize(run);
  std::string html = std::string("<section id=\"verdict\" class=\"hero ") + (total.ok() ? "good" : "bad") +
                     "\"><div class=\"glyph\" aria-hidden=\"true\">" + (total.ok() ? "✓" : "✗") + "</div><div><h1>" +
                     html_escape(headline(total)) + "</h1><p class=\"soft\">Plumbline " + html_escape(run.version) +
                     (run.commit.empty() ? "" : " at <code>" + html_escape(run.commit.substr(0, 12)) + "</code>") +
                     ", " + readable_time(run.started) + ", seed " + std::to_string(run.seed) +
                     (run.command.empty() ? "" : ", <code>" + html_escape(run.command) + "</code>") +
                     "</p></div></section>";
  const std::string since = changes_html(run, ids, options) + past_runs(options);
  return html + tiles(run, total) + "<div class=\"news\">" + failures(run, ids) +
         (since.empty() ? ""
                        : "<section id=\"changes\" class=\"card\"><h2>Since the last run</h2>" + since + "</section>") +
         "</div>";
}

}  // namespace page

std::string report_html(const RunRecord& run, const std::filesystem::path& folder, const ReportOptions& options) {
  const std::vector<std::string> ids = page::case_ids(run);
  const RunSummary total = summarize(run);
  const std::vector<std::pair<const char*, std::string>> sections = {
      {"", page::overview(run, ids, options)},
      {"Matrix", page::matrix(run, ids)},
      {"Driver", driver_html(run)},
      {"Families", page::families(run, ids)},
      {"Verdicts", page::verdict_tables(run)},
      {"Measurements", page::figures(run, ids)},
      {"Rays", ray_sections(run, total)},
      {"Cases", page::cases(run, ids, folder, options.embed_pictures)}};
  std::string nav, main;
  for (const auto& [name, html] : sections) {
    main += html + "\n";
    const std::size_t at = html.find("id=\"");
    if (*name && at != std::string::npos)
      nav += "<a href=\"#" + html.substr(at + 4, html.find('"', at + 4) - at - 4) + "\">" + name + "</a>";
  }
  return page::filled(asset("report.html"), {{"title", (total.ok() ? "✓ " : "✗ ") + html_escape(headline(total))},
                                             {"palette", palette_rules() + page::scale_rules(run)},
                                             {"css", std::string(asset("report.css"))},
                                             {"nav", nav},
                                             {"main", main},
                                             {"footer", libraries_html(run)},
                                             {"rays", page::packed_rays(run, ids)},
                                             {"js", std::string(asset("page.js")) + std::string(asset("report.js")) +
                                                        std::string(asset("viewer.js"))}});
}

void write_report(const RunRecord& run, const std::filesystem::path& folder, const ReportOptions& options) {
  write_results(run, folder / "results.json");
  write_junit(run, folder / "junit.xml");
  write_markdown(run, folder / "report.md");
  write_text(folder / "index.html", report_html(run, folder, options));
}

}  // namespace plumbline
