// SPDX-License-Identifier: MIT
// The page of an inspected image: figures, histograms, memory, rays, pictures; the tree itself is the script's.
#include <algorithm>
#include <cmath>

#include "reports/assets.h"
#include "reports/color.h"
#include "reports/files.h"
#include "reports/format.h"
#include "reports/html_parts.h"
#include "reports/inspect_parts.h"
#include "reports/inspect_report.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

using Bake = InspectedBake;

std::string cell(const std::string& html, const char* css = "n") {
  return "<td class=\"" + std::string(css) + "\">" + html + "</td>";
}
std::string shown(double value) { return std::isfinite(value) ? value_text(value) : "–"; }

/// A row of a value for each image and, for two, the second over the first.
template <class Value>
std::string figure_row(const InspectRecord& record, const std::string& name, const Value& value) {
  std::string row = "<tr><th scope=\"row\">" + name + "</th>";
  std::vector<double> values;
  for (const Bake& bake : record.bakes) {
    values.push_back(static_cast<double>(value(bake)));
    row += cell(values.back() == std::floor(values.back()) && std::abs(values.back()) < 1e15 && values.back() >= 0.0
                    ? grouped(static_cast<std::uint64_t>(values.back()))
                    : shown(values.back()));
  }
  if (values.size() == 2)
    row += cell(values[0] > 0.0 && std::isfinite(values[1]) ? "× " + value_text(values[1] / values[0]) : "", "n ratio");
  return row + "</tr>";
}
template <class Text>
std::string text_row(const InspectRecord& record, const std::string& name, const Text& text) {
  std::string row = "<tr><th scope=\"row\">" + name + "</th>";
  for (const Bake& bake : record.bakes) row += cell(text(bake));
  return row + (record.bakes.size() == 2 ? "<td></td>" : "") + "</tr>";
}

std::vector<page::Column> bake_columns(const InspectRecord& record) {
  std::vector<page::Column> columns{{""}};
  for (const Bake& bake : record.bakes) columns.push_back({html_escape(bake.name), "n"});
  if (record.bakes.size() == 2) columns.push_back({"second / first", "n"});
  return columns;
}

std::string spread(const SpreadRecord& s) {
  if (s.count == 0) return "–";
  return shown(s.mean) + " / " + shown(s.median) + " / " + shown(s.p99) + " / " + shown(s.max);
}

std::string tile(const std::string& name, const std::string& value, const std::string& note) {
  return "<div class=\"tile\"><dt>" + name + "</dt><dd>" + value + "<small>" + note + "</small></dd></div>";
}

std::string tiles(const Bake& b) {
  std::string html = "<dl class=\"tiles\">";
  html += tile("nodes", grouped(b.nodes), grouped(b.leaves) + " leaves, depth " + grouped(b.depth));
  for (const InspectedRays& rays : b.rays)
    html += tile("steps, " + html_escape(rays.name), shown(rays.steps.mean),
                 "in the mean; at most " + shown(rays.steps.max));
  for (const InspectedRays& rays : b.rays)
    html += tile("tests, " + html_escape(rays.name), shown(rays.tests.mean),
                 "in the mean; at most " + shown(rays.tests.max));
  if (b.slack.count > 0) html += tile("slack", shown(b.slack.median), "median; at most " + shown(b.slack.max));
  html += tile("overlap", shown(b.overlap_met), "of children, at a node that is hit");
  return html + "</dl>";
}

std::string headline(const InspectRecord& record) {
  const Bake& a = record.bakes.front();
  const auto steps = [](const Bake& b) { return b.rays.empty() ? b.expected_steps : b.rays[0].steps.mean; };
  if (record.bakes.size() == 1)
    return html_escape(a.source) + ": " + counted(a.nodes, "node") + ", " + shown(steps(a)) + " steps " +
           (a.rays.empty() ? "expected" : "for each ray of the " + html_escape(a.rays[0].name));
  const Bake& b = record.bakes[1];
  return html_escape(b.name) + " takes " + shown(steps(b) / steps(a)) + " times the steps of " + html_escape(a.name);
}

std::string overview(const InspectRecord& record) {
  std::string html = "<section class=\"hero\"><div><h1>" + headline(record) + "</h1><p class=\"soft\">Plumbline " +
                     html_escape(record.version) + " at <code>" + html_escape(record.commit.substr(0, 12)) +
                     "</code>, <code>" + html_escape(record.command) + "</code></p><p class=\"soft\">" +
                     html_escape(record.camera) + "</p></div></section>";
  for (const Bake& bake : record.bakes) {
    if (record.bakes.size() > 1) html += "<h2>" + html_escape(bake.name) + "</h2>";
    html += tiles(bake);
    if (bake.fault_count == 0) continue;
    html += "<section class=\"card faults\"><h2>" + html_escape(bake.name) + " breaks the format in " +
            counted(bake.fault_count, "place") + "</h2><ul>";
    for (const std::string& fault : bake.faults) html += "<li>" + html_escape(fault) + "</li>";
    html +=
        "</ul><p>What is said here is said as far as it can be. <code>plumbline verify</code> tells all.</p></section>";
  }
  return html;
}

std::string figures(const InspectRecord& record) {
  std::string rows;
  const auto add = [&](const std::string& row) { rows += row; };
  add(figure_row(record, "nodes, of one copy", [](const Bake& b) { return b.nodes; }));
  add(figure_row(record, "leaves", [](const Bake& b) { return b.leaves; }));
  add(figure_row(record, "primitives stored", [](const Bake& b) { return b.primitives; }));
  add(figure_row(record, "leaves that lead into transforms", [](const Bake& b) { return b.transforms; }));
  add(figure_row(record, "depth of a tree", [](const Bake& b) { return b.depth; }));
  add(figure_row(record, "copies of each region", [](const Bake& b) { return b.copies; }));
  add(figure_row(record, "r² cost: steps of a random line", [](const Bake& b) { return b.expected_steps; }));
  add(figure_row(record, "r² cost: primitive tests", [](const Bake& b) { return b.expected_tests; }));
  add(figure_row(record, "r² cost: transforms entered", [](const Bake& b) { return b.expected_transforms; }));
  add(text_row(record, "slack: mean / median / p99 / max", [](const Bake& b) { return spread(b.slack); }));
  add(text_row(record, "overlap: mean / median / p99 / max", [](const Bake& b) { return spread(b.overlap); }));
  add(figure_row(record, "overlap at a node that is hit", [](const Bake& b) { return b.overlap_met; }));
  add(text_row(record, "bake", [](const Bake& b) { return b.bake_seconds > 0.0 ? duration(b.bake_seconds) : "–"; }));
  add(text_row(record, "statistics", [](const Bake& b) { return duration(b.statistics_seconds); }));
  add(text_row(record, "rays, counted", [](const Bake& b) { return duration(b.trace_seconds); }));
  std::string html =
      "<section id=\"figures\" class=\"card\"><h2>Figures</h2>" +
      page::framed_table("Figures",
                         "A random line through the scene's ball meets a ball of radius r in it with "
                         "probability r² / R², a box by its share of the surface: that gives the cost of "
                         "a line that nothing stops. Slack is a sphere's radius over that of the smallest "
                         "one around what stands below it. Overlap is what every two children share, "
                         "summed, over the volume of their parent.",
                         "", bake_columns(record), rows);
  std::string options;
  for (const Bake& bake : record.bakes) {
    options += "<p class=\"caption\"><b>" + html_escape(bake.name) + "</b>, " + html_escape(bake.source) + ":";
    for (const auto& [name, value] : bake.options)
      options += " " + html_escape(name) + " <code>" + html_escape(value) + "</code>";
    options += "</p>";
  }
  return html + options + "</section>";
}

/// Bars of a histogram, for one image or two.
std::string histogram_svg(const std::vector<const HistogramRecord*>& all) {
  constexpr double kWidth = 340.0, kHeight = 110.0, kBase = 94.0;
  std::size_t bars = 1;
  std::uint64_t most = 1;
  for (const HistogramRecord* h : all) {
    bars = std::max(bars, h->counts.size());
    for (const std::uint64_t count : h->counts) most = std::max(most, count);
  }
  const double slot = kWidth / static_cast<double>(bars), bar = slot * 0.86 / static_cast<double>(all.size());
  std::string svg =
      "<svg class=\"bars\" viewBox=\"0 0 340 110\" role=\"img\" aria-label=\"" + html_escape(all[0]->name) + "\">";
  for (std::size_t k = 0; k < all.size(); ++k) {
    const HistogramRecord& h = *all[k];
    for (std::size_t i = 0; i < h.counts.size(); ++i) {
      if (h.counts[i] == 0) continue;
      // A bar of one in many is still seen.
      const double height = std::max(1.0, 80.0 * static_cast<double>(h.counts[i]) / static_cast<double>(most));
      const std::uint64_t low = h.first + i * h.width, high = low + h.width - 1;
      svg += "<rect" + std::string(k > 0 ? " class=\"second\"" : "") + " x=\"" +
             fixed(static_cast<double>(i) * slot + static_cast<double>(k) * bar, 2) + "\" y=\"" +
             fixed(kBase - height, 2) + "\" width=\"" + fixed(bar, 2) + "\" height=\"" + fixed(height, 2) +
             "\"><title>" + (high > low ? grouped(low) + " to " + grouped(high) : grouped(low)) + ": " +
             grouped(h.counts[i]) + "</title></rect>";
    }
  }
  const HistogramRecord& h = *all[0];
  svg += "<text x=\"0\" y=\"107\">" + grouped(h.first) + "</text><text x=\"340\" y=\"107\" text-anchor=\"end\">" +
         grouped(h.first + (bars - 1) * h.width) +
         "</text><text x=\"170\" y=\"107\" text-anchor=\"middle\">most: " + grouped(most) + "</text>";
  static_assert(kHeight == 110.0);
  return svg + "</svg>";
}

std::string histograms(const InspectRecord& record) {
  std::string html;
  const auto add = [&](const std::vector<const HistogramRecord*>& all) {
    html += "<figure><figcaption><b>" + html_escape(all[0]->name) + "</b> (" + html_escape(all[0]->unit) +
            ")</figcaption>" + histogram_svg(all) + "</figure>";
  };
  for (std::size_t i = 0; i < record.bakes[0].histograms.size(); ++i) {
    std::vector<const HistogramRecord*> all;
    for (const Bake& bake : record.bakes) all.push_back(&bake.histograms.at(i));
    add(all);
  }
  for (std::size_t i = 0; i < record.bakes[0].rays.size(); ++i) {
    std::vector<const HistogramRecord*> all;
    for (const Bake& bake : record.bakes) all.push_back(&bake.rays.at(i).histogram);
    // Bars of two images stand beside each other only where they are as wide.
    if (all.size() == 2 && all[0]->width != all[1]->width) all.pop_back();
    add(all);
  }
  const std::string key = record.bakes.size() == 2
                              ? "<p class=\"caption\">Blue: " + html_escape(record.bakes[0].name) +
                                    "; brown or yellow: " + html_escape(record.bakes[1].name) + ".</p>"
                              : "";
  return "<section id=\"shape\" class=\"card\"><h2>Shape and steps</h2>" + key + "<div class=\"plots\">" + html +
         "</div></section>";
}

std::string memory(const InspectRecord& record) {
  const auto color = [](const std::string& name) { return hex_color(texel_color(name)); };
  std::string html = "<section id=\"memory\" class=\"card\"><h2>Memory</h2>";
  for (const Bake& bake : record.bakes) {
    std::uint64_t all = 0;
    for (const ShareRecord& share : bake.memory) all += share.count;
    html += "<p class=\"caption\"><b>" + html_escape(bake.name) + "</b>: " + std::to_string(bake.width) + " × " +
            std::to_string(bake.height) + " texels of 16 bytes, " +
            value_text(static_cast<double>(all) * 16.0 / 1048576.0) + " MiB</p><div class=\"memory\">";
    std::string legend;
    for (const ShareRecord& share : bake.memory) {
      if (share.count == 0) continue;
      const double part =
          100.0 * static_cast<double>(share.count) / static_cast<double>(std::max<std::uint64_t>(all, 1));
      html += "<i style=\"width:" + fixed(part, 3) + "%;background:" + color(share.name) + "\" title=\"" +
              html_escape(share.name) + "\"></i>";
      legend += "<li><span class=\"swatch\" style=\"background:" + color(share.name) + "\"></span>" +
                html_escape(share.name) + " " + grouped(share.count) + " <small class=\"soft\">" +
                percent(share.count, all) + "</small></li>";
    }
    html += "</div><ul class=\"legend\">" + legend + "</ul>";
    std::string rows;
    constexpr std::size_t kMostRegions = 100;
    for (std::size_t i = 0; i < std::min(bake.regions.size(), kMostRegions); ++i) {
      const InspectedRegionRecord& r = bake.regions[i];
      rows += "<tr><th scope=\"row\">" + html_escape(r.name) + "</th>" + cell(grouped(r.shown)) +
              cell(grouped(r.nodes)) + cell(grouped(r.leaves)) + cell(grouped(r.depth)) + cell(grouped(r.primitives)) +
              cell(grouped(r.texels)) + cell(shown(r.visits)) + cell(shown(r.tests)) + "</tr>";
    }
    html += page::framed_table(
        "Regions of " + html_escape(bake.name),
        "What is walked in one space stands in the image once, however often it is shown" +
            (bake.regions.size() > kMostRegions ? "; the first " + grouped(kMostRegions) + " of " +
                                                      grouped(bake.regions.size()) + " regions, all are in inspect.json"
                                                : std::string()) +
            ". Steps and tests: of a random line that enters it, with all that is behind its transforms.",
        "",
        {{"region"},
         {"shown", "n"},
         {"nodes", "n"},
         {"leaves", "n"},
         {"depth", "n"},
         {"primitives", "n"},
         {"texels", "n"},
         {"steps", "n"},
         {"tests", "n"}},
        rows);
  }
  return html + "</section>";
}

std::string rays(const InspectRecord& record) {
  std::string rows;
  for (const Bake& bake : record.bakes)
    for (const InspectedRays& r : bake.rays)
      rows += "<tr><th scope=\"row\">" + html_escape(bake.name) + "</th><td>" + html_escape(r.name) +
              "<br><small class=\"soft\">" + html_escape(r.what) + "</small></td>" + cell(grouped(r.count)) +
              cell(percent(r.hits, r.count)) + cell(spread(r.steps)) + cell(shown(r.expected_steps)) +
              cell(spread(r.tests)) + cell(shown(r.expected_tests)) + "</tr>";
  std::string html =
      "<section id=\"rays\" class=\"card\"><h2>Rays</h2>" +
      page::framed_table("Rays",
                         "Measured with the production shader. What is expected is for lines that nothing "
                         "stops: rays that hit something early take less. Mean / median / p99 / max.",
                         "",
                         {{"image"},
                          {"rays"},
                          {"count", "n"},
                          {"hit", "n"},
                          {"steps", "n"},
                          {"expected", "n"},
                          {"primitive tests", "n"},
                          {"expected", "n"}},
                         rows);
  if (record.bakes.size() == 2) {
    const Bake &a = record.bakes[0], &b = record.bakes[1];
    std::string depths;
    for (std::size_t d = 1; d < std::max(a.visits_by_depth.size(), b.visits_by_depth.size()); ++d) {
      const auto of = [d](const Bake& bake) { return d < bake.visits_by_depth.size() ? bake.visits_by_depth[d] : 0; };
      depths +=
          "<tr><th scope=\"row\">" + std::to_string(d) + "</th>" + cell(grouped(of(a))) + cell(grouped(of(b))) +
          cell(of(a) ? "× " + value_text(static_cast<double>(of(b)) / static_cast<double>(of(a))) : "", "n ratio") +
          "</tr>";
    }
    html +=
        "<h3>Visits by depth</h3>" +
        page::framed_table("Visits by depth",
                           record.are_alike ? "The trees are alike: in the outline each node has the visits of its "
                                              "twin, and the view shows the difference."
                                            : "The trees are not alike, so that nodes have no twins; depth by depth:",
                           "", {{"depth"}, {html_escape(a.name), "n"}, {html_escape(b.name), "n"}, {"", "n"}}, depths);
  }
  for (std::size_t k = 0; k < record.bakes.size(); ++k) {
    const Bake& bake = record.bakes[k];
    if (!bake.costliest.empty()) {
      std::string costs;
      for (const InspectedNodeRecord& n : bake.costliest)
        costs += "<tr><td><button type=\"button\" class=\"go\" data-bake=\"" + std::to_string(k) + "\" data-region=\"" +
                 std::to_string(n.region) + "\" data-node=\"" + std::to_string(n.number) + "\">" +
                 std::to_string(n.number) + "</button></td>" +
                 cell(n.region < bake.regions.size() ? html_escape(bake.regions[n.region].name) : "", "") +
                 cell("(" + std::to_string(n.x) + ", " + std::to_string(n.y) + ")") +
                 cell(n.is_leaf ? "leaf" : "inner", "") + cell(std::to_string(n.depth)) + cell(grouped(n.visits)) +
                 cell(n.visits ? percent(n.hits, n.visits) : "–") + cell(grouped(n.tests)) +
                 cell(grouped(static_cast<std::uint64_t>(n.cost))) +
                 (record.are_alike ? cell(shown(n.other_visits)) : "") + "</tr>";
      std::vector<page::Column> columns{{"node"},       {"region"},      {"cell", "n"}, {"kind"},
                                        {"depth", "n"}, {"visits", "n"}, {"hit", "n"},  {"primitive tests", "n"},
                                        {"cost", "n"}};
      if (record.are_alike) columns.push_back({"visits of its twin", "n"});
      html += "<h3>Nodes that cost most: " + html_escape(bake.name) + "</h3>" +
              page::framed_table("Nodes that cost most",
                                 "Costs in sphere tests. A node's number leads to it in the tree.", "", columns, costs);
    }
    for (const InspectedRays& r : bake.rays) {
      if (r.longest.empty()) continue;
      html +=
          "<h3>Longest walks: " + html_escape(r.name) + ", " + html_escape(bake.name) + "</h3><ol class=\"longest\">";
      for (const InspectedRayRecord& ray : r.longest)
        html += "<li>" + grouped(ray.steps) + " steps, " + grouped(ray.tests) +
                " primitive tests: " + html_escape(ray.where) + ", " + html_escape(ray.answer) +
                (ray.replay.empty() ? "" : page::command_box(ray.replay)) + "</li>";
      html += "</ol>";
    }
  }
  return html + "</section>";
}

std::string pictures(const InspectRecord& record) {
  std::string html;
  for (const Bake& bake : record.bakes) {
    if (bake.pictures.empty()) continue;
    html += "<h3>" + html_escape(bake.name) + "</h3><div class=\"pictures\">";
    for (const PictureRecord& p : bake.pictures) {
      html += std::string("<figure") + (p.width > 2 * p.height ? " class=\"wide\"" : "") + "><a href=\"" +
              html_escape(p.path) + "\"><img loading=\"lazy\" src=\"" + html_escape(p.path) + "\" alt=\"" +
              html_escape(p.title) + "\" width=\"" + std::to_string(p.width) + "\" height=\"" +
              std::to_string(p.height) + "\"></a><figcaption><b>" + html_escape(p.title) + "</b> " +
              html_escape(p.caption);
      if (!p.scale.colors.empty()) {
        std::string colors;
        for (const std::string& color : p.scale.colors) colors += "," + color;
        html += "<span class=\"scale\"><i style=\"background:linear-gradient(90deg" + colors + ")\"></i><span>" +
                shown(p.scale.low) + "</span><span>" + html_escape(p.scale.unit) + "</span><span>" +
                shown(p.scale.high) + "</span></span>";
      }
      if (!p.legend.empty()) {
        html += "<span class=\"legend\">";
        for (const LegendEntry& entry : p.legend)
          html += "<span><span class=\"swatch\" style=\"background:" + html_escape(entry.color) + "\"></span>" +
                  html_escape(entry.label) + " " + grouped(entry.pixels) + "</span>";
        html += "</span>";
      }
      html += "</figcaption></figure>";
    }
    html += "</div>";
  }
  return html.empty() ? "" : "<section id=\"pictures\" class=\"card\"><h2>Pictures</h2>" + html + "</section>";
}

std::string kept(const InspectRecord& record) {
  std::string text;
  for (const Bake& bake : record.bakes)
    if (bake.kept_depth > 0)
      text += "Of " + html_escape(bake.name) + " this page keeps the " + grouped(bake.outline.size()) +
              " nodes down to depth " + std::to_string(bake.kept_depth) + ", of " + grouped(bake.nodes) + " in all. ";
  return text +
         "Visits and costs are of all rays together; coordinates and radii in the units of each space in the image.";
}

}  // namespace

std::string inspect_html(const InspectRecord& record) {
  PLUMBLINE_ASSERT(!record.bakes.empty() && record.bakes.size() <= 2);
  const std::string rest = figures(record) + histograms(record) + memory(record) + rays(record) + pictures(record);
  std::string nav =
      "<a href=\"#tree\">Tree</a><a href=\"#figures\">Figures</a><a href=\"#shape\">Shape</a>"
      "<a href=\"#memory\">Memory</a><a href=\"#rays\">Rays</a>";
  if (rest.find("id=\"pictures\"") != std::string::npos) nav += "<a href=\"#pictures\">Pictures</a>";
  return page::filled(asset("inspect.html"),
                      {{"title", html_escape(record.bakes[0].source) + ": the tree"},
                       {"css", std::string(asset("report.css")) + std::string(asset("inspect.css"))},
                       {"nav", nav},
                       {"overview", overview(record)},
                       {"kept", kept(record)},
                       {"rest", rest},
                       {"footer", "<footer><p>The same data: <a href=\"inspect.json\">inspect.json</a>. " +
                                      html_escape(record.driver) + ".</p></footer>"},
                       {"data", page::packed_nodes(record)},
                       {"js", std::string(asset("page.js")) + std::string(asset("inspect.js"))}});
}

void write_inspect_report(const InspectRecord& record, const std::filesystem::path& folder) {
  write_text(folder / "inspect.json", inspect_json(record));
  write_text(folder / "inspect.html", inspect_html(record));
}

}  // namespace plumbline
