// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of long work on a terminal: one line that is rewritten, shown only after two seconds and never when piped.
#pragma once

#include <chrono>
#include <string>

namespace plumbline {

class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows "[ 42 %] what", with the time left once it can be told. `share` is 0 to 1.
  void show(double share, const std::string& what);
  /// Removes the line, so that something else can be printed.
  void clear();

 private:
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace plumbline
