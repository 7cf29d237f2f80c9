// SPDX-License-Identifier: MIT
// The page's matrix of families and scenes, its tables of verdicts and its table of measured figures.
#include <algorithm>
#include <unordered_map>

#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/summary.h"

namespace plumbline::page {
namespace {

/// All cases of one family on one scene.
struct Cell {
  CaseStatus status = CaseStatus::skipped;
  std::uint64_t cases = 0, rays = 0, failing = 0;
  std::size_t worst = 0;  ///< index of the case that the cell leads to
};

int severity(CaseStatus status) {
  switch (status) {
    case CaseStatus::skipped:
      return 0;
    case CaseStatus::passed:
      return 1;
    case CaseStatus::failed:
      return 2;
    case CaseStatus::error:
      return 3;
  }
  return 3;
}

std::string link_class(CaseStatus status) { return "s-" + std::string(status_name(status)); }

std::string cell_html(const Cell& cell, const std::vector<std::string>& ids, const std::string& family,
                      const std::string& scene) {
  std::string title =
      family + " on " + scene + ": " + std::string(status_name(cell.status)) + ", " + counted(cell.rays, "ray");
  if (cell.failing) title += ", " + grouped(cell.failing) + " of them failing";
  if (cell.cases > 1) title += ", " + counted(cell.cases, "case");
  return "<td class=\"" + link_class(cell.status) + "\"><a href=\"#" + ids[cell.worst] + "\" title=\"" +
         html_escape(title) + "\">" + std::string(glyph(cell.status)) +
         (cell.rays ? "<small>" + short_count(cell.failing ? cell.failing : cell.rays) + "</small>" : "") + "</a></td>";
}

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

std::string matrix(const RunRecord& run, const std::vector<std::string>& ids) {
  const std::vector<std::string> families = families_of(run), scenes = scenes_of(run);
  std::unordered_map<std::string, std::size_t> row_of, column_of;
  for (std::size_t i = 0; i < families.size(); ++i) row_of[families[i]] = i;
  for (std::size_t i = 0; i < scenes.size(); ++i) column_of[scenes[i]] = i;
  std::vector<Cell> cells(families.size() * scenes.size());
  std::vector<bool> row_used(families.size()), column_used(scenes.size());
  std::string others;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const CaseRecord& record = run.cases[i];
    const CaseStatus status = outcome(record);
    if (record.family.empty() || record.scene.empty()) {
      others += "<li><a class=\"" + link_class(status) + "\" href=\"#" + ids[i] + "\"><span>" +
                std::string(glyph(status)) + "</span> " + html_escape(record.name) + "</a></li>";
      continue;
    }
    const std::size_t row = row_of.at(record.family), column = column_of.at(record.scene);
    row_used[row] = column_used[column] = true;
    Cell& cell = cells[row * scenes.size() + column];
    if (cell.cases == 0 || severity(status) > severity(cell.status)) {
      cell.status = status;
      cell.worst = i;
    }
    ++cell.cases;
    cell.rays += record.rays;
    cell.failing += failing_rays(record) + rays_without_verdict(record);
  }

  std::string html;
  if (std::find(row_used.begin(), row_used.end(), true) != row_used.end()) {
    std::vector<Column> columns = {{""}};
    for (std::size_t c = 0; c < scenes.size(); ++c)
      if (column_used[c]) columns.push_back({"<span>" + html_escape(scenes[c]) + "</span>"});
    std::string rows;
    for (std::size_t r = 0; r < families.size(); ++r) {
      if (!row_used[r]) continue;
      rows += "<tr><th scope=\"row\">" + html_escape(families[r]) + "</th>";
      for (std::size_t c = 0; c < scenes.size(); ++c) {
        if (!column_used[c]) continue;
        const Cell& cell = cells[r * scenes.size() + c];
        rows += cell.cases ? cell_html(cell, ids, families[r], scenes[c]) : "<td class=\"none\"></td>";
      }
      rows += "</tr>";
    }
    html += framed_table(
                "Families and scenes",
                "Each cell is a family of rays on a scene: its status and its rays (k thousand, M million); where it "
                "failed, the rays that failed it. It leads to the case.",
                "matrix", columns, rows) +
            "<p class=\"key\"><span class=\"s-passed\">✓</span> passed <span "
            "class=\"s-failed\">✗</span> failed "
            "<span class=\"s-error\">!</span> error <span class=\"s-skipped\">–</span> skipped</p>";
  }
  if (!others.empty())
    html += (html.empty() ? "" : "<h3>Cases outside the matrix</h3>") + ("<ul class=\"chips\">" + others + "</ul>");
  return html.empty() ? "" : "<section id=\"matrix\" class=\"card\"><h2>Families and scenes</h2>" + html + "</section>";
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
