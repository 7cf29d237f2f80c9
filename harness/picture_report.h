// SPDX-License-Identifier: GPL-3.0-or-later
// What a report shows of a comparison of pictures: its verdict, the tests and their power, the map of z, the histogram
// and the quantiles of the p-values.
#pragma once

#include <filesystem>
#include <string>

#include "harness/compare_pictures.h"
#include "reports/record.h"

namespace plumbline {

/// Adds to `record` the pictures of both engines, named "Tracer" and "Reference" or as told, and their difference, so
/// that the report can flip between them and name the values of a pixel. Linear colour, width * height each.
struct PicturePair {
  std::vector<glm::dvec3> tested, truth;
  int width = 0, height = 0;
  std::string tested_name = "Tracer", truth_name = "Reference";
  std::string caption;  ///< what both have in common: "Mean of 64 frames."
};
void record_pair(const PicturePair& pair, const std::filesystem::path& folder, const std::string& stem,
                 CaseRecord& record);

/// Adds to `record` all but names and times; it fails where the comparison raises an alarm. Pictures go to
/// folder/pictures/STEM.*.
void record_comparison(const PictureComparison& comparison, const std::filesystem::path& folder,
                       const std::string& stem, CaseRecord& record);

}  // namespace plumbline
