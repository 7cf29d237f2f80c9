// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/paired.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/hit_cases.h"
#include "harness/paired_bounds.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double u = 0x1p-24;
constexpr std::size_t kMostKept = 64;

/// The verdicts on all rays of a batch.
struct BatchVerdicts {
  std::array<std::vector<Verdict>, 64> paths;
  std::map<TappedSamples::Key, std::vector<Verdict>> shadows;
};

std::string listed(const glm::dvec3& v) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", v.x, v.y, v.z);
  return text;
}

/// Follows one sample.
class SampleFollower {
 public:
  SampleFollower(const Stage& stage, const PreparedScene& prepared, const TappedSamples& samples,
                 const BatchVerdicts& verdicts, std::size_t item, std::uint64_t seed, PairedSample& result,
                 std::array<double, kPairedSteps>& largest)
      : stage_(stage),
        prepared_(prepared),
        samples_(samples),
        verdicts_(verdicts),
        item_(item),
        numbers_(samples, item, seed),
        result_(result),
        largest_(largest) {
    const glm::uvec2 pixel = samples.batch.pixel(item);
    result_.x = pixel.x, result_.y = pixel.y, result_.frame = samples.batch.frame(item);
  }

  void run() {
    const SampleNumbers sample{prepared_, numbers_, {result_.x, result_.y, result_.frame, 1, 0}};
    const glm::dvec3 own = sample_color(prepared_, numbers_, result_.x, result_.y, result_.frame);
    const glm::dvec3 told(samples_.colors[item_]);
    result_.told = told, result_.own = own;
    if (samples_.colors[item_].w != 0.0f) return differ(PairedStep::hit, 0, "a walk found no end");
    result_.end_to_end = greatest(glm::abs(told - own));
    if (!check_ray(PairedStep::primary, primary_ray(sample), primary_bounds(sample))) return;
    if (!follow(sample, 1, 0, 1.0)) return;
    if (const std::size_t there = rays_there(); there != seen_)
      return differ(PairedStep::hit, 0,
                    std::to_string(there) + " rays were traced, of which " + std::to_string(seen_) + " have a cause");
    compare_color(told);
  }

 private:
  static double greatest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

  void note(SampleVerdict verdict, PairedStep step, std::uint32_t ray, const std::string& event) {
    result_.verdict = verdict;
    result_.step = step;
    result_.ray = ray;
    result_.event = event;
    if (ray > 0 && samples_.paths[ray].has(item_)) result_.replay = replay_of(samples_.paths[ray].rays[item_]);
  }
  void differ(PairedStep step, std::uint32_t ray, const std::string& event) {
    note(SampleVerdict::differ, step, ray, event);
  }
  void set_apart(PairedStep step, std::uint32_t ray, const std::string& event) {
    note(SampleVerdict::apart, step, ray, event);
  }
  /// Empty where things move: the command knows no times.
  std::string replay_of(const Ray& ray) const {
    if (!stage_.scene.animation.empty()) return {};
    return "./plumbline explain " + quoted(stage_.spec) + " --ray=" + ray_argument(ray);
  }

  std::size_t rays_there() const {
    std::size_t count = 0;
    for (const TappedRays& rays : samples_.paths) count += rays.has(item_) ? 1 : 0;
    return count;
  }

  /// Whether an error is within its bound; where not, what differs.
  bool within(PairedStep step, std::uint32_t ray, double error, double bound, const char* what) {
    if (!(error <= bound)) {
      char text[128];
      std::snprintf(text, sizeof text, "%s is off by %.3g, %.3g times its bound", what, error, error / bound);
      differ(step, ray, text);
      return false;
    }
    if (bound > 0.0) {
      double& most = largest_[static_cast<std::size_t>(step)];
      most = std::max(most, error / bound);
      result_.largest = std::max(result_.largest, error / bound);
    }
    return true;
  }

  /// A ray that must be there, as it must be.
  bool check_ray(PairedStep step, const PathRay& expected, const RayBounds& bounds) {
    const TappedRays& tapped = samples_.paths[expected.number];
    if (!tapped.has(item_)) {
      differ(step, expected.number,
             "the tracer has sent no such ray; the reference sends it towards " + listed(expected.direction));
      return false;
    }
    const Ray& ray = tapped.rays[item_];
    return within(step, expected.number, glm::length(glm::dvec3(ray.origin) - expected.origin), bounds.origin,
                  "the ray's origin") &&
           within(step, expected.number, glm::length(glm::dvec3(ray.direction) - expected.direction), bounds.direction,
                  "the ray's direction");
  }

  /// True where the ray's hit may be built upon.
  bool judged(PairedStep step, std::uint32_t ray, Verdict verdict, const char* what) {
    if (verdict == Verdict::agree || verdict == Verdict::reference_wrong) return true;
    const std::string text = std::string(what) + ": " + std::string(verdict_name(verdict));
    if (verdict == Verdict::tie || verdict == Verdict::grazing)
      set_apart(step, ray, text);
    else
      differ(step, ray, text);
    return false;
  }

  bool follow(const SampleNumbers& sample, std::uint32_t number, std::uint32_t bounce, double weight) {
    ++seen_;
    const TappedRays& tapped = samples_.paths[number];
    const Ray& ray = tapped.rays[item_];
    const Hit& hit = tapped.hits[item_];
    if (!judged(PairedStep::hit, number, verdicts_.paths[number][item_], "what the ray hits")) return false;
    const SeenGround ground = meet_ground(*prepared_.scene, ray);
    const bool is_hit = hit.kind == HitKind::hit;
    const bool is_near = ground.hit && is_hit &&
                         std::fabs(ground.hit->t - static_cast<double>(hit.t)) <= ground.t + 2.0 * t_bound(ray, hit);
    const bool is_ground = ground.hit && (!is_hit || ground.hit->t < static_cast<double>(hit.t));
    const bool is_hidden = is_hit && !is_ground && !is_near;
    if ((!ground.undecided.empty() && !is_hidden) || is_near) {
      set_apart(PairedStep::hit, number, is_near ? "ground and primitive are equally far" : ground.undecided);
      return false;
    }
    if (!is_hit && !is_ground) {
      add(weight * glm::dvec3(prepared_.scene->background), glm::dvec3(0.0), bounce);
      return true;
    }
    SeenSurface seen =
        is_ground ? see_ground(prepared_, ray, *ground.hit) : see_surface(prepared_, stage_.judge.bounds, ray, hit);
    if (!seen.undecided.empty()) {
      set_apart(PairedStep::hit, number, seen.undecided);
      return false;
    }
    const glm::dvec3 direction = glm::normalize(glm::dvec3(ray.direction));
    for (std::uint32_t k = 0; k < prepared_.scene->lights.size(); ++k)
      if (!follow_light(sample, seen, direction, number, k, bounce, weight)) return false;
    if (bounce >= std::min(prepared_.effects.depth, 5u)) return true;
    const Material& material = *seen.surface.material;
    const PathRay path{glm::dvec3(ray.origin), direction, number, bounce};
    const auto send = [&](PairedStep step, const SeenRay& next, float factor) {
      if (!next.undecided.empty()) {
        set_apart(step, number, next.undecided);
        return false;
      }
      return check_ray(step, next.ray, next.bounds) &&
             follow(sample, next.ray.number, bounce + 1, weight * static_cast<double>(factor));
    };
    if (material.specular > 0.0f && !send(PairedStep::reflected, see_reflected(sample, seen, path), material.specular))
      return false;
    return !(material.transmittance > 0.0f) ||
           send(PairedStep::refracted, see_refracted(seen, path), material.transmittance);
  }

  double t_bound(const Ray& ray, const Hit& hit) const {
    const BoundsContext& context = stage_.judge.bounds;
    return value_bounds(context, place_ray(context, ray, hit.instance), hit.primitive, static_cast<double>(hit.t)).t;
  }

  bool follow_light(const SampleNumbers& sample, const SeenSurface& seen, const glm::dvec3& direction,
                    std::uint32_t number, std::uint32_t k, std::uint32_t bounce, double weight) {
    const SeenLight light = see_light(sample, seen, direction, number, k);
    if (!light.undecided.empty()) {
      set_apart(PairedStep::shadow, number, light.undecided);
      return false;
    }
    const auto found = samples_.shadows.find({number, k});
    const bool is_sent = found != samples_.shadows.end() && found->second.has(item_);
    const bool is_asked = light.outcome == LightOutcome::lit;
    const std::string name = "light " + std::to_string(k);
    if (is_sent != is_asked) {
      differ(PairedStep::shadow, number,
             name + (is_asked ? ": no shadow ray, though the surface faces it"
                              : ": a shadow ray, though the surface does not face it"));
      return false;
    }
    if (!is_asked) return true;
    const Ray& ray = found->second.rays[item_];
    if (!within(PairedStep::shadow, number, glm::length(glm::dvec3(ray.origin) - glm::dvec3(light.shadow.origin)),
                light.shadow_bounds.origin, "the shadow ray's origin") ||
        !within(PairedStep::shadow, number, glm::length(glm::dvec3(ray.direction) - glm::dvec3(light.shadow.direction)),
                light.shadow_bounds.direction, "the shadow ray's direction"))
      return false;
    if (!judged(PairedStep::shadow, number, verdicts_.shadows.at({number, k})[item_], "the shadow ray")) {
      result_.replay = replay_of(ray);
      return false;
    }
    const SeenGround ground = meet_ground(*prepared_.scene, ray);
    const bool is_blocked = found->second.hits[item_].kind == HitKind::hit;
    if (!is_blocked && !ground.undecided.empty()) {
      set_apart(PairedStep::shadow, number, ground.undecided);
      return false;
    }
    if (!is_blocked && !ground.hit) add(weight * light.brought, weight * light.brought_bounds, bounce);
    return true;
  }

  /// A term of the sample's colour; weights are products of `bounce` factors.
  void add(const glm::dvec3& term, const glm::dvec3& bound, std::uint32_t bounce) {
    color_ += term;
    bound_ += bound + (2.0 + bounce) * u * glm::abs(term);
    sizes_ += glm::abs(term) + bound;
    ++terms_;
  }

  void compare_color(const glm::dvec3& told) {
    // Each addition rounds a sum that is no larger than that of all terms.
    const glm::dvec3 bound = bound_ + static_cast<double>(terms_) * u * sizes_;
    for (int i = 0; i < 3; ++i) {
      const double error = std::fabs(told[i] - color_[i]);
      if (bound[i] > 0.0) result_.error_in_bounds = std::max(result_.error_in_bounds, error / bound[i]);
      if (!within(PairedStep::color, 0, error, bound[i], "the colour")) {
        result_.event += ": " + listed(told) + ", by the reference " + listed(color_);
        return;
      }
    }
  }

  const Stage& stage_;
  const PreparedScene& prepared_;
  const TappedSamples& samples_;
  const BatchVerdicts& verdicts_;
  const std::size_t item_;
  const ItemNumbers numbers_;
  PairedSample& result_;
  std::array<double, kPairedSteps>& largest_;
  std::size_t seen_ = 0, terms_ = 0;
  glm::dvec3 color_{0.0}, bound_{0.0}, sizes_{0.0};
};

/// Judges rays of one number, whose nearest hits the tracer has told.
std::vector<Verdict> judge_paths(const Stage& stage, const TappedRays& tapped, std::uint64_t seed, PairedTally& tally) {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<std::size_t> items;
  for (std::size_t i = 0; i < tapped.rays.size(); ++i) {
    if (!tapped.has(i)) continue;
    rays.push_back(tapped.rays[i]);
    hits.push_back(tapped.hits[i]);
    items.push_back(i);
  }
  std::vector<ReferenceHit> reference(rays.size());
  stage.embree.intersect(rays, reference);
  std::vector<Verdict> told(rays.size()), verdicts(tapped.rays.size(), Verdict::agree);
  Tally judged;
  judge_batch(stage.judge, rays, hits, reference, 0, seed, 1024, judged, told);
  for (std::size_t i = 0; i < items.size(); ++i) verdicts[items[i]] = told[i];
  for (std::size_t v = 0; v < kVerdictCount; ++v) tally.verdicts[v] += judged.count[v];
  tally.rays += rays.size();
  return verdicts;
}

/// Judges shadow rays, of which the tracer has told whether they hit anything. Those on which the reference agrees are
/// settled; of the others the tracer's nearest hit is asked for, and judged.
std::vector<Verdict> judge_shadows(Session& session, const Stage& stage, const TappedRays& tapped, PairedTally& tally) {
  std::vector<Verdict> verdicts(tapped.rays.size(), Verdict::agree);
  std::vector<std::uint8_t> differs(tapped.rays.size(), 0);
  tbb::parallel_for(std::size_t{0}, tapped.rays.size(), [&](std::size_t i) {
    if (tapped.has(i))
      differs[i] = stage.embree.is_blocked(tapped.rays[i]) != (tapped.hits[i].kind == HitKind::hit) ? 1 : 0;
  });
  for (std::size_t i = 0; i < tapped.rays.size(); ++i) {
    if (!tapped.has(i)) continue;
    ++tally.shadow_rays;
    if (differs[i] == 0) {
      ++tally.verdicts[static_cast<std::size_t>(Verdict::agree)];
      continue;
    }
    const std::array rays{tapped.rays[i]};
    std::array<Hit, 1> nearest;
    session.probe(stage).trace(rays, nearest);
    Verdict verdict = judge(stage.judge, rays[0], nearest[0], stage.embree.first_hit(rays[0]), true).verdict;
    // Embree's word may differ between its two questions; the tracer's may not.
    if (nearest[0].kind != tapped.hits[i].kind && verdict != Verdict::grazing) verdict = Verdict::tracer_wrong;
    verdicts[i] = verdict;
    ++tally.verdicts[static_cast<std::size_t>(verdict)];
  }
  return verdicts;
}

}  // namespace

const char* name_of(PairedStep step) {
  static constexpr std::array<const char*, kPairedSteps> kNames{"primary ray",   "hit",           "shadow ray",
                                                                "reflected ray", "refracted ray", "colour"};
  return kNames[static_cast<std::size_t>(step)];
}

void compare_samples(Session& session, const Stage& stage, const PreparedScene& prepared, const TappedSamples& samples,
                     std::uint64_t seed, PairedTally& tally) {
  BatchVerdicts verdicts;
  for (std::size_t number = 0; number < samples.paths.size(); ++number)
    verdicts.paths[number] = judge_paths(stage, samples.paths[number], seed, tally);
  for (const auto& [key, tapped] : samples.shadows)
    verdicts.shadows[key] = judge_shadows(session, stage, tapped, tally);

  const int width = prepared.scene->camera.width, height = prepared.scene->camera.height;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  tally.error_in_bounds.resize(pixels, 0.0f);
  tally.verdict.resize(pixels, 0);
  tally.tracer.resize(pixels, glm::dvec3(0.0)), tally.reference.resize(pixels, glm::dvec3(0.0));
  std::vector<PairedSample> results(samples.colors.size());
  std::vector<std::array<double, kPairedSteps>> largest(results.size());
  tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t item) {
    SampleFollower(stage, prepared, samples, verdicts, item, seed, results[item], largest[item]).run();
  });
  for (std::size_t item = 0; item < results.size(); ++item) {
    PairedSample& r = results[item];
    ++tally.samples;
    tally.apart += r.verdict == SampleVerdict::apart ? 1 : 0;
    tally.differ += r.verdict == SampleVerdict::differ ? 1 : 0;
    const std::size_t pixel = static_cast<std::size_t>(r.y) * static_cast<std::size_t>(width) + r.x;
    tally.tracer[pixel] += r.told, tally.reference[pixel] += r.own;
    tally.error_in_bounds[pixel] = std::max(tally.error_in_bounds[pixel], static_cast<float>(r.error_in_bounds));
    tally.verdict[pixel] = std::max(tally.verdict[pixel], static_cast<std::uint8_t>(r.verdict));
    for (std::size_t step = 0; step < kPairedSteps; ++step)
      tally.largest[step] = std::max(tally.largest[step], largest[item][step]);
    if (r.verdict == SampleVerdict::agree) {
      tally.end_to_end.push_back(r.end_to_end);
      tally.above_tenth += r.error_in_bounds > 0.1 ? 1 : 0;
    } else if (tally.kept.size() < kMostKept || r.verdict == SampleVerdict::differ) {
      tally.kept.push_back(std::move(r));
    }
  }
  // The worst first: those that differ, then the others.
  std::stable_sort(tally.kept.begin(), tally.kept.end(),
                   [](const PairedSample& a, const PairedSample& b) { return a.verdict > b.verdict; });
  if (tally.kept.size() > kMostKept) tally.kept.resize(kMostKept);
}

}  // namespace plumbline
