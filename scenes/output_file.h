// SPDX-License-Identifier: MIT
// Where the bytes of an output file go: files are replaced as a whole, devices, pipes and open descriptors are written
// in place.
#pragma once

#include <filesystem>

namespace plumbline {

struct OutputTarget {
  std::filesystem::path path;  ///< symbolic links followed, so that a link to a file stays a link
  /// True: nothing is there, or a plain file: it may be replaced by renaming another one onto it. False: a device, a
  /// pipe, a socket, or /dev/stdout and its like: renaming would put a plain file in its place.
  bool replaceable = true;
  int descriptor = -1;  ///< an open descriptor of this process that the path names (/dev/stdout, /dev/fd/3); else -1
};

/// Throws InputError where `file` is a folder or its links lead in a circle.
OutputTarget output_target(const std::filesystem::path& file);

}  // namespace plumbline
