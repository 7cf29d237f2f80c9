// SPDX-License-Identifier: MIT
// Parts of the page of an inspected image, for inspect_html.cpp alone.
#pragma once

#include <string>

#include "reports/inspect_record.h"

namespace plumbline::page {

/// The nodes of all images as JSON for the page's script, packed (see inspect_nodes.cpp), safe inside a script element.
std::string packed_nodes(const InspectRecord& record);

}  // namespace plumbline::page
