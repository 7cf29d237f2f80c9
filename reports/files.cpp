// SPDX-License-Identifier: MIT
// See files.h.
#include "reports/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "scenes/error.h"
#include "scenes/output_file.h"

namespace plumbline {

namespace fs = std::filesystem;

namespace {

/// False: errno says why.
bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

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
  const OutputTarget target = output_target(file);
  const auto refuse = [&](const std::string& why) {
    throw EnvironmentError(file.string() + ": cannot be written: " + why);
  };
  if (target.descriptor >= 0) {
    std::fflush(nullptr);  // what was printed before comes before
    if (!write_all(target.descriptor, text)) refuse(std::strerror(errno));
    return;
  }
  // The process number keeps two shards that write beside one another apart.
  fs::path written = target.path;
  if (target.replaceable) written += ".part" + std::to_string(::getpid());
  const int flags = target.replaceable ? O_WRONLY | O_CREAT | O_TRUNC : O_WRONLY;
  const int descriptor = ::open(written.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor < 0) refuse(std::strerror(errno));
  int failure = write_all(descriptor, text) ? 0 : errno;
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  if (target.replaceable && failure == 0 && ::rename(written.c_str(), target.path.c_str()) != 0) failure = errno;
  if (failure == 0) return;
  if (target.replaceable) ::unlink(written.c_str());
  refuse(std::strerror(failure));
}

ScratchFolder::ScratchFolder(const std::string& stem)
    : path_(std::filesystem::temp_directory_path() / (stem + "-" + std::to_string(::getpid()))) {
  std::filesystem::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace plumbline
