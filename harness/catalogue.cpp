// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/catalogue.h"

#include <algorithm>
#include <set>

#include "harness/checked_pictures.h"
#include "harness/closed_form_cases.h"
#include "harness/densities.h"
#include "harness/drt_cases.h"
#include "harness/help.h"
#include "harness/tracer_engine.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

/// Shell-like match of '*' and '?'.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, mark = 0;
  while (n < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++, mark = n;
    } else if (star != std::string_view::npos) {
      p = star + 1, n = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// Names to type instead of a pattern that matches nothing: the features and the prefixes of names that are nearest.
std::string alike(const std::vector<Case>& cases, const std::string& pattern) {
  std::set<std::string> words;
  for (const Case& c : cases) {
    words.insert(c.feature);
    for (std::size_t dot = c.name.find('.'); dot != std::string::npos; dot = c.name.find('.', dot + 1))
      words.insert(c.name.substr(0, dot));
    words.insert(c.name);
  }
  if (const std::string near = words_alike(pattern, words); !near.empty()) return near;
  for (const Case& c : cases)
    if (c.scene == pattern || c.family == pattern)
      return c.scene == pattern ? "'*." + pattern + "'" : "'*." + pattern + ".*'";
  return "";
}

/// The tracer's samples and perturbations, with each source of random numbers.
std::vector<Case> tracer_statistics(bool few_frames, const RendererFault& fault) {
  std::vector<Case> cases = density_cases(reference_perturbations());
  const auto add = [&](std::vector<Case> more) {
    for (Case& c : more) cases.push_back(std::move(c));
  };
  for (const RandomKind random : {RandomKind::hash, RandomKind::md5, RandomKind::texture})
    add(density_cases(tracer_perturbations(random, fault.patches)));
  DrtOptions depth;
  if (few_frames) depth.single_frames = 4, depth.pair_frames = depth.all_frames = 1;
  RenderSettings own;
  own.patches = fault.patches;
  const auto engine_of = [&](const RenderSettings& settings) -> EngineUnderTest {
    return [settings, edit = fault.edit](CaseContext&) {
      return edit ? edited_engines(tracer_engines(settings), edit) : tracer_engines(settings);
    };
  };
  add(independent_cases(engine_of(own), depth));
  // Of the image of noise one effect at a time: pairs and all together ask nothing more of a source of numbers.
  DrtOptions texture = depth;
  texture.name = "texture";
  texture.pixels_independent = false;
  own.random = RandomKind::texture;
  for (Case& c : independent_cases(engine_of(own), texture))
    if (c.name.starts_with("drt.independent.")) cases.push_back(std::move(c));
  return cases;
}

}  // namespace

bool selects(const std::string& pattern, const std::string& name) {
  if (pattern.find_first_of("*?") != std::string::npos) return matches(pattern, name);
  return name == pattern ||
         (name.size() > pattern.size() && name.compare(0, pattern.size(), pattern) == 0 && name[pattern.size()] == '.');
}

const std::vector<Feature>& features() {
  static const std::vector<Feature> all = {
      {"driver", "what the GL implementation gets wrong"},
      {"hits", "every ray hits what exact arithmetic says"},
      {"bake", "trees, links and bounds are sound, in every variant"},
      {"transforms", "instances, nested, mirrored and moving"},
      {"bundles", "rays that walk the tree together"},
      {"combined", "effects of distributed ray tracing in pairs, and all at once"},
      {"shading", "light, reflection and refraction"},
      {"aa", "anti-aliasing"},
      {"dof", "depth of field"},
      {"soft_shadow", "lights with a size"},
      {"glossy", "rough reflections"},
      {"motion_blur", "a shutter that stays open"},
  };
  return all;
}

std::string axes_of(const Case& c) {
  std::string text = c.scene.empty() ? "" : "scene=" + c.scene;
  if (!c.family.empty()) text += (text.empty() ? "" : ", ") + ("family=" + c.family);
  return c.variant.empty() ? text : text + "; " + c.variant;
}

Case scene_case(const std::string& name, const std::string& feature, const ListedScene& scene, const std::string& paper,
                const std::string& proves) {
  Case c;
  c.name = name, c.feature = feature;
  c.scene = scene.name, c.spec = scene.spec;
  c.paper = paper, c.proves = proves;
  return c;
}

std::vector<Case> make_catalogue(const CatalogueOptions& options) {
  std::vector<Case> cases = driver_cases();
  const auto add = [&](std::vector<Case> more) {
    for (Case& c : more) cases.push_back(std::move(c));
  };
  for (const ListedScene& scene : options.scenes) {
    add(scene.has_nodes ? transform_cases(scene, options.transform_rays, options.variant_rays)
                        : hit_cases(scene, options.hits_rays));
    cases.push_back(picture_case(scene));
    cases.push_back(captured_case(scene, options.captured_rays));
    if (scene.has_spheres && !scene.has_nodes) cases.push_back(embree_spheres_case(scene, options.hits_rays));
    cases.push_back(brute_force_case(scene, options.brute_force_tests));
    cases.push_back(variants_case(scene, scene.has_nodes ? options.moved_rays : options.variant_rays));
    add(bundle_cases(scene, options.bundle_rays));
    cases.push_back(bake_file_case(scene));
    cases.push_back(verify_case(scene));
    // These put other scenes on the stage, so they come last.
    if (options.paired_samples > 0)
      add(paired_cases(scene, {options.paired_samples, true, false, options.fault.patches}));
    if (options.checked) cases.push_back(checked_picture_case(scene, *options.checked));
    if (scene.moves) cases.push_back(frames_case(scene, options.moved_rays));
    if (scene.has_nodes) cases.push_back(updates_case(scene, options.moved_rays));
  }
  for (const ListedScene& scene : options.pictures) {
    cases.push_back(captured_case(scene, options.captured_rays));
    add(paired_cases(scene, {options.paired_samples, false, !options.few_frames, options.fault.patches}));
  }
  if (options.whole) {
    cases.push_back(broken_trees_case());
    cases.push_back(drift_case());
    cases.push_back(bunnies_case(options.moved_rays));
    add(closed_form_cases(picture_sources(options.fault.patches), options.profile_samples));
    add(tracer_statistics(options.few_frames, options.fault));
    add(model_bias_cases());
  }
  return cases;
}

std::uint64_t case_seed(std::uint64_t run_seed, const std::string& case_name) {
  return mix64(run_seed ^ name_hash(case_name));
}

std::vector<Case> select_cases(const std::vector<Case>& cases, const std::vector<std::string>& patterns) {
  if (patterns.empty()) return cases;
  const auto takes = [](const std::string& pattern, const Case& c) {
    return pattern == c.feature || selects(pattern, c.name);
  };
  for (const std::string& pattern : patterns) {
    if (std::any_of(cases.begin(), cases.end(), [&](const Case& c) { return takes(pattern, c); })) continue;
    const std::string meant = alike(cases, pattern);
    throw InputError("no case matches '" + pattern + "'; " +
                     (meant.empty() ? "`plumbline list` names them all" : "did you mean " + meant + "?"));
  }
  std::vector<Case> chosen;
  std::copy_if(cases.begin(), cases.end(), std::back_inserter(chosen), [&](const Case& c) {
    return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) { return takes(pattern, c); });
  });
  return chosen;
}

}  // namespace plumbline
