// SPDX-License-Identifier: GPL-3.0-or-later
// The subcommands that have a file each, for command_line.cpp alone.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "harness/catalogue.h"
#include "scenes/scene.h"
#include "tracer/geometry_image.h"

namespace plumbline {

/// Of --github, wherever it is.
inline constexpr const char* kGithubHelp =
    "Annotate failing cases for GitHub Actions, and append report.md to the step's summary";

/// A subcommand and what it does, once the arguments are parsed; returns the exit status.
using Commands = std::vector<std::pair<CLI::App*, std::function<int()>>>;

void add_bake_command(CLI::App& app, Commands& commands);
void add_explain_command(CLI::App& app, Commands& commands);
void add_verify_command(CLI::App& app, Commands& commands);
void add_inspect_command(CLI::App& app, Commands& commands);
void add_render_command(CLI::App& app, Commands& commands);
void add_statistics_command(CLI::App& app, Commands& commands);
void add_history_commands(CLI::App& app, Commands& commands);
void add_faults_command(CLI::App& app, Commands& commands);
/// `all` makes what is listed.
void add_list_command(CLI::App& app, Commands& commands, std::function<CatalogueOptions()> all);

/// Adds --layout, --bounds, --links, ...: all that makes one bake another. `options` must outlive the parsing.
void add_bake_options(CLI::App& sub, BakeOptions& options);
/// Reads the same options from one word, "layout=paper,bounds=aabb": names and values as above. What is not named stays
/// as in `options`. Throws InputError for anything else.
BakeOptions parse_bake_options(const std::string& text, BakeOptions options);
/// Adds --transform-out alone.
void add_transform_out(CLI::App& sub, TransformOut& out);
/// Loads a scene and prints its warnings. Throws InputError, also where it shows no primitives.
Scene load_to_trace(const std::string& spec);
/// A size in pixels, "640x480", that `option` was given.
void parse_size(const std::string& option, const std::string& text, int& width, int& height);
/// Seconds of an animation.
double parse_time(const std::string& text);

}  // namespace plumbline
