// SPDX-License-Identifier: GPL-3.0-or-later
// `plumbline faults`: the seeded faults of hits and what catches them; with --pictures those of distributed ray
// tracing, by the nightly's cases; with --mutants every operator, constant and swizzle of the production shaders
// changed, and who sees it.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <random>

#include "harness/commands.h"
#include "harness/faults.h"
#include "harness/mutation.h"
#include "harness/progress.h"
#include "harness/renderer_faults.h"
#include "harness/run.h"
#include "reports/files.h"
#include "scenes/error.h"
#include "tracer/gl_context.h"

namespace plumbline {
namespace {

struct FaultsArguments {
  bool mutants = false, pictures = false;
  bool is_seeded = false;  ///< by the user
  std::vector<std::string> names;
  std::string json, out;
  MutationOptions mutation;
};

int seed_faults() {
  Progress progress;
  const std::vector<FaultResult> results =
      run_faults(1, [&](double share, const std::string& what) { progress.show(share, what); });
  progress.clear();
  bool all = true;
  for (const FaultResult& r : results) {
    std::printf("%-28s %-8s %s\n", r.name.c_str(), r.caught_by.empty() ? "MISSED" : "caught",
                r.caught_by.empty() ? r.what.c_str() : r.caught_by.c_str());
    if (r.layer != Layer::none)
      std::printf("%-28s %-8s layer %s: %s\n", "", "", std::string(name_of(r.layer)).c_str(), r.sentence.c_str());
    all = all && !r.caught_by.empty();
  }
  return all ? 0 : 1;
}

/// A sentence, cut where a line of a terminal would be full.
std::string short_text(const std::string& text) {
  constexpr std::size_t kMost = 110;
  return text.size() <= kMost ? text : text.substr(0, kMost) + " ...";
}

int seed_picture_faults(const FaultsArguments& a) {
  std::random_device device;
  const std::uint64_t seed = a.is_seeded ? a.mutation.seed : (std::uint64_t{device()} << 32 | device()) >> 1;
  std::vector<SeededRendererFault> faults = renderer_faults(a.names);
  std::printf("seed %llu%s\n", static_cast<unsigned long long>(seed),
              a.is_seeded ? "" : ", drawn for this run; --seed repeats it");
  std::fflush(stdout);
  bool all = true;
  int caught = 0;
  const std::size_t count = faults.size();
  Progress progress;
  run_renderer_faults(
      seed, std::move(faults), [&](double share, const std::string& what) { progress.show(share, what); },
      [&](const RendererFaultResult& r) {
        progress.clear();
        const bool is_sound = r.name == "sound", is_right = r.caught() != is_sound;
        all = all && is_right;
        if (!is_sound) caught += r.caught();
        const char* verdict = is_sound ? (is_right ? "passes" : "ALARM") : is_right ? "caught" : "MISSED";
        std::printf("%-17s %-7s %5.1f s  %s\n", r.name.c_str(), verdict, r.seconds, r.what.c_str());
        for (const RendererFaultWitness& w : r.witnesses)
          if (!is_sound || w.caught)
            std::printf("  %-8s %s: %s\n", w.caught ? "sees it" : "passes", w.name.c_str(),
                        short_text(w.message).c_str());
        std::fflush(stdout);
      });
  const bool alarmed = !all && static_cast<std::size_t>(caught) == count;
  std::printf("%d of %zu faults caught at the nightly's depth%s\n", caught, count,
              alarmed ? ", but the sound renderer raised an alarm" : "");
  return all ? 0 : 1;
}

int run_mutation(const FaultsArguments& a) {
  MutationOptions options = a.mutation;
  Progress progress;
  options.progress = [&](double share, const std::string& what) { progress.show(share, what); };
  const MutationRun run = run_mutants(options);
  progress.clear();
  std::fputs(run.costs.c_str(), stderr);
  std::fputs(mutation_text(run).c_str(), stdout);
  if (!a.out.empty()) {
    RunOptions report;
    report.out = a.out;
    report.seed = options.seed;
    report.command = "./plumbline faults --mutants";
    RunRecord record = begin_record(report);
    record.cases = mutation_cases(run);
    record.planned_cases = record.cases.size();
    record.seconds = run.seconds;
    const GlContext context;
    record.driver_renderer = context.renderer();
    record.driver_version = context.version();
    finish_run(record, report);
  }
  if (!a.json.empty()) write_text(a.json, mutation_json(run));
  return is_passed(run) ? 0 : 1;
}

}  // namespace

void add_faults_command(CLI::App& app, Commands& commands) {
  CLI::App* sub =
      app.add_subcommand("faults", "Break the tracer on purpose, one fault at a time, and name what catches it");
  auto a = std::make_shared<FaultsArguments>();
  MutationOptions& m = a->mutation;
  CLI::Option* mutants = sub->add_flag("--mutants", a->mutants,
                                       "Change every operator, constant and swizzle of the production shaders instead");
  sub->add_option("FILE", m.filters, "With --mutants: shader files or features, such as triangle.glsl or bundles")
      ->needs(mutants);
  sub->add_option("--sample", m.sample, "So many mutants, chosen at random")->needs(mutants);
  CLI::Option* pictures = sub->add_flag("--pictures", a->pictures,
                                        "Seed faults of distributed ray tracing into the renderer instead, and ask the "
                                        "nightly's cases, at its depth")
                              ->excludes(mutants);
  sub->add_option("--fault", a->names, "With --pictures: these only")->needs(pictures);
  CLI::Option* seed = sub->add_option("--seed", m.seed,
                                      "With --mutants: of the choice, 1 if not given. With --pictures: of all random "
                                      "numbers, drawn if not given");
  sub->add_option("--jobs", m.jobs, "Processes that share the mutants")
      ->check(CLI::Range(1, 256))
      ->capture_default_str()
      ->needs(mutants);
  sub->add_option("--journal", m.journal, "Keep results here as they come, one a line")->needs(mutants);
  CLI::Option* resume =
      sub->add_flag("--resume", m.resume, "Do not ask again what stands in the journal")->needs("--journal");
  sub->add_flag("--again", m.again, "... but what survived")->needs(resume);
  sub->add_option("--out", a->out, "Folder for a report, a case for each shader file")->needs(mutants);
  sub->add_option("--json", a->json, "Write all results to this file too")->needs(mutants);
  commands.emplace_back(sub, [a, seed] {
    a->is_seeded = seed->count() > 0;
    if (a->pictures) return seed_picture_faults(*a);
    if (a->is_seeded && !a->mutants) throw InputError("--seed belongs to --mutants or --pictures; add one of them");
    return a->mutants ? run_mutation(*a) : seed_faults();
  });
}

}  // namespace plumbline
