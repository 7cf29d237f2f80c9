// SPDX-License-Identifier: GPL-3.0-or-later
// What the cases that compare rays share: tracing on both sides, judging, and writing the outcome into a record.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "harness/session.h"
#include "reports/record.h"

namespace plumbline {

/// Answers of one batch, kept between batches so that memory is allocated once.
struct TraceBuffers {
  std::vector<Hit> tracer;
  std::vector<ReferenceHit> reference;
  double trace_seconds = 0.0;  ///< spent on both sides from rays to hits
};

/// generate_rays on all cores.
void generate_rays_parallel(const RaySource& source, RayFamily family, std::uint64_t seed, std::uint64_t first,
                            std::span<Ray> rays);

/// Traces `rays` on both sides and adds their verdicts to `tally`; ray i has number first_index + i.
void trace_and_judge(const Judge& judge, Probe& probe, const EmbreeScene& embree, std::span<const Ray> rays,
                     std::uint64_t first_index, std::uint64_t seed, TraceBuffers& buffers, Tally& tally);

/// Compares `count` rays of a family, batch by batch, so that memory does not grow with their number. Notes the tracing
/// time in `record`.
Tally compare_family(CaseContext& context, const Stage& stage, const Judge& judge, Probe& probe,
                     const EmbreeScene& embree, RayFamily family, std::uint64_t seed, std::uint64_t count,
                     CaseRecord& record);

/// Rays of every family, `each` of each.
std::vector<Ray> mixed_rays(const RaySource& source, std::uint64_t seed, std::size_t each);

/// Whether two answers are the same bit for bit. Steps and tests tell of the walk and do not count.
bool same_bits(const Hit& a, const Hit& b);

/// Counts the rays whose answers differ in any bit, as agree and tracer_wrong, and keeps the first few. A difference
/// fails the case.
void record_differences(std::span<const Ray> rays, std::span<const Hit> got, std::span<const Hit> expected,
                        const std::string& expected_name, const std::string& spec, CaseRecord& record);

/// Marks the case as skipped where there is nothing to trace.
bool is_skipped(const Stage& stage, CaseRecord& record);

/// How many rays of a case may be grazing: derived from the scene for random families, all of them where rays are aimed
/// at rounding.
std::uint64_t grazing_budget(const Stage& stage, RayFamily family, std::uint64_t rays);

/// Verdict counts, kept rays and figures of a tally.
void record_tally(const Tally& tally, const std::string& spec, CaseRecord& record);

/// Sets status and message: failed by any tracer_wrong, leak or capped ray, or by more grazing rays than the budget.
void conclude(const Tally& tally, std::uint64_t budget, CaseRecord& record);

/// The ray as `explain --ray` reads it: seven hex floats.
std::string ray_argument(const Ray& ray);

/// An argument quoted for a shell where it needs it.
std::string quoted(const std::string& argument);

}  // namespace plumbline
