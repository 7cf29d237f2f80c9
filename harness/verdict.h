// SPDX-License-Identifier: GPL-3.0-or-later
// One ray, two answers, one verdict (design: hit by hit). Rays on which both tracers agree are settled by bounds; all
// others, and a random sample of the agreeing ones, go to the exact arbiter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/bounds.h"
#include "reference/arbiter.h"
#include "scenes/ray.h"
#include "scenes/topology.h"

namespace plumbline {

enum class Verdict : std::uint8_t { agree, tie, grazing, leak, tracer_wrong, reference_wrong, undefined, capped };
inline constexpr std::size_t kVerdictCount = 8;
inline constexpr std::array<Verdict, kVerdictCount> kVerdicts{
    Verdict::agree,           Verdict::tie,       Verdict::grazing, Verdict::leak, Verdict::tracer_wrong,
    Verdict::reference_wrong, Verdict::undefined, Verdict::capped};
std::string_view verdict_name(Verdict verdict);
/// True for the verdicts that fail a case by themselves: leak, tracer_wrong and capped.
bool is_failure(Verdict verdict);
/// How many rays of a verdict a case keeps. Of the reference's own errors all are listed, up to a number that no case
/// has come near; of others the worst few.
std::size_t kept_of(Verdict verdict);

/// The verdict on one ray and what it rests on.
struct Judgement {
  Verdict verdict = Verdict::agree;
  bool arbitrated = false;  ///< exact arithmetic was asked
  /// Grazing: what decided, across the ray in units of the primitive's own space, or along it in world units.
  double margin = 0.0;
  double bound = 0.0;  ///< grazing: what 32 bits resolve, same units
  std::string exact;   ///< what exact arithmetic says, one line; empty where it was not asked
  std::string reason;  ///< one sentence; empty for agree
};

/// Everything that judging rays of one scene needs. Build once per scene; judging is thread-safe.
struct Judge {
  const Scene* scene = nullptr;
  const Arbiter* arbiter = nullptr;
  const Topology* topology = nullptr;
  bool drifts = false;  ///< the tracer leaves transforms by their inverses: bounds grow with Hit::transforms
  BoundsContext bounds;
};
Judge make_judge(const Scene& scene, const Arbiter& arbiter, const Topology& topology, const SceneTree& tree);
/// How many transforms the tracer may have left by their inverses on its way to this answer.
std::uint32_t left_by(const Judge& judge, const Hit& tracer);

/// Judges one ray. With `arbitrate_always` exact arithmetic is asked even where both agree.
Judgement judge(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference,
                bool arbitrate_always = false);

/// A judged ray that is worth keeping.
struct JudgedRay {
  std::uint64_t index = 0;  ///< number within its family
  Ray ray;
  Hit tracer;
  ReferenceHit reference;
  Judgement judgement;
  std::string layer{};        ///< of a failing ray, once it was explained (layers.h)
  std::string explanation{};  ///< the page that explains it, relative to the run's folder; empty: none
};

/// Verdicts of a batch or of a whole case.
struct Tally {
  std::array<std::uint64_t, kVerdictCount> count{};
  std::uint64_t arbitrated = 0;   ///< rays that exact arithmetic decided, the sample of agreeing rays included
  std::uint64_t sampled = 0;      ///< agreeing rays that were arbitrated all the same
  double max_margin_ratio = 0.0;  ///< largest margin over bound of the grazing rays
  /// The worst kept_of() of each verdict but agree: grazing rays by margin over bound, others by number.
  std::vector<JudgedRay> kept;
  std::uint64_t rays() const;
  std::uint64_t operator[](Verdict verdict) const { return count[static_cast<std::size_t>(verdict)]; }
};

/// Judges a batch on all cores and adds it to `tally`. Ray i has number first_index + i. About one agreeing ray in
/// `sample_one_in` is arbitrated, chosen by a hash of (seed, number). `verdicts`, if it is not empty, receives each
/// ray's verdict.
void judge_batch(const Judge& judge, std::span<const Ray> rays, std::span<const Hit> tracer,
                 std::span<const ReferenceHit> reference, std::uint64_t first_index, std::uint64_t seed,
                 std::uint32_t sample_one_in, Tally& tally, std::span<Verdict> verdicts = {});

/// "hit 812 at t = 3.2000003", "hit 812 of instance 7 at t = 3.2000003", "miss", ...
std::string describe(const Hit& hit);
std::string describe(const ReferenceHit& hit);
/// Nine significant digits, or a hex float: both read back to the same bits.
std::string hex_float(float value);
std::string hex_vector(const glm::vec3& value);

}  // namespace plumbline
