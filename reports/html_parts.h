// SPDX-License-Identifier: MIT
// The sections of the page, for html.cpp, and what other pages have in common with it. Each returns HTML, empty where
// there is nothing to show.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "reports/html.h"

namespace plumbline::page {

/// Puts values into the template's {{marks}}, in one pass: a value that contains a mark is text.
std::string filled(std::string_view text, const std::unordered_map<std::string_view, std::string>& values);

/// For each case of the run the id of its element: "case-" and its name, made unique and fit for an address.
std::vector<std::string> case_ids(const RunRecord& run);

std::string_view glyph(CaseStatus status);            ///< "✓": status is never told by colour alone
std::string verdict_class(std::string_view verdict);  ///< "v-tie"; "v-other" for unknown names
/// The stacked bar of `counts`, `full` rays wide; agreeing rays only where `with_agree`. SVG, a hundred per cent wide.
std::string stacked_bar(const VerdictCounts& counts, std::uint64_t full, bool with_agree);
struct Column {
  std::string heading;   ///< HTML; empty: no heading
  const char* css = "";  ///< class: "n" for numbers
};
/// A table that scrolls sideways where the window is narrow. `caption` is HTML and stands above it, outside of what
/// scrolls; `rows` is HTML.
std::string framed_table(const std::string& label, const std::string& caption, const std::string& css_class,
                         const std::vector<Column>& columns, const std::string& rows);
/// A command in a box that the page's script gives a copy button.
std::string command_box(std::string_view command);

/// A relative address: everything that has a meaning in one is encoded, so that a strange file name stays a file name.
std::string address_of(std::string_view path);
/// JSON that may stand inside a script element.
std::string inside_script(std::string_view json);

std::string overview(const RunRecord& run, const std::vector<std::string>& ids, const ReportOptions& options);
std::string matrix(const RunRecord& run, const std::vector<std::string>& ids);
std::string families(const RunRecord& run, const std::vector<std::string>& ids);
std::string verdict_tables(const RunRecord& run);
std::string figures(const RunRecord& run, const std::vector<std::string>& ids);
std::string cases(const RunRecord& run, const std::vector<std::string>& ids, const std::filesystem::path& folder,
                  bool embed_pictures);
/// Rules for the colour bars of the run's pictures: one class for each distinct list of colours.
std::string scale_rules(const RunRecord& run);
/// The rays of all cases as JSON for the page's script, packed (see html_rays.cpp), safe inside a script element.
std::string packed_rays(const RunRecord& run, const std::vector<std::string>& ids);

}  // namespace plumbline::page
