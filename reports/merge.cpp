// SPDX-License-Identifier: MIT
// See merge.h.
#include "reports/merge.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "reports/files.h"
#include "reports/html.h"
#include "reports/journal.h"
#include "reports/json.h"
#include "reports/summary.h"
#include "scenes/error.h"

namespace plumbline {

namespace fs = std::filesystem;

RunRecord read_run(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError(folder.string() + ": no such folder; give the folder of a run");
  return fs::exists(folder / "results.json", error) ? read_results(folder / "results.json") : read_journal(folder);
}

namespace {

/// A part as its run left it: nothing torn off, nothing changed.
RunRecord read_part(const fs::path& folder) {
  const fs::path file = folder / "results.json";
  std::error_code error;
  if (!fs::exists(file, error) && fs::exists(folder / kJournalName, error))
    throw InputError(folder.string() + ": this part was cut short; go on with it (`--resume`) before it is merged");
  const std::string text = read_text(file);
  const RunRecord run = run_from_json(text, file.string());
  if (!has_digest(text))
    throw InputError(file.string() + ": has no digest, so nobody can tell whether it was changed; run this part again");
  return run;
}

/// Refuses what is not every part of one run, each once.
void check_shards(const std::vector<RunRecord>& parts) {
  std::vector<bool> there(static_cast<std::size_t>(std::max(0, parts[0].shard.of)), false);
  for (const RunRecord& part : parts) {
    if (part.shard.of != parts[0].shard.of || part.shard.whole != parts[0].shard.whole ||
        part.shard.whole_cases != parts[0].shard.whole_cases)
      throw InputError("these parts were not cut from the same run: their cases, rays or number of parts differ");
    if (part.shard.of == 0) continue;
    if (part.shard.number < 1 || part.shard.number > part.shard.of)
      throw InputError("there is no part " + std::to_string(part.shard.number) + " of " +
                       std::to_string(part.shard.of));
    const auto number = static_cast<std::size_t>(part.shard.number - 1);
    if (there[number]) throw InputError("part " + std::to_string(number + 1) + " is there twice; give each part once");
    there[number] = true;
  }
  for (std::size_t i = 0; i < there.size(); ++i)
    if (!there[i])
      throw InputError("part " + std::to_string(i + 1) + " of " + std::to_string(there.size()) +
                       " is missing; give the folders of all parts");
}

}  // namespace

RunRecord merge_runs(std::vector<RunRecord> parts) {
  if (parts.empty()) throw InputError("nothing to merge: give the folders of the shards");
  check_shards(parts);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const RunRecord& a, const RunRecord& b) { return a.shard.number < b.shard.number; });
  RunRecord run = parts[0];
  run.cases.clear();
  run.planned_cases = 0;
  run.shard = {};
  std::unordered_map<std::string, std::size_t> position;
  for (const RunRecord& part : parts) {
    const auto same = [&](const char* what, const std::string& a, const std::string& b) {
      if (a != b)
        throw InputError("shards of different runs cannot be merged: their " + std::string(what) + " is \"" + a +
                         "\" and \"" + b + "\"");
    };
    same("version", run.version, part.version);
    same("commit", run.commit, part.commit);
    same("seed", std::to_string(run.seed), std::to_string(part.seed));
    same("driver", run.driver_renderer + ", " + run.driver_version, part.driver_renderer + ", " + part.driver_version);
    run.started = std::min(run.started, part.started);
    run.seconds = std::max(run.seconds, part.seconds);
    // A shard cut short has planned more than it did.
    run.planned_cases += std::max<std::uint64_t>(part.planned_cases, part.cases.size());
    for (const CaseRecord& record : part.cases) {
      const auto [found, is_new] = position.emplace(record.name, run.cases.size());
      if (is_new) {
        run.cases.push_back(record);
        continue;
      }
      --run.planned_cases;
      CaseRecord& kept = run.cases[found->second];
      if (is_failure(outcome(record)) && !is_failure(outcome(kept))) kept = record;
    }
  }
  if (parts[0].shard.of > 0) run.planned_cases = parts[0].shard.whole_cases;
  return run;
}

RunRecord merge_reports(const std::vector<fs::path>& folders, const fs::path& out) {
  std::vector<RunRecord> parts;
  for (const fs::path& folder : folders) parts.push_back(read_part(folder));
  const RunRecord run = merge_runs(parts);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const CaseRecord& record : parts[i].cases) {
      std::vector<std::string> files;
      for (const PictureRecord& picture : record.pictures) {
        files.push_back(picture.path);
        if (!picture.values.empty()) files.push_back(picture.values);
      }
      for (const RayRecord& ray : record.worst)
        if (!ray.explanation.empty()) files.push_back(ray.explanation);
      for (const std::string& file : files) {
        // Only files of the run's own folder: a path that leaves it is not followed.
        const fs::path path = fs::path(file).lexically_normal();
        std::error_code error;
        if (path.is_absolute() || path.empty() || *path.begin() == ".." ||
            !fs::is_regular_file(folders[i] / path, error))
          continue;
        if (fs::equivalent(folders[i] / path, out / path, error)) continue;
        write_text(out / path, read_text(folders[i] / path));
      }
    }
  }
  write_report(run, out);
  return run;
}

}  // namespace plumbline
