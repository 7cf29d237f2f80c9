// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/progress.h"

#include <unistd.h>

#include <cstdio>

#include "harness/clock.h"

namespace plumbline {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}
Progress::~Progress() { clear(); }

void Progress::show(double share, const std::string& what) {
  if (!terminal_) return;
  const auto now = Clock::now();
  if (now - start_ < std::chrono::seconds(2) || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  const double spent = std::chrono::duration<double>(now - start_).count();
  char left[48] = "";
  if (share > 0.02) std::snprintf(left, sizeof left, ", %.0f s left", spent * (1.0 - share) / share);
  std::fprintf(stderr, "\r\033[K[%3.0f %%] %.90s%s", 100.0 * share, what.c_str(), left);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace plumbline
