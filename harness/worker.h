// SPDX-License-Identifier: GPL-3.0-or-later
// A process of its own that does jobs, so that one that crashes or hangs takes nothing else with it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "harness/clock.h"

namespace plumbline {

/// Called with the share done, 0 to 1, by a job; any call is a sign of life.
using JobProgress = std::function<void(double)>;

/// Owns a forked process. It begins with what this one had in memory, and must be made before this process has threads
/// or a GL context: they would not follow. It is killed when this goes, and when this process is killed.
class Worker {
 public:
  using Serve = std::function<std::string(const std::string& job, const JobProgress& progress)>;

  /// Throws EnvironmentError where no process can be made.
  explicit Worker(Serve serve);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// What the process came to instead of an answer: "crashed: Segmentation fault (signal 11)". It is gone then.
  struct Death {
    std::string how;
  };
  /// Has `job` served. Nothing: see `death`. What `serve` throws is thrown here: InputError, EnvironmentError, others
  /// as std::runtime_error. After `silent_seconds` without a sign of life the process is killed.
  std::optional<std::string> ask(const std::string& job, double silent_seconds, const JobProgress& progress,
                                 Death& death);

  // The same in steps, for several workers at once.

  /// Hands over a job and returns. The answer to the one before must have been taken.
  void give(const std::string& job, double silent_seconds);
  /// Returns when one of them, each with a job, has something to tell or has been silent for too long.
  static void wait(std::span<Worker* const> workers);
  enum class News { none, alive, answer, death };
  /// What there is to tell now, without waiting for more: a sign of life (told to `progress`), the answer, or a death.
  /// Throws as `ask` does.
  News news(const JobProgress& progress, std::string& answer, Death& death);

  /// What the process holds in memory now; 0 where it is gone or the system does not tell.
  std::uint64_t resident_bytes() const;

 private:
  [[noreturn]] void live(const Serve& serve, int jobs, int answers);
  std::string end();
  void sign_of_life();

  pid_t process_ = -1;
  int jobs_ = -1, answers_ = -1;
  double silent_seconds_ = 0.0;
  Clock::time_point deadline_{};  ///< of the next sign of life
  double used_ = 0.0;             ///< processor time at the last one, seconds
};

}  // namespace plumbline
