// SPDX-License-Identifier: GPL-3.0-or-later
// How fast: the production tracer against Embree's rtcIntersect1 on the same rays and the same cores, interleaved round
// by round in one process, so that a machine whose speed drifts does not tell a wrong ratio.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace plumbline {

/// One figure over all rounds.
struct Metric {
  std::string name;  ///< "primary_vs_embree.bunny"
  std::string unit;  ///< "ratio", "rays/s", "s", "MB", "steps/ray"
  double median = 0.0, min = 0.0, max = 0.0;
  int rounds = 0;
};

/// Median, least and greatest of the values of all rounds. `values` is not empty.
Metric make_metric(const std::string& name, const std::string& unit, std::vector<double> values);

struct BenchOptions {
  int rounds = 7;        ///< at least 5 for figures that are quoted
  bool variants = true;  ///< the variants side by side
  bool large = true;     ///< the scene of a million triangles
  std::function<void(double, const std::string&)> progress = [](double, const std::string&) {};
};

std::vector<Metric> run_bench(const BenchOptions& options);

/// A table for people, one metric a line.
std::string bench_table(const std::vector<Metric>& metrics);
/// The document that `bench --json` writes: {"metrics": [{name, unit, median, min, max, rounds}]}.
std::string bench_json(const std::vector<Metric>& metrics);

}  // namespace plumbline
