// SPDX-License-Identifier: GPL-3.0-or-later
// Help: words to type instead, completion and manual made of the commands.
#include "harness/help.h"

#include <array>
#include <catch2/catch.hpp>

using namespace plumbline;

TEST_CASE("A wrong word is answered with those that are near") {
  const std::set<std::string> words = {"--seed", "--shard", "--rays"};
  CHECK(words_alike("--sed", words) == "--seed");
  CHECK(words_alike("--shrad", words).starts_with("--shard"));
  CHECK(words_alike("--nothing", words).empty());
}

TEST_CASE("Completion and manual name every command and option, a wrong one is told what to type") {
  CLI::App app{"What it does.", "plumbline"};
  CLI::App* run = app.add_subcommand("run", "Run cases");
  std::string seed;
  run->add_option("--seed", seed, "Of all rays");
  Commands commands;
  add_help_commands(app, commands);
  add_examples(app);
  CHECK_THAT(run->help(), Catch::Contains("Examples:") && Catch::Contains("plumbline run transforms"));
  CHECK_THAT(completion_script(app),
             Catch::Contains("run completion manual") && Catch::Contains("run) words='--help --seed -h'"));
  CHECK_THAT(manual_page(app, "1.0"), Catch::Contains(".SS run\nRun cases.") && Catch::Contains("\\-\\-seed"));
  const std::array<const char*, 4> wrong_option = {"plumbline", "run", "hits", "--sede=4"};
  CHECK(meant(app, 4, wrong_option.data()) == "--seed");
  const std::array<const char*, 2> wrong_command = {"plumbline", "rnu"};
  CHECK_THAT(meant(app, 2, wrong_command.data()), Catch::Contains("run"));
}
