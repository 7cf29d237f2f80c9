// SPDX-License-Identifier: GPL-3.0-or-later
// Finds what a ray's line passes, by the arbiter's own tree, and puts it in exact order.
#include "reference/arbiter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "reference/box_tree.h"
#include "reference/filter.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

float round_down(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -INFINITY) : f;
}

Box box_of(const Solid& solid) {
  Box box;
  if (solid.is_sphere) {
    const double r = solid.radius;
    for (int axis = 0; axis < 3; ++axis) {
      // The sum is rounded to double before it is rounded to float: one more step outwards makes up for that.
      box.lower[axis] = std::nextafter(round_down(solid.corners[0][axis] - r), -INFINITY);
      box.upper[axis] = -std::nextafter(round_down(-(solid.corners[0][axis] + r)), -INFINITY);
    }
    return box;
  }
  for (const glm::vec3& corner : solid.corners) {
    box.lower = glm::min(box.lower, corner);
    box.upper = glm::max(box.upper, corner);
  }
  return box;
}

/// A primitive where the tree's leaves want it.
struct Item {
  Solid solid;
  std::uint32_t primitive = kNone;
};

/// The t that are asked for, in units of Line::direction from the ray's origin: first < t <= last.
struct Range {
  double first = 0.0, last = 0.0;
};

/// A primitive that the line meets, at one of its roots.
struct Meeting {
  const Item* item = nullptr;
  Root root = Root::enter;
  BoundedT t;
};

bool within(Filter& filter, const Item& item, Root root, const BoundedT& t, const Range& range) {
  return filter.compare_t(item.solid, root, t, range.first) > 0 &&
         filter.compare_t(item.solid, root, t, range.last) <= 0;
}

/// A finding, with what its place in the order hangs on.
struct Found {
  Crossing crossing;
  Meeting meeting;
};

int compare(Filter& filter, const Meeting& a, const Meeting& b) {
  return filter.compare_t(a.item->solid, a.root, a.t, b.item->solid, b.root, b.t);
}

/// Fills margin, near_edges and, where the line passes by, t. False where it passes beyond `reach`.
bool measure_triangle(Filter& filter, const Solid& solid, double reach, bool meets, Crossing& crossing) {
  double least = INFINITY;
  int nearest_edge = 0;
  for (int i = 0; i < 3; ++i) {
    const double distance = filter.segment_distance(solid.corners[i], solid.corners[(i + 1) % 3]);
    if (distance <= reach) crossing.near_edges = static_cast<std::uint8_t>(crossing.near_edges | (1 << i));
    if (distance < least) least = distance, nearest_edge = i;
  }
  crossing.margin = meets ? least : -least;
  if (meets) return true;
  if (!(least <= reach)) return false;

  const Line& line = filter.line();
  const glm::dvec3& d = line.direction;
  const double length2 = glm::dot(d, d);
  std::array<double, 3> s{};
  for (int i = 0; i < 3; ++i) s[i] = glm::dot((glm::dvec3(solid.corners[i]) - line.point) - line.rest, d) / length2;
  const auto [first, last] = std::minmax_element(s.begin(), s.end());
  crossing.t_enter = line.ray_t(*first), crossing.t_leave = line.ray_t(*last);
  const glm::vec3 from = solid.corners[nearest_edge], to = solid.corners[(nearest_edge + 1) % 3];
  const glm::dvec3 start = glm::cross(d, (glm::dvec3(from) - line.point) - line.rest);
  const glm::dvec3 edge = glm::cross(d, glm::dvec3(to) - glm::dvec3(from));
  const double where =
      glm::dot(edge, edge) > 0.0 ? std::clamp(-glm::dot(start, edge) / glm::dot(edge, edge), 0.0, 1.0) : 0.0;
  crossing.t = line.ray_t(s[nearest_edge] + where * (s[(nearest_edge + 1) % 3] - s[nearest_edge]));
  return true;
}

/// Examines one triangle. False where the line passes beyond `reach`, or out of range.
bool find_triangle(Filter& filter, const Item& item, double reach, const Range& range, Found& found) {
  const Solid& solid = item.solid;
  const Line& line = filter.line();
  const TrianglePass pass = filter.pass_triangle(solid);
  if (pass.beside && reach == 0.0) return false;
  Crossing& crossing = found.crossing;
  crossing = Crossing{};
  crossing.primitive = item.primitive;
  crossing.on_line = pass.meets;
  if (pass.meets) {
    const BoundedT t = filter.t_of(solid, Root::enter);
    if (!within(filter, item, Root::enter, t, range)) return false;
    crossing.hit = within(filter, item, Root::enter, t, {0.0, line.t_max});
    crossing.t = crossing.t_enter = crossing.t_leave = filter.ray_t(solid, Root::enter, t);
    found.meeting = {&item, Root::enter, t};
  }
  if (!measure_triangle(filter, solid, reach, pass.meets, crossing)) return false;
  const bool abreast = crossing.t_leave / line.unit > range.first && crossing.t_enter / line.unit <= range.last;
  if (!pass.meets && !abreast) return false;
  crossing.facing = filter.facing(solid);
  crossing.in_plane = crossing.facing == 0 && filter.in_plane(solid);
  return true;
}

/// Examines one sphere, as find_triangle does.
bool find_sphere(Filter& filter, const Item& item, double reach, const Range& range, Found& found) {
  const Solid& solid = item.solid;
  const Line& line = filter.line();
  const int side = filter.sphere_side(solid);
  if (side < 0 && reach == 0.0) return false;
  Crossing& crossing = found.crossing;
  crossing = Crossing{};
  crossing.primitive = item.primitive;
  crossing.margin = side * filter.sphere_distance(solid);
  if (side < 0) {
    if (!(-crossing.margin <= reach)) return false;
    const glm::dvec3& d = line.direction;
    const double middle = glm::dot((glm::dvec3(solid.corners[0]) - line.point) - line.rest, d) / glm::dot(d, d);
    const double half = solid.radius / glm::length(d);
    crossing.t = line.ray_t(middle);
    crossing.t_enter = line.ray_t(middle - half), crossing.t_leave = line.ray_t(middle + half);
    return line.shift + middle + half > range.first && line.shift + middle - half <= range.last;
  }
  crossing.on_line = true;
  const BoundedT enter = filter.t_of(solid, Root::enter), leave = filter.t_of(solid, Root::leave);
  if (!within(filter, item, Root::enter, enter, range) && !within(filter, item, Root::leave, leave, range))
    return false;
  const Range valid{0.0, line.t_max};
  // The nearest valid root; where neither is valid, the one nearest to being so.
  const bool take_enter = filter.compare_t(solid, Root::enter, enter, 0.0) > 0;
  found.meeting = {&item, take_enter ? Root::enter : Root::leave, take_enter ? enter : leave};
  crossing.hit = within(filter, item, found.meeting.root, found.meeting.t, valid);
  crossing.t_enter = filter.ray_t(solid, Root::enter, enter);
  crossing.t_leave = filter.ray_t(solid, Root::leave, leave);
  crossing.t = take_enter ? crossing.t_enter : crossing.t_leave;
  return true;
}

/// Orders by exact t, what the line passes by last, and marks the nearest hits.
void order_crossings(Filter& filter, std::vector<Found>& found) {
  std::sort(found.begin(), found.end(), [&](const Found& a, const Found& b) {
    if (a.crossing.on_line != b.crossing.on_line) return a.crossing.on_line;
    if (a.crossing.on_line) {
      const int sign = compare(filter, a.meeting, b.meeting);
      if (sign != 0) return sign < 0;
    } else if (a.crossing.t != b.crossing.t) {
      return a.crossing.t < b.crossing.t;
    }
    return a.crossing.primitive < b.crossing.primitive;
  });
  const Found* first = nullptr;
  for (Found& f : found) {
    if (!f.crossing.hit) continue;
    if (first != nullptr && compare(filter, f.meeting, first->meeting) > 0) break;
    if (first == nullptr) first = &f;
    f.crossing.nearest = true;
  }
}

/// Where the ray hits the primitive. False where it misses.
bool hit_of(Filter& filter, const Item& item, Meeting& meeting) {
  const Range valid{0.0, filter.line().t_max};
  meeting = {&item, Root::enter, {}};
  if (!item.solid.is_sphere) {
    if (!filter.pass_triangle(item.solid).meets) return false;
    meeting.t = filter.t_of(item.solid, Root::enter);
    return within(filter, item, Root::enter, meeting.t, valid);
  }
  if (filter.sphere_side(item.solid) < 0) return false;
  for (const Root root : {Root::enter, Root::leave}) {
    meeting = {&item, root, filter.t_of(item.solid, root)};
    if (within(filter, item, root, meeting.t, valid)) return true;
  }
  return false;
}

}  // namespace

struct Arbiter::Impl {
  BoxTree tree;
  std::vector<Item> items;  ///< in the order of the tree
  Ball ball;
  std::atomic<std::uint64_t> exact_decisions{0};

  SlabLine slabs(const Line& line, double reach, const Range& range) const {
    // s = t - shift, and what the difference's rounding may have taken.
    const auto rounding = [&](double t) {
      return std::isinf(t) ? 0.0 : 0x1p-52 * (std::fabs(t) + std::fabs(line.shift));
    };
    return {line, tree.bounds, reach, range.first - line.shift - rounding(range.first),
            range.last - line.shift + rounding(range.last)};
  }
};

Arbiter::Arbiter(const Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->ball = bounding_ball(scene);
  const std::uint32_t count = scene.primitive_count();
  std::vector<Box> boxes(count);
  tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) { boxes[i] = box_of(solid_of(scene, i)); });
  impl_->tree = build_box_tree(boxes);
  impl_->items.resize(count);
  tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) {
    const std::uint32_t primitive = impl_->tree.order[i];
    impl_->items[i] = {solid_of(scene, primitive), primitive};
  });
}

Arbiter::~Arbiter() = default;
Arbiter::Arbiter(Arbiter&&) noexcept = default;
Arbiter& Arbiter::operator=(Arbiter&&) noexcept = default;

std::vector<Crossing> Arbiter::crossings(const Ray& ray, double reach, double t_slack) const {
  PLUMBLINE_ASSERT(is_defined(ray) && reach >= 0.0 && t_slack >= 0.0);
  const Line line = line_near(ray, impl_->ball);
  Filter filter(line);
  const double slack = t_slack / line.unit;
  const Range range{-slack, line.t_max + slack};
  if (!(range.first < range.last)) return {};
  SlabLine slabs = impl_->slabs(line, reach, range);
  std::vector<Found> found;
  Found one;
  walk(impl_->tree, slabs, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Item& item = impl_->items[i];
      if (item.solid.is_sphere ? find_sphere(filter, item, reach, range, one)
                               : find_triangle(filter, item, reach, range, one)) {
        found.push_back(one);
      }
    }
  });
  order_crossings(filter, found);
  std::vector<Crossing> crossings;
  crossings.reserve(found.size());
  for (const Found& f : found) crossings.push_back(f.crossing);
  impl_->exact_decisions.fetch_add(filter.exact_decisions(), std::memory_order_relaxed);
  return crossings;
}

std::vector<std::uint32_t> Arbiter::nearest(const Ray& ray) const {
  PLUMBLINE_ASSERT(is_defined(ray));
  if (!(ray.t_max > 0.0f)) return {};
  const Line line = line_near(ray, impl_->ball);
  Filter filter(line);
  SlabLine slabs = impl_->slabs(line, 0.0, {0.0, line.t_max});
  std::vector<Meeting> best;  // all equal in t
  Meeting meeting;
  walk(impl_->tree, slabs, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = first; i < first + count; ++i) {
      if (!hit_of(filter, impl_->items[i], meeting)) continue;
      const int sign = best.empty() ? -1 : compare(filter, meeting, best.front());
      if (sign > 0) continue;
      if (sign < 0) best.clear();
      best.push_back(meeting);
      const double t_upper = static_cast<double>(meeting.t.value + meeting.t.error);
      slabs.last = std::min(slabs.last, t_upper - line.shift + 0x1p-50 * (std::fabs(t_upper) + std::fabs(line.shift)));
    }
  });
  std::vector<std::uint32_t> primitives;
  primitives.reserve(best.size());
  for (const Meeting& m : best) primitives.push_back(m.item->primitive);
  std::sort(primitives.begin(), primitives.end());
  impl_->exact_decisions.fetch_add(filter.exact_decisions(), std::memory_order_relaxed);
  return primitives;
}

std::uint64_t Arbiter::exact_decisions() const { return impl_->exact_decisions.load(std::memory_order_relaxed); }

}  // namespace plumbline
