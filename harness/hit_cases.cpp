// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `hits.*`: the same rays through the production tracer and through Embree, every one of them with a verdict.
#include "harness/hit_cases.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "harness/catalogue.h"
#include "harness/clock.h"
#include "harness/exact_view.h"
#include "harness/explained_cases.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr std::size_t kBatch = std::size_t{1} << 17;
/// One agreeing ray in this many is arbitrated all the same, so that both being wrong together is seen.
constexpr std::uint32_t kSampleOneIn = 1024;

/// The families whose rays are random lines that know nothing of the tracer's rounding; the others are aimed at it.
bool is_random_family(RayFamily family) {
  return family == RayFamily::camera || family == RayFamily::chords || family == RayFamily::inside;
}

}  // namespace

void generate_rays_parallel(const RaySource& source, RayFamily family, std::uint64_t seed, std::uint64_t first,
                            std::span<Ray> rays) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), 4096),
                    [&](const tbb::blocked_range<std::size_t>& r) {
                      generate_rays(source, family, seed, first + r.begin(), rays.subspan(r.begin(), r.size()));
                    });
}

void trace_and_judge(const Judge& judge, Probe& probe, const EmbreeScene& embree, std::span<const Ray> rays,
                     std::uint64_t first_index, std::uint64_t seed, TraceBuffers& buffers, Tally& tally) {
  buffers.tracer.resize(rays.size());
  buffers.reference.resize(rays.size());
  const auto start = Clock::now();
  probe.trace(rays, buffers.tracer);
  embree.intersect(rays, buffers.reference);
  buffers.trace_seconds += seconds_since(start);
  judge_batch(judge, rays, buffers.tracer, buffers.reference, first_index, seed, kSampleOneIn, tally);
}

Tally compare_family(CaseContext& context, const Stage& stage, const Judge& judge, Probe& probe,
                     const EmbreeScene& embree, RayFamily family, std::uint64_t seed, std::uint64_t count,
                     CaseRecord& record) {
  Tally tally;
  TraceBuffers buffers;
  std::vector<Ray> batch;
  for (std::uint64_t first = 0; first < count; first += kBatch) {
    batch.resize(std::min<std::uint64_t>(kBatch, count - first));
    generate_rays_parallel(stage.rays, family, seed, first, batch);
    trace_and_judge(judge, probe, embree, batch, first, seed, buffers, tally);
    context.progress(static_cast<double>(first + batch.size()) / static_cast<double>(count));
  }
  PLUMBLINE_ASSERT(tally.rays() == count);
  record.trace_seconds = buffers.trace_seconds;
  return tally;
}

std::vector<Ray> mixed_rays(const RaySource& source, std::uint64_t seed, std::size_t each) {
  std::vector<Ray> rays(each * ray_families().size());
  std::size_t at = 0;
  for (const RayFamilyInfo& family : ray_families()) {
    generate_rays_parallel(source, family.family, seed, 0, std::span(rays).subspan(at, each));
    at += each;
  }
  return rays;
}

bool same_bits(const Hit& a, const Hit& b) {
  const auto values = [](const Hit& h) {
    return std::array{h.t,        h.position.x, h.position.y,     h.position.z,    h.normal.x,
                      h.normal.y, h.normal.z,   h.barycentrics.x, h.barycentrics.y};
  };
  const auto va = values(a), vb = values(b);
  return a.kind == b.kind && a.primitive == b.primitive && a.instance == b.instance &&
         std::memcmp(&va, &vb, sizeof va) == 0;
}

void record_differences(std::span<const Ray> rays, std::span<const Hit> got, std::span<const Hit> expected,
                        const std::string& expected_name, const std::string& spec, CaseRecord& record) {
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (same_bits(got[i], expected[i]) && got[i].kind != HitKind::capped) continue;  // both capped is no agreement
    if (++differing > 8) continue;
    RayRecord r;
    r.verdict = verdict_name(got[i].kind == HitKind::capped ? Verdict::capped : Verdict::tracer_wrong);
    r.index = i;
    r.origin = hex_vector(rays[i].origin), r.direction = hex_vector(rays[i].direction),
    r.t_max = hex_float(rays[i].t_max);
    r.tracer = describe(got[i]);
    r.reference = describe(expected[i]);
    r.reason = "Not bit for bit what " + expected_name + " answers.";
    r.replay = "./plumbline explain " + quoted(spec) + " --ray=" + ray_argument(rays[i]);
    record.worst.push_back(std::move(r));
  }
  record.rays += rays.size();
  record.verdicts["agree"] += rays.size() - differing;
  record.verdicts["tracer_wrong"] += differing;
  if (differing > 0) {
    record.status = CaseStatus::failed;
    record.message += (record.message.empty() ? "" : "; ") + std::to_string(differing) + " of " +
                      std::to_string(rays.size()) + " rays differ from " + expected_name;
  }
}

bool is_skipped(const Stage& stage, CaseRecord& record) {
  if (placed_count(stage.scene) > 0) return false;
  record.status = CaseStatus::skipped;
  record.message = "the scene shows no primitives";
  return true;
}

std::string ray_argument(const Ray& ray) {
  return hex_vector(ray.origin) + "," + hex_vector(ray.direction) + "," + hex_float(ray.t_max);
}

std::string quoted(const std::string& argument) {
  if (argument.find_first_of(" '\"$`\\&;()<>|*?#~") == std::string::npos && !argument.empty()) return argument;
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

void record_tally(const Tally& tally, const std::string& spec, CaseRecord& record) {
  record.rays = tally.rays();
  for (const Verdict v : kVerdicts) record.verdicts[std::string(verdict_name(v))] = tally[v];
  record.max_margin_ratio = tally.max_margin_ratio;
  for (const JudgedRay& kept : tally.kept) {
    RayRecord r;
    r.verdict = verdict_name(kept.judgement.verdict);
    r.index = kept.index;
    r.origin = hex_vector(kept.ray.origin);
    r.direction = hex_vector(kept.ray.direction);
    r.t_max = hex_float(kept.ray.t_max);
    r.tracer = describe(kept.tracer);
    r.reference = describe(kept.reference);
    r.exact = kept.judgement.exact;
    r.reason = kept.judgement.reason;
    r.margin = kept.judgement.margin;
    r.bound = kept.judgement.bound;
    r.layer = kept.layer;
    r.explanation = kept.explanation;
    r.replay = "./plumbline explain " + quoted(spec) + " --ray=" + ray_argument(kept.ray);
    record.worst.push_back(std::move(r));
  }
  record.message = std::to_string(tally.arbitrated) + " rays went to exact arithmetic, " +
                   std::to_string(tally.sampled) + " of them by chance";
  if (const std::size_t most = kept_of(Verdict::reference_wrong); tally[Verdict::reference_wrong] > most)
    record.message += "; of " + std::to_string(tally[Verdict::reference_wrong]) + " rays that Embree has wrong, " +
                      std::to_string(most) + " are listed";
}

std::uint64_t grazing_budget(const Stage& stage, RayFamily family, std::uint64_t rays) {
  // A random line of the ball of radius R passes within w of a segment of length l with probability (pi/4) 2wl / (pi
  // R^2) = wl / 2R^2, and within w of a sphere's outline of radius r with probability 2 pi r 2w / (pi R^2) = 4rw / R^2.
  // Summed over the scene: p rays per ray; of an instance lengths and w are stretched, at most, as it stretches. Camera
  // rays are no random lines, hence a factor of 16; six standard deviations and 16 rays are for chance in small
  // samples. A tracer that is wrong near edges by ten times its bound is not grazing but wrong; this budget catches one
  // whose rounding is worse than its formulas allow.
  if (!is_random_family(family)) return rays;
  const Scene& scene = stage.scene;
  BoundsContext context = stage.judge.bounds;
  const double radius = stage.rays.ball.radius;
  const Ray typical{glm::vec3(stage.rays.ball.center + glm::dvec3(2.0 * radius, 0.0, 0.0)), {-1.0f, 0.0f, 0.0f}};
  // Twice the sum of lengths of edges, each edge told twice, and 4 r, of a range of primitives.
  const auto outlines = [&](std::uint32_t first_triangle, std::uint32_t triangles, std::uint32_t first_sphere,
                            std::uint32_t spheres) {
    double sum = 0.0;
    for (std::uint32_t p = first_triangle; p < first_triangle + triangles; ++p) {
      const auto v = scene.corners(p);
      for (int i = 0; i < 3; ++i) sum += 0.25 * glm::length(glm::dvec3(v[(i + 1) % 3]) - glm::dvec3(v[i]));
    }
    for (std::uint32_t i = first_sphere; i < first_sphere + spheres; ++i) sum += 4.0 * scene.spheres[i].radius;
    return sum;
  };
  const auto width = [&](std::uint32_t instance) {
    return lateral_bound_of_space(context, place_ray(context, typical, instance));
  };
  const auto typical_edge = [](SpaceExtent& space) {
    space.longest_edge = std::min(space.longest_edge, space.ball.radius / 64.0);
  };
  typical_edge(context.world);
  double sum = outlines(0, scene.world_triangle_count(), 0, scene.world_sphere_count()) * width(kNone);
  std::vector<double> parts;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const Part& part = scene.parts[i];
    typical_edge(context.parts[i]);
    parts.push_back(outlines(part.first_triangle, part.triangle_count, part.first_sphere, part.sphere_count));
  }
  for (const std::uint32_t instance : instances_of(scene)) {
    const double stretch = context.spaces.instances[instance].stretch;
    sum += stretch * stretch * parts[scene.nodes[instance].part] * width(instance);
  }
  const double expected = 16.0 * sum / (radius * radius) * static_cast<double>(rays);
  return expected < static_cast<double>(rays) ? static_cast<std::uint64_t>(expected + 6.0 * std::sqrt(expected) + 16.0)
                                              : rays;
}

void conclude(const Tally& tally, std::uint64_t budget, CaseRecord& record) {
  std::string message = record.message;
  const auto complain = [&](const std::string& text) {
    message = record.status == CaseStatus::failed ? message + "; " + text : text;
    record.status = CaseStatus::failed;
  };
  for (const Verdict v : {Verdict::tracer_wrong, Verdict::leak, Verdict::capped})
    if (tally[v] > 0)
      complain(std::to_string(tally[v]) + " of " + std::to_string(tally.rays()) +
               " rays: " + std::string(verdict_name(v)));
  if (tally[Verdict::grazing] > budget)
    complain(std::to_string(tally[Verdict::grazing]) + " rays grazing, over the budget of " + std::to_string(budget));
  record.message = message;
  count_layers(record);
}

std::vector<Case> hit_cases(const ListedScene& scene, std::uint64_t rays) {
  std::vector<Case> cases;
  for (const RayFamilyInfo& family : ray_families()) {
    Case c = scene_case("hits." + std::string(family.name) + "." + scene.name, "hits", scene, "4",
                        "Every ray of the family hits what exact arithmetic says: " + std::string(family.description));
    c.family = family.name;
    c.rays = rays;
    c.run = [id = family.family](CaseContext& context, const Case& self, CaseRecord& record) {
      Stage& stage = context.session.stage(self.spec);
      if (is_skipped(stage, record)) return;
      const std::uint64_t seed = case_seed(context.seed, self.name);
      Tally tally = compare_family(context, stage, stage.judge, context.session.probe(stage), stage.embree, id, seed,
                                   self.rays, record);
      explain_failing(context, examined_of(stage), self.name, "./plumbline explain " + quoted(self.spec), tally);
      record_tally(tally, self.spec, record);
      conclude(tally, grazing_budget(stage, id, self.rays), record);
    };
    cases.push_back(std::move(c));
  }
  return cases;
}

Case embree_spheres_case(const ListedScene& scene, std::uint64_t rays) {
  Case c = scene_case(
      "reference.embree_spheres." + scene.name, "hits", scene, "",
      "The reference's spheres, intersected in double precision, and Embree's own sphere primitive agree, or exact "
      "arithmetic says that Embree erred.");
  c.family = "chords";
  c.rays = rays;
  c.run = [](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    if (stage.scene.spheres.empty()) {
      record.status = CaseStatus::skipped;
      record.message = "the scene has no spheres";
      return;
    }
    const EmbreeScene other(stage.scene, SphereMode::embree);
    const std::uint64_t seed = case_seed(context.seed, self.name);
    Tally tally = compare_family(context, stage, stage.judge, context.session.probe(stage), other, RayFamily::chords,
                                 seed, self.rays, record);
    explain_failing(context, examined_of(stage), self.name, "./plumbline explain " + quoted(self.spec), tally);
    record_tally(tally, self.spec, record);
    conclude(tally, self.rays, record);
  };
  return c;
}

}  // namespace plumbline
