// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/depths.h"

#include <algorithm>

#include "scenes/rays.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kNightlyRays = 21'000'000;
constexpr std::uint64_t kNightlyProfile = 1 << 15;   ///< samples for each point of a profile
constexpr std::uint64_t kNightlyCaptured = 1 << 16;  ///< rays of a picture of each scene
constexpr std::uint64_t kNightlyPaired = 24'000;     ///< samples of each scene and effect, followed step by step

std::vector<ListedScene> every_scene() {
  std::vector<ListedScene> scenes = own_scenes();
  for (ListedScene& s : real_scenes()) scenes.push_back(std::move(s));
  for (ListedScene& s : placed_scenes()) scenes.push_back(std::move(s));
  return scenes;
}

/// The catalogue over `scenes` with `rays` of each family and scene, if it is not 0.
CatalogueOptions catalogue_of(std::vector<ListedScene> scenes, std::uint64_t rays) {
  CatalogueOptions options;
  if (rays > 0) options.hits_rays = options.transform_rays = options.profile_samples = options.captured_rays = rays;
  options.scenes = std::move(scenes);
  return options;
}

}  // namespace

CatalogueOptions run_catalogue(std::uint64_t rays) {
  CatalogueOptions options = catalogue_of(every_scene(), rays);
  options.pictures = effect_scenes();
  options.whole = true;
  return options;
}

CatalogueOptions nightly_catalogue(std::uint64_t rays) {
  CatalogueOptions options = run_catalogue(rays);
  if (rays > 0) return options;
  const auto plain = static_cast<std::uint64_t>(std::count_if(
      options.scenes.begin(), options.scenes.end(), [](const ListedScene& scene) { return !scene.has_nodes; }));
  options.hits_rays = kNightlyRays / (plain * ray_families().size()) + 1;
  options.profile_samples = kNightlyProfile;
  options.captured_rays = kNightlyCaptured;
  options.paired_samples = kNightlyPaired;
  return options;
}

CatalogueOptions conformance_catalogue() {
  std::vector<ListedScene> scenes = own_scenes();
  for (ListedScene& s : placed_scenes()) scenes.push_back(std::move(s));
  CatalogueOptions options = catalogue_of(std::move(scenes), 0);
  options.pictures = effect_scenes();
  options.whole = true;
  options.few_frames = true;
  options.transform_rays = 1 << 12;
  options.moved_rays = 1 << 8;
  return options;
}

CatalogueOptions scene_catalogue(const ListedScene& scene, std::uint64_t rays) { return catalogue_of({scene}, rays); }

}  // namespace plumbline
