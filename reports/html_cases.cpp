// SPDX-License-Identifier: MIT
// The page's section per case: what it proves, what came, how to repeat it, its pictures. The tables of its rays are
// built by the page's script when the section is opened.
#include <algorithm>
#include <map>
#include <unordered_set>

#include "reports/files.h"
#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/summary.h"
#include "scenes/error.h"

namespace plumbline::page {
namespace {

/// Where the page finds a file of the run: its relative address, or all of it.
std::string source_of(const std::string& path, const char* type, const std::filesystem::path& folder, bool embed) {
  if (embed) {
    try {
      return "data:" + std::string(type) + ";base64," + base64(read_text(folder / path));
    } catch (const InputError&) {
      // The file was not kept with the results: the page then says so where it would stand.
    }
  }
  return address_of(path);
}

std::string scale_key(const ColorScale& scale) {
  std::string key;
  for (const std::string& color : scale.colors) {
    const bool is_color =
        color.size() == 7 && color[0] == '#' && color.find_first_not_of("0123456789abcdef", 1) == std::string::npos;
    key += (key.empty() ? "" : ",") + (is_color ? color : "#808080");
  }
  return key;
}

/// Distinct lists of colours, numbered.
std::map<std::string, std::size_t> scales_of(const RunRecord& run) {
  std::map<std::string, std::size_t> numbers;
  for (const CaseRecord& record : run.cases)
    for (const PictureRecord& picture : record.pictures)
      if (!picture.scale.colors.empty()) numbers.emplace(scale_key(picture.scale), numbers.size());
  return numbers;
}

std::string picture_html(const PictureRecord& picture, const std::map<std::string, std::size_t>& scales,
                         const std::filesystem::path& folder, bool embed) {
  std::string html =
      "<figure><img loading=\"lazy\" src=\"" +
      source_of(picture.path, picture.path.ends_with(".svg") ? "image/svg+xml" : "image/png", folder, embed) +
      "\" alt=\"" + html_escape(picture.title) + "\"";
  if (picture.width > 0 && picture.height > 0)
    html += " width=\"" + std::to_string(picture.width) + "\" height=\"" + std::to_string(picture.height) + "\"";
  if (!picture.values.empty())
    html += " data-values=\"" + source_of(picture.values, "text/javascript", folder, embed) + "\" data-path=\"" +
            html_escape(picture.path) + "\"";
  if (!picture.explain.empty()) html += " data-explain=\"" + html_escape(picture.explain) + "\"";
  html += "><figcaption><b>" + html_escape(picture.title) + "</b> " + html_escape(picture.caption);
  const ColorScale& scale = picture.scale;
  if (!scale.colors.empty())
    html += "<div class=\"scale\"><i class=\"scale" + std::to_string(scales.at(scale_key(scale))) + "\"></i><span>" +
            value_text(scale.low) + "</span><span>" + value_text(0.5 * (scale.low + scale.high)) + "</span><span>" +
            value_text(scale.high) + " " + html_escape(scale.unit) + "</span></div>";
  if (!picture.legend.empty()) {
    html += "<ul class=\"legend\">";
    for (const LegendEntry& entry : picture.legend) {
      const std::string color = scale_key({0.0, 0.0, "", {entry.color}});
      html += "<li><i style=\"background:" + color + "\"></i>" + html_escape(entry.label) + " " +
              grouped(entry.pixels) + "</li>";
    }
    html += "</ul>";
  }
  return html + "</figcaption></figure>";
}

std::string fact(std::string_view name, std::string_view value) {
  return value.empty() ? "" : "<div><dt>" + std::string(name) + "</dt><dd>" + std::string(value) + "</dd></div>";
}

std::string table_html(const TableRecord& table) {
  std::vector<Column> columns;
  for (const std::string& heading : table.columns) columns.push_back({html_escape(heading)});
  std::string rows;
  for (const std::vector<std::string>& cells : table.rows) {
    rows += "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
      rows +=
          i == 0 ? "<th scope=\"row\">" + html_escape(cells[i]) + "</th>" : "<td>" + html_escape(cells[i]) + "</td>";
    rows += "</tr>";
  }
  return framed_table(html_escape(table.title), html_escape(table.title), "findings", columns, rows);
}

std::string case_html(const CaseRecord& record, const std::string& id, const std::map<std::string, std::size_t>& scales,
                      const std::filesystem::path& folder, bool embed) {
  const CaseStatus status = outcome(record);
  const std::string status_text(status_name(status));
  std::string html = "<details id=\"" + id + "\" class=\"case s-" + status_text + "\" data-family=\"" +
                     html_escape(record.family) + "\" data-scene=\"" + html_escape(record.scene) +
                     "\"><summary><span class=\"st\" role=\"img\" aria-label=\"" + status_text + "\">" +
                     std::string(glyph(status)) + "</span><span class=\"name\">" + html_escape(record.name) + "</span>";
  if (record.rays)
    html += stacked_bar(record.verdicts, record.rays, true) + "<span class=\"n\">" + short_count(record.rays) +
            " rays</span>";
  html += "<span class=\"t\">" + duration(record.seconds) + "</span></summary><div class=\"body\">";

  const std::string message = message_of(record);
  if (!message.empty()) html += "<p class=\"message\">" + html_escape(message) + "</p>";
  if (!record.proves.empty() || !record.paper.empty()) {
    html += "<p><b>Proves:</b> " + html_escape(record.proves);
    if (!record.paper.empty()) html += " <span class=\"soft\">Paper, section " + html_escape(record.paper) + ".</span>";
    html += "</p>";
  }
  html += "<dl class=\"facts\">";
  html += fact("rays", record.rays ? grouped(record.rays) : "");
  for (const std::string& name : verdicts_in_order(record.verdicts))
    html +=
        fact("<i class=\"" + verdict_class(name) + "\"></i>" + html_escape(name), grouped(record.verdicts.at(name)));
  if (record.max_margin_ratio > 0.0) html += fact("largest margin / bound", value_text(record.max_margin_ratio));
  if (record.trace_seconds > 0.0) html += fact("of which tracing", duration(record.trace_seconds));
  for (const Figure& figure : record.figures)
    html += fact(html_escape(figure.name),
                 value_text(figure.value) + (figure.unit == "1" ? "" : " " + html_escape(figure.unit)));
  html += fact("seed", std::to_string(record.seed)) + "</dl>";
  if (!record.replay.empty()) html += command_box(record.replay);
  if (!record.pictures.empty()) {
    html += "<div class=\"pictures\">";
    for (const PictureRecord& picture : record.pictures) html += picture_html(picture, scales, folder, embed);
    html += "</div>";
  }
  for (const TableRecord& table : record.tables) html += table_html(table);
  if (!record.worst.empty()) html += "<div class=\"rays\"></div>";
  return html + "</div></details>";
}

}  // namespace

std::string address_of(std::string_view path) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
                       c == '_' || c == '-' || c == '/';
    if (plain)
      out += c;
    else
      out += {'%', kHex[byte >> 4], kHex[byte & 15u]};
  }
  return out;
}

std::vector<std::string> case_ids(const RunRecord& run) {
  std::vector<std::string> ids;
  std::unordered_set<std::string> taken;
  for (const CaseRecord& record : run.cases) {
    std::string base = "case-" + record.name;
    for (char& c : base) {
      const bool plain =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_';
      if (!plain) c = '-';
    }
    std::string id = base;
    for (int k = 2; !taken.insert(id).second; ++k) id = base + "-" + std::to_string(k);
    ids.push_back(std::move(id));
  }
  return ids;
}

std::string_view glyph(CaseStatus status) {
  switch (status) {
    case CaseStatus::passed:
      return "✓";
    case CaseStatus::failed:
      return "✗";
    case CaseStatus::error:
      return "!";
    case CaseStatus::skipped:
      return "–";
  }
  return "!";
}

std::string command_box(std::string_view command) {
  return "<div class=\"cmd\"><code>" + html_escape(command) + "</code></div>";
}

std::string scale_rules(const RunRecord& run) {
  std::string css;
  for (const auto& [colors, number] : scales_of(run))
    css += ".scale" + std::to_string(number) + "{background:linear-gradient(90deg," + colors + ")}\n";
  return css;
}

std::string cases(const RunRecord& run, const std::vector<std::string>& ids, const std::filesystem::path& folder,
                  bool embed_pictures) {
  if (run.cases.empty()) return "";
  const auto scales = scales_of(run);
  std::vector<std::string> features = features_of(run);
  if (std::any_of(run.cases.begin(), run.cases.end(), [](const CaseRecord& record) { return record.feature.empty(); }))
    features.emplace_back();
  std::string html = "<section id=\"cases\" class=\"card\"><h2>Cases</h2><div id=\"case-tools\"></div>";
  for (const std::string& feature : features) {
    std::string list;
    std::uint64_t count = 0, failed = 0;
    for (std::size_t i = 0; i < run.cases.size(); ++i) {
      const CaseRecord& record = run.cases[i];
      if (record.feature != feature) continue;
      ++count;
      failed += is_failure(outcome(record));
      list += case_html(record, ids[i], scales, folder, embed_pictures) + "\n";
    }
    html += "<section class=\"group\" data-feature=\"" + html_escape(feature) + "\"><h3>" +
            html_escape(feature.empty() ? "other" : feature) + " <small>" + counted(count, "case") +
            (failed ? ", " + grouped(failed) + " failed" : "") + "</small></h3>\n" + list + "</section>";
  }
  return html + "</section>";
}

}  // namespace plumbline::page
