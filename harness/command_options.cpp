// SPDX-License-Identifier: GPL-3.0-or-later
// Options that several subcommands have, and how their values are read.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <vector>

#include "harness/commands.h"
#include "scenes/error.h"
#include "scenes/generate.h"

namespace plumbline {
namespace {

/// An option whose values go by their names.
template <class Choice>
void add_choice(CLI::App& sub, const std::string& name, Choice& choice, std::initializer_list<Choice> choices,
                const std::string& what) {
  std::map<std::string, Choice> by_name;
  std::string listed;
  for (const Choice c : choices)
    by_name[name_of(c)] = c, listed += (listed.empty() ? "" : ", ") + std::string(name_of(c));
  sub.add_option_function<std::string>(
         name, [&choice, by_name](const std::string& text) { choice = by_name.at(text); }, what)
      ->type_name("{" + listed + "}")
      ->check(CLI::IsMember(by_name).description(""))
      ->default_str(name_of(choice));
}

}  // namespace

void add_transform_out(CLI::App& sub, TransformOut& out) {
  add_choice(sub, "--transform-out", out, {TransformOut::restore, TransformOut::inverse},
             "How rays leave a transform: derived anew, or by the inverse matrix (the paper's)");
}

void add_bake_options(CLI::App& sub, BakeOptions& options) {
  add_choice(sub, "--layout", options.layout, {Layout::compact, Layout::paper},
             "One texel for each node, or the paper's cells of two");
  add_choice(sub, "--bounds", options.bounds, {Bounds::sphere, Bounds::aabb}, "Spheres (the paper's), or boxes");
  add_choice(sub, "--links", options.links, {Links::octant, Links::threaded},
             "A copy of the tree for each octant of directions, or one (the paper's)");
  add_transform_out(sub, options.transform_out);
  add_choice(sub, "--transform-list", options.transform_list, {TransformList::tree, TransformList::root},
             "Transforms in a tree over their bounds, or all at the root (the paper's)");
  sub.add_option("--image-width", options.width, "Texels in a row, a power of two; grows to what the tree needs")
      ->capture_default_str();
  sub.add_option("--leaf-size", options.tree.leaf_size, "Primitives in a leaf at most")
      ->check(CLI::Range(1, static_cast<int>(kMaxLeafSize)))
      ->capture_default_str();
  sub.add_option("--tree-width", options.tree.width, "Children of a node at most; 0: as many as cost least")
      ->check(CLI::Range(0, 1 << 20))
      ->capture_default_str();
  sub.add_option("--split-long", options.tree.split_long,
                 "Split triangles with an edge longer than this share of the scene's radius; 0: none; measured if not "
                 "given")
      ->check(CLI::Range(0.0f, 2.0f));
}

BakeOptions parse_bake_options(const std::string& text, BakeOptions options) {
  CLI::App app;
  app.set_help_flag();
  add_bake_options(app, options);
  std::vector<std::string> words;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    words.push_back("--" + text.substr(at, end - at));
    at = end + 1;
  }
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  try {
    for (const std::string& word : words)
      if (word.find('=') == std::string::npos) throw CLI::ParseError("'" + word.substr(2) + "' has no value", 1);
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InputError("'" + text + "' is no list of bake options such as layout=paper,bounds=aabb: " + error.what());
  }
  return options;
}

Scene load_to_trace(const std::string& spec) {
  Scene scene = load_scene(spec);
  for (const std::string& warning : scene.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (placed_count(scene) == 0) throw InputError(spec + ": nothing to trace in this scene");
  return scene;
}

void parse_size(const std::string& option, const std::string& text, int& width, int& height) {
  const char* const end = text.data() + text.size();
  const auto [x, width_error] = std::from_chars(text.data(), end, width);
  const bool has_x = width_error == std::errc() && x != end && *x == 'x';
  const auto [last, height_error] = std::from_chars(has_x ? x + 1 : end, end, height);
  if (!has_x || height_error != std::errc() || last != end || width < 1 || height < 1)
    throw InputError(option + " takes WIDTHxHEIGHT, such as 640x480; it is '" + text + "'");
}

double parse_time(const std::string& text) {
  std::size_t used = 0;
  double value = std::numeric_limits<double>::quiet_NaN();
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value))
    throw InputError("--time takes seconds, such as 0.5; it is '" + text + "'");
  return value;
}

}  // namespace plumbline
