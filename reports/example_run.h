// SPDX-License-Identifier: MIT
// A made-up run for the tests of the reports, with everything in it that a real one can have. No figure in it was
// measured.
#pragma once

#include <filesystem>

#include "reports/record.h"

namespace plumbline {

struct ExampleOptions {
  std::size_t families = 5, scenes = 4;  ///< up to 15 and 20 get names of their own
  std::size_t rays_per_case = 3;         ///< worst rays of each case
  bool failing = true;
};
RunRecord example_run(const ExampleOptions& options = {});

/// Writes the pages that the run's failing rays name, all with the same made-up walk.
void add_example_explanations(const RunRecord& run, const std::filesystem::path& folder);

/// Paints six pictures for each case of the family "camera" and writes them into folder/pictures.
void add_example_pictures(RunRecord& run, const std::filesystem::path& folder);

/// Strings that break careless writers: quotes, tags, control characters, bad UTF-8.
extern const char* const kNastyText;

/// A new empty folder of its own under the system's temporary folder; removed when this goes.
struct TemporaryFolder {
  TemporaryFolder();
  ~TemporaryFolder();
  std::filesystem::path path;
};

}  // namespace plumbline
