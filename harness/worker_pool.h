// SPDX-License-Identifier: GPL-3.0-or-later
// Several workers at once, watched by one thread: what runs cases side by side, and what judges mutants.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/worker.h"

namespace plumbline {

class WorkerPool {
 public:
  struct Job {
    std::string text;
    double silent_seconds;  ///< without a sign of life for so long it hangs
  };
  /// How a job ended: with an answer, or with a failure, which is what it threw or what its process died of.
  struct End {
    std::string answer, failure;
    bool is_dead = false;
    double seconds = 0.0;
    std::uint64_t resident_bytes = 0;  ///< of the process, at the end
  };
  /// All are called from the thread that runs the pool; what they throw ends the run.
  struct Events {
    std::function<std::optional<Job>(std::size_t place)> next;  ///< for a place that is free; nothing: none for now
    std::function<void(std::size_t place, double share)> progress;
    /// True: the process goes on. False: the place gets another one with its next job, as where it has died.
    std::function<bool(std::size_t place, const End&)> ended;
  };

  /// Processes are made with the first job of each place. See Worker for when that may be.
  WorkerPool(std::size_t places, Worker::Serve serve);

  /// Returns when no place has a job and there is none for any. Workers stay for the next run.
  void run(const Events& events);

 private:
  struct Place {
    std::unique_ptr<Worker> worker;
    bool is_busy = false;
    Clock::time_point start{};
  };
  std::optional<End> news_of(Place& place, const JobProgress& progress);

  Worker::Serve serve_;
  std::vector<Place> places_;
};

}  // namespace plumbline
