// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/verdict.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "reference/exact_values.h"
#include "scenes/error.h"
#include "scenes/random.h"

namespace plumbline {
namespace {

/// The smallest normal float: what the driver flushes to zero cannot be held against it.
constexpr double kSmallest = 0x1p-126;

/// Name of the value that lies outside its bound, empty if none does. Written so that NaN is outside.
std::string value_outside_bound(const ValueBounds& b, const Hit& hit, const ReferenceHit& truth) {
  char text[160];
  const auto say = [&](const char* what, double error, double bound) {
    std::snprintf(text, sizeof text, "%s is off by %.3g, the bound is %.3g", what, error, bound);
    return std::string(text);
  };
  // A t beyond what 32 bits hold is infinite.
  const bool overflow = std::isinf(hit.t) && truth.t + b.t > static_cast<double>(std::numeric_limits<float>::max());
  const double dt = std::abs(static_cast<double>(hit.t) - truth.t);
  if (!overflow && !(dt <= b.t + kSmallest)) return say("t", dt, b.t);
  const double dp = glm::length(glm::dvec3(hit.position) - truth.position);
  if (!(dp <= b.position + kSmallest)) return say("the position", dp, b.position);
  const double dn = glm::length(glm::dvec3(hit.normal) - truth.normal);
  if (!(dn <= b.normal)) return say("the normal", dn, b.normal);
  for (int i = 0; i < 2; ++i) {
    const double dw = std::abs(static_cast<double>(hit.barycentrics[i]) - truth.barycentrics[i]);
    if (!(dw <= b.barycentrics)) return say("a barycentric weight", dw, b.barycentrics);
  }
  return {};
}

/// A relaxation that explains an answer: `amount` of what 32 bits resolve (`bound`) was used.
struct Relaxation {
  double amount = 0.0, bound = 0.0;
  double ratio() const {
    return bound > 0.0 ? amount / bound : (amount > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
  }
};

/// The exact picture of one ray: what its line meets or passes close by, nearest first.
class Picture {
 public:
  Picture(const Judge& judge, const Ray& ray)
      : judge_(judge), ray_(ray), length_(glm::length(glm::dvec3(ray.direction))) {
    const double reach = lateral_bound_of_scene(judge.bounds, ray);
    const double slack = (2.0 * judge.bounds.longest_edge + 2.0 * reach +
                          2.0 * std::sqrt(2.0 * judge.bounds.largest_radius * reach + reach * reach)) /
                         length_;
    crossings_ = judge.arbiter->crossings(ray, reach, slack);
  }

  bool is_nearest(const Crossing& c) const { return c.hit && c.nearest; }
  const Crossing* find(std::uint32_t primitive) const {
    for (const Crossing& c : crossings_)
      if (c.primitive == primitive) return &c;
    return nullptr;
  }
  bool any_hit() const {
    return std::any_of(crossings_.begin(), crossings_.end(), [](const Crossing& c) { return c.hit; });
  }
  /// Whether `kind, primitive` is an exact answer.
  bool is_exact(HitKind kind, std::uint32_t primitive) const {
    if (kind == HitKind::miss) return !any_hit();
    const Crossing* c = find(primitive);
    return c && is_nearest(*c);
  }

  /// Whether `t` is a sphere's other root than the exact one, and not the exact one within its bound.
  bool is_other_root(const Crossing& c, double t) const {
    if (judge_.scene->is_triangle(c.primitive) || !c.on_line) return false;
    const double other = c.t == c.t_enter ? c.t_leave : c.t_enter;
    return std::abs(t - other) < std::abs(t - c.t) && !(std::abs(t - c.t) <= dt(c));
  }

  double dt(const Crossing& c) const { return value_bounds(judge_.bounds, ray_, c.primitive, c.t).t; }

  /// Whether 32-bit evaluation may have come to this answer although it is not the exact one; if so, the largest
  /// relaxation used. `answered_t` tells which of a sphere's two roots the answer means.
  std::optional<Relaxation> explained(HitKind kind, std::uint32_t primitive, double answered_t) const {
    Relaxation worst;
    const auto use = [&](double amount, double bound) {
      const Relaxation r{amount, bound};
      if (!(r.ratio() <= 1.0)) return false;
      if (r.ratio() >= worst.ratio()) worst = r;
      return true;
    };
    double t = std::numeric_limits<double>::infinity(), t_bound = 0.0;
    if (kind == HitKind::hit) {
      const Crossing* c = find(primitive);
      if (!c) return std::nullopt;
      t_bound = dt(*c);
      t = c->t;
      if (is_other_root(*c, answered_t)) {
        // The near root lies within rounding of the origin, and was taken for valid, or for behind it.
        if (!use(std::abs(c->t_enter) * length_, t_bound * length_)) return std::nullopt;
        t = c->t == c->t_enter ? c->t_leave : c->t_enter;
      }
      if (!c->on_line && !use(-c->margin, lateral_bound(judge_.bounds, ray_, primitive))) return std::nullopt;
      if (!(t > 0.0) && !use(-t * length_, t_bound * length_)) return std::nullopt;
      if (t > ray_.t_max && !use((t - ray_.t_max) * length_, t_bound * length_)) return std::nullopt;
    }
    for (const Crossing& x : crossings_) {  // all that the answer skipped
      if (!x.hit || !(x.t < t)) continue;
      if (x.primitive == primitive) continue;
      const double bound = dt(x);
      const bool order = kind == HitKind::hit && use((t - x.t) * length_, (bound + t_bound) * length_);
      if (order) continue;
      if (use(x.margin, lateral_bound(judge_.bounds, ray_, x.primitive))) continue;
      // Taken for behind the origin; a sphere's far root must then be beyond the answer, or the ray's end.
      const bool far_root_matters = !judge_.scene->is_triangle(x.primitive) && x.t_leave > bound &&
                                    x.t_leave + bound + t_bound < std::min<double>(t, ray_.t_max);
      if (!far_root_matters && use(x.t * length_, bound * length_)) continue;
      if (std::isfinite(ray_.t_max) && use((ray_.t_max - x.t) * length_, bound * length_)) continue;
      return std::nullopt;
    }
    return worst;
  }

  /// Whether the answer went through a closed surface: the triangle that it went through, or null. Every triangle that
  /// was skipped is near, that is met within what 32 bits resolve of its outline; rounding may take the ray past such
  /// triangles, but not through the surface:
  ///   - Triangles that are near and hang together by their corners form a patch. Past a patch that has two facings (a
  ///   silhouette) or belongs to no
  ///     closed surface a ray may go; through a patch that faces one way it may not, unless it is the patch that
  ///     answered, or one in which the ray starts or ends, or that goes on behind the answer.
  ///   - A ray that goes past a surface crosses it an even number of times. This is asked only where the number is
  ///   certain: not where a near triangle
  ///     is seen exactly edge-on, nor where a crossing lies within rounding of the ray's origin, of its end, or of the
  ///     answer.
  const Crossing* leaked(HitKind kind, std::uint32_t primitive) const {
    double t = std::numeric_limits<double>::infinity();
    if (kind == HitKind::hit)
      if (const Crossing* c = find(primitive)) t = c->t - dt(*c);
    std::vector<const Crossing*> near;
    for (const Crossing& c : crossings_)
      if (judge_.scene->is_triangle(c.primitive) &&
          std::abs(c.margin) <= lateral_bound(judge_.bounds, ray_, c.primitive))
        near.push_back(&c);
    std::map<std::uint32_t, std::vector<const Crossing*>> skipped;  // by closed component
    std::set<std::uint32_t> uncertain;  // components whose number of crossings is not certain
    for (const Crossing& x : crossings_) {
      if (!x.hit || !is_in_closed_surface(x.primitive) || x.primitive == primitive || !is_within(x, t)) continue;
      const std::vector<const Crossing*> patch = patch_of(x, near);
      if (std::any_of(patch.begin(), patch.end(),
                      [&](const Crossing* c) { return c->primitive == primitive || !is_within(*c, t); })) {
        uncertain.insert(judge_.topology->component[x.primitive]);
        continue;
      }
      if (std::all_of(patch.begin(), patch.end(), [&](const Crossing* c) { return side_of(*c) == side_of(x); }))
        return &x;
      skipped[judge_.topology->component[x.primitive]].push_back(&x);
    }
    for (const Crossing* c : near)
      if (c->facing == 0 && is_in_closed_surface(c->primitive))
        uncertain.insert(judge_.topology->component[c->primitive]);
    for (const Crossing& c : crossings_) {
      if (c.primitive == primitive || !is_in_closed_surface(c.primitive)) continue;
      const double bound = dt(c);
      if (std::abs(c.t) <= bound || std::abs(c.t - ray_.t_max) <= bound || std::abs(c.t - t) <= bound)
        uncertain.insert(judge_.topology->component[c.primitive]);
    }
    for (const auto& [component, list] : skipped)
      if (!uncertain.count(component) && crosses_oddly(list)) return list.front();
    return nullptr;
  }

  bool is_in_closed_surface(std::uint32_t primitive) const {
    return judge_.topology->is_closed(primitive) &&
           judge_.topology->component_orientable[judge_.topology->component[primitive]];
  }
  /// The side of its surface that the line meets: as `facing`, but told alike by all triangles of a surface, however
  /// each is wound.
  int side_of(const Crossing& c) const { return judge_.topology->turned[c.primitive] ? -c.facing : c.facing; }

  /// Whether the crossing lies between the ray's origin and both its end and `t`, whatever rounding does.
  bool is_within(const Crossing& c, double t) const {
    const double bound = dt(c);
    return c.t > bound && c.t + bound < ray_.t_max && c.t + bound < t;
  }

  /// The near triangles that hang together with x, x first.
  std::vector<const Crossing*> patch_of(const Crossing& x, std::vector<const Crossing*> near) const {
    std::vector<const Crossing*> patch{&x};
    for (std::size_t i = 0; i < patch.size(); ++i)
      std::erase_if(near, [&](const Crossing* c) {
        if (c == patch[i]) return true;
        if (!judge_.topology->share_a_corner(c->primitive, patch[i]->primitive)) return false;
        patch.push_back(c);
        return true;
      });
    return patch;
  }

  /// Whether the crossings, in order of t, are an odd number. Crossings of one point (a shared edge, a corner) count
  /// once; where those face both ways the ray touches the surface there, and the number tells nothing.
  bool crosses_oddly(const std::vector<const Crossing*>& list) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const bool same_point = i > 0 && list[i]->t == list[i - 1]->t &&
                              judge_.topology->share_a_corner(list[i]->primitive, list[i - 1]->primitive);
      if (same_point && side_of(*list[i]) != side_of(*list[i - 1])) return false;
      count += !same_point;
    }
    return count % 2 == 1;
  }

  /// What is wrong with the values of an answer that is not the exact one; empty if nothing is. On a primitive that the
  /// line meets all of them are known. Where it passes by, t is known to within the primitive's bound, the normal of a
  /// triangle too, and weights lie in [0, 1].
  std::string value_error_beside(const Hit& hit) const {
    if (hit.kind != HitKind::hit) return {};
    const Crossing* c = find(hit.primitive);
    if (!c) return "its primitive is not near the ray";
    if (c->on_line && judge_.scene->is_triangle(hit.primitive)) {
      const ReferenceHit truth = exact_hit(*judge_.scene, ray_, hit.primitive);
      return value_outside_bound(value_bounds(judge_.bounds, ray_, hit.primitive, truth.t), hit, truth);
    }
    const ValueBounds b = value_bounds(judge_.bounds, ray_, hit.primitive, c->t);
    const double t = is_other_root(*c, hit.t) ? (c->t == c->t_enter ? c->t_leave : c->t_enter) : c->t;
    const bool overflow = std::isinf(hit.t) && t + b.t > static_cast<double>(std::numeric_limits<float>::max());
    if (!overflow && !(std::abs(hit.t - t) <= b.t + kSmallest)) return "its t is not that of the primitive";
    const glm::dvec3 at = glm::dvec3(ray_.origin) + t * glm::dvec3(ray_.direction);
    const double beside = glm::length(glm::dvec3(hit.position) - at),
                 allowed = b.position + b.t * length_ + std::abs(c->margin);
    if (!(beside <= allowed + kSmallest)) return "its position lies beside the ray";
    if (!(std::abs(glm::length(glm::dvec3(hit.normal)) - 1.0) <= 0x1p-20)) return "its normal is not of unit length";
    if (!(hit.barycentrics.x >= 0.0f && hit.barycentrics.y >= 0.0f &&
          hit.barycentrics.x + hit.barycentrics.y <= 1.0f + 0x1p-20f))
      return "its weights lie outside the triangle";
    return {};
  }

  std::string describe_truth() const {
    std::string text;
    char part[96];
    for (const Crossing& c : crossings_) {
      if (!is_nearest(c)) continue;
      std::snprintf(part, sizeof part, "%s%u", text.empty() ? "hit " : " and ", c.primitive);
      text += part;
    }
    if (text.empty()) return "miss";
    for (const Crossing& c : crossings_)
      if (is_nearest(c)) {
        std::snprintf(part, sizeof part, " at t = %.17g, %.3g inside its outline", c.t, c.margin);
        return text + part;
      }
    return text;
  }

 private:
  const Judge& judge_;
  const Ray& ray_;
  double length_;
  std::vector<Crossing> crossings_;
};

std::string answer(HitKind kind, std::uint32_t primitive) {
  return kind == HitKind::hit ? "primitive " + std::to_string(primitive) : std::string("a miss");
}

/// The values on a sphere at its other root than exact_hit's, in double.
ReferenceHit at_other_root(const Scene& scene, const Ray& ray, const ReferenceHit& truth) {
  const Sphere& sphere = scene.sphere(truth.primitive);
  const glm::dvec3 o(ray.origin), d(ray.direction), c(sphere.center);
  const double foot = glm::dot(c - o, d) / glm::dot(d, d);
  ReferenceHit other = truth;
  other.t = 2.0 * foot - truth.t;
  other.position = o + other.t * d;
  other.normal = glm::normalize(other.position - c);
  return other;
}

/// Once the primitive is settled, values must lie within their bounds of the exact values: which of them does not,
/// empty if all do.
std::string exact_value_error(const Judge& judge, const Ray& ray, const Hit& tracer, bool other_root) {
  ReferenceHit truth = exact_hit(*judge.scene, ray, tracer.primitive);
  if (other_root) truth = at_other_root(*judge.scene, ray, truth);
  return value_outside_bound(value_bounds(judge.bounds, ray, tracer.primitive, truth.t), tracer, truth);
}

Judgement arbitrate(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference) {
  Judgement j;
  j.arbitrated = true;
  const Picture picture(judge, ray);
  j.exact = picture.describe_truth();
  bool tracer_exact = picture.is_exact(tracer.kind, tracer.primitive);
  const bool reference_exact = picture.is_exact(reference.kind, reference.primitive);
  const bool same = tracer.kind == reference.kind && tracer.primitive == reference.primitive;

  if (tracer_exact && tracer.kind == HitKind::hit) {
    const Crossing* c = picture.find(tracer.primitive);
    const bool other_root = picture.is_other_root(*c, tracer.t);
    const std::string error = exact_value_error(judge, ray, tracer, other_root);
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
    j.verdict = same ? Verdict::agree : Verdict::tie;
    if (!same) j.reason = "Both primitives are exactly nearest.";
    return j;
  }
  if (!tracer_exact) {
    const auto why = picture.explained(tracer.kind, tracer.primitive, tracer.t);
    if (!why) {
      j.verdict = Verdict::tracer_wrong;
      j.reason = "The tracer answered " + answer(tracer.kind, tracer.primitive) +
                 ", which no rounding of its formulas explains.";
      return j;
    }
    if (const Crossing* x = picture.leaked(tracer.kind, tracer.primitive)) {
      j.verdict = Verdict::leak;
      j.reason = "The ray slipped through the closed surface at triangle " + std::to_string(x->primitive) + ".";
      return j;
    }
    if (const std::string error = picture.value_error_beside(tracer); !error.empty()) {
      j.verdict = Verdict::tracer_wrong;
      j.reason = "The tracer's primitive is within rounding of the exact one, but " + error + ".";
      return j;
    }
    j.verdict = Verdict::grazing;
    j.margin = why->amount, j.bound = why->bound;
    j.reason = "The tracer's answer differs from the exact one by less than 32 bits resolve.";
    return j;
  }
  const auto why = picture.explained(reference.kind, reference.primitive, reference.t);
  if (!why) {
    j.verdict = Verdict::reference_wrong;
    j.reason = "Embree answered " + answer(reference.kind, reference.primitive) + "; the tracer is exactly right.";
    return j;
  }
  j.verdict = Verdict::grazing;
  j.margin = why->amount, j.bound = why->bound;
  j.reason = "The tracer is exactly right; Embree differs by less than 32 bits resolve.";
  return j;
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

Judge make_judge(const Scene& scene, const Arbiter& arbiter, const Topology& topology) {
  return {&scene, &arbiter, &topology, make_bounds_context(scene)};
}

Judgement judge(const Judge& judge, const Ray& ray, const Hit& tracer, const ReferenceHit& reference,
                bool arbitrate_always) {
  if (!is_defined(ray)) {
    if (tracer.kind == HitKind::undefined)
      return {Verdict::undefined, false, 0.0, 0.0, {}, "The ray has no answer (SEMANTICS 1.3)."};
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The ray has no answer, but the tracer gave one."};
  }
  if (tracer.kind == HitKind::capped)
    return {
        Verdict::capped, false, 0.0, 0.0, {}, "The tracer's walk did not end within the number of cells of the image."};
  if (tracer.kind == HitKind::undefined)
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The ray has an answer, but the tracer called it undefined."};
  if (tracer.kind == HitKind::hit && tracer.primitive >= judge.scene->primitive_count())
    return {Verdict::tracer_wrong, false, 0.0, 0.0, {}, "The tracer named a primitive that does not exist."};
  if (!arbitrate_always && tracer.kind == reference.kind) {
    if (tracer.kind == HitKind::miss) return {};
    if (tracer.primitive == reference.primitive &&
        value_outside_bound(value_bounds(judge.bounds, ray, tracer.primitive, reference.t), tracer, reference).empty())
      return {};
  }
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

std::string describe(const Hit& hit) {
  char text[160];
  switch (hit.kind) {
    case HitKind::miss:
      return "miss";
    case HitKind::undefined:
      return "undefined";
    case HitKind::capped:
      return "capped";
    case HitKind::hit:
      break;
  }
  std::snprintf(text, sizeof text, "hit %u at t = %.9g", hit.primitive, static_cast<double>(hit.t));
  return text;
}

std::string describe(const ReferenceHit& hit) {
  char text[160];
  if (hit.kind == HitKind::miss) return "miss";
  if (hit.kind == HitKind::undefined) return "undefined";
  std::snprintf(text, sizeof text, "hit %u at t = %.17g", hit.primitive, hit.t);
  return text;
}

}  // namespace plumbline
