// SPDX-License-Identifier: MIT
// Whole text files: read at once, and written so that a reader never sees half of one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace plumbline {

/// Throws InputError that says what to do, where the file is missing, unreadable or a folder.
std::string read_text(const std::filesystem::path& file);

/// Writes a temporary file beside `file` and renames it; a symbolic link stays one. A device, a pipe and /dev/stdout
/// are written in place. Makes the folder where it is missing. Throws EnvironmentError where the disk refuses; then a
/// plain `file` is as it was before. InputError for a folder.
void write_text(const std::filesystem::path& file, std::string_view text);

/// Throws EnvironmentError where the folder cannot be made.
void make_folder(const std::filesystem::path& folder);

/// A folder for what nobody keeps, among the system's temporary ones; removed with all that is in it.
class ScratchFolder {
 public:
  /// `stem` begins its name.
  explicit ScratchFolder(const std::string& stem);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace plumbline
