// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/explain.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "harness/exact_view.h"
#include "harness/hit_cases.h"
#include "harness/slice.h"
#include "harness/version.h"
#include "harness/walk_record.h"
#include "scenes/camera.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// Primitives, counted in every instance, up to which one ray is asked of all: a second or two.
constexpr std::uint64_t kMostBruteForce = 4'000'000;

/// Comma-separated floats, each read whole. strtof takes hex floats, nan and inf.
std::vector<float> parse_floats(const std::string& text, const char* option) {
  std::vector<float> values;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    char* rest = nullptr;
    const float value = std::strtof(part.c_str(), &rest);
    if (part.empty() || *rest != '\0') throw InputError(std::string(option) + ": '" + part + "' is not a number");
    values.push_back(value);
    at = end + 1;
  }
  return values;
}

template <class... Args>
void print(std::string& text, const char* format, Args... args) {
  char line[512];
  std::snprintf(line, sizeof line, format, args...);
  text += line;
}

std::string vector_text(const glm::dvec3& v) {
  char text[128];
  std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", v.x, v.y, v.z);
  return text;
}

std::string with_values(const std::string& answer, bool is_hit, const glm::dvec3& position, const glm::dvec3& normal) {
  return is_hit ? answer + ", position " + vector_text(position) + ", normal " + vector_text(normal) : answer;
}

bool same_bits(const glm::vec3& a, const glm::vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Whether two answers of the tracer are one. Where rays leave transforms by their inverses, what a walk went through
/// before leaves its rounding in the values: then the primitive alone counts.
bool same_answer(const Hit& a, const Hit& b, TransformOut out) {
  if (!is_same(answer_of(a), answer_of(b))) return false;
  if (a.kind != HitKind::hit || out == TransformOut::inverse) return true;
  return same_bits({a.t, 0.0f, 0.0f}, {b.t, 0.0f, 0.0f}) && same_bits(a.position, b.position) &&
         same_bits(a.normal, b.normal) && same_bits(glm::vec3(a.barycentrics, 0.0f), glm::vec3(b.barycentrics, 0.0f));
}

/// A loop over all primitives with the faults of the production shader, as far as they stand in what both share: the
/// loop has neither a walk nor changes of space.
Probe brute_probe(GlContext& context, const GeometryImage& image, std::span<const ShaderPatch> patches) {
  std::vector<ShaderPatch> shared;
  for (const ShaderPatch& patch : patches)
    if (patch.file != "change_space.glsl" && !patch.file.starts_with("walk_")) shared.push_back(patch);
  return Probe(context, image, Traversal::brute_force, shared);
}

/// The exact truth, as far as it is a hit.
ExpectedHit truth_of(const ExactView& view) {
  for (const Crossing& c : view.crossings())
    if (c.nearest) return {c.instance, c.primitive, c.t};
  return {};
}

/// Of an answer that is a hit where nothing should be hit: the step that found it.
const WalkStep* found_at(const Walk& walk) {
  const WalkStep* found = nullptr;
  for (const WalkStep& step : walk.steps)
    for (const TestedPrimitive& p : step.primitives)
      if (p.outcome == PrimitiveTest::new_nearest && p.primitive == walk.hit.primitive) found = &step;
  return found;
}

std::string sentence_of(const GeometryImage& image, const Explanation& e) {
  if (!e.is_wrong) return e.expected.primitive == kNone ? "nothing is to be hit, and nothing was" : e.loss->sentence;
  if (e.layer == Layer::driver)
    return e.walk.driver_agrees ? "the captured walk ends otherwise than the same ray did in production"
                                : "pixels that walked the same ray with the same code came to different ends";
  const std::string answered = "primitive " + std::to_string(e.tracer.primitive) +
                               (e.tracer.instance == kNone ? "" : " of instance " + std::to_string(e.tracer.instance));
  const bool found = e.loss && e.loss->kind == LossKind::none;
  if (found)
    return "the walk found " + answered + ", which is the nearest, but with values that are wrong" +
           (e.layer == Layer::transform ? ": they did not come out of its space as they should" : "");
  std::string text;
  if (e.loss && e.loss->kind != LossKind::nearer) {
    text = e.loss->sentence;
  } else if (const WalkStep* step = found_at(e.walk); step != nullptr && e.tracer.kind == HitKind::hit) {
    text = answered + " was found at cell (" + std::to_string(step->x) + ", " + std::to_string(step->y) +
           "), where the truth is " +
           (e.expected.primitive == kNone ? "a miss" : "primitive " + std::to_string(e.expected.primitive));
  } else {
    text = e.loss ? e.loss->sentence : "the walk came to another end than the truth, a miss";
  }
  if (e.layer == Layer::primitive_arithmetic) text += "; a loop over all primitives answers the same";
  if (e.layer == Layer::transform && (!e.loss || e.loss->transform == kNone)) {
    const std::uint32_t node = ray_led_astray(image, e.walk);
    text += node == kNone
                ? "; the ray or the hit was not taken through a transform as it should be"
                : "; before, transform " + std::to_string(node) + " has taken the ray elsewhere than its matrix";
  }
  return text;
}

}  // namespace

Ray parse_ray(const std::string& text) {
  const std::vector<float> v = parse_floats(text, "--ray");
  if (v.size() != 6 && v.size() != 7)
    throw InputError("--ray takes 6 or 7 numbers, OX,OY,OZ,DX,DY,DZ[,TMAX]; there are " + std::to_string(v.size()));
  Ray ray{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  if (v.size() == 7) ray.t_max = v[6];
  return ray;
}

Ray pixel_ray(const Scene& scene, const std::string& text) {
  const std::vector<float> v = parse_floats(text, "--pixel");
  if (v.size() != 2) throw InputError("--pixel takes two numbers, X,Y");
  const Camera& c = scene.camera;
  if (v[0] != std::floor(v[0]) || v[1] != std::floor(v[1]))
    throw InputError("--pixel takes whole numbers, X,Y; they are '" + text + "'");
  if (!(v[0] >= 0.0f && v[0] < static_cast<float>(c.width) && v[1] >= 0.0f && v[1] < static_cast<float>(c.height)))
    throw InputError("--pixel " + text + " is outside the picture of " + std::to_string(c.width) + " x " +
                     std::to_string(c.height) + " pixels");
  return camera_ray(c, v[0], v[1]);
}

Examiner::Examiner(Session& session, const Examined& examined)
    : session_(session), examined_(examined), recorder_(session.context(), *examined.image, examined.patches) {
  if (examined.patches.empty()) return;
  const GeometryImage& sound = examined.sound != nullptr ? *examined.sound : examined.stage->image;
  patched_.emplace(session.context(), *examined.image, Traversal::tree, examined.patches);
  patched_brute_.emplace(brute_probe(session.context(), sound, examined.patches));
}
Examiner::~Examiner() = default;

Explanation Examiner::explain(const Ray& ray, std::size_t most_events) {
  const Stage& stage = *examined_.stage;
  const TransformOut out = examined_.image->options.transform_out;
  const std::span<const Ray> rays(&ray, 1);
  Explanation e;
  e.ray = ray;
  (patched_ ? *patched_ : session_.probe(*examined_.image)).trace(rays, {&e.tracer, 1});
  e.has_brute = placed_count(stage.scene) <= kMostBruteForce;
  if (e.has_brute) (patched_brute_ ? *patched_brute_ : session_.brute_force(stage)).trace(rays, {&e.brute, 1});
  stage.embree.intersect(rays, {&e.reference, 1});
  const Judge judge_data = stage.judge_of(out);
  e.judgement = judge(judge_data, ray, e.tracer, e.reference, true);
  e.walk = recorder_.record(ray, most_events);
  if (!is_defined(ray)) return e;

  e.expected = truth_of(ExactView(judge_data, ray, left_by(judge_data, e.tracer)));
  const bool brute_same = e.has_brute && same_answer(e.tracer, e.brute, out);
  e.is_wrong = is_failure(e.judgement.verdict) || (e.has_brute && !brute_same);
  // Where exact arithmetic allows both answers, the loop's is the one that the tree should have found.
  if (e.has_brute && !brute_same && !is_failure(e.judgement.verdict))
    e.expected = e.brute.kind == HitKind::hit
                     ? ExpectedHit{e.brute.instance, e.brute.primitive, static_cast<double>(e.brute.t)}
                     : ExpectedHit{};
  if (e.expected.primitive != kNone) e.loss = lost_at(*examined_.image, e.walk, e.expected, examined_.sound);
  if (e.is_wrong)
    e.layer = layer_of(
        {examined_.image, examined_.sound, &e.walk, e.loss ? &*e.loss : nullptr, e.tracer, brute_same, e.expected});
  e.sentence = sentence_of(*examined_.image, e);
  return e;
}

ExplanationRecord Examiner::record(const Explanation& e, const std::string& command, std::size_t most_steps) const {
  const Stage& stage = *examined_.stage;
  const GeometryImage& image = *examined_.image;
  const TransformOut out = image.options.transform_out;
  ExplanationRecord r;
  r.scene = stage.spec;
  r.command = command;
  r.version = version();
  r.driver = session_.context().renderer() + ", " + session_.context().version();
  r.image = examined_.source + ": " + shape_of(image);
  r.shape = shape_of(image);
  r.bounds = name_of(image.options.bounds);
  r.ray = {hex_vector(e.ray.origin), hex_vector(e.ray.direction), hex_float(e.ray.t_max)};
  r.verdict = verdict_name(e.judgement.verdict);
  r.reason = e.judgement.reason;
  if (e.judgement.verdict == Verdict::grazing) {
    char text[80];
    std::snprintf(text, sizeof text, " (margin %.3g, bound %.3g)", e.judgement.margin, e.judgement.bound);
    r.reason += text;
  }
  r.layer = name_of(e.layer);
  r.sentence = e.sentence;
  std::string tracer =
      with_values(describe(e.tracer), e.tracer.kind == HitKind::hit, e.tracer.position, e.tracer.normal) + "; " +
      std::to_string(e.tracer.steps) + " cells visited, " + std::to_string(e.tracer.primitive_tests) +
      " primitives tested";
  if (!stage.scene.nodes.empty())
    tracer += ", " + std::to_string(e.tracer.transforms) + " transforms entered (way out: " + name_of(out) + ")";
  r.answers.emplace_back("tracer", std::move(tracer));
  if (e.has_brute)
    r.answers.emplace_back(
        "brute force", with_values(describe(e.brute), e.brute.kind == HitKind::hit, e.brute.position, e.brute.normal));
  r.answers.emplace_back("Embree", with_values(describe(e.reference), e.reference.kind == HitKind::hit,
                                               e.reference.position, e.reference.normal));
  if (!e.judgement.exact.empty()) r.answers.emplace_back("exact", e.judgement.exact);
  if (is_defined(e.ray)) {
    const Judge judge_data = stage.judge_of(out);
    const ExactView view(judge_data, e.ray, left_by(judge_data, e.tracer));
    for (const Crossing& c : view.crossings()) {
      if (r.crossings.size() == 16) {
        r.crossings.push_back("and " + std::to_string(view.crossings().size() - 16) + " more");
        break;
      }
      char text[160];
      std::snprintf(text, sizeof text, " at t = %.17g, %s by %.3g (32 bits resolve %.3g)%s", c.t,
                    c.margin < 0.0 ? "passed" : "met inside its outline", std::abs(c.margin), view.lateral(c),
                    c.nearest      ? ", nearest"
                    : c.in_plane   ? ", seen exactly edge-on"
                    : c.facing < 0 ? ", front"
                    : c.facing > 0 ? ", back"
                                   : "");
      r.crossings.push_back((stage.scene.is_triangle(c.primitive) ? "triangle, " : "sphere, ") +
                            primitive_name(stage.scene, c.instance, c.primitive) + text);
    }
  }
  r.truth_primitive = e.expected.primitive, r.truth_instance = e.expected.instance, r.truth_t = e.expected.t;
  Loss loss;
  loss.kind = LossKind::none;
  if (e.loss) loss = *e.loss;
  for (const Ancestor& a : loss.chain)
    r.chain.push_back({a.space, a.cell, a.node, a.x, a.y, a.transform,
                       a.step == kNoStep ? kNoNumber : static_cast<std::uint32_t>(a.step)});
  r.fault.kind = name_of(loss.kind);
  r.fault.step = loss.step == kNoStep ? kNoNumber : static_cast<std::uint32_t>(loss.step);
  r.fault.space = loss.space, r.fault.cell = loss.cell, r.fault.node = loss.node, r.fault.transform = loss.transform;
  r.fault.x = loss.x, r.fault.y = loss.y, r.fault.shortfall = loss.shortfall;
  if (loss.as_baked) r.fault.as_baked = *loss.as_baked ? "yes" : "no";
  r.slice = slice_of(image, stage.scene, e.walk, loss, {e.expected, e.tracer});
  record_walk(e.walk, loss, most_steps, r);
  return r;
}

}  // namespace plumbline
