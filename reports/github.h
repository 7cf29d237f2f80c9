// SPDX-License-Identifier: MIT
// What GitHub Actions shows of a run: annotations of the failing cases, by workflow commands on standard output.
#pragma once

#include <string>
#include <string_view>

#include "reports/record.h"

namespace plumbline {

/// GitHub shows no more errors of a step than these.
inline constexpr std::size_t kMostGithubErrors = 10;

/// "::error title=CASE::MESSAGE" for the first kMostGithubErrors failing cases, then "::notice" with the headline and
/// how many more failed. A line each, whatever the names hold.
std::string github_annotations(const RunRecord& run);

/// A workflow command's message: '%' and line breaks are encoded. Other control characters become spaces.
std::string github_message(std::string_view text);
/// A workflow command's property: ':' and ',' are encoded too.
std::string github_property(std::string_view text);

}  // namespace plumbline
