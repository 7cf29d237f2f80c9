// SPDX-License-Identifier: GPL-3.0-or-later
// What helps at the command line: examples in every --help, words to type instead of a wrong one, completion for the
// shell and a manual page, both made from the commands themselves.
#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>

#include "harness/commands.h"

namespace plumbline {

/// Up to three of `words` that are nearly `word`, nearest first: "hits, bits"; empty where none is.
std::string words_alike(const std::string& word, const std::set<std::string>& words);

/// Puts examples under the help of every subcommand. Call when all have been added.
void add_examples(CLI::App& app);

/// What to type instead of the first word that `app` does not know; empty where nothing is near.
std::string meant(const CLI::App& app, int argc, const char* const* argv);

/// A bash script that completes commands, options and, for `run` and `list`, cases.
std::string completion_script(const CLI::App& app);

/// The manual page, in troff.
std::string manual_page(const CLI::App& app, const std::string& version);

/// The commands `completion` and `manual`.
void add_help_commands(CLI::App& app, Commands& commands);

}  // namespace plumbline
