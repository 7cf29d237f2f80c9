// SPDX-License-Identifier: MIT
// The faces of an inspected image: JSON, a page with the trees as an outline and in three dimensions, and a few lines
// for the terminal.
#pragma once

#include <filesystem>
#include <string>

#include "reports/inspect_record.h"

namespace plumbline {

/// Everything in the record; numbers that are none are null.
std::string inspect_json(const InspectRecord& record);

/// A page that needs nothing but its pictures, which are named relatively.
std::string inspect_html(const InspectRecord& record);

/// For the terminal: aligned lines of at most 100 characters, two columns with ratios where two images are compared.
/// Then tables of the costliest nodes and the longest walks, where any were asked for.
std::string inspect_text(const InspectRecord& record);

/// Writes inspect.html and inspect.json into `folder`, each through a temporary file. Throws EnvironmentError where the
/// disk refuses.
void write_inspect_report(const InspectRecord& record, const std::filesystem::path& folder);

}  // namespace plumbline
