// SPDX-License-Identifier: MIT
// Files for tests: the shared data, found where PLUMBLINE_DATA points, else beside the checkout, and folders that
// vanish.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace plumbline {

/// The folder of shared test data; it may be missing.
inline std::filesystem::path data_folder() {
  const char* const variable = std::getenv("PLUMBLINE_DATA");
  return variable != nullptr ? std::filesystem::path(variable) : std::filesystem::path("../shared/data");
}

/// A folder of its own that is removed with all in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("plumbline_test_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    std::ofstream(path_ / name, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace plumbline

/// Leaves a test that needs shared data where there is none, saying so.
#define PLUMBLINE_NEEDS_DATA()                                                                  \
  if (!std::filesystem::is_directory(plumbline::data_folder())) {                               \
    WARN("no test data at " << plumbline::data_folder() << ": not tested; set PLUMBLINE_DATA"); \
    return;                                                                                     \
  }
