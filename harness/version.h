// SPDX-License-Identifier: GPL-3.0-or-later
// What this binary was built from and with.
#pragma once

#include <map>
#include <string>

namespace plumbline {

std::string version();  ///< of Plumbline: "0.1.0"
std::string commit();   ///< abbreviated, "-dirty" behind it where the tree was changed; "unknown" outside a checkout
/// Name to version: Embree, CGAL, OpenImageIO, OSMesa, SQLite, compiler.
std::map<std::string, std::string> library_versions();

}  // namespace plumbline
