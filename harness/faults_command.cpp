// SPDX-License-Identifier: GPL-3.0-or-later
// `plumbline faults`: the seeded faults and what catches them; with --mutants, every operator, constant and swizzle of
// the production shaders changed, and who sees it.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "harness/commands.h"
#include "harness/faults.h"
#include "harness/mutation.h"
#include "harness/progress.h"
#include "harness/run.h"
#include "reports/files.h"
#include "tracer/gl_context.h"

namespace plumbline {
namespace {

struct FaultsArguments {
  bool mutants = false, list = false;
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
  sub->add_option("--seed", m.seed, "Of the choice")->capture_default_str()->needs(mutants);
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
  commands.emplace_back(sub, [a] { return a->mutants ? run_mutation(*a) : seed_faults(); });
}

}  // namespace plumbline
