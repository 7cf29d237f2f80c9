// SPDX-License-Identifier: MIT
// The page's matrices: features and scenes, which every case is in, for the first screen; families of rays and scenes,
// with counts, for a closer look.
#include <algorithm>
#include <unordered_map>

#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/summary.h"

namespace plumbline::page {
namespace {

/// More columns than these get narrow cells, so that all are seen at once.
constexpr std::size_t kWideColumns = 22;

/// All cases of one row and column.
struct Cell {
  CaseStatus status = CaseStatus::skipped;
  std::uint64_t cases = 0, rays = 0, failing = 0, failed_cases = 0;
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

/// What a matrix is made by: the fields that choose a case's row and column. An empty column is one of its own.
struct Axes {
  std::string CaseRecord::*row;
  std::vector<std::string> rows, columns;
  bool counts_cases;  ///< a cell tells its number of cases, else of rays
};

std::string cell_html(const Cell& cell, const std::vector<std::string>& ids, const Axes& axes, const std::string& row,
                      const std::string& column) {
  if (cell.cases == 0) return "<td class=\"none\"></td>";
  const std::string status(status_name(cell.status));
  std::string title = (row.empty() ? "other" : row) + (column.empty() ? "" : " on " + column) + ": ";
  if (cell.cases > 1) title += counted(cell.cases, "case") + ", ";
  title += cell.cases > 1 && cell.failed_cases ? grouped(cell.failed_cases) + " of them failed" : status;
  if (cell.rays) title += ", " + counted(cell.rays, "ray");
  if (cell.failing) title += ", " + grouped(cell.failing) + " of them failing";
  const std::uint64_t rays = cell.failing ? cell.failing : cell.rays;
  const std::uint64_t cases = cell.failed_cases ? cell.failed_cases : cell.cases;
  const std::uint64_t number = axes.counts_cases ? cases : rays;
  // The page's script shows the label as a tip.
  return "<td class=\"s-" + status + "\"><a href=\"#" + ids[cell.worst] + "\" aria-label=\"" + html_escape(title) +
         "\">" + std::string(glyph(cell.status)) + (number ? "<small>" + short_count(number) + "</small>" : "") +
         "</a></td>";
}

std::string table_of(const RunRecord& run, const std::vector<std::string>& ids, const Axes& axes,
                     const std::string& name, const std::string& caption) {
  std::unordered_map<std::string, std::size_t> row_of, column_of;
  for (std::size_t i = 0; i < axes.rows.size(); ++i) row_of[axes.rows[i]] = i;
  for (std::size_t i = 0; i < axes.columns.size(); ++i) column_of[axes.columns[i]] = i;
  std::vector<Cell> cells(axes.rows.size() * axes.columns.size());
  std::vector<bool> row_used(axes.rows.size()), column_used(axes.columns.size());
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const CaseRecord& record = run.cases[i];
    const auto row = row_of.find(record.*axes.row), column = column_of.find(record.scene);
    if (row == row_of.end() || column == column_of.end()) continue;
    row_used[row->second] = column_used[column->second] = true;
    Cell& cell = cells[row->second * axes.columns.size() + column->second];
    const CaseStatus status = outcome(record);
    if (cell.cases == 0 || severity(status) > severity(cell.status)) {
      cell.status = status;
      cell.worst = i;
    }
    ++cell.cases;
    cell.rays += record.rays;
    cell.failing += failing_rays(record) + rays_without_verdict(record);
    cell.failed_cases += is_failure(status);
  }
  std::vector<Column> headings = {{""}};
  for (std::size_t c = 0; c < axes.columns.size(); ++c) {
    const std::string& scene = axes.columns[c];
    if (column_used[c])
      headings.push_back({"<span" + std::string(scene.empty() ? " class=\"soft\"" : "") + ">" +
                          (scene.empty() ? "no scene" : html_escape(scene)) + "</span>"});
  }
  if (headings.size() == 1) return "";
  std::string rows;
  for (std::size_t r = 0; r < axes.rows.size(); ++r) {
    if (!row_used[r]) continue;
    rows += "<tr><th scope=\"row\">" + (axes.rows[r].empty() ? "other" : html_escape(axes.rows[r])) + "</th>";
    for (std::size_t c = 0; c < axes.columns.size(); ++c)
      if (column_used[c])
        rows += cell_html(cells[r * axes.columns.size() + c], ids, axes, axes.rows[r], axes.columns[c]);
    rows += "</tr>";
  }
  return framed_table(name, caption, headings.size() > kWideColumns ? "matrix narrow" : "matrix", headings, rows) +
         "<p class=\"key\"><span class=\"s-passed\">✓</span> passed <span class=\"s-failed\">✗</span> failed <span "
         "class=\"s-error\">!</span> error <span class=\"s-skipped\">–</span> skipped</p>";
}

}  // namespace

std::string matrix(const RunRecord& run, const std::vector<std::string>& ids) {
  Axes axes{&CaseRecord::feature, features_of(run), scenes_of(run), true};
  axes.rows.emplace_back();
  axes.columns.emplace(axes.columns.begin());
  const std::string table = table_of(run, ids, axes, "Features and scenes",
                                     "Every case is in one cell. A cell leads to its worst case and narrows the list "
                                     "of cases to its own; its number is that of its cases, of those that failed where "
                                     "some did.");
  return table.empty() ? ""
                       : "<section id=\"matrix\" class=\"card\"><h2>Features and scenes</h2>" + table + "</section>";
}

std::string families(const RunRecord& run, const std::vector<std::string>& ids) {
  const Axes axes{&CaseRecord::family, families_of(run), scenes_of(run), false};
  const std::string table = table_of(run, ids, axes, "Families and scenes",
                                     "Each cell is a family of rays on a scene: its status and its rays (k thousand, M "
                                     "million); where it failed, the rays that failed it.");
  return table.empty()
             ? ""
             : "<section id=\"families\" class=\"card\"><h2>Families of rays and scenes</h2>" + table + "</section>";
}

}  // namespace plumbline::page
