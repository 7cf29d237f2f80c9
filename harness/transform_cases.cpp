// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `transforms.*` that compare rays on a scene of instances as it stands: both ways of leaving a transform
// against Embree and exact arithmetic, and Embree's two ways of placing geometry against each other.
#include <algorithm>
#include <limits>

#include "harness/catalogue.h"
#include "harness/exact_view.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "harness/transform_cases.h"
#include "reference/arbiter.h"
#include "reference/exact_values.h"
#include "reference/geometry.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr std::size_t kBatch = std::size_t{1} << 16;

/// What a family proves where geometry is placed by transforms.
std::string proof_of(RayFamily family, TransformOut out) {
  const std::string ends =
      out == TransformOut::inverse
          ? " Rays leave a transform by its inverse, as in the paper; bounds grow with each one left."
          : " Rays leave a transform as they were before it.";
  const auto say = [&](const char* text) { return text + ends; };
  switch (family) {
    case RayFamily::camera:
      return say(
          "What the camera sees: position, normal, distance, primitive and instance of every hit, and what follows a "
          "transform in the walk is again in the outer space.");
    case RayFamily::secondary:
      return say("Rays that the renderer sends on from instances, mirrored and towards lights, hit what they should.");
    case RayFamily::chords:
      return say("Random lines pass through several instances, miss everything inside some, and hit the nearest.");
    case RayFamily::inside:
      return say("Rays that start inside transformed objects, whose transforms lie behind and around them.");
    case RayFamily::on_surface:
      return say("Rays that start on a transformed surface leave it, or enter it, but do not hit where they start.");
    case RayFamily::far:
      return say(
          "Rays from 10^3 to 10^6 scene sizes away find the instance, though its space is far from their origin.");
    case RayFamily::scaled:
      return say("Directions of any length: t of a hit is in units of the ray's own direction, not of the instance's.");
    case RayFamily::segments:
      return say("Segments that end just before and just after a hit: t_max means the same in every space.");
    case RayFamily::undefined:
      return say("Rays without an answer are told, whatever transforms stand in the scene.");
    case RayFamily::tangents:
      return say("Tangents of transformed spheres and of bounding spheres: mirrored, sheared and stretched outlines.");
    default:
      break;
  }
  if (ray_family_info(family).name == "into_instances")
    return say("Rays leave one instance and enter another, overlapping or apart.");
  if (ray_family_info(family).name == "between_instances")
    return say("Rays from a point in one instance to a point in another pass through what stands between.");
  return say("Aimed at transformed geometry, every ray hits what exact arithmetic says:") + " " +
         std::string(ray_family_info(family).description);
}

Case family_case(const ListedScene& scene, TransformOut out, RayFamily family, std::uint64_t rays) {
  const RayFamilyInfo& info = ray_family_info(family);
  Case c = scene_case(std::string("transforms.") + name_of(out) + "." + std::string(info.name) + "." + scene.name,
                      "transforms", scene, "6", proof_of(family, out));
  c.family = info.name;
  c.variant = std::string("transform-out=") + name_of(out);
  c.rays = rays;
  c.run = [out, family](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    if (is_skipped(stage, record)) return;
    // Both variants are asked the same rays.
    const std::uint64_t seed = case_seed(context.seed, self.family + "." + self.scene);
    const Judge judge = stage.judge_of(out);
    Probe& probe = context.session.probe(stage, out);
    Tally tally = compare_family(context, stage, judge, probe, stage.embree, family, seed, self.rays, record);
    explain_failing(context, examined_of(stage, out), self.name,
                    "./plumbline explain " + quoted(self.spec) + " --transform-out " + name_of(out), tally);
    record_tally(tally, self.spec, record);
    if (out != BakeOptions{}.transform_out)
      for (RayRecord& r : record.worst)
        r.replay.insert(r.replay.find(" --ray="), std::string(" --transform-out ") + name_of(out));
    conclude(tally, grazing_budget(stage, family, self.rays), record);
  };
  return c;
}

/// Counts of the two truths' answers to one ray each.
struct TruthTally {
  std::array<std::uint64_t, kVerdictCount> count{};
  std::vector<RayRecord> kept;
  std::uint64_t both_wrong = 0;
  std::uint64_t astray = 0;      ///< the right primitive, but not its values
  std::uint64_t unresolved = 0;  ///< wrong in one scene, about what Embree's 32 bits cannot tell
};

bool is_right_or_near(const ExactView& view, const Answer& answer) {
  return view.is_exact(answer) || view.explained(answer).has_value();
}

/// How far flattening to 32 bits, and Embree's arithmetic with coordinates of that size, may move what the flattened
/// scene shows: a few roundings of the largest coordinate.
double flattening_blur(const Stage& stage) {
  const Ball& ball = stage.judge.bounds.world.ball;
  return 4.0 * 0x1p-24 * (glm::length(ball.center) + ball.radius);
}

/// A triangle's corners in the world.
std::array<glm::dvec3, 3> world_corners(const Stage& stage, std::uint32_t instance, std::uint32_t primitive) {
  std::array<glm::dvec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = glm::dvec3(stage.scene.positions[stage.scene.triangles[primitive].position[i]]);
    if (instance != kNone)
      corners[i] = transform_point(stage.judge.bounds.spaces.instances[instance].to_world, corners[i]);
  }
  return corners;
}

/// Whether 32 bits cannot tell if the ray's line meets the triangle. With D the size of coordinates and distances and M
/// the longest edge, an edge function d . (c_i x c_i+1), d of unit length and corners taken from the origin, is off by
/// 2 u D M for the corners' differences, 2 u D M for its products, and 4 u D M for the ray's own origin and direction,
/// which Embree has in 32 bits. So a ray that is outside of no edge by more than 8 u D M, and inside of one of them by
/// less, may be answered either way; so may any line near a triangle seen so nearly edge-on that the three functions'
/// sum, its area across the ray, is below 24 u D M.
bool is_beyond_embree(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& origin, const glm::dvec3& direction) {
  double size = 0.0, longest = 0.0, sum = 0.0;
  std::array<double, 3> edge;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 from = corners[i] - origin, to = corners[(i + 1) % 3] - origin;
    size = std::max(size, glm::length(from) + glm::length(corners[i]) + glm::length(origin));
    longest = std::max(longest, glm::length(to - from));
    edge[i] = glm::dot(direction, glm::cross(from, to));
    sum += edge[i];
  }
  const double unknown = 8.0 * 0x1p-24 * size * longest, sign = sum < 0.0 ? -1.0 : 1.0;
  const double least =
      sign * (sign > 0.0 ? std::min({edge[0], edge[1], edge[2]}) : std::max({edge[0], edge[1], edge[2]}));
  return least >= -unknown && (least <= unknown || std::abs(sum) <= 3.0 * unknown);
}

/// Whether any triangle of the scene is one that Embree may answer either way.
bool may_be_lost(const Stage& stage, const Ray& ray) {
  const glm::dvec3 origin(ray.origin), direction = glm::normalize(glm::dvec3(ray.direction));
  const auto any_of_range = [&](std::uint32_t instance, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t p = first; p < first + count; ++p)
      if (is_beyond_embree(world_corners(stage, instance, p), origin, direction)) return true;
    return false;
  };
  for (std::uint32_t p = 0; p < stage.scene.triangles.size(); ++p)
    if (stage.scene.is_placed(kNone, p) && any_of_range(kNone, p, 1)) return true;
  for (const std::uint32_t instance : instances_of(stage.scene)) {
    const Part& part = stage.scene.parts[stage.scene.nodes[instance].part];
    if (any_of_range(instance, part.first_triangle, part.triangle_count)) return true;
  }
  return false;
}

/// Whether one scene's values are those of the primitive that it names, by exact arithmetic. `blur`: how far its
/// corners may have been rounded; of a triangle of lowest altitude h that turns the normal by up to 3 blur / h.
bool values_hold(const Stage& stage, const Ray& ray, const ReferenceHit& hit, double blur) {
  const ReferenceHit truth = exact_hit(stage.scene, ray, hit.instance, hit.primitive);
  const PlacedRay placed = place_ray(stage.judge.bounds, ray, hit.instance);
  ValueBounds bounds = value_bounds(stage.judge.bounds, blur > 0.0 ? blurred(stage.judge.bounds, placed, blur) : placed,
                                    hit.primitive, truth.t);
  if (blur > 0.0 && stage.scene.is_triangle(hit.primitive)) {
    const auto c = world_corners(stage, hit.instance, hit.primitive);
    const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
    bounds.normal += 3.0 * blur * longest / glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
  }
  return std::abs(hit.t - truth.t) <= bounds.t && glm::length(hit.position - truth.position) <= bounds.position &&
         glm::length(hit.normal - truth.normal) <= bounds.normal;
}

/// Settles a ray on which the two scenes differ.
void settle(const Stage& stage, const Ray& ray, std::uint64_t index, const ReferenceHit& placed,
            const ReferenceHit& flattened, TruthTally& tally) {
  const ExactView view(stage.judge, ray, 0);
  const Answer a = answer_of(placed), b = answer_of(flattened);
  const bool a_holds = is_right_or_near(view, a);
  const bool b_holds = is_right_or_near(ExactView(stage.judge, ray, 0, flattening_blur(stage)), b);
  Verdict verdict = Verdict::reference_wrong;
  if (view.is_exact(a) && view.is_exact(b)) {
    verdict = is_same(a, b) ? Verdict::agree : Verdict::tie;
    for (const auto& [hit, blur] : {std::pair{placed, 0.0}, std::pair{flattened, flattening_blur(stage)}})
      tally.astray += hit.kind == HitKind::hit && !view.is_other_root(*view.find(answer_of(hit)), hit.t) &&
                      !values_hold(stage, ray, hit, blur);
  } else if (a_holds && b_holds) {
    verdict = Verdict::grazing;
  }
  ++tally.count[static_cast<std::size_t>(verdict)];
  if (verdict != Verdict::reference_wrong) return;
  tally.both_wrong += !a_holds && !b_holds;
  tally.unresolved += (a_holds || b_holds) && may_be_lost(stage, ray);
  if (tally.kept.size() >= kept_of(verdict)) return;
  RayRecord r;
  r.verdict = verdict_name(verdict);
  r.index = index;
  r.origin = hex_vector(ray.origin), r.direction = hex_vector(ray.direction), r.t_max = hex_float(ray.t_max);
  r.tracer = "instanced: " + describe(placed);
  r.reference = "flattened: " + describe(flattened);
  r.exact = view.describe_truth();
  r.reason = a_holds   ? "Embree's flattened scene erred."
             : b_holds ? "Embree's instanced scene erred."
                       : "Both of Embree's scenes erred.";
  r.replay = "./plumbline explain " + quoted(stage.spec) + " --ray=" + ray_argument(ray);
  tally.kept.push_back(std::move(r));
}

/// Whether the two scenes' values tell of one point, but for the rounding of the flattened scene's corners.
bool same_point(const Stage& stage, const Ray& ray, const ReferenceHit& a, const ReferenceHit& b) {
  const PlacedRay placed = place_ray(stage.judge.bounds, ray, a.instance);
  const ValueBounds bounds =
      value_bounds(stage.judge.bounds, blurred(stage.judge.bounds, placed, flattening_blur(stage)), a.primitive, a.t);
  return std::abs(a.t - b.t) <= bounds.t && glm::length(a.position - b.position) <= bounds.position &&
         glm::length(a.normal - b.normal) <= bounds.normal;
}

Case two_truths_case(const ListedScene& scene, std::uint64_t per_family) {
  Case c = scene_case(
      "transforms.two_truths." + scene.name, "transforms", scene, "6",
      "Embree's instances and Embree on all geometry flattened to world space agree with each other, or exact "
      "arithmetic says which erred.");
  c.run = [per_family](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    if (is_skipped(stage, record)) return;
    if (placed_count(stage.scene) > kMostFlattened) {
      record.status = CaseStatus::skipped;
      record.message = std::to_string(placed_count(stage.scene)) + " primitives are too many to flatten";
      return;
    }
    const EmbreeScene flattened(stage.scene, SphereMode::exact_user, Placement::flattened);
    const std::vector<Ray> rays = mixed_rays(stage.rays, case_seed(context.seed, self.name), per_family);
    std::vector<ReferenceHit> a(rays.size()), b(rays.size());
    stage.embree.intersect(rays, a);
    flattened.intersect(rays, b);
    TruthTally tally;
    std::uint64_t apart = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool same = is_same(answer_of(a[i]), answer_of(b[i]));
      if (!is_defined(rays[i])) {
        const bool told = a[i].kind == HitKind::undefined && b[i].kind == HitKind::undefined;
        ++tally.count[static_cast<std::size_t>(told ? Verdict::undefined : Verdict::tracer_wrong)];
      } else if (same && (a[i].kind != HitKind::hit || same_point(stage, rays[i], a[i], b[i]))) {
        ++tally.count[static_cast<std::size_t>(Verdict::agree)];
      } else {
        apart += same;
        settle(stage, rays[i], i, a[i], b[i], tally);
      }
      if (i % kBatch == 0) context.progress(static_cast<double>(i) / static_cast<double>(rays.size()));
    }
    record.rays = rays.size();
    for (const Verdict v : kVerdicts)
      record.verdicts[std::string(verdict_name(v))] = tally.count[static_cast<std::size_t>(v)];
    record.worst = std::move(tally.kept);
    record.figures.push_back({"same primitive, values apart", "rays", static_cast<double>(apart)});
    const std::uint64_t wrong = tally.count[static_cast<std::size_t>(Verdict::reference_wrong)];
    const std::uint64_t untold = tally.count[static_cast<std::size_t>(Verdict::tracer_wrong)];
    // Embree may err about triangles seen edge-on (its issue 387) and edges passed closely, wherever they are placed.
    // Any other wrong answer tells of how a scene was placed.
    if (tally.both_wrong > 0 || tally.astray > 0 || untold > 0 || wrong > tally.unresolved) {
      record.status = CaseStatus::failed;
      record.message = std::to_string(wrong) + " of " + std::to_string(rays.size()) +
                       " rays are wrong in one of Embree's scenes, " + std::to_string(tally.unresolved) +
                       " of them about what 32 bits cannot tell, " + std::to_string(tally.both_wrong) + " in both, " +
                       std::to_string(tally.astray) + " have the right primitive and wrong values, and " +
                       std::to_string(untold) + " undefined ones are answered";
    }
  };
  return c;
}

}  // namespace

std::vector<Case> transform_cases(const ListedScene& scene, std::uint64_t rays, std::uint64_t truth_rays) {
  std::vector<Case> cases;
  cases.push_back(two_truths_case(scene, truth_rays));
  for (const TransformOut out : {TransformOut::restore, TransformOut::inverse})
    for (const RayFamilyInfo& family : ray_families()) cases.push_back(family_case(scene, out, family.family, rays));
  return cases;
}

}  // namespace plumbline
