// SPDX-License-Identifier: MIT
// See files.h.
#include "reports/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "scenes/error.h"

namespace plumbline {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw InputError(file.string() + ": no such file; give the folder of a finished run");
  if (fs::is_directory(status)) throw InputError(file.string() + ": this is a folder, not a file");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  // An empty file gives no characters and sets failbit: that is not an error.
  if (!in || (in.peek() != std::ifstream::traits_type::eof() && !(text << in.rdbuf())))
    throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
  return std::move(text).str();
}

void make_folder(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw EnvironmentError(folder.string() + ": cannot make this folder (" + error.message() +
                           "); choose one that can be written");
}

void write_text(const fs::path& file, std::string_view text) {
  make_folder(file.parent_path());
  // The process number keeps two shards that write beside one another apart.
  fs::path temporary = file;
  temporary += ".part" + std::to_string(::getpid());
  std::ofstream out(temporary, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  std::error_code error;
  if (!out) {
    const std::string why = std::strerror(errno);
    fs::remove(temporary, error);
    throw EnvironmentError(file.string() + ": cannot be written: " + why);
  }
  fs::rename(temporary, file, error);
  if (error) {
    const std::string why = error.message();
    fs::remove(temporary, error);
    throw EnvironmentError(file.string() + ": cannot be written: " + why);
  }
}

}  // namespace plumbline
