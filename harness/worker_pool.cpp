// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/worker_pool.h"

#include "harness/clock.h"

namespace plumbline {

WorkerPool::WorkerPool(std::size_t places, Worker::Serve serve) : serve_(std::move(serve)), places_(places) {}

/// Takes what a worker has to tell; nothing where that does not end its job.
std::optional<WorkerPool::End> WorkerPool::news_of(Place& place, const JobProgress& progress) {
  End end;
  try {
    Worker::Death death;
    switch (place.worker->news(progress, end.answer, death)) {
      case Worker::News::none:
      case Worker::News::alive:
        return std::nullopt;
      case Worker::News::answer:
        break;
      case Worker::News::death:
        end.failure = death.how, end.is_dead = true;
    }
  } catch (const std::exception& error) {
    end.failure = error.what();
  }
  end.seconds = seconds_since(place.start);
  if (!end.is_dead) end.resident_bytes = place.worker->resident_bytes();
  return end;
}

void WorkerPool::run(const Events& events) {
  for (;;) {
    std::vector<Worker*> busy;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      Place& place = places_[k];
      if (!place.is_busy) {
        const std::optional<Job> job = events.next(k);
        if (!job) continue;
        if (!place.worker) place.worker = std::make_unique<Worker>(serve_);
        place.worker->give(job->text, job->silent_seconds);
        place.is_busy = true, place.start = Clock::now();
      }
      busy.push_back(place.worker.get());
    }
    if (busy.empty()) return;
    Worker::wait(busy);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      Place& place = places_[k];
      if (!place.is_busy) continue;
      const std::optional<End> end = news_of(place, [&](double share) { events.progress(k, share); });
      if (!end) continue;
      place.is_busy = false;
      if (!events.ended(k, *end) || end->is_dead) place.worker.reset();
    }
  }
}

}  // namespace plumbline
