// SPDX-License-Identifier: MIT
// An inspected image on a terminal.
#include <algorithm>
#include <cmath>

#include "reports/format.h"
#include "reports/inspect_report.h"

namespace plumbline {
namespace {

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}
std::string right(const std::string& text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

constexpr std::size_t kName = 30, kValue = 30;  // two values and a ratio: 100 characters

/// At most three digits behind the point, so that two spreads stand in a line.
std::string shortened(double value) {
  std::string text = fixed(value, std::abs(value) >= 10.0 ? 1 : 3);
  text.resize(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

/// Lines of a name and a value for each image; with two, what the second has over the first.
class Lines {
 public:
  explicit Lines(const InspectRecord& record) : record_(record) {}

  template <class Value>
  void figure(const std::string& name, const Value& value, const std::string& unit = "") {
    std::vector<double> values;
    std::string line = "  " + padded(name, kName);
    for (const InspectedBake& bake : record_.bakes) {
      const auto v = value(bake);
      values.push_back(static_cast<double>(v));
      line += padded((std::isfinite(values.back()) ? shown(v) : "-") + unit, kValue);
    }
    if (values.size() == 2 && values[0] > 0.0) line += "x " + shortened(values[1] / values[0]);
    add(line);
  }
  template <class Words>
  void words(const std::string& name, const Words& words) {
    std::string line = "  " + padded(name, kName);
    for (const InspectedBake& bake : record_.bakes) line += padded(words(bake), kValue);
    add(line);
  }
  void add(std::string line) {
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += line + "\n";
  }
  std::string text;

 private:
  static std::string shown(double v) { return value_text(v); }
  static std::string shown(std::uint64_t v) { return grouped(v); }
  const InspectRecord& record_;
};

std::string spread(const SpreadRecord& s) {
  if (s.count == 0) return "-";
  return shortened(s.median) + " / " + shortened(s.p99) + " / " + shortened(s.max);
}

void add_costliest(const InspectedBake& bake, std::string& text) {
  if (bake.costliest.empty()) return;
  text += "\nNodes of " + bake.name + " that cost most (" + grouped([&] {
            std::uint64_t rays = 0;
            for (const InspectedRays& r : bake.rays) rays += r.count;
            return rays;
          }()) +
          " rays; costs in sphere tests)\n  region    node  cell          visits     hit  prim. tests         cost\n";
  for (const InspectedNodeRecord& n : bake.costliest)
    text += right(std::to_string(n.region), 8) + right(std::to_string(n.number), 8) + "  " +
            padded("(" + std::to_string(n.x) + ", " + std::to_string(n.y) + ")", 12) + right(short_count(n.visits), 8) +
            right(n.visits ? percent(n.hits, n.visits) : "-", 8) + right(short_count(n.tests), 13) +
            right(short_count(static_cast<std::uint64_t>(n.cost)), 13) + (n.is_leaf ? "  leaf" : "") + "\n";
}

void add_longest(const InspectedBake& bake, std::string& text) {
  for (const InspectedRays& rays : bake.rays) {
    if (rays.longest.empty()) continue;
    text += "\nWalks of " + bake.name + " that are longest: " + rays.name + "\n   steps   tests  ray\n";
    for (const InspectedRayRecord& r : rays.longest)
      text += right(grouped(r.steps), 8) + right(grouped(r.tests), 8) + "  " + r.where + ", " + r.answer +
              (r.replay.empty() ? "" : "\n                  " + r.replay) + "\n";
  }
}

}  // namespace

std::string inspect_text(const InspectRecord& record) {
  Lines lines(record);
  using Bake = const InspectedBake&;
  lines.words("", [](Bake b) { return b.name; });
  lines.words("image, texels", [](Bake b) { return std::to_string(b.width) + " x " + std::to_string(b.height); });
  lines.figure("nodes", [](Bake b) { return b.nodes; });
  lines.figure("leaves", [](Bake b) { return b.leaves; });
  lines.figure("primitives stored", [](Bake b) { return b.primitives; });
  lines.figure("depth", [](Bake b) { return b.depth; });
  lines.figure("regions", [](Bake b) { return std::uint64_t{b.regions.size()}; });
  lines.words("slack: median / p99 / max", [](Bake b) { return spread(b.slack); });
  lines.words("overlap: median / p99 / max", [](Bake b) { return spread(b.overlap); });
  lines.figure("overlap at a node that is hit", [](Bake b) { return b.overlap_met; });
  if (!record.bakes.empty())
    for (std::size_t i = 0; i < record.bakes[0].memory.size(); ++i)
      if (std::any_of(record.bakes.begin(), record.bakes.end(),
                      [i](Bake b) { return i < b.memory.size() && b.memory[i].count > 0; }))
        lines.figure("texels: " + record.bakes[0].memory[i].name,
                     [i](Bake b) { return i < b.memory.size() ? b.memory[i].count : 0; });
  lines.figure("r^2 cost: steps of a line", [](Bake b) { return b.expected_steps; });
  lines.figure("r^2 cost: primitive tests", [](Bake b) { return b.expected_tests; });
  if (!record.bakes.empty())
    for (std::size_t i = 0; i < record.bakes[0].rays.size(); ++i) {
      const std::string name = record.bakes[0].rays[i].name;
      lines.figure(name + ": steps, mean", [i](Bake b) { return b.rays.at(i).steps.mean; });
      lines.words("  median / p99 / max", [i](Bake b) { return spread(b.rays.at(i).steps); });
      lines.figure(name + ": tests, mean", [i](Bake b) { return b.rays.at(i).tests.mean; });
      lines.words("  median / p99 / max", [i](Bake b) { return spread(b.rays.at(i).tests); });
    }
  lines.words("seconds: bake, tree, rays", [](Bake b) {
    return (b.bake_seconds > 0.0 ? fixed(b.bake_seconds, 2) : "-") + ", " + fixed(b.statistics_seconds, 2) + ", " +
           fixed(b.trace_seconds, 2);
  });
  std::string text = lines.text;
  for (Bake bake : record.bakes) {
    if (bake.fault_count > 0)
      text += "\n" + bake.name + " breaks the format in " + counted(bake.fault_count, "place") +
              "; `plumbline verify` tells all. The first: " + bake.faults.front() + "\n";
    add_costliest(bake, text);
    add_longest(bake, text);
  }
  return text;
}

}  // namespace plumbline
