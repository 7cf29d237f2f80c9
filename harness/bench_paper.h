// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's tables again: Figure 4 (one ray against two that walk together) and Figure 6 (sphereflakes with 2 and 16
// rays a pixel, together and one by one), as ratios beside the paper's own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/bench.h"

namespace plumbline {

struct PaperFigure {
  Metric metric;
  double paper = 0.0;  ///< the paper's own ratio; 0: it has none
};

/// Measures all rows in turn, `rounds` times over, so that a machine whose speed drifts does not tell a wrong ratio.
std::vector<PaperFigure> run_paper_bench(int rounds, const std::function<void(double, const std::string&)>& progress);

/// The same for whole pictures: Figure 6, Figure 1, and what the sources of random numbers cost.
std::vector<PaperFigure> run_render_bench(int rounds, const std::function<void(double, const std::string&)>& progress);

/// A table for people, one figure a line.
std::string paper_table(const std::vector<PaperFigure>& figures);

}  // namespace plumbline
