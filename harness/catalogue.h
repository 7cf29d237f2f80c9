// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue: every case by its dotted name, with what it proves and how it is run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/scene_list.h"
#include "harness/session.h"
#include "reports/record.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// What a case is given beside the session.
struct CaseContext {
  Session& session;
  std::uint64_t seed = 0;                                ///< of the run; a case mixes its own name into it
  std::filesystem::path out;                             ///< the run's folder; pictures go to out/pictures
  std::function<void(double)> progress = [](double) {};  ///< share done, 0 to 1
};

struct Case {
  std::string name;        ///< dotted and stable: "hits.aimed_edges.creature"
  std::string feature;     ///< one of features()
  std::string scene;       ///< name, or empty
  std::string spec;        ///< what loads the scene, or empty
  std::string family;      ///< of rays, or empty
  std::string variant{};   ///< what must not change the answer: "bundle=2", "bake=all"; empty: the default
  std::string proves;      ///< one sentence
  std::string paper;       ///< section of the paper, or empty
  std::uint64_t rays = 0;  ///< that it will trace
  std::function<void(CaseContext&, const Case&, CaseRecord&)>
      run;  ///< fills everything of the record that the case knows
};

/// Something that the tracer can do, and whose cases are its conformance test.
struct Feature {
  std::string name;   ///< "hits"
  std::string means;  ///< in a few words
};
const std::vector<Feature>& features();

/// Pictures of each scene whose hits are compared, tracer against reference (checked_pictures.h).
struct CheckedPictures {
  int width = 48, height = 36;       ///< pixels
  std::uint32_t frames = 0;          ///< samples of each pixel, made a multiple of 64; 0: as many as `seconds` allow
  double seconds = 20.0;             ///< for a picture, by what a few frames take
  std::vector<ShaderPatch> patches;  ///< faults on purpose
};

/// What is wrong on purpose with the tracer's pictures (renderer_faults.h).
struct RendererFault {
  std::vector<ShaderPatch> patches;
  std::function<void(Scene&)>
      edit;  ///< what the independent comparison hands to the tracer, and only to it; empty: nothing
};

struct CatalogueOptions {
  std::vector<ListedScene> scenes;          ///< whose hits are compared
  std::uint64_t hits_rays = 1 << 14;        ///< per family and scene
  std::uint64_t variant_rays = 1 << 11;     ///< per family, variant and scene
  std::uint64_t transform_rays = 1 << 14;   ///< per family, way out of a transform, and scene of instances
  std::uint64_t moved_rays = 1 << 9;        ///< per family and frame, after updates, and per variant there
  std::uint64_t captured_rays = 1 << 12;    ///< of a picture of each scene, the scenes of pictures too
  std::uint64_t paired_samples = 2400;      ///< per scene and effect; 0: none are compared
  std::uint64_t bundle_rays = 1 << 6;       ///< per family, size of bundle, way out of a transform, and scene
  std::uint64_t profile_samples = 1 << 14;  ///< for each point of a profile that is known in closed form
  std::vector<ListedScene> pictures;        ///< scenes for renderers alone
  bool few_frames =
      false;  ///< statistics of pictures at a third of their depth or less, and one source of numbers for paired ones
  std::optional<CheckedPictures> checked;  ///< none in the nightly, which has cases of more kinds
  RendererFault fault;                     ///< of the cases of effects
  bool whole = false;                      ///< the cases that have scenes of their own, too
  std::uint64_t brute_force_tests =
      40'000'000;  ///< primitive tests per scene in the brute-force layer, spread over all families
};

/// What every case about a scene says of itself. `paper`: the section that it holds to account, or empty.
Case scene_case(const std::string& name, const std::string& feature, const ListedScene& scene, const std::string& paper,
                const std::string& proves);

/// Every case, in the order in which a run takes them: the driver first, then scene by scene.
std::vector<Case> make_catalogue(const CatalogueOptions& options);

/// The seed that a case's rays are made of.
std::uint64_t case_seed(std::uint64_t run_seed, const std::string& case_name);

/// Whether a pattern selects a name: '*' and '?' as in a shell; without them it is the name or a dotted prefix of it.
bool selects(const std::string& pattern, const std::string& name);

/// Cases whose name or feature is selected by one of the patterns. No patterns: all. Throws InputError for a pattern
/// that matches nothing, with what it may have meant.
std::vector<Case> select_cases(const std::vector<Case>& cases, const std::vector<std::string>& patterns);

/// What tells the case from others like it: "scene=creature, family=camera; bundle=2". Before the semicolon what
/// changes the answer (permutations), behind it what must not (variants).
std::string axes_of(const Case& c);

// The makers of the catalogue's parts, one file each.
std::vector<Case> driver_cases();
std::vector<Case> hit_cases(const ListedScene& scene, std::uint64_t rays);
Case picture_case(const ListedScene& scene);
struct PairedOptions {
  std::uint64_t samples = 2400;      ///< of each effect
  bool few = false;                  ///< shading and all effects together, and no other
  bool every_source = false;         ///< all effects together with the numbers of MD5 and of the image of noise, too
  std::vector<ShaderPatch> patches;  ///< faults on purpose
};
/// With each effect alone, without any, and with all of them.
std::vector<Case> paired_cases(const ListedScene& scene, const PairedOptions& options);
Case captured_case(const ListedScene& scene, std::uint64_t rays);
Case brute_force_case(const ListedScene& scene, std::uint64_t tests);
Case variants_case(const ListedScene& scene, std::uint64_t rays);
std::vector<Case> bundle_cases(const ListedScene& scene, std::uint64_t rays);
Case bake_file_case(const ListedScene& scene);
Case verify_case(const ListedScene& scene);
Case broken_trees_case();
Case embree_spheres_case(const ListedScene& scene, std::uint64_t rays);
std::vector<Case> transform_cases(const ListedScene& scene, std::uint64_t rays, std::uint64_t truth_rays);
Case frames_case(const ListedScene& scene, std::uint64_t rays);
Case updates_case(const ListedScene& scene, std::uint64_t rays);
Case drift_case();
Case bunnies_case(std::uint64_t rays);

}  // namespace plumbline
