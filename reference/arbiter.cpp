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

/// The t that are asked for: first < t <= last.
struct Range {
  double first = 0.0, last = 0.0;
};

/// A ray's line in one space, the world's or an instance's.
struct Space {
  Filter& filter;
  std::uint32_t instance = kNone;
};

/// A primitive that the line meets, at one of its roots.
struct Meeting {
  Space* space = nullptr;
  const Item* item = nullptr;
  Root root = Root::enter;
  BoundedT t;

  Placed placed() const { return {space->instance, item->primitive}; }
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

int compare(const Meeting& a, const Meeting& b) {
  return a.space->filter.compare_t(a.item->solid, a.root, a.t, b.space->filter, b.item->solid, b.root, b.t);
}

/// Whether what the line passes by is in range; where the line is lost to rounding it is.
bool abreast(const Line& line, const Crossing& crossing, const Range& range) {
  return std::isinf(line.point_error) || (crossing.t_leave > range.first && crossing.t_enter <= range.last);
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
bool find_triangle(Space& space, const Item& item, double reach, const Range& range, const Range& valid, Found& found) {
  Filter& filter = space.filter;
  const Solid& solid = item.solid;
  const Line& line = filter.line();
  const TrianglePass pass = filter.pass_triangle(solid);
  if (pass.beside && reach == 0.0) return false;
  Crossing& crossing = found.crossing;
  crossing = Crossing{};
  crossing.primitive = item.primitive;
  crossing.instance = space.instance;
  crossing.on_line = pass.meets;
  if (pass.meets) {
    const BoundedT t = filter.t_of(solid, Root::enter);
    if (!within(filter, item, Root::enter, t, range)) return false;
    crossing.hit = within(filter, item, Root::enter, t, valid);
    crossing.t = crossing.t_enter = crossing.t_leave = filter.ray_t(solid, Root::enter, t);
    found.meeting = {&space, &item, Root::enter, t};
  }
  if (!measure_triangle(filter, solid, reach, pass.meets, crossing)) return false;
  if (!pass.meets && !abreast(line, crossing, range)) return false;
  crossing.facing = filter.facing(solid);
  crossing.in_plane = crossing.facing == 0 && filter.in_plane(solid);
  return true;
}

/// Examines one sphere, as find_triangle does.
bool find_sphere(Space& space, const Item& item, double reach, const Range& range, const Range& valid, Found& found) {
  Filter& filter = space.filter;
  const Solid& solid = item.solid;
  const Line& line = filter.line();
  const int side = filter.sphere_side(solid);
  if (side < 0 && reach == 0.0) return false;
  Crossing& crossing = found.crossing;
  crossing = Crossing{};
  crossing.primitive = item.primitive;
  crossing.instance = space.instance;
  crossing.margin = side * filter.sphere_distance(solid);
  if (side < 0) {
    if (!(-crossing.margin <= reach)) return false;
    const glm::dvec3& d = line.direction;
    const double middle = glm::dot((glm::dvec3(solid.corners[0]) - line.point) - line.rest, d) / glm::dot(d, d);
    const double half = solid.radius / glm::length(d);
    crossing.t = line.ray_t(middle);
    crossing.t_enter = line.ray_t(middle - half), crossing.t_leave = line.ray_t(middle + half);
    return abreast(line, crossing, range);
  }
  crossing.on_line = true;
  const BoundedT enter = filter.t_of(solid, Root::enter), leave = filter.t_of(solid, Root::leave);
  if (!within(filter, item, Root::enter, enter, range) && !within(filter, item, Root::leave, leave, range))
    return false;
  // The nearest valid root; where neither is valid, the one nearest to being so.
  const bool take_enter = filter.compare_t(solid, Root::enter, enter, 0.0) > 0;
  found.meeting = {&space, &item, take_enter ? Root::enter : Root::leave, take_enter ? enter : leave};
  crossing.hit = within(filter, item, found.meeting.root, found.meeting.t, valid);
  crossing.t_enter = filter.ray_t(solid, Root::enter, enter);
  crossing.t_leave = filter.ray_t(solid, Root::leave, leave);
  crossing.t = take_enter ? crossing.t_enter : crossing.t_leave;
  return true;
}

/// Orders by exact t, what the line passes by last, and marks the nearest hits.
void order_crossings(std::vector<Found>& found) {
  std::sort(found.begin(), found.end(), [&](const Found& a, const Found& b) {
    if (a.crossing.on_line != b.crossing.on_line) return a.crossing.on_line;
    if (a.crossing.on_line) {
      const int sign = compare(a.meeting, b.meeting);
      if (sign != 0) return sign < 0;
    } else if (a.crossing.t != b.crossing.t) {
      return a.crossing.t < b.crossing.t;
    }
    return Placed{a.crossing.instance, a.crossing.primitive} < Placed{b.crossing.instance, b.crossing.primitive};
  });
  const Found* first = nullptr;
  for (Found& f : found) {
    if (!f.crossing.hit) continue;
    if (first != nullptr && compare(f.meeting, first->meeting) > 0) break;
    if (first == nullptr) first = &f;
    f.crossing.nearest = true;
  }
}

/// Where the ray hits the primitive. False where it misses.
bool hit_of(Space& space, const Item& item, const Range& valid, Meeting& meeting) {
  Filter& filter = space.filter;
  meeting = {&space, &item, Root::enter, {}};
  if (!item.solid.is_sphere) {
    if (!filter.pass_triangle(item.solid).meets) return false;
    meeting.t = filter.t_of(item.solid, Root::enter);
    return within(filter, item, Root::enter, meeting.t, valid);
  }
  if (filter.sphere_side(item.solid) < 0) return false;
  for (const Root root : {Root::enter, Root::leave}) {
    meeting = {&space, &item, root, filter.t_of(item.solid, root)};
    if (within(filter, item, root, meeting.t, valid)) return true;
  }
  return false;
}

/// What one space holds: the world's or a part's primitives.
struct Group {
  BoxTree tree;
  std::vector<Item> items;  ///< in the order of the tree
  Ball ball;
};

/// Triangles [first, last) and spheres likewise, by their numbers in the scene.
Group make_group(const Scene& scene, std::uint32_t first_triangle, std::uint32_t triangles, std::uint32_t first_sphere,
                 std::uint32_t spheres, const Ball& ball) {
  const std::uint32_t sphere_offset = static_cast<std::uint32_t>(scene.triangles.size()) + first_sphere;
  const auto number = [&](std::uint32_t i) {
    return i < triangles ? first_triangle + i : sphere_offset + i - triangles;
  };
  Group group;
  group.ball = ball;
  const std::uint32_t count = triangles + spheres;
  std::vector<Box> boxes(count);
  tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) { boxes[i] = box_of(solid_of(scene, number(i))); });
  group.tree = build_box_tree(boxes);
  group.items.resize(count);
  tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) {
    const std::uint32_t primitive = number(group.tree.order[i]);
    group.items[i] = {solid_of(scene, primitive), primitive};
  });
  return group;
}

/// The part of a line where t is in range, with what the roundings may have taken.
SlabLine slabs_of(const Line& line, const BoxTree& tree, double reach, const Range& range) {
  // s = t / unit - shift; the division by a power of two is exact.
  const auto s_of = [&](double t, double outwards) {
    const double in_units = t / line.unit;
    if (std::isinf(in_units) || std::isinf(line.point_error)) return outwards * INFINITY;
    return in_units - line.shift + outwards * 0x1p-52 * (std::fabs(in_units) + std::fabs(line.shift));
  };
  return {line, tree.bounds, reach, s_of(range.first, -1.0), s_of(range.last, 1.0)};
}

/// An instance's line in one query; the filter keeps references to it.
struct Visited {
  LocalLine local;
  Filter filter;
  Space space;
  Visited(const Ray& ray, const Line& world, const InstanceMap& map, const Ball& ball)
      : local(local_line(ray, map, ball)), filter(local, world, map), space{filter, map.instance} {}
};
using VisitedInstances = std::vector<std::unique_ptr<Visited>>;

}  // namespace

struct Arbiter::Impl {
  Group world;
  std::vector<Group> parts;
  std::vector<InstanceMap> maps;
  BoxTree instances;       ///< over the maps
  std::vector<Box> boxes;  ///< of the maps, in the world
  Ball ball;               ///< around everything
  std::atomic<std::uint64_t> exact_decisions{0};

  void add_instances(const Scene& scene) {
    for (const Part& part : scene.parts) {
      parts.push_back(make_group(scene, part.first_triangle, part.triangle_count, part.first_sphere, part.sphere_count,
                                 bounding_ball(scene, part)));
    }
    maps = instance_maps(scene);
    boxes.resize(maps.size());
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const Box& local = parts[maps[i].part].tree.bounds;
      const BoxD box = world_box(maps[i], {glm::dvec3(local.lower), glm::dvec3(local.upper)});
      for (int axis = 0; axis < 3; ++axis) {
        boxes[i].lower[axis] = round_down(box.lower[axis]);
        boxes[i].upper[axis] = -round_down(-box.upper[axis]);
      }
    }
    instances = build_box_tree(boxes);
  }

  void count_decisions(const Filter& filter, const VisitedInstances& visited) {
    std::uint64_t count = filter.exact_decisions();
    for (const auto& v : visited) count += v->filter.exact_decisions();
    if (count > 0) exact_decisions.fetch_add(count, std::memory_order_relaxed);
  }
};

Arbiter::Arbiter(const Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->ball = bounding_ball(scene);
  impl_->world = make_group(scene, 0, scene.world_triangle_count(), 0, scene.world_sphere_count(), impl_->ball);
  impl_->add_instances(scene);
}

Arbiter::~Arbiter() = default;
Arbiter::Arbiter(Arbiter&&) noexcept = default;
Arbiter& Arbiter::operator=(Arbiter&&) noexcept = default;

std::vector<Crossing> Arbiter::crossings(const Ray& ray, const Reach& reach, double t_slack) const {
  PLUMBLINE_ASSERT(is_defined(ray) && reach.world >= 0.0 && t_slack >= 0.0);
  const Line line = line_near(ray, impl_->ball);
  Filter filter(line);
  Space world{filter};
  const Range range{-t_slack, ray.t_max + t_slack}, valid{0.0, ray.t_max};
  if (!(range.first < range.last)) return {};
  std::vector<Found> found;
  Found one;
  const auto search = [&](Space& space, const Group& group, double group_reach) {
    SlabLine slabs = slabs_of(space.filter.line(), group.tree, group_reach, range);
    walk(group.tree, slabs, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t i = first; i < first + count; ++i) {
        const Item& item = group.items[i];
        if (item.solid.is_sphere ? find_sphere(space, item, group_reach, range, valid, one)
                                 : find_triangle(space, item, group_reach, range, valid, one)) {
          found.push_back(one);
        }
      }
    });
  };
  search(world, impl_->world, reach.world);

  VisitedInstances visited;
  SlabLine slabs = slabs_of(line, impl_->instances, reach.world, range);
  walk(impl_->instances, slabs, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = first; i < first + count; ++i) {
      const std::uint32_t number = impl_->instances.order[i];
      if (slabs.enter(impl_->boxes[number]) == INFINITY) continue;
      const InstanceMap& map = impl_->maps[number];
      const Group& part = impl_->parts[map.part];
      const double local_reach = reach.local ? reach.local(map.instance) : 0.0;
      PLUMBLINE_ASSERT(local_reach >= 0.0);
      search(visited.emplace_back(std::make_unique<Visited>(ray, line, map, part.ball))->space, part, local_reach);
    }
  });

  order_crossings(found);
  std::vector<Crossing> crossings;
  crossings.reserve(found.size());
  for (const Found& f : found) crossings.push_back(f.crossing);
  impl_->count_decisions(filter, visited);
  return crossings;
}

std::vector<Crossing> Arbiter::crossings(const Ray& ray, double reach, double t_slack) const {
  PLUMBLINE_ASSERT(reach == 0.0 || impl_->maps.empty());
  return crossings(ray, Reach{reach, {}}, t_slack);
}

std::vector<Placed> Arbiter::nearest(const Ray& ray) const {
  PLUMBLINE_ASSERT(is_defined(ray));
  if (!(ray.t_max > 0.0f)) return {};
  const Line line = line_near(ray, impl_->ball);
  Filter filter(line);
  Space world{filter};
  const Range valid{0.0, ray.t_max};
  std::vector<Meeting> best;   // all equal in t
  double least_t = ray.t_max;  // no less than the t of these
  // What is behind the nearest so far is left out by slabs, which rounding may only move outwards.
  const auto shorten = [&](SlabLine& slabs, const Line& in) {
    if (std::isinf(in.point_error)) return;
    const double s = least_t / in.unit;
    slabs.last = std::min(slabs.last, s - in.shift + 0x1p-50 * (std::fabs(s) + std::fabs(in.shift)));
  };
  Meeting meeting;
  const auto search = [&](Space& space, const Group& group) {
    SlabLine slabs = slabs_of(space.filter.line(), group.tree, 0.0, {0.0, least_t});
    walk(group.tree, slabs, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t i = first; i < first + count; ++i) {
        if (!hit_of(space, group.items[i], valid, meeting)) continue;
        const int sign = best.empty() ? -1 : compare(meeting, best.front());
        if (sign > 0) continue;
        if (sign < 0) best.clear();
        best.push_back(meeting);
        least_t = std::min(least_t, static_cast<double>(meeting.t.value + meeting.t.error) * (1.0 + 0x1p-52));
        shorten(slabs, space.filter.line());
      }
    });
  };
  search(world, impl_->world);

  VisitedInstances visited;
  SlabLine slabs = slabs_of(line, impl_->instances, 0.0, {0.0, least_t});
  walk(impl_->instances, slabs, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = first; i < first + count; ++i) {
      const std::uint32_t number = impl_->instances.order[i];
      if (slabs.enter(impl_->boxes[number]) == INFINITY) continue;
      const InstanceMap& map = impl_->maps[number];
      const Group& part = impl_->parts[map.part];
      search(visited.emplace_back(std::make_unique<Visited>(ray, line, map, part.ball))->space, part);
    }
    shorten(slabs, line);
  });

  std::vector<Placed> nearest;
  nearest.reserve(best.size());
  for (const Meeting& m : best) nearest.push_back(m.placed());
  std::sort(nearest.begin(), nearest.end());
  impl_->count_decisions(filter, visited);
  return nearest;
}

const InstanceMap& Arbiter::map_of(std::uint32_t instance) const {
  const auto before = [](const InstanceMap& map, std::uint32_t number) { return map.instance < number; };
  const auto found = std::lower_bound(impl_->maps.begin(), impl_->maps.end(), instance, before);
  PLUMBLINE_ASSERT(found != impl_->maps.end() && found->instance == instance);
  return *found;
}

std::uint64_t Arbiter::exact_decisions() const { return impl_->exact_decisions.load(std::memory_order_relaxed); }

}  // namespace plumbline
