// SPDX-License-Identifier: MIT
// The files of assets/ (and the schema), built into the library by embed_assets.cmake, so that the program runs from
// anywhere.
#pragma once

#include <string_view>

namespace plumbline {

/// The whole file, by its name without folder: "report.css". A name that was not embedded is a broken invariant.
std::string_view asset(std::string_view name);

}  // namespace plumbline
