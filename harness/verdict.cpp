// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/verdict.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdio>

#include "harness/exact_view.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

std::string name_of(const Scene& scene, const Answer& a) {
  return a.kind == HitKind::hit ? primitive_name(scene, a.instance, a.primitive) : std::string("a miss");
}

Judgement arbitrate(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference) {
  Judgement j;
  j.arbitrated = true;
  const ExactView view(judge, ray, left_by(judge, tracer));
  const Answer ours = answer_of(tracer), theirs = answer_of(reference);
  j.exact = view.describe_truth();
  bool tracer_exact = view.is_exact(ours);
  const bool reference_exact = view.is_exact(theirs);

  if (tracer_exact && tracer.kind == HitKind::hit) {
    const bool other_root = view.is_other_root(*view.find(ours), tracer.t);
    const std::string error = view.value_error(tracer, other_root);
    if (error.empty() && other_root) {
      // Right primitive, wrong root of a sphere: to be explained like a wrong primitive.
      tracer_exact = false;
    } else if (!error.empty()) {
      j.verdict = Verdict::tracer_wrong;
      j.reason = "The tracer found the right primitive, but " + error + ".";
      return j;
    }
  }
  if (tracer_exact && reference_exact) {
    j.verdict = is_same(ours, theirs) ? Verdict::agree : Verdict::tie;
    if (j.verdict == Verdict::tie) j.reason = "Both primitives are exactly nearest.";
    return j;
  }
  if (!tracer_exact) {
    const auto why = view.explained(ours);
    if (!why) {
      j.verdict = Verdict::tracer_wrong;
      j.reason = "The tracer answered " + name_of(*judge.scene, ours) + ", which no rounding of its formulas explains.";
      return j;
    }
    if (const Crossing* x = view.leaked(ours)) {
      j.verdict = Verdict::leak;
      j.reason = "The ray slipped through the closed surface at " +
                 primitive_name(*judge.scene, x->instance, x->primitive) + ".";
      return j;
    }
    if (const std::string error = view.value_error_beside(tracer); !error.empty()) {
      j.verdict = Verdict::tracer_wrong;
      j.reason = "The tracer's primitive is within rounding of the exact one, but " + error + ".";
      return j;
    }
    j.verdict = Verdict::grazing;
    j.margin = why->amount, j.bound = why->bound;
    j.reason = "The tracer's answer differs from the exact one by less than 32 bits resolve.";
    return j;
  }
  const auto why = view.explained(theirs);
  if (!why) {
    j.verdict = Verdict::reference_wrong;
    j.reason = "Embree answered " + name_of(*judge.scene, theirs) + "; the tracer is exactly right.";
    return j;
  }
  j.verdict = Verdict::grazing;
  j.margin = why->amount, j.bound = why->bound;
  j.reason = "The tracer is exactly right; Embree differs by less than 32 bits resolve.";
  return j;
}

/// Whether both gave the same answer and the tracer's values lie within their bounds of the reference's.
bool both_agree(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference) {
  if (tracer.kind != reference.kind) return false;
  if (tracer.kind == HitKind::miss) return true;
  if (!is_same(answer_of(tracer), answer_of(reference))) return false;
  const PlacedRay placed = place_ray(judge.bounds, ray, tracer.instance, left_by(judge, tracer));
  // Most are settled by what costs next to nothing.
  if (is_within_bounds(least_value_bounds(judge.bounds, placed, tracer.primitive, reference.t), tracer, reference))
    return true;
  return value_outside_bound(value_bounds(judge.bounds, placed, tracer.primitive, reference.t), tracer, reference)
      .empty();
}

}  // namespace

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, kVerdictCount> kNames{
      "agree", "tie", "grazing", "leak", "tracer_wrong", "reference_wrong", "undefined", "capped"};
  return kNames[static_cast<std::size_t>(verdict)];
}

bool is_failure(Verdict verdict) {
  return verdict == Verdict::leak || verdict == Verdict::tracer_wrong || verdict == Verdict::capped;
}

std::size_t kept_of(Verdict verdict) {
  if (verdict == Verdict::reference_wrong) return 4096;
  return is_failure(verdict) ? 24 : 6;
}

Judge make_judge(const Scene& scene, const Arbiter& arbiter, const Topology& topology, const SceneTree& tree) {
  return {&scene, &arbiter, &topology, false, make_bounds_context(scene, tree)};
}

std::uint32_t left_by(const Judge& judge, const Hit& tracer) { return judge.drifts ? tracer.transforms : 0; }

Judgement judge(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference,
                bool arbitrate_always) {
  if (!is_defined(ray)) {
    if (tracer.kind == HitKind::undefined)
      return {Verdict::undefined, false, 0.0, 0.0, {}, "The ray has no answer (SEMANTICS 1.3)."};
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The ray has no answer, but the tracer gave one."};
  }
  // Bounds of `inverse` grow with each transform left; a walk enters each at most once.
  if (judge.drifts && tracer.transforms > judge.bounds.spaces.nodes.size())
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The tracer entered more transforms than there are."};
  if (tracer.kind == HitKind::capped)
    return {
        Verdict::capped, false, 0.0, 0.0, {}, "The tracer's walk did not end within the number of cells of the image."};
  if (tracer.kind == HitKind::undefined)
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The ray has an answer, but the tracer called it undefined."};
  if (tracer.kind == HitKind::hit && !judge.scene->is_placed(tracer.instance, tracer.primitive))
    return {Verdict::tracer_wrong,
            false,
            0.0,
            0.0,
            {},
            "The tracer named " + primitive_name(*judge.scene, tracer.instance, tracer.primitive) +
                ", which does not exist."};
  if (!arbitrate_always && both_agree(judge, ray, tracer, reference)) return {};
  return arbitrate(judge, ray, tracer, reference);
}

std::uint64_t Tally::rays() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : count) sum += n;
  return sum;
}

namespace {

/// Keeps the worst few of each verdict: those that used most of what 32 bits resolve, then the first.
void prune(std::vector<JudgedRay>& kept) {
  const auto ratio = [](const JudgedRay& r) {
    return r.judgement.bound > 0.0 ? r.judgement.margin / r.judgement.bound : 0.0;
  };
  std::stable_sort(kept.begin(), kept.end(), [&](const JudgedRay& a, const JudgedRay& b) {
    return ratio(a) != ratio(b) ? ratio(a) > ratio(b) : a.index < b.index;
  });
  std::array<std::size_t, kVerdictCount> count{};
  std::erase_if(kept, [&](const JudgedRay& r) {
    return ++count[static_cast<std::size_t>(r.judgement.verdict)] > kept_of(r.judgement.verdict);
  });
}

void merge(Tally& into, const Tally& from) {
  for (std::size_t i = 0; i < kVerdictCount; ++i) into.count[i] += from.count[i];
  into.arbitrated += from.arbitrated;
  into.sampled += from.sampled;
  into.max_margin_ratio = std::max(into.max_margin_ratio, from.max_margin_ratio);
  into.kept.insert(into.kept.end(), from.kept.begin(), from.kept.end());
  prune(into.kept);
}

}  // namespace

void judge_batch(const Judge& judge_data, std::span<const Ray> rays, std::span<const Hit> tracer,
                 std::span<const ReferenceHit> reference, std::uint64_t first_index, std::uint64_t seed,
                 std::uint32_t sample_one_in, Tally& tally, std::span<Verdict> verdicts) {
  PLUMBLINE_ASSERT(verdicts.empty() || verdicts.size() == rays.size());
  PLUMBLINE_ASSERT(tracer.size() == rays.size() && reference.size() == rays.size());
  const std::uint64_t salt = mix64(seed ^ name_hash("arbitrated sample"));
  const Tally batch = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, rays.size(), 512), Tally{},
      [&](const tbb::blocked_range<std::size_t>& range, Tally part) {
        std::array<std::size_t, kVerdictCount> kept{};
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const std::uint64_t index = first_index + i;
          const bool sample = sample_one_in > 0 && mix64(salt ^ index) % sample_one_in == 0;
          Judgement j = judge(judge_data, rays[i], tracer[i], reference[i], sample);
          ++part.count[static_cast<std::size_t>(j.verdict)];
          if (!verdicts.empty()) verdicts[i] = j.verdict;
          part.arbitrated += j.arbitrated;
          part.sampled += sample && j.arbitrated;
          if (j.verdict == Verdict::grazing && j.bound > 0.0)
            part.max_margin_ratio = std::max(part.max_margin_ratio, j.margin / j.bound);
          const bool first_few = ++kept[static_cast<std::size_t>(j.verdict)] <= kept_of(j.verdict);
          if (j.verdict == Verdict::grazing || (j.verdict != Verdict::agree && first_few))
            part.kept.push_back({index, rays[i], tracer[i], reference[i], std::move(j)});
        }
        prune(part.kept);
        return part;
      },
      [](Tally a, const Tally& b) {
        merge(a, b);
        return a;
      });
  merge(tally, batch);
}

std::string hex_float(float value) {
  char text[48];
  std::snprintf(text, sizeof text, "%a", static_cast<double>(value));
  return text;
}

std::string hex_vector(const glm::vec3& v) { return hex_float(v.x) + "," + hex_float(v.y) + "," + hex_float(v.z); }

namespace {

std::string describe_answer(const Answer& answer, int digits) {
  switch (answer.kind) {
    case HitKind::miss:
      return "miss";
    case HitKind::undefined:
      return "undefined";
    case HitKind::capped:
      return "capped";
    case HitKind::hit:
      break;
  }
  char t[48];
  std::snprintf(t, sizeof t, " at t = %.*g", digits, answer.t);
  std::string text = "hit " + std::to_string(answer.primitive);
  if (answer.instance != kNone) text += " of instance " + std::to_string(answer.instance);
  return text + t;
}

}  // namespace

std::string describe(const Hit& hit) { return describe_answer(answer_of(hit), 9); }
std::string describe(const ReferenceHit& hit) { return describe_answer(answer_of(hit), 17); }

}  // namespace plumbline
