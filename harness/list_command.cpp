// SPDX-License-Identifier: GPL-3.0-or-later
// The command `list`: the catalogue, filtered, for people and for programs.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "harness/commands.h"
#include "harness/shards.h"
#include "reports/format.h"
#include "reports/merge.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

struct ListArguments {
  std::vector<std::string> patterns;
  std::string feature, section, measured, ctest;
  bool long_form = false, json = false, names = false, only_features = false;
};

void list_features(const std::vector<Case>& cases) {
  for (const Feature& f : features()) {
    double cost = 0.0;
    std::uint64_t count = 0;
    for (const Case& c : cases)
      if (c.feature == f.name) cost += cost_of(c), ++count;
    std::printf("%-12s %10s %10s  %s\n", f.name.c_str(), counted(count, "case").c_str(), duration(cost).c_str(),
                f.means.c_str());
  }
}

/// A script for CTest: each case a test, with its feature as label and its report under `folder`.
void list_tests(const std::vector<Case>& cases, const std::filesystem::path& folder) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  for (const Case& c : cases) {
    const std::string test = "[[case." + c.name + "]]";
    std::printf("add_test(%s [[%s]] run [[%s]] --jobs 1 --history none --out [[%s]])\n", test.c_str(), program.c_str(),
                c.name.c_str(), (folder / c.name).c_str());
    std::printf("set_tests_properties(%s PROPERTIES LABELS [[case;%s]] TIMEOUT 900)\n", test.c_str(),
                c.feature.c_str());
  }
}

int list(const ListArguments& a, const CatalogueOptions& all) {
  if (!a.measured.empty()) {
    std::fputs(costs_text(read_run(a.measured)).c_str(), stdout);
    return 0;
  }
  std::vector<Case> cases = select_cases(make_catalogue(all), a.patterns);
  std::erase_if(cases, [&](const Case& c) {
    return (!a.feature.empty() && c.feature != a.feature) || (!a.section.empty() && c.paper != a.section);
  });
  if (cases.empty() && !a.only_features)
    throw InputError("no case is left by these filters; `plumbline list --features` names the features");
  if (a.only_features) {
    list_features(cases);
  } else if (a.json) {
    auto out = nlohmann::ordered_json::array();
    for (const Case& c : cases)
      out.push_back({{"name", c.name},
                     {"feature", c.feature},
                     {"paper", c.paper},
                     {"proves", c.proves},
                     {"axes", {{"scene", c.scene}, {"family", c.family}, {"variant", c.variant}}},
                     {"rays", c.rays},
                     {"seconds", cost_of(c)}});
    std::printf("%s\n", out.dump(1).c_str());
  } else if (!a.ctest.empty()) {
    list_tests(cases, a.ctest);
  } else if (a.names) {
    for (const Case& c : cases) std::printf("%s\n", c.name.c_str());
  } else {
    for (const Case& c : cases) {
      std::printf("%-44s %-10s %-4s %7s  %s\n", c.name.c_str(), c.feature.c_str(),
                  c.paper.empty() ? "" : ("§" + c.paper).c_str(), duration(cost_of(c)).c_str(), c.proves.c_str());
      if (a.long_form) std::printf("%-44s %s; %s\n", "", axes_of(c).c_str(), counted(c.rays, "ray").c_str());
    }
  }
  return 0;
}

}  // namespace

void add_list_command(CLI::App& app, Commands& commands, std::function<CatalogueOptions()> all) {
  const auto a = std::make_shared<ListArguments>();
  CLI::App* sub = app.add_subcommand("list", "List cases: feature, section of the paper, cost, and what each proves");
  sub->add_option("PATTERN", a->patterns, "Features, names, prefixes or patterns with * and ?; all if none");
  std::vector<std::string> names;
  for (const Feature& f : features()) names.push_back(f.name);
  sub->add_option("--feature", a->feature, "Only cases of this feature")->check(CLI::IsMember(names));
  sub->add_option("--section", a->section, "Only cases that hold this section of the paper to account, such as 6");
  sub->add_flag("--long", a->long_form, "A second line for each: its axes and rays");
  sub->add_flag("--features", a->only_features, "The features alone, with their number of cases and cost");
  sub->add_flag("--names", a->names, "Names alone");
  sub->add_flag("--json", a->json, "As JSON");
  sub->add_option("--ctest", a->ctest, "As a script for CTest, each case a test; reports go under this folder");
  sub->add_option("--measured", a->measured, "Print instead what the cases of this run's folder cost (case_costs.txt)");
  commands.emplace_back(sub, [a, all] { return list(*a, all()); });
}

}  // namespace plumbline
