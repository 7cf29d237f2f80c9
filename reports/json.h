// SPDX-License-Identifier: MIT
// RunRecord to results.json and back. The format is described, key by key, in results.schema.json (JSON Schema, draft
// 7).
//
// Numbers of 64 bits that are not counts (seeds) are strings of decimal digits, always: JavaScript and many JSON
// readers would round them. Counts are numbers; they stay below 2^53. A double that JSON cannot hold is one of the
// strings "nan", "inf", "-inf". Text that is not UTF-8 has its bad bytes replaced by U+FFFD. A status is written as
// what the case comes to (summary.h).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "reports/record.h"

namespace plumbline {

/// The whole run, indented, keys in a fixed order: equal runs give equal text.
std::string run_to_json(const RunRecord& run);
/// The reverse. `file` is named in errors. Throws InputError for text that is not JSON (truncated files included), not
/// ours, of a newer version, lacks a key, or was changed since it was written; unknown keys are passed over.
RunRecord run_from_json(std::string_view text, const std::string& file);
/// Whether a run's text carries a digest, by which run_from_json sees changes.
bool has_digest(std::string_view text);

/// One line each, without a line break: what the journal is made of. The header is a run without its cases.
std::string run_header_to_json(const RunRecord& run);
RunRecord run_header_from_json(std::string_view line, const std::string& file, std::size_t line_number);
std::string case_to_json(const CaseRecord& record);
CaseRecord case_from_json(std::string_view line, const std::string& file, std::size_t line_number);

/// Writes through a temporary file. Throws EnvironmentError.
void write_results(const RunRecord& run, const std::filesystem::path& file);
RunRecord read_results(const std::filesystem::path& file);

/// The text of results.schema.json, built into the library.
std::string_view results_schema();

}  // namespace plumbline
