// SPDX-License-Identifier: GPL-3.0-or-later
// What mutation testing came to, for a terminal and as JSON.
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/mutation.h"
#include "tracer/embedded_shaders.h"

namespace plumbline {
namespace {

struct Score {
  int killed = 0, equivalent = 0, survived = 0, stillborn = 0;
  double seconds = 0.0;
  int compiled() const { return killed + equivalent + survived; }
  void add(const MutantResult& r) {
    killed += r.outcome == MutantOutcome::killed;
    stillborn += r.outcome == MutantOutcome::stillborn;
    (r.equivalent.empty() ? survived : equivalent) += r.outcome == MutantOutcome::survived;
    seconds += r.seconds;
  }
};

/// By file or feature; under "" of all.
std::map<std::string, Score> scores(const MutationRun& run, bool by_file) {
  std::map<std::string, Score> all;
  for (const MutantResult& r : run.results) {
    all[by_file ? r.mutant.file : feature_of(r.mutant.file)].add(r);
    all[""].add(r);
  }
  return all;
}

std::string share(const Score& s) {
  if (s.compiled() == 0) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * s.killed / s.compiled());
  return text;
}

std::string row(const std::string& name, const Score& s) {
  char text[160];
  std::snprintf(text, sizeof text, "%-24s %8d %8d %11d %9d %10d %9s %8.0f\n", name.empty() ? "all" : name.c_str(),
                s.compiled() + s.stillborn, s.killed, s.equivalent, s.survived, s.stillborn, share(s).c_str(),
                s.seconds);
  return text;
}

}  // namespace

bool is_passed(const MutationRun& run) {
  return run.stale.empty() && std::none_of(run.results.begin(), run.results.end(), [](const MutantResult& r) {
           return r.outcome == MutantOutcome::survived && r.equivalent.empty();
         });
}

std::string mutation_text(const MutationRun& run) {
  const auto head = [](const char* what) {
    char text[160];
    std::snprintf(text, sizeof text, "%-24s %8s %8s %11s %9s %10s %9s %8s\n", what, "mutants", "killed", "equivalent",
                  "survived", "stillborn", "score", "seconds");
    return std::string(text);
  };
  std::string text = head("file");
  const auto files = scores(run, true), features = scores(run, false);
  for (const auto& [name, score] : files)
    if (!name.empty()) text += row(name, score);
  text += "\n" + head("feature");
  for (const auto& [name, score] : features)
    if (!name.empty()) text += row(name, score);
  text += row("", files.at(""));
  text += "\nThe score is the share of those that compile that were killed. Not mutated:\n";
  std::map<std::string, std::set<std::string>> excluded;
  for (const EmbeddedShader& shader : embedded_shaders())
    if (const auto why = exclusion_of(shader.name)) excluded[*why].insert(std::string(shader.name));
  for (const auto& [why, names] : excluded)
    text += "  " + *names.begin() + (names.size() > 1 ? " and " + std::to_string(names.size() - 1) + " more" : "") +
            ": " + why + "\n";
  bool has_title = false;
  for (const bool known : {false, true})
    for (const MutantResult& r : run.results) {
      if (r.outcome != MutantOutcome::survived || r.equivalent.empty() == known) continue;
      if (!has_title) text += "\nSurvivors:\n";
      has_title = true;
      text += name_of(r.mutant) + (r.asked == 0 ? "  (no oracle runs this line)" : "") + "\n    " + r.mutant.line_text +
              "\n";
      if (known) text += "    equivalent: " + r.equivalent + "\n";
    }
  for (const EquivalentMutant& e : run.stale)
    text += "The list of equivalents names what is none: " + e.file + ": " + e.line + " (" + e.before + " to " +
            e.after + ")\n";
  return text;
}

std::string mutation_json(const MutationRun& run) {
  nlohmann::ordered_json json;
  json["seconds"] = run.seconds;
  const auto listed = [](const std::map<std::string, Score>& all) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& [name, s] : all)
      list.push_back({{"name", name.empty() ? "all" : name},
                      {"killed", s.killed},
                      {"equivalent", s.equivalent},
                      {"survived", s.survived},
                      {"stillborn", s.stillborn},
                      {"seconds", s.seconds}});
    return list;
  };
  json["files"] = listed(scores(run, true));
  json["features"] = listed(scores(run, false));
  json["mutants"] = nlohmann::ordered_json::array();
  for (const MutantResult& r : run.results)
    json["mutants"].push_back({{"file", r.mutant.file},
                               {"line", r.mutant.line},
                               {"column", r.mutant.column},
                               {"rule", name_of(r.mutant.rule)},
                               {"before", r.mutant.before},
                               {"after", r.mutant.after},
                               {"text", r.mutant.line_text},
                               {"outcome", name_of(r.outcome)},
                               {"oracle", r.oracle},
                               {"how", r.how},
                               {"equivalent", r.equivalent},
                               {"seconds", r.seconds}});
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::vector<CaseRecord> mutation_cases(const MutationRun& run) {
  std::map<std::string, CaseRecord> cases;
  const auto files = scores(run, true);
  for (const auto& [file, score] : files) {
    if (file.empty()) continue;
    CaseRecord& c = cases[file];
    c.name = "mutants." + file.substr(0, file.find(".glsl"));
    std::replace(c.name.begin() + 8, c.name.end(), '.', '_');
    c.feature = feature_of(file);
    c.proves = "Every operator, constant and swizzle of " + file + " matters, and its change is seen.";
    c.replay = "./plumbline faults --mutants " + file;
    c.seconds = score.seconds;
    c.status = score.survived > 0 ? CaseStatus::failed : CaseStatus::passed;
    c.message = std::to_string(score.killed) + " of " + std::to_string(score.compiled()) + " mutants killed, " +
                std::to_string(score.equivalent) + " equivalent, " + std::to_string(score.survived) + " survived";
    const double share_killed = score.compiled() > 0 ? 1.0 * score.killed / score.compiled() : 0.0;
    c.figures.push_back({"mutation score", "share", share_killed, 0, 0, 0});
    c.figures.push_back({"mutants that do not compile", "", static_cast<double>(score.stillborn), 0, 0, 0});
  }
  for (const MutantResult& r : run.results) {
    if (r.outcome != MutantOutcome::survived) continue;
    CaseRecord& c = cases[r.mutant.file];
    if (c.tables.empty())
      c.tables.push_back({"Survivors", {"line", "column", "change", "text", "why no answer changes"}, {}});
    c.tables.front().rows.push_back({std::to_string(r.mutant.line), std::to_string(r.mutant.column),
                                     r.mutant.before + " to " + (r.mutant.after.empty() ? "nothing" : r.mutant.after),
                                     r.mutant.line_text, r.equivalent.empty() ? "not known" : r.equivalent});
  }
  std::vector<CaseRecord> all;
  for (auto& [file, record] : cases) all.push_back(std::move(record));
  return all;
}

}  // namespace plumbline
