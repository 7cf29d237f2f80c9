// SPDX-License-Identifier: MIT
// The page's tables of verdicts and its table of measured figures.
#include <algorithm>
#include <unordered_map>

#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/summary.h"

namespace plumbline::page {
namespace {

std::string legend_of(const std::vector<std::string>& verdicts) {
  std::string html = "<ul class=\"legend\">";
  for (const std::string& name : verdicts) {
    std::string meaning;
    for (const VerdictInfo& info : verdict_infos())
      if (info.name == name) meaning = info.meaning;
    html += "<li><i class=\"" + verdict_class(name) + "\"></i><b>" + html_escape(name) + "</b> " +
            html_escape(meaning) + "</li>";
  }
  return html + "</ul>";
}

std::string verdict_table(const RunRecord& run, const std::string& what, const std::vector<std::string>& values,
                          std::string CaseRecord::*field, const std::vector<std::string>& verdicts) {
  struct Row {
    std::string label;
    std::uint64_t rays = 0, other = 0;
    VerdictCounts counts;
  };
  std::vector<Row> rows;
  std::uint64_t most = 0;
  for (const std::string& value : values) {
    Row row{value, 0, 0, {}};
    for (const CaseRecord& record : run.cases) {
      if (record.*field != value) continue;
      row.rays += record.rays;
      for (const auto& [name, count] : record.verdicts) {
        row.counts[name] += count;
        if (name != "agree") row.other += count;
      }
    }
    if (row.rays == 0) continue;
    most = std::max(most, row.other);
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return "";

  std::vector<Column> columns = {{what}, {"rays", "n"}, {"other than agree", "bar"}};
  for (const std::string& name : verdicts) columns.push_back({html_escape(name), "n"});
  std::string html;
  for (const Row& row : rows) {
    html += "<tr><th scope=\"row\">" + html_escape(row.label) + "</th><td class=\"n\">" + grouped(row.rays) +
            "</td><td class=\"bar\">" + stacked_bar(row.counts, most, false) + "<small>" +
            (row.other ? percent(row.other, row.rays) : "") + "</small></td>";
    for (const std::string& name : verdicts) {
      const auto found = row.counts.find(name);
      const std::uint64_t count = found == row.counts.end() ? 0 : found->second;
      const char* mark = count && verdict_always_fails(name) ? " bad" : "";
      html += std::string("<td class=\"n") + mark + "\">" + (count ? grouped(count) : "<span class=\"nil\">0</span>") +
              "</td>";
    }
    html += "</tr>";
  }
  return framed_table("Verdicts by " + what,
                      "Verdicts by " + what + ", in rays. The bar shows those that do not simply agree; " +
                          (most ? "its full width is " + counted(most, "ray") + "." : "there are none."),
                      "verdicts", columns, html);
}

}  // namespace

std::string verdict_class(std::string_view verdict) {
  for (const VerdictInfo& info : verdict_infos())
    if (info.name == verdict) return "v-" + std::string(verdict);
  return "v-other";
}

std::string stacked_bar(const VerdictCounts& counts, std::uint64_t full, bool with_agree) {
  constexpr double kLeast = 1.0;  // per cent: one ray of a million is still seen
  struct Part {
    std::string name;
    double width;
  };
  std::vector<Part> parts;
  double sum = 0.0;
  for (const std::string& name : verdicts_in_order(counts)) {
    if (name == "agree" && !with_agree) continue;
    const double share = static_cast<double>(counts.at(name)) / static_cast<double>(std::max<std::uint64_t>(full, 1));
    parts.push_back({name, std::max(kLeast, 100.0 * share)});
    sum += parts.back().width;
  }
  if (parts.empty()) return "";
  std::string rects;
  double x = 0.0;
  for (const Part& part : parts) {
    const double width = part.width * std::min(1.0, 100.0 / sum);
    rects += "<rect class=\"" + verdict_class(part.name) + "\" x=\"" + fixed(x, 1) + "%\" width=\"" + fixed(width, 1) +
             "%\"/>";
    x += width;
  }
  return "<svg class=\"stack\" aria-hidden=\"true\">" + rects + "</svg>";
}

std::string framed_table(const std::string& label, const std::string& caption, const std::string& css_class,
                         const std::vector<Column>& columns, const std::string& rows) {
  std::string html = caption.empty() ? "" : "<p class=\"caption\">" + caption + "</p>";
  html += "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + label + "\"><table class=\"" +
          css_class + "\"><thead><tr>";
  for (const Column& column : columns) {
    const std::string css = *column.css ? " class=\"" + std::string(column.css) + "\"" : "";
    html += column.heading.empty() ? "<td></td>" : "<th scope=\"col\"" + css + ">" + column.heading + "</th>";
  }
  return html + "</tr></thead><tbody>" + rows + "</tbody></table></div>";
}

std::string verdict_tables(const RunRecord& run) {
  const RunSummary total = summarize(run);
  const std::vector<std::string> verdicts = verdicts_in_order(total.verdicts);
  if (verdicts.empty()) return "";
  return "<section id=\"verdicts\" class=\"card\"><h2>Verdicts</h2>" + legend_of(verdicts) +
         verdict_table(run, "family", families_of(run), &CaseRecord::family, verdicts) +
         verdict_table(run, "scene", scenes_of(run), &CaseRecord::scene, verdicts) + "</section>";
}

std::string figures(const RunRecord& run, const std::vector<std::string>& ids) {
  std::string rows;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    for (const Figure& figure : run.cases[i].figures) {
      const bool spread = figure.rounds > 1;
      rows += "<tr><th scope=\"row\">" + html_escape(figure.name) + "</th><td class=\"n\">" + value_text(figure.value) +
              "</td><td>" + (figure.unit == "1" ? "" : html_escape(figure.unit)) + "</td><td class=\"n\">" +
              (spread ? value_text(figure.low) + " to " + value_text(figure.high) : "") + "</td><td class=\"n\">" +
              (spread ? std::to_string(figure.rounds) : "") + "</td><td><a href=\"#" + ids[i] + "\">" +
              html_escape(run.cases[i].name) + "</a></td></tr>";
    }
  }
  if (rows.empty()) return "";
  return "<section id=\"figures\" class=\"card\"><h2>Measurements</h2>" +
         framed_table("Measurements", "Measured figures: the median where there were several rounds, and their range.",
                      "figures", {{"figure"}, {"value", "n"}, {"unit"}, {"range", "n"}, {"rounds", "n"}, {"case"}},
                      rows) +
         "</section>";
}

}  // namespace plumbline::page
