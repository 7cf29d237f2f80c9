// SPDX-License-Identifier: MIT
// The report of a run as one page that needs nothing but its pictures: it opens from a disk, in light and dark, on a
// phone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reports/history.h"
#include "reports/record.h"

namespace plumbline {

struct ReportOptions {
  bool embed_pictures = false;        ///< pictures inside the page; otherwise beside it, named relatively
  std::optional<RunChanges> changes;  ///< shown on the first screen
  std::vector<PastRun> past;          ///< newest first, without this run
};

/// The page's text. Pictures are looked for in `folder` only where they are embedded; one that cannot be read stays a
/// link.
std::string report_html(const RunRecord& run, const std::filesystem::path& folder, const ReportOptions& options = {});

/// Writes index.html, results.json, junit.xml and report.md into `folder`, each through a temporary file.
/// Throws EnvironmentError where the disk refuses.
void write_report(const RunRecord& run, const std::filesystem::path& folder, const ReportOptions& options = {});

}  // namespace plumbline
