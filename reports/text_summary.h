// SPDX-License-Identifier: MIT
// The run in plain words: for the terminal when it ends, and as a short Markdown page for merge requests and mail.
#pragma once

#include <filesystem>
#include <string>

#include "reports/record.h"

namespace plumbline {

struct TextOptions {
  bool color = false;         ///< ANSI colours: only for a terminal
  std::size_t failures = 20;  ///< how many failing cases are listed; the rest is counted
};

/// The headline, what the driver does wrong, verdicts by family as a table, and each failure with its replay command.
std::string text_summary(const RunRecord& run, const TextOptions& options = {});

/// The same as Markdown, at most about 60 lines: ten failing cases and twenty families, the rest counted.
std::string markdown_summary(const RunRecord& run);

/// Writes markdown_summary through a temporary file. Throws EnvironmentError.
void write_markdown(const RunRecord& run, const std::filesystem::path& file);

}  // namespace plumbline
