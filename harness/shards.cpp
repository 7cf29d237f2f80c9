// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/shards.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "scenes/error.h"

namespace plumbline {
namespace {

/// Of a case that nobody has measured.
constexpr double kUnknownSeconds = 0.1, kUnknownSecondsPerRay = 2e-5;

struct Cost {
  double seconds = 0.0, rays = 0.0;
};

/// A case's name without its family of rays: families of one kind and scene cost about the same.
std::string kind_of(std::string name, const std::string& family) {
  if (!family.empty())
    if (const std::size_t at = name.find("." + family + "."); at != std::string::npos)
      name.erase(at, family.size() + 1);
  return name;
}

std::map<std::string, Cost> measured_costs() {
  std::map<std::string, Cost> costs;
  std::ifstream in(PLUMBLINE_CASE_COSTS);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string kind;
    Cost cost;
    if (!(words >> kind >> cost.seconds >> cost.rays) || !(cost.seconds >= 0.0) || !(cost.rays >= 0.0))
      throw InputError(PLUMBLINE_CASE_COSTS, number, "expected a kind of case, seconds and rays");
    costs[kind] = cost;
  }
  return costs;
}

}  // namespace

double cost_of(const Case& c) {
  static const std::map<std::string, Cost> costs = measured_costs();
  const auto rays = static_cast<double>(c.rays);
  const auto found = costs.find(kind_of(c.name, c.family));
  if (found == costs.end()) return kUnknownSeconds + kUnknownSecondsPerRay * rays;
  return found->second.seconds * (found->second.rays > 0.0 && rays > 0.0 ? rays / found->second.rays : 1.0);
}

std::vector<Case> shard_of(const std::vector<Case>& cases, int shard, int shards) {
  double total = 0.0, before = 0.0;
  for (const Case& c : cases)
    if (c.feature != "driver") total += cost_of(c);
  std::vector<Case> part;
  for (const Case& c : cases) {
    if (c.feature == "driver") {
      part.push_back(c);
      continue;
    }
    const double cost = cost_of(c);
    const int number = std::min(shards, 1 + static_cast<int>((before + 0.5 * cost) / total * shards));
    before += cost;
    if (number == shard) part.push_back(c);
  }
  return part;
}

std::string costs_text(const RunRecord& run) {
  struct Sum {
    double seconds = 0.0, rays = 0.0, cases = 0.0;
  };
  std::map<std::string, Sum> sums;
  for (const CaseRecord& record : run.cases) {
    Sum& sum = sums[kind_of(record.name, record.family)];
    sum.seconds += record.seconds, sum.rays += static_cast<double>(record.rays), sum.cases += 1.0;
  }
  std::string text =
      "# What cases cost: kind (a case's name without its family of rays), seconds, rays. Measured; written by\n"
      "# `plumbline list --measured DIR`. Shards are cut by it.\n";
  for (const auto& [kind, sum] : sums) {
    char line[256];
    std::snprintf(line, sizeof line, "%s %.3g %.0f\n", kind.c_str(), sum.seconds / sum.cases, sum.rays / sum.cases);
    text += line;
  }
  return text;
}

}  // namespace plumbline
