// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages in either direction are a letter, a length and as many bytes. Jobs are 'J'. Answers are 'P' (progress, a
// number), 'A' (the answer), and what was thrown: 'I' (InputError), 'V' (EnvironmentError), 'X' (another).
#include "harness/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <sstream>
#include <vector>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr int kFirstOfWorker = 100;      ///< descriptors of a worker's pipes; what is below, it closes
constexpr double kProgressEvery = 0.05;  ///< seconds

bool write_all(int descriptor, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes += written, size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool send(int descriptor, char kind, const std::string& text) {
  std::array<char, 1 + sizeof(std::uint64_t)> head{kind};
  const std::uint64_t size = text.size();
  std::memcpy(head.data() + 1, &size, sizeof size);
  return write_all(descriptor, head.data(), head.size()) && write_all(descriptor, text.data(), text.size());
}

enum class Received { all, ended, silent };

double seconds_until(Clock::time_point moment) {
  return std::fmax(0.0, std::chrono::duration<double>(moment - Clock::now()).count());
}

/// All that a process's threads have used so far; 0 where the system does not tell.
double processor_seconds(pid_t process) {
  std::ifstream stream("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(stream, text);
  // Behind the name, which ends with the last bracket: state and ten more fields, then time in the program and in the
  // system, in ticks.
  std::istringstream fields(text.substr(std::min(text.rfind(')') + 1, text.size())));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0.0, system = 0.0;
  fields >> user >> system;
  return fields ? (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK)) : 0.0;
}

/// For poll; rounded up, so that a deadline is past when the wait ends.
int milliseconds(double seconds) { return static_cast<int>(std::ceil(1000.0 * std::fmin(seconds, 1e6))); }

/// Reads `size` bytes; `silent` where none came before `deadline` (none: waits for ever).
Received receive(int descriptor, char* bytes, std::size_t size, std::optional<Clock::time_point> deadline) {
  while (size > 0) {
    if (deadline) {
      pollfd waiting{descriptor, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, milliseconds(seconds_until(*deadline)));
      if (ready < 0 && errno == EINTR) continue;
      if (ready == 0) return Received::silent;
    }
    const ssize_t got = ::read(descriptor, bytes, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return Received::ended;
    bytes += got, size -= static_cast<std::size_t>(got);
  }
  return Received::all;
}

Received receive(int descriptor, char& kind, std::string& text, std::optional<Clock::time_point> deadline) {
  std::array<char, 1 + sizeof(std::uint64_t)> head{};
  if (const Received r = receive(descriptor, head.data(), head.size(), deadline); r != Received::all) return r;
  kind = head[0];
  std::uint64_t size = 0;
  std::memcpy(&size, head.data() + 1, sizeof size);
  text.resize(size);
  return receive(descriptor, text.data(), text.size(), deadline);
}

}  // namespace

Worker::Worker(Serve serve) {
  std::array<int, 2> jobs{-1, -1}, answers{-1, -1};
  if (::pipe2(jobs.data(), O_CLOEXEC) != 0 || ::pipe2(answers.data(), O_CLOEXEC) != 0)
    throw EnvironmentError(std::string("no pipe to a worker: ") + std::strerror(errno));
  std::fflush(nullptr);  // or the worker would print it again
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) throw EnvironmentError(std::string("no process for a worker: ") + std::strerror(errno));
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(0);
    // What it dies of is told by the parent; handlers of the parent's are not for here.
    for (const int signal : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGTERM}) ::signal(signal, SIG_DFL);
    // What this process has open, the lock on the journal first of all, is none of the worker's.
    const int in = ::fcntl(jobs[0], F_DUPFD_CLOEXEC, kFirstOfWorker);
    const int out = ::fcntl(answers[1], F_DUPFD_CLOEXEC, kFirstOfWorker);
    ::close_range(3, kFirstOfWorker - 1, 0);
    ::close_range(static_cast<unsigned>(std::max(in, out)) + 1, ~0U, 0);
    live(serve, in, out);
  }
  ::close(jobs[0]);
  ::close(answers[1]);
  jobs_ = jobs[1], answers_ = answers[0];
}

void Worker::live(const Serve& serve, int jobs, int answers) {
  std::mutex one_message;
  Clock::time_point last{};
  const JobProgress progress = [&](double share) {
    const std::lock_guard lock(one_message);
    if (seconds_since(last) < kProgressEvery) return;
    last = Clock::now();
    send(answers, 'P', std::to_string(share));
  };
  char kind = 0;
  for (std::string job; receive(jobs, kind, job, std::nullopt) == Received::all;) {
    std::string text;
    try {
      text = serve(job, progress);
      kind = 'A';
    } catch (const InputError& error) {
      text = error.what(), kind = 'I';
    } catch (const EnvironmentError& error) {
      text = error.what(), kind = 'V';
    } catch (const std::exception& error) {
      text = error.what(), kind = 'X';
    }
    const std::lock_guard lock(one_message);
    if (!send(answers, kind, text)) break;
  }
  std::fflush(nullptr);
  ::_exit(0);  // not exit: what the parent made is not this process's to unmake
}

Worker::~Worker() { end(); }

/// Kills the process where it still runs; how it ended.
std::string Worker::end() {
  if (process_ < 0) return "gone";
  // One that ends by itself is given the time to; what it dies of is the answer.
  int status = 0;
  pid_t done = ::waitpid(process_, &status, WNOHANG);
  if (done == 0) {
    ::kill(process_, SIGKILL);
    while ((done = ::waitpid(process_, &status, 0)) < 0 && errno == EINTR) {
    }
  }
  process_ = -1;
  ::close(jobs_);
  ::close(answers_);
  if (done > 0 && WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "crashed: " + std::string(strsignal(signal)) + " (signal " + std::to_string(signal) + ")" +
           (signal == SIGKILL ? ", killed from outside or out of memory" : "");
  }
  return "ended with exit status " + std::to_string(WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

void Worker::sign_of_life() {
  used_ = processor_seconds(process_);
  deadline_ =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(silent_seconds_));
}

void Worker::give(const std::string& job, double silent_seconds) {
  silent_seconds_ = silent_seconds;
  sign_of_life();
  if (process_ < 0) return;
  // A worker that is gone takes no job: what it died of is told by news(), and this process is not to die of it.
  struct sigaction ignored {
  }, before{};
  ignored.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &ignored, &before);
  send(jobs_, 'J', job);
  ::sigaction(SIGPIPE, &before, nullptr);
}

void Worker::wait(std::span<Worker* const> workers) {
  std::vector<pollfd> waiting;
  double left = 1e6;
  for (const Worker* worker : workers) {
    if (worker->process_ < 0) return;
    waiting.push_back({worker->answers_, POLLIN, 0});
    left = std::fmin(left, seconds_until(worker->deadline_));
  }
  ::poll(waiting.data(), waiting.size(), milliseconds(left));
}

std::uint64_t Worker::resident_bytes() const {
  std::ifstream stream("/proc/" + std::to_string(process_) + "/statm");
  std::uint64_t all = 0, resident = 0;
  stream >> all >> resident;
  return stream ? resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

Worker::News Worker::news(const JobProgress& progress, std::string& answer, Death& death) {
  if (process_ < 0) {
    death.how = end();
    return News::death;
  }
  pollfd waiting{answers_, POLLIN, 0};
  char kind = 0;
  Received got = Received::silent;
  if (::poll(&waiting, 1, 0) > 0)
    got = receive(answers_, kind, answer, deadline_);
  else if (Clock::now() < deadline_)
    return News::none;
  if (got == Received::silent) {
    // A loop without an end uses a processor all the while, threads that wait for each other none.
    const double used = processor_seconds(process_) - used_;
    end();
    char text[128];
    std::snprintf(text, sizeof text, "hung: no sign of life for %g s, with %.1f s of processor time, so it was killed",
                  silent_seconds_, used);
    death.how = text;
    return News::death;
  }
  if (got == Received::ended) {
    // The pipe closes a moment before the process can be waited for.
    siginfo_t info{};
    ::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOWAIT);
    death.how = end();
    return News::death;
  }
  if (kind == 'P') {
    sign_of_life();
    progress(std::strtod(answer.c_str(), nullptr));
    return News::alive;
  }
  if (kind == 'I') throw InputError(answer);
  if (kind == 'V') throw EnvironmentError(answer);
  if (kind == 'X') throw std::runtime_error(answer);
  return News::answer;
}

std::optional<std::string> Worker::ask(const std::string& job, double silent_seconds, const JobProgress& progress,
                                       Death& death) {
  give(job, silent_seconds);
  Worker* const self = this;
  for (std::string answer;;) {
    wait({&self, 1});
    const News n = news(progress, answer, death);
    if (n == News::answer) return answer;
    if (n == News::death) return std::nullopt;
  }
}

}  // namespace plumbline
