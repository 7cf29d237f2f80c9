// SPDX-License-Identifier: MIT
// References: which primitives can be hit at all, their outward-rounded boxes, and early split clipping of long
// triangles (Ernst and Greiner 2007).
//
// Why splitting never changes an answer. Each part's reference tests the whole triangle, so a leaf that is reached
// answers as if nothing had been split; what must hold is that some leaf of the triangle is reached by every ray that
// hits it. The hit point lies in the triangle, so it lies in one of the parts, so in the box and the ball of that
// part's leaf and of every node above it. That the parts cover the triangle although their corners are rounded: cut
// polygon P along the chord from V to W, where V and W lie on two of its edges, and the two pieces are P, whatever
// chord it is. A computed V lies within e of the point V* with the same parameter on the same edge. By induction over
// the cuts there are exact polygons, their union being the triangle, whose corners are within (number of cuts) * e of
// the stored ones. Giving each stored corner that radius makes the hull of its balls contain the exact polygon. For e:
// V = P + t (Q - P) in double has per coordinate an error of at most 2^-53 (2M + 2M + M), M the largest coordinate;
// setting the coordinate across the cut to the cut's own moves it by no more than 2^-53 * 11M, t being rounded by a
// share of 3 * 2^-53. So e < 2^-48 M, and with fewer than kMaxCuts = 64 = 2^6 cuts one above the other, 2^-42 M covers
// all of them.
#include "tracer/tree_references.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "scenes/error.h"
#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

constexpr int kMaxCuts = 64;

/// Piece of a triangle, waiting to be cut.
struct Piece {
  std::uint32_t primitive = 0;
  int cuts = 0;             ///< that led here
  std::uint64_t order = 0;  ///< of creation, so that equal lengths are cut in an order of our own
  double length = 0.0;      ///< longest side of its box
  int axis = 0;             ///< of that side
  std::vector<glm::dvec3> corners;
};

struct ShorterPiece {
  bool operator()(const Piece& a, const Piece& b) const {
    return a.length != b.length ? a.length < b.length : a.order > b.order;
  }
};

void measure(Piece& part) {
  glm::dvec3 lower = part.corners[0], upper = part.corners[0];
  for (const glm::dvec3& corner : part.corners) lower = glm::min(lower, corner), upper = glm::max(upper, corner);
  const glm::dvec3 size = upper - lower;
  part.axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  part.length = size[part.axis];
}

/// Cuts `part` across the middle of its longest side. False, and nothing done, where the corners do not fall into one
/// run on either side: slivers that rounding has bent are left whole.
bool cut(const Piece& part, Piece& low, Piece& high) {
  const int axis = part.axis;
  const std::size_t n = part.corners.size();
  double lower = part.corners[0][axis], upper = lower;
  for (const glm::dvec3& corner : part.corners)
    lower = std::min(lower, corner[axis]), upper = std::max(upper, corner[axis]);
  const double plane = lower + 0.5 * (upper - lower);
  if (!(lower < plane && plane < upper) || part.cuts + 1 >= kMaxCuts) return false;

  for (Piece* side : {&low, &high}) *side = {part.primitive, part.cuts + 1, 0, 0.0, 0, {}};
  int low_runs = 0, high_runs = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 &p = part.corners[i], &q = part.corners[(i + 1) % n];
    if (p[axis] <= plane) low.corners.push_back(p);
    if (p[axis] >= plane) high.corners.push_back(p);
    low_runs += p[axis] >= plane && q[axis] < plane;
    high_runs += p[axis] <= plane && q[axis] > plane;
    if ((p[axis] < plane && q[axis] > plane) || (p[axis] > plane && q[axis] < plane)) {
      const double t = (plane - p[axis]) / (q[axis] - p[axis]);
      glm::dvec3 v = p + t * (q - p);
      v[axis] = plane;
      low.corners.push_back(v);
      high.corners.push_back(v);
    }
  }
  if (low_runs != 1 || high_runs != 1) return false;
  measure(low);
  measure(high);
  return true;
}

void add_reference(References& references, std::uint32_t primitive, std::span<const FloatBall> balls) {
  Reference reference;
  reference.primitive = primitive;
  reference.first_ball = static_cast<std::uint32_t>(references.balls.size());
  reference.ball_count = static_cast<std::uint32_t>(balls.size());
  for (const FloatBall& ball : balls)
    for (int axis = 0; axis < 3; ++axis) {
      reference.box.lower[axis] = std::min(reference.box.lower[axis], sum_down(ball.center[axis], -ball.radius));
      reference.box.upper[axis] = std::max(reference.box.upper[axis], sum_up(ball.center[axis], ball.radius));
    }
  references.balls.insert(references.balls.end(), balls.begin(), balls.end());
  references.list.push_back(reference);
}

void add_triangle(References& references, std::uint32_t primitive, const std::array<glm::vec3, 3>& corners) {
  const std::array<FloatBall, 3> balls{FloatBall{corners[0]}, FloatBall{corners[1]}, FloatBall{corners[2]}};
  add_reference(references, primitive, balls);
}

void add_part(References& references, const Piece& part) {
  double largest = 0.0;
  for (const glm::dvec3& corner : part.corners)
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::fabs(corner[axis]));
  std::vector<FloatBall> balls;
  for (const glm::dvec3& corner : part.corners) {
    const glm::vec3 rounded(corner);
    const double moved = glm::length(glm::dvec3(rounded) - corner);
    balls.push_back({rounded, sum_up(moved * (1.0 + 0x1p-50), 0x1p-42 * largest)});
  }
  add_reference(references, part.primitive, balls);
}

double longest_edge(const std::array<glm::vec3, 3>& corners) {
  double longest = 0.0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, glm::length(glm::dvec3(corners[(i + 1) % 3]) - glm::dvec3(corners[i])));
  return longest;
}

/// Cuts the triangles `long_ones` into parts of at most `limit` and adds these.
void add_split(References& references, const Scene& scene, const std::vector<std::uint32_t>& long_ones, double limit) {
  std::priority_queue<Piece, std::vector<Piece>, ShorterPiece> waiting;
  std::uint64_t order = 0;
  for (const std::uint32_t primitive : long_ones) {
    Piece part{primitive, 0, order++, 0.0, 0, {}};
    for (const glm::vec3& corner : scene.corners(primitive)) part.corners.emplace_back(corner);
    measure(part);
    waiting.push(std::move(part));
  }
  std::vector<Piece> done;
  std::size_t may_add = std::max<std::size_t>(kMinExtraParts, scene.primitive_count());
  while (!waiting.empty()) {
    Piece part = waiting.top(), low, high;
    waiting.pop();
    if (may_add > 0 && part.length > limit && cut(part, low, high)) {
      --may_add;
      low.order = order++, high.order = order++;
      waiting.push(std::move(low));
      waiting.push(std::move(high));
    } else {
      done.push_back(std::move(part));
    }
  }
  // Those that were never cut are whole triangles with exact corners.
  for (const Piece& part : done) {
    if (part.cuts > 0)
      add_part(references, part);
    else
      add_triangle(references, part.primitive, scene.corners(part.primitive));
  }
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Every coordinate that is used must be finite, and so must a sphere's box.
void check_coordinates(const Scene& scene) {
  for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive) {
    bool good = true;
    if (scene.is_triangle(primitive)) {
      for (const glm::vec3& corner : scene.corners(primitive)) good = good && is_finite(corner);
    } else {
      const Sphere& sphere = scene.sphere(primitive);
      for (int axis = 0; axis < 3; ++axis)
        good = good && std::isfinite(sum_up(sphere.center[axis], sphere.radius)) &&
               std::isfinite(sum_down(sphere.center[axis], -sphere.radius));
    }
    if (!good)
      throw InputError(
          "scene " + scene.name + ": primitive " + std::to_string(primitive) +
          " has a coordinate that is not a number, or too large for 32 bits; mend it or scale the scene down");
  }
}

/// The radius of the smallest ball around everything.
double scene_radius(const Scene& scene) {
  std::vector<FloatBall> everything;
  for (const Triangle& triangle : scene.triangles)
    for (const std::uint32_t corner : triangle.position) everything.push_back({scene.positions[corner], 0.0f});
  for (const Sphere& sphere : scene.spheres) everything.push_back({sphere.center, sphere.radius});
  if (everything.empty()) return 0.0;
  BallSupport support;
  const glm::vec3 center(smallest_ball_center(everything, {}, support));
  return enclosing_radius(everything, center);
}

}  // namespace

bool has_no_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    // (b - a) x (c - a) along `axis`, multiplied out so that each term is a product of two floats
    const double bx = b[x], by = b[y], cx = c[x], cy = c[y], ax = a[x], ay = a[y];
    const std::array<double, 6> terms{bx * cy, -bx * ay, -ax * cy, -by * cx, by * ax, ay * cx};
    if (exact_sign(terms) != 0) return false;
  }
  return true;
}

References collect_references(const Scene& scene, float split_long) {
  check_coordinates(scene);
  References references;
  references.list.reserve(scene.primitive_count());
  references.balls.reserve(3 * scene.triangles.size() + scene.spheres.size());
  const double limit = split_long > 0.0f ? split_long * scene_radius(scene) : 0.0;
  std::vector<std::uint32_t> long_ones;
  for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive) {
    if (!scene.is_triangle(primitive)) {
      const FloatBall ball{scene.sphere(primitive).center, scene.sphere(primitive).radius};
      if (ball.radius > 0.0f) add_reference(references, primitive, {&ball, 1});
      continue;
    }
    const std::array<glm::vec3, 3> corners = scene.corners(primitive);
    if (has_no_area(corners[0], corners[1], corners[2])) continue;
    if (split_long > 0.0f && longest_edge(corners) > limit) {
      long_ones.push_back(primitive);
      continue;
    }
    add_triangle(references, primitive, corners);
  }
  if (!long_ones.empty()) add_split(references, scene, long_ones, limit);
  return references;
}

}  // namespace plumbline
