// SPDX-License-Identifier: MIT
// The errors that a user can mend, and the exit status that each kind ends with.
#pragma once

#include <stdexcept>
#include <string>

namespace plumbline {

/// The input is wrong (a file, an argument): what() is one line that names the place and says what to do. Exit
/// status 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
  InputError(const std::string& file, std::size_t line, const std::string& message)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + message) {}
};

/// The machine is wrong (a library, a driver, a full disk). Exit status 3.
struct EnvironmentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A broken invariant of our own: checked in release builds too. Never the user's fault.
[[noreturn]] void invariant_failed(const char* condition, const char* file, int line);

}  // namespace plumbline

#define PLUMBLINE_ASSERT(condition)                                                  \
  do {                                                                               \
    if (!(condition)) ::plumbline::invariant_failed(#condition, __FILE__, __LINE__); \
  } while (false)
