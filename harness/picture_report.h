// SPDX-License-Identifier: GPL-3.0-or-later
// What a report shows of a comparison of pictures: its verdict, the tests and their power, the map of z, the histogram
// and the quantiles of the p-values.
#pragma once

#include <filesystem>
#include <string>

#include "harness/compare_pictures.h"
#include "reports/record.h"

namespace plumbline {

/// Adds to `record` all but names and times; it fails where the comparison raises an alarm. Pictures go to
/// folder/pictures/STEM.*.
void record_comparison(const PictureComparison& comparison, const std::filesystem::path& folder,
                       const std::string& stem, CaseRecord& record);

}  // namespace plumbline
