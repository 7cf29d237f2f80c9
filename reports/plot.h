// SPDX-License-Identifier: MIT
// Line plots with axes, units and a legend, as SVG: small, sharp at any size, and readable on a dark page and a light
// one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/record.h"

namespace plumbline {

struct PlotSeries {
  std::string label;  ///< "inverse, median"; empty: not in the legend
  std::string color;  ///< "#d55e00"
  bool dashed = false;
  std::vector<double> x, y;  ///< as long as each other; points that a logarithmic axis cannot show are left out
  bool marks = true;         ///< a dot at each point
  bool line = true;          ///< from point to point
  std::vector<double> low = {}, high = {};  ///< ends of a bar at each point, as long as y; empty: no bars
};

struct Plot {
  std::string x_label, y_label;  ///< with units: "nesting depth (transforms)"
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
};

/// The plot as an SVG document of 640 x 400 units.
std::string plot_svg(const Plot& plot);

/// Writes folder/pictures/STEM.svg as save_picture does and returns its record.
PictureRecord save_plot(const Plot& plot, const std::filesystem::path& folder, const std::string& stem,
                        const std::string& title, const std::string& caption);

}  // namespace plumbline
