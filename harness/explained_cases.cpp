// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/explained_cases.h"

#include <algorithm>
#include <map>

#include "harness/hit_cases.h"
#include "reports/files.h"

namespace plumbline {
namespace {

/// Of a long walk (one that never ends, say) a page holds the beginning and what tells something.
constexpr std::size_t kMostPageSteps = 4000, kMostPageEvents = 20'000;

/// A ray to explain, and where to write what is found.
struct Found {
  std::string layer, sentence, page;  ///< page: relative to the run's folder; empty: none was written
};

Found explain_one(CaseContext& context, Examiner& examiner, const std::string& case_name, std::uint64_t index,
                  const Ray& ray, const std::string& replay, bool with_page) {
  const Explanation e = examiner.explain(ray, kMostPageEvents);
  Found found{std::string(name_of(e.layer)), e.sentence, {}};
  if (!with_page) return found;
  std::string name = case_name + "-" + std::to_string(index);
  std::replace(name.begin(), name.end(), '/', '_');
  found.page = "explanations/" + name + ".html";
  write_text(context.out / found.page, explanation_html(examiner.record(e, replay, kMostPageSteps)));
  return found;
}

std::string added_to(const std::string& reason, const Found& found) {
  if (found.sentence.empty()) return reason;
  return reason + (reason.empty() ? "" : " ") + "Lost by the layer " + found.layer + ": " + found.sentence + ".";
}

bool is_failing(const RayRecord& ray) {
  return std::any_of(kVerdicts.begin(), kVerdicts.end(),
                     [&](Verdict v) { return is_failure(v) && verdict_name(v) == ray.verdict; });
}

}  // namespace

Examined examined_of(const Stage& stage, TransformOut out) {
  const GeometryImage& image = stage.image_of(out);
  return {&stage, &image, &image, {}, "baked by the case"};
}

void explain_failing(CaseContext& context, const Examined& examined, const std::string& case_name,
                     const std::string& replay, Tally& tally) {
  const bool is_explain = replay.starts_with("./plumbline explain ");
  std::size_t pages = 0;
  for (const JudgedRay& kept : tally.kept) pages += !kept.explanation.empty();
  std::optional<Examiner> examiner;  // most cases need none
  for (JudgedRay& kept : tally.kept) {
    if (!is_failure(kept.judgement.verdict) || !kept.layer.empty()) continue;
    if (!examiner) examiner.emplace(context.session, examined);
    const Found found =
        explain_one(context, *examiner, case_name, kept.index, kept.ray,
                    is_explain ? replay + " --ray=" + ray_argument(kept.ray) : replay, pages < kMostPages);
    kept.layer = found.layer;
    kept.explanation = found.page;
    kept.judgement.reason = added_to(kept.judgement.reason, found);
    pages += !found.page.empty();
  }
}

void explain_failing(CaseContext& context, const Examined& examined, CaseRecord& record, std::size_t first) {
  std::size_t pages = 0;
  for (const RayRecord& ray : record.worst) pages += !ray.explanation.empty();
  std::optional<Examiner> examiner;
  for (std::size_t i = first; i < record.worst.size(); ++i) {
    RayRecord& ray = record.worst[i];
    if (!is_failing(ray) || !ray.layer.empty()) continue;
    if (!examiner) examiner.emplace(context.session, examined);
    // Variants of a case are asked the same rays: the page's number is that of the record.
    const Found found =
        explain_one(context, *examiner, record.name, i, parse_ray(ray.origin + "," + ray.direction + "," + ray.t_max),
                    ray.replay, pages < kMostPages);
    ray.layer = found.layer;
    ray.explanation = found.page;
    ray.reason = added_to(ray.reason, found);
    pages += !found.page.empty();
  }
}

void count_layers(CaseRecord& record) {
  std::map<std::string, std::uint64_t> layers;
  std::uint64_t explained = 0, pages = 0, failing = 0;
  for (const RayRecord& ray : record.worst) {
    if (!is_failing(ray)) continue;
    ++explained;
    ++layers[ray.layer.empty() ? "not known" : ray.layer];
    pages += !ray.explanation.empty();
  }
  if (explained == 0) return;
  for (const Verdict v : kVerdicts) {
    const auto count = record.verdicts.find(std::string(verdict_name(v)));
    if (is_failure(v) && count != record.verdicts.end()) failing += count->second;
  }
  std::string text =
      failing > explained
          ? "of " + std::to_string(failing) + " rays lost " + std::to_string(explained) + " were examined: "
          : std::to_string(explained) + (explained == 1 ? " ray lost: " : " rays lost: ");
  bool is_first = true;
  for (const auto& [layer, count] : layers) {
    text += (is_first ? "" : ", ") + layer + " " + std::to_string(count);
    is_first = false;
  }
  if (pages < explained) text += "; " + std::to_string(pages) + " of them have a page of their own";
  record.message += (record.message.empty() ? "" : "; ") + text;
}

}  // namespace plumbline
