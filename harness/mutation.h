// SPDX-License-Identifier: GPL-3.0-or-later
// Mutation testing of the production shaders: each mutant is shown to the cheapest oracles that run its line, until one
// sees it. Those that none sees are equivalent, for a reason that is written down, or something is not tested.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/mutants.h"
#include "reports/record.h"

namespace plumbline {

enum class MutantOutcome {
  killed,     ///< an oracle saw it, or it hung or crashed
  survived,   ///< none did
  stillborn,  ///< the driver refuses to compile it
};
const char* name_of(MutantOutcome outcome);

struct MutantResult {
  Mutant mutant;
  MutantOutcome outcome = MutantOutcome::survived;
  std::string oracle;      ///< who saw it
  std::string how;         ///< what was seen, one sentence
  std::string equivalent;  ///< of a survivor: why it changes no answer; empty: nobody knows
  int asked = 0;           ///< oracles
  double seconds = 0.0;
};

/// A known equivalent: of every mutant by `rule` of a line with this text, whatever its number.
struct EquivalentMutant {
  std::string file, line;     ///< the line's text without the blanks around it
  std::string before, after;  ///< the token and what stands in its place; empty: any
  int column = 0;             ///< where the line has that token twice; 0: any
  std::string reason;         ///< one sentence
};
std::filesystem::path equivalent_mutants_file();
/// JSON, an array of objects with the keys file, line, before, after, reason. Throws InputError for anything else.
std::vector<EquivalentMutant> read_equivalent_mutants(const std::filesystem::path& file);

struct MutationOptions {
  std::vector<std::string> filters;  ///< of files and features, names or patterns; empty: all
  std::uint64_t sample = 0;          ///< so many, chosen at random; 0: all
  std::uint64_t seed = 1;
  int jobs = 2;                   ///< processes
  std::filesystem::path journal;  ///< results as they come, one JSON object a line; empty: none
  bool resume = false;            ///< mutants in the journal are not asked again ...
  bool again = false;             ///< ... but those that survived
  std::function<void(double share, const std::string& what)> progress = [](double, const std::string&) {};
};

struct MutationRun {
  std::vector<MutantResult> results;    ///< in the order of all_mutants()
  std::vector<EquivalentMutant> stale;  ///< of the list: those that match no mutant, or one that was killed
  std::string costs;                    ///< of each oracle on the sound shaders, a line each
  double seconds = 0.0;
};

/// Throws InputError for a filter that selects nothing, and EnvironmentError where an oracle complains of the sound
/// shaders.
MutationRun run_mutants(const MutationOptions& options);

/// True where every mutant that compiles is killed or known to be equivalent, and the list of equivalents holds.
bool is_passed(const MutationRun& run);
/// Scores by file and feature, then every survivor with its line and why: for a terminal.
std::string mutation_text(const MutationRun& run);
std::string mutation_json(const MutationRun& run);
/// A case for each shader file, `mutants.triangle`, with its score and a table of its survivors: for a report.
std::vector<CaseRecord> mutation_cases(const MutationRun& run);

}  // namespace plumbline
