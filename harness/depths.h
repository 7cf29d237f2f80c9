// SPDX-License-Identifier: GPL-3.0-or-later
// How deep the catalogue goes, for each of the commands that run it.
#pragma once

#include <cstdint>

#include "harness/catalogue.h"

namespace plumbline {

/// Over all scenes that are there, those of the data folder too. `rays`: of each family and scene, 0 for the command's
/// own.
CatalogueOptions nightly_catalogue(std::uint64_t rays = 0);
CatalogueOptions run_catalogue(std::uint64_t rays = 0);
/// What `run FEATURE...` asks: all scenes that come with Plumbline, at a depth that ends within a minute for any one
/// feature.
CatalogueOptions conformance_catalogue();
/// One scene, with so many rays of each family.
CatalogueOptions scene_catalogue(const ListedScene& scene, std::uint64_t rays);

}  // namespace plumbline
