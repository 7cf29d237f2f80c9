// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutation.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "harness/clock.h"
#include "harness/json_entries.h"
#include "harness/mutation_oracles.h"
#include "harness/worker_pool.h"
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
    for (auto* make : {arithmetic_oracles, geometry_oracles, pass_oracles, tie_oracles, walk_oracles, ray_walk_oracles,
                       edge_oracles, picture_oracles})
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

std::string key_of(const Mutant& m) { return name_of(m) + "\n" + m.line_text; }

/// One line of JSON: what a process answers, and what the journal keeps.
std::string line_of(const MutantResult& r) {
  return nlohmann::ordered_json{{"mutant", name_of(r.mutant)},
                                {"line", r.mutant.line_text},
                                {"outcome", name_of(r.outcome)},
                                {"oracle", r.oracle},
                                {"how", r.how},
                                {"asked", r.asked},
                                {"seconds", r.seconds}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
/// All but the mutant. An outcome that is none counts as `survived`: then it is asked for again.
MutantResult result_of(const nlohmann::json& json) {
  MutantResult r;
  for (const MutantOutcome outcome : {MutantOutcome::killed, MutantOutcome::stillborn})
    if (json.value("outcome", "") == name_of(outcome)) r.outcome = outcome;
  r.oracle = json.value("oracle", ""), r.how = json.value("how", "");
  r.asked = json.value("asked", 0), r.seconds = json.value("seconds", 0.0);
  return r;
}

/// Results by key_of. A line that a killed run has cut short is passed over.
std::map<std::string, MutantResult> read_journal(const std::filesystem::path& file) {
  std::map<std::string, MutantResult> known;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object()) known[json.value("mutant", "") + "\n" + json.value("line", "")] = result_of(json);
  }
  return known;
}

/// Judges one mutant after the other; a rehearsal comes first.
Worker::Serve court_serve(const std::vector<Mutant>& mutants) {
  return [&mutants, court = std::make_shared<std::unique_ptr<Court>>()](const std::string& job,
                                                                        const JobProgress& progress) {
    if (!*court) *court = std::make_unique<Court>();
    if (job == kRehearsal) return (*court)->rehearse(progress);
    return line_of((*court)->judge(mutants[std::stoul(job)], progress));
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
    folder_.emplace("plumbline-mutants");
    ::setenv("MESA_SHADER_CACHE_DIR", folder_->path().c_str(), 0);
  }
  ~ShaderCache() {
    if (folder_) ::unsetenv("MESA_SHADER_CACHE_DIR");
  }
  ShaderCache(const ShaderCache&) = delete;
  ShaderCache& operator=(const ShaderCache&) = delete;

 private:
  std::optional<ScratchFolder> folder_;
};

/// Asks for all mutants in turn, several at once, each in a process that has rehearsed. A mutant that hangs or crashes
/// its process is killed by that.
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
    places_.resize(std::min<std::size_t>(static_cast<std::size_t>(std::max(options_.jobs, 1)), open_.size()));
    WorkerPool pool(places_.size(), court_serve(mutants_));
    pool.run({[this](std::size_t place) { return next(places_[place]); }, [](std::size_t, double) {},
              [this](std::size_t place, const WorkerPool::End& end) { return ended(places_[place], end); }});
    return costs_;
  }

 private:
  struct Place {
    bool has_rehearsed = false;
    std::optional<std::size_t> mutant;  ///< that it judges; none: it rehearses
  };

  std::optional<WorkerPool::Job> next(Place& place) {
    if (next_ >= open_.size()) return std::nullopt;
    place.mutant.reset();
    if (!place.has_rehearsed) return WorkerPool::Job{kRehearsal, 10.0 * kSilentSeconds};
    place.mutant = open_[next_++];
    return WorkerPool::Job{std::to_string(*place.mutant), kSilentSeconds};
  }

  bool ended(Place& place, const WorkerPool::End& end) {
    if (!end.failure.empty() && !(end.is_dead && place.mutant))
      throw EnvironmentError((end.is_dead ? "the oracles do not stand the sound shaders: the process " : "") +
                             end.failure);
    place.has_rehearsed = !end.is_dead;
    if (!place.mutant) {
      costs_ = end.answer;
      return true;
    }
    MutantResult result;
    if (end.is_dead) {
      result.outcome = MutantOutcome::killed;
      result.oracle = "watchdog", result.how = end.failure, result.asked = 1, result.seconds = end.seconds;
    } else {
      result = result_of(nlohmann::json::parse(end.answer));
    }
    result.mutant = mutants_[*place.mutant];
    if (journal_.is_open()) journal_ << line_of(result) << std::endl;
    options_.progress(static_cast<double>(++done_) / static_cast<double>(open_.size()), name_of(result.mutant));
    results_[*place.mutant] = std::move(result);
    return true;
  }

  const MutationOptions& options_;
  const std::vector<Mutant>& mutants_;
  std::vector<MutantResult>& results_;
  std::vector<std::size_t> open_;
  std::vector<Place> places_;
  std::ofstream journal_;
  std::size_t next_ = 0, done_ = 0;
  std::string costs_;
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
  std::vector<EquivalentMutant> list;
  for (const JsonEntry& read : read_json_entries(file, {"file", "line", "before", "after", "column", "reason"})) {
    EquivalentMutant& entry = list.emplace_back();
    entry.file = read.text("file"), entry.line = read.text("line");
    entry.before = read.text("before"), entry.after = read.text("after");
    entry.column = read.number("column");
    entry.reason = read.text("reason");
    if (entry.file.empty() || entry.line.empty()) read.refuse("\"file\" and \"line\" name the line of a shader");
    if (entry.reason.empty()) read.refuse("\"reason\" says in a sentence why no answer changes");
  }
  return list;
}

}  // namespace plumbline
