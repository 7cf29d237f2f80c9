// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <tuple>

#include "harness/clock.h"
#include "harness/mutation_oracles.h"
#include "harness/worker.h"
#include "reports/files.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

/// Without a sign of life a mutant has hung. Every oracle is one; none takes a tenth of this.
constexpr double kSilentSeconds = 30.0;

constexpr const char* kRehearsal = "rehearse";
constexpr const char* kRefusal = "the OpenGL driver refuses";  ///< how link_program begins

/// All oracles, by cost, in a process of their own.
class Court {
 public:
  Court() {
    for (auto* make : {arithmetic_oracles, walk_oracles, ray_walk_oracles, picture_oracles})
      for (MutationOracle& oracle : make(context_)) oracles_.push_back(std::move(oracle));
  }

  /// What each oracle takes on the sound shaders; throws EnvironmentError where one complains.
  std::string rehearse(const JobProgress& progress) {
    std::string costs;
    for (const MutationOracle& oracle : oracles_) {
      const auto start = Clock::now();
      const std::string what = oracle.ask({});
      if (!what.empty())
        throw EnvironmentError("the oracle " + oracle.name + " complains of the sound shaders: " + what);
      costs += oracle.name + ": " + std::to_string(seconds_since(start)) + " s\n";
      progress(0.0);
    }
    return costs;
  }

  MutantResult judge(const Mutant& mutant, const JobProgress& progress) {
    MutantResult result;
    result.mutant = mutant;
    const auto start = Clock::now();
    for (const MutationOracle& oracle : oracles_) {
      if (!oracle.sees(mutant)) continue;
      ++result.asked;
      context_.set_patches({patch_of(mutant)});
      try {
        result.how = oracle.ask(mutant);
      } catch (const EnvironmentError& error) {
        result.how = error.what();
        if (result.how.starts_with(kRefusal)) result.outcome = MutantOutcome::stillborn;
      } catch (const InputError& error) {
        result.how = error.what();
      }
      context_.set_patches({});
      progress(0.0);
      if (result.how.empty()) continue;
      if (result.outcome != MutantOutcome::stillborn) result.outcome = MutantOutcome::killed;
      result.oracle = oracle.name;
      break;
    }
    result.seconds = seconds_since(start);
    return result;
  }

 private:
  GlContext context_;
  std::vector<MutationOracle> oracles_;
};

nlohmann::ordered_json to_json(const MutantResult& r) {
  return {{"mutant", name_of(r.mutant)},
          {"line", r.mutant.line_text},
          {"outcome", name_of(r.outcome)},
          {"oracle", r.oracle},
          {"how", r.how},
          {"asked", r.asked},
          {"seconds", r.seconds}};
}

/// Results by mutant's name and line. A line that a killed run has cut short is passed over.
std::map<std::string, MutantResult> read_journal(const std::filesystem::path& file) {
  std::map<std::string, MutantResult> known;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) continue;
    MutantResult r;
    const std::string outcome = json.value("outcome", "");
    r.outcome = outcome == "killed"      ? MutantOutcome::killed
                : outcome == "stillborn" ? MutantOutcome::stillborn
                                         : MutantOutcome::survived;
    r.oracle = json.value("oracle", ""), r.how = json.value("how", "");
    r.asked = json.value("asked", 0), r.seconds = json.value("seconds", 0.0);
    known[json.value("mutant", "") + "\n" + json.value("line", "")] = r;
  }
  return known;
}
std::string key_of(const Mutant& m) { return name_of(m) + "\n" + m.line_text; }

/// The answer of a process, and back.
std::string answer_of(const MutantResult& r) {
  return nlohmann::json{{"outcome", static_cast<int>(r.outcome)},
                        {"oracle", r.oracle},
                        {"how", r.how},
                        {"asked", r.asked},
                        {"seconds", r.seconds}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
MutantResult from_json(const nlohmann::json& json, const Mutant& mutant) {
  MutantResult r;
  r.mutant = mutant;
  r.outcome = static_cast<MutantOutcome>(json.at("outcome").get<int>());
  r.oracle = json.at("oracle"), r.how = json.at("how");
  r.asked = json.at("asked"), r.seconds = json.at("seconds");
  return r;
}

/// Judges one mutant after the other.
Worker::Serve court_serve(const std::vector<Mutant>& mutants) {
  return [&mutants, court = std::make_shared<std::unique_ptr<Court>>()](const std::string& job,
                                                                        const JobProgress& progress) {
    if (!*court) *court = std::make_unique<Court>();
    if (job == kRehearsal) return (*court)->rehearse(progress);
    const MutantResult r = (*court)->judge(mutants[std::stoul(job)], progress);
    return answer_of(r);
  };
}

/// Keeps such a process, and makes another where a mutant has hung or crashed it. This one has neither threads nor a
/// context, so it can.
Worker::Serve keeper_serve(const std::vector<Mutant>& mutants) {
  return [&mutants, court = std::make_shared<std::unique_ptr<Worker>>()](const std::string& job,
                                                                         const JobProgress& progress) {
    Worker::Death death;
    const auto rehearsed = [&] {
      *court = std::make_unique<Worker>(court_serve(mutants));
      const auto costs = (*court)->ask(kRehearsal, 10.0 * kSilentSeconds, progress, death);
      if (!costs) throw EnvironmentError("the oracles do not stand the sound shaders: the process " + death.how);
      return *costs;
    };
    if (job == kRehearsal) return rehearsed();
    if (!*court) rehearsed();
    if (const auto answer = (*court)->ask(job, kSilentSeconds, progress, death)) return *answer;
    court->reset();
    MutantResult r;
    r.outcome = MutantOutcome::killed;
    r.oracle = "watchdog", r.how = death.how, r.asked = 1;
    return answer_of(r);
  };
}

bool is_selected(const Mutant& m, const std::vector<std::string>& filters) {
  return filters.empty() || std::any_of(filters.begin(), filters.end(), [&](const std::string& filter) {
           return m.file == filter || feature_of(m.file) == filter || m.file.starts_with(filter + ".") ||
                  name_of(m).starts_with(filter);
         });
}

std::vector<Mutant> selected_mutants(const MutationOptions& options) {
  std::vector<Mutant> mutants = all_mutants();
  std::erase_if(mutants, [&](const Mutant& m) { return !is_selected(m, options.filters); });
  if (mutants.empty())
    throw InputError("no mutant is of what was asked for; name files such as triangle.glsl, or features");
  if (options.sample > 0 && options.sample < mutants.size()) {
    // The first of a shuffle; in their own order again.
    Random random(options.seed, name_hash("mutants"), 0);
    for (std::size_t i = 0; i < options.sample; ++i)
      std::swap(mutants[i], mutants[i + random.below(static_cast<std::uint32_t>(mutants.size() - i))]);
    mutants.resize(options.sample);
    std::sort(mutants.begin(), mutants.end(), [](const Mutant& a, const Mutant& b) {
      return std::tie(a.file, a.at, a.after) < std::tie(b.file, b.at, b.after);
    });
  }
  return mutants;
}

/// A folder for the driver's compiled shaders, so that thousands of mutants do not push others out of the user's own.
/// One that the user has named is kept.
class ShaderCache {
 public:
  ShaderCache() {
    ::setenv("LP_NUM_THREADS", "1", 0);  // the processes share the cores already
    if (std::getenv("MESA_SHADER_CACHE_DIR") != nullptr) return;
    folder_ = std::filesystem::temp_directory_path() / ("plumbline-mutants-" + std::to_string(::getpid()));
    ::setenv("MESA_SHADER_CACHE_DIR", folder_.c_str(), 0);
  }
  ~ShaderCache() {
    if (folder_.empty()) return;
    ::unsetenv("MESA_SHADER_CACHE_DIR");
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ShaderCache(const ShaderCache&) = delete;
  ShaderCache& operator=(const ShaderCache&) = delete;

 private:
  std::filesystem::path folder_;
};

/// Asks for all mutants in turn, a thread for each process.
class Trial {
 public:
  Trial(const MutationOptions& options, const std::vector<Mutant>& mutants, std::vector<MutantResult>& results,
        std::vector<std::size_t> open)
      : options_(options), mutants_(mutants), results_(results), open_(std::move(open)) {
    if (!options.journal.empty()) {
      make_folder(std::filesystem::absolute(options.journal).parent_path());
      journal_.open(options.journal, options.resume ? std::ios::app : std::ios::trunc);
      if (!journal_) throw EnvironmentError(options.journal.string() + " cannot be written");
    }
  }

  /// What each oracle takes on the sound shaders, a line each.
  std::string run() {
    std::vector<std::unique_ptr<Worker>> keepers;
    const auto count = std::min<std::size_t>(static_cast<std::size_t>(std::max(options_.jobs, 1)), open_.size());
    for (std::size_t i = 0; i < count; ++i) keepers.push_back(std::make_unique<Worker>(keeper_serve(mutants_)));
    std::vector<std::thread> threads;
    for (auto& keeper : keepers) threads.emplace_back([this, &keeper] { work(*keeper); });
    for (std::thread& thread : threads) thread.join();
    if (!error_.empty()) throw EnvironmentError(error_);
    return costs_;
  }

 private:
  void work(Worker& keeper) {
    try {
      Worker::Death death;
      const auto quiet = [](double) {};
      const auto costs = keeper.ask(kRehearsal, 10.0 * kSilentSeconds, quiet, death);
      if (!costs) throw EnvironmentError(death.how);
      const std::lock_guard lock(mutex_);
      costs_ = *costs;
    } catch (const std::exception& error) {
      fail(error.what());
    }
    try {
      Worker::Death death;
      const auto quiet = [](double) {};
      for (;;) {
        const std::size_t k = next_++;
        if (k >= open_.size() || has_failed_) return;
        const Mutant& mutant = mutants_[open_[k]];
        const auto answer = keeper.ask(std::to_string(open_[k]), 10.0 * kSilentSeconds, quiet, death);
        if (!answer) throw EnvironmentError(death.how);
        take(open_[k], from_json(nlohmann::json::parse(*answer), mutant));
      }
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }

  void fail(const std::string& what) {
    const std::lock_guard lock(mutex_);
    has_failed_ = true;
    if (error_.empty()) error_ = what;
  }

  void take(std::size_t i, MutantResult result) {
    const std::lock_guard lock(mutex_);
    if (journal_.is_open())
      journal_ << to_json(result).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
    options_.progress(static_cast<double>(++done_) / static_cast<double>(open_.size()), name_of(result.mutant));
    results_[i] = std::move(result);
  }

  const MutationOptions& options_;
  const std::vector<Mutant>& mutants_;
  std::vector<MutantResult>& results_;
  std::vector<std::size_t> open_;
  std::ofstream journal_;
  std::mutex mutex_;
  std::atomic<std::size_t> next_ = 0, done_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::string error_, costs_;
};

bool is_of(const EquivalentMutant& e, const Mutant& m) {
  return e.file == m.file && e.line == m.line_text && (e.before.empty() || e.before == m.before) &&
         (e.after.empty() || e.after == m.after) && (e.column == 0 || e.column == m.column);
}

}  // namespace

const char* name_of(MutantOutcome outcome) {
  static constexpr std::array<const char*, 3> kNames{"killed", "survived", "stillborn"};
  return kNames[static_cast<std::size_t>(outcome)];
}

MutationRun run_mutants(const MutationOptions& options) {
  const auto start = Clock::now();
  const ShaderCache cache;
  const std::vector<Mutant> mutants = selected_mutants(options);
  MutationRun run;
  run.results.resize(mutants.size());
  std::vector<std::size_t> open;
  const auto known = options.resume ? read_journal(options.journal) : std::map<std::string, MutantResult>{};
  for (std::size_t i = 0; i < mutants.size(); ++i) {
    const auto found = known.find(key_of(mutants[i]));
    if (found == known.end() || (options.again && found->second.outcome == MutantOutcome::survived)) {
      open.push_back(i);
    } else {
      run.results[i] = found->second;
      run.results[i].mutant = mutants[i];
    }
  }
  if (!open.empty()) run.costs = Trial(options, mutants, run.results, std::move(open)).run();
  const std::vector<EquivalentMutant> equivalent = read_equivalent_mutants(equivalent_mutants_file());
  const std::vector<Mutant> all = all_mutants();
  for (const EquivalentMutant& e : equivalent) {
    bool is_asked = false, is_seen = false;
    for (MutantResult& r : run.results) {
      if (!is_of(e, r.mutant)) continue;
      is_asked = true;
      is_seen = is_seen || r.outcome != MutantOutcome::survived;
      if (r.outcome == MutantOutcome::survived) r.equivalent = e.reason;
    }
    const bool is_of_none = std::none_of(all.begin(), all.end(), [&](const Mutant& m) { return is_of(e, m); });
    if (is_of_none || (is_asked && is_seen)) run.stale.push_back(e);
  }
  run.seconds = seconds_since(start);
  return run;
}

std::filesystem::path equivalent_mutants_file() { return PLUMBLINE_EQUIVALENT_MUTANTS; }

std::vector<EquivalentMutant> read_equivalent_mutants(const std::filesystem::path& file) {
  const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
  const std::string name = file.string();
  if (!json.is_array())
    throw InputError(name + ": expected a JSON array of objects with the keys file, line, before, after and reason");
  std::vector<EquivalentMutant> list;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto refuse = [&](const std::string& why) {
      throw InputError(name + ": entry " + std::to_string(i) + ": " + why);
    };
    if (!json[i].is_object()) refuse("expected an object");
    EquivalentMutant& entry = list.emplace_back();
    for (const auto& [key, value] : json[i].items()) {
      if (key == "column" && value.is_number_integer()) {
        entry.column = value.get<int>();
        continue;
      }
      std::string* field = key == "file"     ? &entry.file
                           : key == "line"   ? &entry.line
                           : key == "before" ? &entry.before
                           : key == "after"  ? &entry.after
                           : key == "reason" ? &entry.reason
                                             : nullptr;
      if (!field) refuse("there is no key \"" + key + "\"; keys are file, line, before, after, column, reason");
      if (!value.is_string()) refuse("\"" + key + "\" is text");
      *field = value.get<std::string>();
    }
    if (entry.file.empty() || entry.line.empty()) refuse("\"file\" and \"line\" name the line of a shader");
    if (entry.reason.empty()) refuse("\"reason\" says in a sentence why no answer changes");
  }
  return list;
}

}  // namespace plumbline
