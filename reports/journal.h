// SPDX-License-Identifier: MIT
// The journal of a run: each case is written when it ends, so that a killed run keeps what it finished and can be
// resumed. It is the file cases.jsonl in the run's folder: JSON lines, first the run without its cases, then a line per
// case.
#pragma once

#include <filesystem>

#include "reports/record.h"

namespace plumbline {

inline constexpr const char* kJournalName = "cases.jsonl";

/// Owns the open journal. While it lives no second run can write into the folder.
class Journal {
 public:
  /// Begins a new journal in `folder` (made where missing), in place of an older one; cases in `header` are not
  /// written. Throws EnvironmentError where the disk refuses, InputError where another run is writing there.
  static Journal begin(const std::filesystem::path& folder, const RunRecord& header);
  /// Opens the journal of an earlier run to go on with it. A torn last line is cut off. `run` receives what it holds.
  /// Throws as begin and read_journal do.
  static Journal resume(const std::filesystem::path& folder, RunRecord& run);

  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;
  ~Journal();

  /// The case is with the operating system when this returns: it outlives a kill of the process. Throws
  /// EnvironmentError.
  void append(const CaseRecord& record);

 private:
  explicit Journal(const std::filesystem::path& file);
  void write_line(std::string line);

  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Whether a run has begun in `folder`: its journal holds a line.
bool has_journal(const std::filesystem::path& folder);

/// The run and all cases that ended, in the order they ended. A last line without its line break was torn by a kill: it
/// is passed over. A case that stands there twice counts as it stands last. Throws InputError for anything else that is
/// not right.
RunRecord read_journal(const std::filesystem::path& folder);

}  // namespace plumbline
