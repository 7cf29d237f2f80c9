// SPDX-License-Identifier: MIT
#include "scenes/output_file.h"

#include <charconv>
#include <string>

#include "scenes/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as Linux has it

/// N of /dev/fd/N and /proc/self/fd/N; -1 for all else.
int descriptor_of(const fs::path& path) {
  if (path.parent_path() != "/dev/fd" && path.parent_path() != "/proc/self/fd") return -1;
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && end == name.data() + name.size() && number >= 0 ? number : -1;
}

}  // namespace

OutputTarget output_target(const fs::path& file) {
  OutputTarget target{file};
  std::error_code error;
  for (int links = 0;; ++links) {
    // The links in /proc/self/fd are no real ones: what they read as may be "pipe:[4711]", or a file since removed.
    target.descriptor = descriptor_of(target.path.lexically_normal());
    if (target.descriptor >= 0 || !fs::is_symlink(fs::symlink_status(target.path, error))) break;
    if (links == kMostLinks) throw InputError(file.string() + ": its symbolic links lead in a circle; name a file");
    const fs::path next = fs::read_symlink(target.path, error);
    if (error) break;
    target.path = next.is_absolute() ? next : target.path.parent_path() / next;
  }
  const fs::file_status status = fs::status(target.path, error);
  if (fs::is_directory(status)) throw InputError(file.string() + ": this is a folder; name a file");
  target.replaceable = target.descriptor < 0 && (!fs::exists(status) || fs::is_regular_file(status));
  return target;
}

}  // namespace plumbline
