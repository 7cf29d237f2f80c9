// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <iostream>
#include <thread>

#include "harness/bench.h"
#include "harness/bench_paper.h"
#include "harness/catalogue.h"
#include "harness/checked_pictures.h"
#include "harness/commands.h"
#include "harness/depths.h"
#include "harness/help.h"
#include "harness/hit_cases.h"
#include "harness/progress.h"
#include "harness/run.h"
#include "harness/version.h"
#include "harness/worker.h"
#include "reports/files.h"
#include "scenes/error.h"
#include "scenes/generate.h"

namespace plumbline {
namespace {

/// Digits alone: CLI11 would read "-1" as 2^64 - 1.
const CLI::Validator kSeed(
    [](std::string& text) {
      const bool digits =
          !text.empty() && text.size() <= 19 && text.find_first_not_of("0123456789") == std::string::npos;
      return digits ? std::string() : "'" + text + "' is no seed; a seed is a whole number of at most 19 digits";
    },
    "");

/// A scene's name as it can stand in case names.
std::string name_part(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') c = '_';
  return name.empty() ? "scene" : name;
}

/// "20m", "90s", "1h", "600" (seconds).
double parse_duration(const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  const double scale = unit == "h" ? 3600.0 : unit == "m" ? 60.0 : unit == "s" || unit.empty() ? 1.0 : 0.0;
  if (used == 0 || scale == 0.0 || !(value > 0.0 && value * scale < 1e7))
    throw InputError("'" + text + "' is not a duration; write 90s, 20m or 2h");
  return value * scale;
}

/// "2/5": the second of five.
void parse_shard(const std::string& text, RunOptions& options) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%d/%d%n", &options.shard, &options.shards, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size() || options.shard < 1 || options.shard > options.shards)
    throw InputError("--shard takes I/N with 1 <= I <= N, such as 2/5; it is '" + text + "'");
}

/// The date as a number, so that every night has its own rays and anybody can ask for them again.
std::uint64_t seed_of_today() {
  const std::time_t now = std::time(nullptr);
  std::tm d{};
  gmtime_r(&now, &d);
  return static_cast<std::uint64_t>(d.tm_year + 1900) * 10000 + static_cast<std::uint64_t>(d.tm_mon + 1) * 100 +
         static_cast<std::uint64_t>(d.tm_mday);
}

std::string joined(int argc, char** argv) {
  std::string text = "./plumbline";
  for (int i = 1; i < argc; ++i) text += " " + quoted(argv[i]);
  return text;
}

/// What the subcommands share.
struct Arguments {
  std::vector<std::string> patterns;
  std::string scene, shard, budget, json, history, picture_size;
  std::string out = "out", expected = expected_failures_file().string();
  std::uint64_t seed = 1, rays = 0;
  std::uint32_t picture_frames = 0;
  bool resume = false, github = false, quick = false, paper = false, no_pictures = false;
  int rounds = 7;
  /// The driver and Embree use all cores while they trace; what lies between is one thread's, hence more at once. Each
  /// holds up to 1.5 GB of memory, or what its scene takes if that is more (case_runner.cpp).
  int jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 4U));
};

bool names_features(const std::vector<std::string>& patterns) {
  return !patterns.empty() && std::all_of(patterns.begin(), patterns.end(), [](const std::string& pattern) {
    return std::any_of(features().begin(), features().end(), [&](const Feature& f) { return f.name == pattern; });
  });
}

RunRecord run(const Arguments& a, RunOptions options, const CatalogueOptions& catalogue) {
  if (!a.shard.empty()) parse_shard(a.shard, options);
  if (!a.budget.empty()) options.budget_seconds = parse_duration(a.budget);
  options.seed = a.seed;
  options.out = a.out;
  options.resume = a.resume;
  options.github = a.github;
  options.isolate = true;
  options.jobs = a.jobs;
  options.expected = read_expected_failures(a.expected);
  if (a.history != "none") options.history = a.history;
  return run_cases(select_cases(make_catalogue(catalogue), a.patterns), options);
}

/// What the catalogue must know of a user's scene. It is loaded in a process of its own: one that crashes the reader is
/// said to, and this process stays without threads, as the worker of the cases wants it.
ListedScene look_at(const std::string& spec) {
  Worker worker([&](const std::string&, const JobProgress&) {
    const Scene scene = load_to_trace(spec);
    return std::string(scene.spheres.empty() ? "0" : "1") + (scene.nodes.empty() ? "0" : "1") +
           (scene.animation.empty() ? "0" : "1") + scene.name;
  });
  Worker::Death death;
  const auto answer = worker.ask(
      "", 3600.0, [](double) {}, death);
  if (!answer) throw EnvironmentError(spec + ": the scene cannot be loaded: its reader " + death.how);
  return {name_part(answer->substr(3)), spec, false, (*answer)[0] == '1', (*answer)[1] == '1', (*answer)[2] == '1'};
}

int check(const Arguments& a, RunOptions options) {
  Arguments arguments = a;
  arguments.history = "none";
  options.replay = "./plumbline check " + quoted(a.scene);
  CheckedPictures pictures;
  if (!a.picture_size.empty()) parse_size("--picture-size", a.picture_size, pictures.width, pictures.height);
  if (std::min(pictures.width, pictures.height) < 8 || std::max(pictures.width, pictures.height) > 1024)
    throw InputError("--picture-size takes sides of 8 to 1024 pixels; it is '" + a.picture_size + "'");
  pictures.frames = a.picture_frames;
  CatalogueOptions catalogue = scene_catalogue(look_at(a.scene), a.rays ? a.rays : 1 << 16);
  if (a.no_pictures) {
    catalogue.paired_samples = 0;
  } else {
    catalogue.checked = pictures;
  }
  const RunRecord record = run(arguments, options, catalogue);
  std::fputs(a.no_pictures ? "Pictures: left out by --no-pictures\n" : pictures_text(record).c_str(), stdout);
  return exit_status(record);
}

int bench(const Arguments& a) {
  BenchOptions options;
  options.rounds = a.rounds;
  if (a.quick) options.variants = options.large = false;
  Progress progress;
  options.progress = [&](double share, const std::string& what) { progress.show(share, what); };
  std::vector<Metric> metrics;
  std::string table;
  if (a.paper) {
    std::vector<PaperFigure> figures = run_paper_bench(
        options.rounds, [&](double share, const std::string& what) { options.progress(0.5 * share, what); });
    const std::vector<PaperFigure> pictures = run_render_bench(
        options.rounds, [&](double share, const std::string& what) { options.progress(0.5 + 0.5 * share, what); });
    figures.insert(figures.end(), pictures.begin(), pictures.end());
    for (const PaperFigure& figure : figures) metrics.push_back(figure.metric);
    table = paper_table(figures);
  } else {
    metrics = run_bench(options);
    table = bench_table(metrics);
  }
  progress.clear();
  std::fputs(table.c_str(), stdout);
  if (!a.json.empty()) write_text(a.json, bench_json(metrics));
  return 0;
}

int dispatch(int argc, char** argv) {
  Arguments a;
  CLI::App app{
      "Plumbline tells whether a GPU ray tracer is right: hit by hit against Embree, with exact arithmetic to settle "
      "every difference.",
      "plumbline"};
  app.set_version_flag("--version", "plumbline " + version() + " (" + commit() + ")");
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 all passed, 1 a case failed, 2 wrong usage or input, 3 wrong environment.\n"
      "A SCENE is a file (.json, .gltf, .glb, .nff, .obj), a scene that comes with Plumbline such as nested, or a "
      "generator such as sphereflake:4.");
  const auto add_run_options = [&](CLI::App* sub) {
    sub->add_option("--out", a.out, "Folder for the report")->capture_default_str();
    sub->add_option("--rays", a.rays, "Rays for each family and scene, samples for each point of a profile")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{10'000'000'000}));
    sub->add_option("--jobs", a.jobs, "Cases that run at once, each in a process of its own")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    sub->add_flag("--resume", a.resume, "Go on with the run in --out: cases that ended there are not run again");
    sub->add_flag("--github", a.github, kGithubHelp);
    sub->add_option("--shard", a.shard, "I/N: run the I-th of N parts of the catalogue");
    sub->add_option("--history", a.history, "Database of earlier runs, or `none`");
    sub->add_option("--expected", a.expected, "List of expected failures (JSON); that of Plumbline if not given");
  };

  CLI::App* nightly = app.add_subcommand("nightly", "Run everything, over 20 million rays, and write the report");
  add_run_options(nightly);
  auto* nightly_seed = nightly->add_option("--seed", a.seed, "Seed of all rays; the date if not given")->check(kSeed);
  auto* nightly_budget = nightly->add_option(
      "--budget", a.budget,
      "Time for all, such as 20m: every case once, then more rays where they tell most; 18m if not given, or `none`");

  CLI::App* run_sub = app.add_subcommand("run", "Run cases, such as `run hits.camera` or `run '*.creature'`");
  run_sub->add_option("PATTERN", a.patterns, "Names, prefixes or patterns with * and ?; all cases if none");
  run_sub->add_option("--seed", a.seed, "Seed of all rays; the same seed repeats a run bit for bit")
      ->check(kSeed)
      ->capture_default_str();
  run_sub->add_option("--budget", a.budget,
                      "Time for all, such as 5m: what cannot begin in it is left out, and said to be; what is left "
                      "goes into more rays");
  add_run_options(run_sub);

  CLI::App* check_sub =
      app.add_subcommand("check", "Examine your own scene: every ray family, every variant, brute force, pictures");
  check_sub->add_option("SCENE", a.scene, "Scene file or generator")->required();
  check_sub->add_option("PATTERN", a.patterns, "Cases of the scene, as `run` names them; all if none");
  check_sub->add_option("--seed", a.seed, "Seed of all rays")->check(kSeed)->capture_default_str();
  check_sub->add_option("--picture-size", a.picture_size, "Of the pictures compared, WIDTHxHEIGHT; 48x36 if not given");
  check_sub
      ->add_option("--picture-frames", a.picture_frames,
                   "Samples of each pixel; as many as 20 seconds allow, at most 1024, if not given")
      ->check(CLI::Range(1u, 1u << 20));
  check_sub->add_flag("--no-pictures", a.no_pictures, "Compare rays alone");
  add_run_options(check_sub);

  Commands commands;
  add_explain_command(app, commands);
  add_bake_command(app, commands);
  add_verify_command(app, commands);
  add_inspect_command(app, commands);
  add_render_command(app, commands);
  add_statistics_command(app, commands);
  add_history_commands(app, commands);
  add_faults_command(app, commands);
  add_help_commands(app, commands);
  add_list_command(app, commands, [] { return run_catalogue(); });

  CLI::App* bench_sub = app.add_subcommand("bench", "Measure speed against Embree, bakes and variants");
  bench_sub->add_option("--json", a.json, "Write the metrics to this file too");
  bench_sub->add_option("--rounds", a.rounds, "Rounds of each measurement, interleaved")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  bench_sub->add_flag("--quick", a.quick, "Leave out the variants and the scene of a million triangles");
  bench_sub->add_flag("--paper", a.paper, "The paper's Figures 4 and 6 instead: rays that walk together, as ratios");

  add_examples(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    // CLI11 forgets which word it did not know.
    const std::string word = argc > 1 ? argv[1] : "";
    const std::vector<CLI::App*> subs = app.get_subcommands({});
    const bool known =
        std::any_of(subs.begin(), subs.end(), [&](const CLI::App* sub) { return sub->get_name() == word; });
    if (word.empty())
      throw InputError("say what to do: nightly, run, list, check, explain, ...; see `plumbline --help`");
    const std::string instead = meant(app, argc, argv);
    const std::string hint = instead.empty() ? "" : "did you mean " + instead + "? ";
    if (!known && word.front() != '-')
      throw InputError("there is no command '" + word + "'; " + hint + "see `plumbline --help`");
    throw InputError(std::string(error.what()) + "; " + hint + "see `plumbline " + (known ? word + " " : "") +
                     "--help`");
  }
  RunOptions options;
  options.command = joined(argc, argv);
  if (a.history.empty()) a.history = (std::filesystem::path(a.out).parent_path() / "plumbline-history.sqlite").string();
  if (*nightly) {
    if (nightly_seed->count() == 0) a.seed = seed_of_today();
    if (nightly_budget->count() == 0) a.budget = "18m";
    if (a.budget == "none") a.budget.clear();
    return exit_status(run(a, options, nightly_catalogue(a.rays)));
  }
  if (*run_sub) {
    if (run_sub->get_option("--history")->count() == 0) a.history = "none";
    return exit_status(
        run(a, options, a.rays == 0 && names_features(a.patterns) ? conformance_catalogue() : run_catalogue(a.rays)));
  }
  if (*check_sub) return check(a, options);
  for (const auto& [sub, act] : commands)
    if (*sub) return act();
  return bench(a);
}

}  // namespace

int run_command_line(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "plumbline: %s\n", error.what());
    return 2;
  } catch (const EnvironmentError& error) {
    std::fprintf(stderr, "plumbline: %s\n", error.what());
    return 3;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "plumbline: out of memory\n");
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "plumbline: unexpected: %s\n", error.what());
    return 3;
  }
}

}  // namespace plumbline
