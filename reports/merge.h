// SPDX-License-Identifier: MIT
// Shards of one run, made into one run again.
#pragma once

#include <filesystem>
#include <vector>

#include "reports/record.h"

namespace plumbline {

/// The run in `folder`: its results.json, or the journal of a run that was cut short. Throws InputError.
RunRecord read_run(const std::filesystem::path& folder);

/// The parts as one run: cases in the order of the shards. A case that every shard asks (those that question the
/// driver) is kept once, a failure before a pass. The run lasted as long as the longest shard. Throws InputError where
/// there are no parts, they differ in version, commit, seed, driver or what they were cut from, or one is missing or
/// there twice: then they are not the parts of one run.
RunRecord merge_runs(std::vector<RunRecord> parts);

/// Reads the folders, merges, copies the pictures and writes the report into `out`. Throws InputError, also for a part
/// that was cut short, truncated or changed since it was written, and EnvironmentError; then `out` is as it was.
RunRecord merge_reports(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& out);

}  // namespace plumbline
