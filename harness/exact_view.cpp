// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/exact_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <set>

#include "reference/exact_values.h"

namespace plumbline {
namespace {

/// The smallest normal float: what the driver flushes to zero cannot be held against it.
constexpr double kSmallest = 0x1p-126;

/// A closed surface: an instance and a component of its part.
using Surface = std::pair<std::uint32_t, std::uint32_t>;

/// The values on a sphere at its other root than exact_hit's, in double.
ReferenceHit at_other_root(const Scene& scene, const PlacedRay& ray, const PlacedSpace* place,
                           const ReferenceHit& truth) {
  const glm::dvec3 c(scene.sphere(truth.primitive).center);
  const double foot = glm::dot(c - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction);
  ReferenceHit other = truth;
  other.t = 2.0 * (ray.t_origin + foot) - truth.t;
  const glm::dvec3 local = ray.origin + (other.t - ray.t_origin) * ray.direction;
  other.position = place ? transform_point(place->to_world, local) : local;
  // v * M is the transpose of M times v.
  other.normal = glm::normalize(place ? (local - c) * inverse(place->to_world).linear : local - c);
  return other;
}

}  // namespace

PlacedRay PlacedRays::in(std::uint32_t instance) const {
  for (const PlacedRay& r : placed_)
    if (r.instance == instance) return r;
  return placed_.emplace_back(blurred(context_, place_ray(context_, ray_, instance, left_), blur_));
}

ExactView::ExactView(const Judge& judge, const Ray& ray, std::uint32_t left, double blur)
    : judge_(judge),
      ray_(ray),
      length_(glm::length(glm::dvec3(ray.direction))),
      placed_(judge.bounds, ray, left, blur) {
  // Of an instance a length l of its own takes at most stretch * l / |d| of t.
  const double reach = lateral_bound_of_scene(judge.bounds, ray, left) + 4.0 * blur;
  const double slack = (2.0 * judge.bounds.longest_edge + 2.0 * reach +
                        2.0 * std::sqrt(2.0 * judge.bounds.largest_radius * reach + reach * reach)) /
                       length_;
  if (judge.scene->nodes.empty()) {
    crossings_ = judge.arbiter->crossings(ray, reach, slack);
    return;
  }
  const Reach reaches{
      reach, [&](std::uint32_t instance) { return lateral_bound_of_space(judge.bounds, placed_.in(instance)); }};
  crossings_ = judge.arbiter->crossings(ray, reaches, slack);
}

const Crossing* ExactView::find(const Answer& answer) const {
  for (const Crossing& c : crossings_)
    if (answer.is(c)) return &c;
  return nullptr;
}

bool ExactView::any_hit() const {
  return std::any_of(crossings_.begin(), crossings_.end(), [](const Crossing& c) { return c.hit; });
}

bool ExactView::is_exact(const Answer& answer) const {
  if (answer.kind == HitKind::miss) return !any_hit();
  const Crossing* c = find(answer);
  return c && c->hit && c->nearest;
}

ValueBounds ExactView::values(const Crossing& c) const {
  return value_bounds(judge_.bounds, placed_.in(c.instance), c.primitive, c.t);
}

double ExactView::lateral(const Crossing& c) const {
  return lateral_bound(judge_.bounds, placed_.in(c.instance), c.primitive);
}

bool ExactView::is_other_root(const Crossing& c, double t) const {
  if (judge_.scene->is_triangle(c.primitive) || !c.on_line) return false;
  const double other = c.t == c.t_enter ? c.t_leave : c.t_enter;
  return std::abs(t - other) < std::abs(t - c.t) && !(std::abs(t - c.t) <= dt(c));
}

double ExactView::meant_t(const Crossing& c, double answered_t) const {
  if (!is_other_root(c, answered_t)) return c.t;
  return c.t == c.t_enter ? c.t_leave : c.t_enter;
}

std::optional<Relaxation> ExactView::explained(const Answer& answer) const {
  Relaxation worst;
  const auto use = [&](double amount, double bound) {
    const Relaxation r{amount, bound};
    if (!(r.ratio() <= 1.0)) return false;
    if (r.ratio() >= worst.ratio()) worst = r;
    return true;
  };
  double t = std::numeric_limits<double>::infinity(), t_bound = 0.0;
  if (answer.kind == HitKind::hit) {
    const Crossing* c = find(answer);
    if (!c) return std::nullopt;
    t_bound = dt(*c);
    t = meant_t(*c, answer.t);
    // The near root lies within rounding of the origin, and was taken for valid, or for behind it.
    if (t != c->t && !use(std::abs(c->t_enter) * length_, t_bound * length_)) return std::nullopt;
    if (!c->on_line && !use(-c->margin, lateral(*c))) return std::nullopt;
    if (!(t > 0.0) && !use(-t * length_, t_bound * length_)) return std::nullopt;
    if (t > ray_.t_max && !use((t - ray_.t_max) * length_, t_bound * length_)) return std::nullopt;
  }
  for (const Crossing& x : crossings_) {  // all that the answer skipped
    if (!x.hit || !(x.t < t) || answer.is(x)) continue;
    const double bound = dt(x);
    const bool order = answer.kind == HitKind::hit && use((t - x.t) * length_, (bound + t_bound) * length_);
    if (order) continue;
    if (use(x.margin, lateral(x))) continue;
    // Taken for behind the origin; a sphere's far root must then be beyond the answer, or the ray's end.
    const bool far_root_matters = !judge_.scene->is_triangle(x.primitive) && x.t_leave > bound &&
                                  x.t_leave + bound + t_bound < std::min<double>(t, ray_.t_max);
    if (!far_root_matters && use(x.t * length_, bound * length_)) continue;
    if (std::isfinite(ray_.t_max) && use((ray_.t_max - x.t) * length_, bound * length_)) continue;
    return std::nullopt;
  }
  return worst;
}

const Crossing* ExactView::leaked(const Answer& answer) const {
  double t = std::numeric_limits<double>::infinity();
  if (const Crossing* c = find(answer)) t = meant_t(*c, answer.t) - dt(*c);
  const auto surface_of = [&](const Crossing& c) {
    return Surface{c.instance, judge_.topology->component[c.primitive]};
  };
  std::vector<const Crossing*> near;
  for (const Crossing& c : crossings_)
    if (judge_.scene->is_triangle(c.primitive) && std::abs(c.margin) <= lateral(c)) near.push_back(&c);
  std::map<Surface, std::vector<const Crossing*>> skipped;
  std::set<Surface> uncertain;  // whose number of crossings is not certain
  for (const Crossing& x : crossings_) {
    if (!x.hit || !is_in_closed_surface(x) || answer.is(x) || !is_within(x, t)) continue;
    const std::vector<const Crossing*> patch = patch_of(x, near);
    if (std::any_of(patch.begin(), patch.end(),
                    [&](const Crossing* c) { return answer.is(*c) || !is_within(*c, t); })) {
      uncertain.insert(surface_of(x));
      continue;
    }
    if (std::all_of(patch.begin(), patch.end(), [&](const Crossing* c) { return side_of(*c) == side_of(x); }))
      return &x;
    skipped[surface_of(x)].push_back(&x);
  }
  for (const Crossing* c : near)
    if (c->facing == 0 && is_in_closed_surface(*c)) uncertain.insert(surface_of(*c));
  for (const Crossing& c : crossings_) {
    if (answer.is(c) || !is_in_closed_surface(c)) continue;
    const double bound = dt(c);
    if (std::abs(c.t) <= bound || std::abs(c.t - ray_.t_max) <= bound || std::abs(c.t - t) <= bound)
      uncertain.insert(surface_of(c));
  }
  for (const auto& [surface, list] : skipped)
    if (!uncertain.count(surface) && crosses_oddly(list)) return list.front();
  return nullptr;
}

bool ExactView::is_in_closed_surface(const Crossing& c) const {
  return judge_.topology->is_closed(c.primitive) &&
         judge_.topology->component_orientable[judge_.topology->component[c.primitive]];
}

/// The side of its surface that the line meets: as `facing`, but told alike by all triangles of a surface, however each
/// is wound.
int ExactView::side_of(const Crossing& c) const { return judge_.topology->turned[c.primitive] ? -c.facing : c.facing; }

/// Whether the crossing lies between the ray's origin and both its end and `t`, whatever rounding does.
bool ExactView::is_within(const Crossing& c, double t) const {
  const double bound = dt(c);
  return c.t > bound && c.t + bound < ray_.t_max && c.t + bound < t;
}

/// The near triangles that hang together with x, x first.
std::vector<const Crossing*> ExactView::patch_of(const Crossing& x, std::vector<const Crossing*> near) const {
  std::vector<const Crossing*> patch{&x};
  for (std::size_t i = 0; i < patch.size(); ++i)
    std::erase_if(near, [&](const Crossing* c) {
      if (c == patch[i]) return true;
      if (c->instance != x.instance || !judge_.topology->share_a_corner(c->primitive, patch[i]->primitive))
        return false;
      patch.push_back(c);
      return true;
    });
  return patch;
}

/// Whether the crossings of one surface, in order of t, are an odd number. Crossings of one point (a shared edge, a
/// corner) count once; where those face both ways the ray touches the surface there, and the number tells nothing.
bool ExactView::crosses_oddly(const std::vector<const Crossing*>& list) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool same_point = i > 0 && list[i]->t == list[i - 1]->t &&
                            judge_.topology->share_a_corner(list[i]->primitive, list[i - 1]->primitive);
    if (same_point && side_of(*list[i]) != side_of(*list[i - 1])) return false;
    count += !same_point;
  }
  return count % 2 == 1;
}

std::string ExactView::value_error_beside(const Hit& hit) const {
  if (hit.kind != HitKind::hit) return {};
  const Crossing* c = find(answer_of(hit));
  if (!c) return "its primitive is not near the ray";
  const PlacedRay placed = placed_.in(hit.instance);
  if (c->on_line && judge_.scene->is_triangle(hit.primitive)) {
    const ReferenceHit truth = exact_hit(*judge_.scene, ray_, hit.instance, hit.primitive);
    return value_outside_bound(value_bounds(judge_.bounds, placed, hit.primitive, truth.t), hit, truth);
  }
  const ValueBounds b = values(*c);
  const double t = meant_t(*c, hit.t);
  const bool overflow = std::isinf(hit.t) && t + b.t > static_cast<double>(std::numeric_limits<float>::max());
  if (!overflow && !(std::abs(hit.t - t) <= b.t + kSmallest)) return "its t is not that of the primitive";
  const glm::dvec3 at = glm::dvec3(ray_.origin) + t * glm::dvec3(ray_.direction);
  const double stretch = hit.instance == kNone ? 1.0 : judge_.bounds.spaces.instances[hit.instance].stretch;
  const double beside = glm::length(glm::dvec3(hit.position) - at),
               allowed = b.position + b.t * length_ + stretch * std::abs(c->margin);
  if (!(beside <= allowed + kSmallest)) return "its position lies beside the ray";
  if (!(std::abs(glm::length(glm::dvec3(hit.normal)) - 1.0) <= 0x1p-20)) return "its normal is not of unit length";
  if (!(hit.barycentrics.x >= 0.0f && hit.barycentrics.y >= 0.0f &&
        hit.barycentrics.x + hit.barycentrics.y <= 1.0f + 0x1p-20f))
    return "its weights lie outside the triangle";
  return {};
}

std::string ExactView::value_error(const Hit& hit, bool other_root) const {
  const PlacedRay placed = placed_.in(hit.instance);
  ReferenceHit truth = exact_hit(*judge_.scene, ray_, hit.instance, hit.primitive);
  const PlacedSpace* place = hit.instance == kNone ? nullptr : &judge_.bounds.spaces.instances[hit.instance];
  if (other_root) truth = at_other_root(*judge_.scene, placed, place, truth);
  return value_outside_bound(value_bounds(judge_.bounds, placed, hit.primitive, truth.t), hit, truth);
}

std::string ExactView::describe_truth() const {
  std::string text;
  for (const Crossing& c : crossings_) {
    if (!c.hit || !c.nearest) continue;
    text += text.empty() ? "hit " : " and ";
    text += std::to_string(c.primitive);
    if (c.instance != kNone) text += " of instance " + std::to_string(c.instance);
  }
  if (text.empty()) return "miss";
  for (const Crossing& c : crossings_)
    if (c.hit && c.nearest) {
      char part[96];
      std::snprintf(part, sizeof part, " at t = %.17g, %.3g inside its outline", c.t, c.margin);
      return text + part;
    }
  return text;
}

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

bool is_within_bounds(const ValueBounds& b, const Hit& hit, const ReferenceHit& truth) {
  const glm::dvec3 dp = glm::dvec3(hit.position) - truth.position, dn = glm::dvec3(hit.normal) - truth.normal;
  const glm::dvec2 dw = glm::abs(glm::dvec2(hit.barycentrics) - truth.barycentrics);
  return std::abs(static_cast<double>(hit.t) - truth.t) <= b.t && glm::dot(dp, dp) <= b.position * b.position &&
         glm::dot(dn, dn) <= b.normal * b.normal && dw.x <= b.barycentrics && dw.y <= b.barycentrics;
}

std::string primitive_name(const Scene& scene, std::uint32_t instance, std::uint32_t primitive) {
  std::string text = "primitive " + std::to_string(primitive);
  if (instance == kNone) return text;
  text += " of instance " + std::to_string(instance);
  if (instance < scene.nodes.size() && !scene.nodes[instance].name.empty())
    text += " (" + scene.nodes[instance].name + ")";
  return text;
}

}  // namespace plumbline
