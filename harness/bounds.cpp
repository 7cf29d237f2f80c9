// SPDX-License-Identifier: GPL-3.0-or-later
// The derivation, for u = 2^-24 (rounding to nearest: each operation has a relative error of at most u). Lengths are in
// world units. Coordinates x, y, z are those of the tracer's triangle test: z along the largest component of d, x and y
// sheared along the ray onto the plane z = 0 ("as seen along the ray"), so a point of the ray has x = y = 0.
//
// Triangle. A = v - o has error u|A| per component. x = A.x - Sx A.z with Sx = d.x / d.z, |Sx| <= 1: A.x brings u|A.x|;
// the product 3u|A.z| (A.z, Sx, the product itself); the difference u|x| <= u(|A.x| + |A.z|). The displacement of a
// corner as seen along the ray is thus at most u sqrt((2|A.x| + 4|A.z|)^2 + (2|A.y| + 4|A.z|)^2) <= 6u|A|. Where the
// tracer first moved the origin near the scene, the moved origin o' is rounded once: with N = |centre of the ball| + 3R
// >= |o'| by 2uN at most in all, seen along the ray by sqrt(3) of that, 4uN; along the ray it shifts t by as much. With
// M = max |A|:
//     delta = 6uM (+ 4uN where moved)
// The test decides by the signs of the edge functions of the displaced corners. Each is a difference of two rounded
// products; rounding is monotone, so a sign is never wrong, only possibly zero, and zero counts as inside. It is zero
// only for |U| <= 2uL^2, L the largest |(x, y)| of a corner, that is for rays within 2uL^2/|e| of the line of edge e.
// Where |det| < 2^-8 L^2 the tracer uses exact products; there |e| is the only free quantity, elsewhere |det| <= 2|e|L
// gives |e| >= 2^-9 L. Hence, perpendicular distances being no longer than sheared ones,
//     lateral = delta + 2uL^2 / max(|e|, 2^-9 L)
//
// Weights. The computed weights are, but for rounding, those of the ray in the displaced triangle: 0 = sum w~_i (V_i +
// eps_i), so sum w~_i V_i = -eps with |eps| <= delta, a convex combination. They are thus the exact weights of a point
// at most delta beside the ray, and weight i falls from 1 to 0 over the height h_i = |det| / |e_i| above the opposite
// edge:  |w~_i - w_i| <= delta / h_i, exactly. Rounding of the edge functions adds
//     rho = min(4uL^2 / |det|, 2^11 u) + 6u
// (an edge function is off by at most uL^2 + u|U|; below |det| = 2^-8 L^2 the tracer's products are exact). All of it
// at most 1: weights lie in [0, 1]. t = (sum w_i z_i) / d.z, the z of corner 0 taken as origin:
//     dz = (delta/h_1 + rho)|z_1 - z_0| + (delta/h_2 + rho)|z_2 - z_0| + 10u max|z| (+ 4uN where moved), the first two
//     at most the range of z; dt = dz / |d.z| + 4u|t|
// position = sum w_i v_i likewise, with |v_1 - v_0|, |v_2 - v_0|, at most the longest edge, + 12u max|v|, + 2uM for the
// origin's rounding. normal = normalise(e1 x e2), corners as given: each component of the cross product has an error of
// at most 4u|e1||e2|:
//     dn = 8u |e1||e2| / |e1 x e2| + 4u, at most 2.
//
// Sphere. m = c - o has error uM, M = |m|. tb = m.d / d.d has an error of 10uM along the ray (dot products of three
// terms and a quotient). f = m - tb d: the error of tb moves f along the ray, to which f is perpendicular: of second
// order; rounding brings 4uM across. So |f| is off by at most 4uM + (12uM)^2 / |f|, and r^2 - f.f by D = 2|f| 4uM +
// (14uM)^2 + 4u f^2 + 3u r^2. h = sqrt(r^2 - f.f) is off by at most min(D / h, sqrt D) + 2uh.  dt |d| = 12uM + that +
// 4u|t d|;  position: that + 4uM + 2u|p|;  normal = (p - c) / r: dp / r + 4u. Underflow. The driver flushes denormals
// to zero, in what it reads and in what it computes: a coordinate of the origin or of a corner may be off by 2^-126,
// seen along the ray and through both by at most kFlush = 2^-123. Products of coordinates are covered by kUnderflow.
//
// lateral: |f| is compared with r:  D / r, for r + |f| >= r:  |r - |f|| <= D / (r + |f|) <= D / r.
//
// Instances. In the space of an instance the tracer computes all this with a ray whose origin is off by e and whose
// direction is off by g (placed_ray.cpp; a far ray enters transforms from its moved origin, which is off by 2uN). Its
// answers are those above of a ray that passes w = e + |t| g beside the exact one, for the t abreast of the primitive.
//
// A triangle's corner is displaced by w, seen along the ray by (w.x + |Sx| w.z, w.y + |Sy| w.z), which is added to
// delta; depths by w.z, added to dz. Where errors leave open which component of d is the largest, the larger bounds of
// the possible choices hold.
//
// A sphere's |f| is off by |w| more, so D is taken at |f| + |w| and grows by 2|f||w| + |w|^2. The foot is off by |w|
// and by |f||g| / |d|, half the chord by h|g| / |d|: along the ray |w| + (|f| + h)|g| / |d| more. lateral = D / r +
// |w|, with D of the tracer's own ray.
//
// t is the same number in every space; the canonical one, by which the tracer compares, has 2u(|t| + |t of the moved
// origin|) more. Of the position, errors along the edges are taken to the world with them, others grow by the
// instance's stretch, and leaving adds its own. The normal's error grows by the stretch of the inverse, over the length
// of the transposed inverse's image of it.
#include "harness/bounds.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plumbline {
namespace {

constexpr double u = 0x1p-24;
/// What gradual underflow, flushed to zero, may take from one product of scaled coordinates: relative to the space's
/// radius squared.
constexpr double kUnderflow = 0x1p-80;

/// What flushing denormal coordinates to zero may move a point by.
constexpr double kFlush = 0x1p-123;

/// Keeps what is meant to be smaller smaller, in spite of double rounding.
constexpr double kLess = 1.0 - 0x1p-40;

/// Unit vectors are no farther apart, but for the rounding of their lengths.
constexpr double kMostApart = 2.0 + 8.0 * u;

constexpr double kRootOf3 = 1.7320508075688774;

double square(double x) { return x * x; }

/// How far the tracer's ray may be from the exact one at this t, component by component.
glm::dvec3 displacement(const PlacedRay& ray, double t) { return ray.origin_error + std::abs(t) * ray.direction_error; }

/// A triangle as the tracer sees it along the ray, in double.
struct Seen {
  std::array<double, 3> x{}, y{}, z{};
  double inverse_dz = 0.0;           ///< 1 / largest component of d
  double reach = 0.0;                ///< M: largest distance of a corner from the (moved) origin
  double extent = 0.0;               ///< L
  std::array<double, 3> opposite{};  ///< length of the edge opposite to each corner, as seen
  double shortest = 0.0;             ///< shortest edge as seen
  double det = 0.0;                  ///< |U + V + W|
  double z_range = 0.0, z_max = 0.0;
  double depth = 0.0;  ///< w.z
  double delta = 0.0;
};

/// Along which axis z runs: the tracer's choice, between equal components too, since it decides how z and weights share
/// the error.
int largest_axis(const glm::dvec3& size) {
  return size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
}

Seen see(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive, int kz) {
  Seen s;
  const glm::dvec3& d = ray.direction;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  s.inverse_dz = 1.0 / d[kz];
  const double sx = d[kx] * s.inverse_dz, sy = d[ky] * s.inverse_dz;
  const auto corners = c.scene->corners(primitive);
  double z_min = 0.0, z_top = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - ray.origin;
    s.x[i] = a[kx] - sx * a[kz];
    s.y[i] = a[ky] - sy * a[kz];
    s.z[i] = a[kz];
    s.reach = std::max(s.reach, glm::dot(a, a));
    s.extent = std::max(s.extent, s.x[i] * s.x[i] + s.y[i] * s.y[i]);
    z_min = i ? std::min(z_min, s.z[i]) : s.z[i];
    z_top = i ? std::max(z_top, s.z[i]) : s.z[i];
  }
  s.reach = std::sqrt(s.reach);
  s.extent = std::sqrt(s.extent);
  s.z_range = z_top - z_min;
  s.z_max = std::max(std::abs(z_min), std::abs(z_top));
  double input = 0.0;
  if (!ray.is_exact) {
    const glm::dvec3 w = displacement(ray, s.z_max * s.inverse_dz);
    input = std::hypot(w[kx] + std::abs(sx) * w[kz], w[ky] + std::abs(sy) * w[kz]);
    s.depth = w[kz];
    s.reach += glm::length(ray.origin_error);
  }
  if (s.reach > ray.farthest) s.reach = ray.farthest;
  if (ray.moved_error > 0.0) s.z_max = s.reach;
  s.shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double ex = s.x[j] - s.x[i], ey = s.y[j] - s.y[i];
    const double e = std::sqrt(ex * ex + ey * ey);
    s.opposite[(i + 2) % 3] = e;
    s.shortest = std::min(s.shortest, e);
  }
  s.det = std::abs((s.x[1] - s.x[0]) * (s.y[2] - s.y[0]) - (s.y[1] - s.y[0]) * (s.x[2] - s.x[0]));
  s.delta = 6.0 * u * s.reach + ray.moved_error + input + kFlush;
  return s;
}

double lateral_of(const Seen& s) {
  return s.delta + 2.0 * u * s.extent * s.extent / std::max(s.shortest, 0x1p-9 * s.extent);
}

/// Calls `use` with the triangle as the tracer may see it: once, unless errors leave the axis open.
template <class Use>
void for_each_sight(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive, Use use) {
  const glm::dvec3 size = glm::abs(ray.direction);
  const int largest = largest_axis(size);
  use(see(c, ray, primitive, largest));
  if (ray.is_exact) return;
  const double least = size[largest] - ray.direction_error[largest];
  for (int axis = 0; axis < 3; ++axis)
    if (axis != largest && size[axis] > 0.0 && !(size[axis] + ray.direction_error[axis] < least))
      use(see(c, ray, primitive, axis));
}

/// A sphere as the tracer sees it along the ray, in double.
struct SeenSphere {
  double reach = 0.0;      ///< M
  double off = 0.0;        ///< |f|
  double displaced = 0.0;  ///< |w|
  double own_error = 0.0;  ///< D of the tracer's own ray
  double error = 0.0;      ///< D
};

SeenSphere see_sphere(const PlacedRay& ray, const Sphere& sphere) {
  SeenSphere s;
  const glm::dvec3 m = glm::dvec3(sphere.center) - ray.origin;
  const glm::dvec3 n = ray.direction / ray.length;
  const double foot = glm::dot(m, n), r = sphere.radius;
  s.off = glm::length(m - foot * n);
  s.reach = glm::length(m);
  if (!ray.is_exact) {
    s.displaced = glm::length(displacement(ray, (std::abs(foot) + r) / ray.length));
    s.reach += glm::length(ray.origin_error);
  }
  s.reach = std::min(s.reach, ray.farthest);
  const double lateral = 4.0 * u * s.reach + ray.moved_error + kFlush, off = s.off + s.displaced;
  const double second_order = 14.0 * u * s.reach + ray.moved_error;
  s.own_error = 2.0 * off * lateral + second_order * second_order + 4.0 * u * off * off + 3.0 * u * r * r;
  s.error = s.own_error + 2.0 * s.off * s.displaced + s.displaced * s.displaced;
  return s;
}

double lateral_of(const SeenSphere& s, double radius) { return s.own_error / radius + s.displaced; }

/// An upper bound of lateral_of over all primitives of a space, for origins that are `reach` from what they are
/// compared with (after moving), and a ray displaced by at most `displaced`.
double lateral_within(const SpaceExtent& space, double reach, double moved, double displaced) {
  reach += kFlush / u;
  // Triangles: as seen along the ray the extent is at most sqrt(3) times the longest edge and the bound, and so is the
  // displacement; the term for zeros is at most 2^10 uL.
  const double triangles = 6.0 * u * reach + moved + kRootOf3 * displaced + 0x1p10 * u * 2.0 * space.longest_edge;
  // Spheres: see_sphere with |f| about r.
  const double r = space.smallest_radius;
  const double spheres = r > 0.0
                             ? displaced + (24.0 * u * reach + 2.0 * moved) * (1.0 + 2.0 * displaced / r) +
                                   8.0 * u * displaced * (1.0 + displaced / r) + square(18.0 * u * reach + moved) / r
                             : 0.0;
  return std::max(space.longest_edge > 0.0 ? triangles : 0.0, spheres);
}

void include_triangle(const Scene& scene, std::uint32_t triangle, SpaceExtent& space) {
  const auto v = scene.corners(triangle);
  for (int i = 0; i < 3; ++i)
    space.longest_edge = std::max(space.longest_edge, glm::length(glm::dvec3(v[(i + 1) % 3]) - glm::dvec3(v[i])));
}

void include_sphere(const Sphere& sphere, SpaceExtent& space) {
  const double r = sphere.radius;
  space.largest_radius = std::max(space.largest_radius, r);
  space.smallest_radius = space.smallest_radius > 0.0 ? std::min(space.smallest_radius, r) : r;
}

/// Takes bounds that hold in an instance's space to the world. `position` and `normal` are the exact ones, local.
void leave(const BoundsContext& c, const PlacedRay& ray, const glm::dvec3& position, const glm::dvec3& normal, double t,
           ValueBounds& b) {
  const LeavingErrors leaving = leaving_errors(c.spaces, *c.scene, ray.instance, position, normal);
  b.t += 2.0 * u * (std::abs(t) + std::abs(ray.t_origin)) + ray.t_rounding;
  b.position += leaving.position;
  const double share =
      (c.spaces.instances[ray.instance].inverse_stretch * b.normal + leaving.normal) / leaving.normal_world_length +
      4.0 * u;
  b.normal = share < 1.0 ? std::min(kMostApart, share / (1.0 - 0.5 * share)) : kMostApart;
}

ValueBounds sphere_bounds(const BoundsContext& c, const PlacedRay& ray, const Sphere& sphere, double t) {
  ValueBounds b;
  const SeenSphere s = see_sphere(ray, sphere);
  const double r = sphere.radius;
  const double h = std::sqrt(std::max(0.0, r * r - s.off * s.off));
  const double turned = ray.is_exact ? 0.0 : (s.off + h) * glm::length(ray.direction_error) / ray.length;
  const double dh = (h > 0.0 ? std::min(s.error / h, std::sqrt(s.error)) : std::sqrt(s.error)) + 2.0 * u * h;
  const double along = 12.0 * u * s.reach + ray.moved_error + s.displaced + turned + dh + kFlush;
  const double across = 4.0 * u * s.reach + ray.moved_error + s.displaced;
  const double largest = glm::length(glm::dvec3(sphere.center)) + r;
  b.t = (along + 4.0 * u * std::abs(t) * ray.length) / ray.length;
  b.position = along + across + 2.0 * u * largest;
  b.normal = std::min(kMostApart, b.position / r + 4.0 * u);
  if (ray.instance == kNone) return b;
  b.position *= c.spaces.instances[ray.instance].stretch;
  const glm::dvec3 position = ray.origin + (t - ray.t_origin) * ray.direction;
  leave(c, ray, position, glm::normalize(position - glm::dvec3(sphere.center)), t, b);
  return b;
}

ValueBounds triangle_bounds(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive, double t) {
  ValueBounds b;
  const auto v = c.scene->corners(primitive);
  const glm::dvec3 e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]), e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
  const double l1 = glm::length(e1), l2 = glm::length(e2);
  const double largest =
      std::max({glm::length(glm::dvec3(v[0])), glm::length(glm::dvec3(v[1])), glm::length(glm::dvec3(v[2]))});
  const PlacedSpace* place = ray.instance == kNone ? nullptr : &c.spaces.instances[ray.instance];
  // The edges in the world, along which errors of the weights move the position.
  const glm::dvec3 f1 = place ? place->to_world.linear * e1 : e1, f2 = place ? place->to_world.linear * e2 : e2;
  const double w_l1 = place ? glm::length(f1) : l1, w_l2 = place ? glm::length(f2) : l2;
  const double longest = std::max({w_l1, w_l2, glm::length(f2 - f1)});
  const double stretch = place ? place->stretch : 1.0, radius = c.extent_of(ray.instance).ball.radius;
  for_each_sight(c, ray, primitive, [&](const Seen& s) {
    const double rho =
        std::min(4.0 * u * s.extent * s.extent / s.det, 0x1p11 * u) + 6.0 * u + kUnderflow * radius * radius / s.det;
    const auto weight = [&](int i) {
      return std::min(1.0, s.delta * s.opposite[i] / s.det + rho);
    };  // det may be 0: then 1
    const double w0 = weight(0), w1 = weight(1), w2 = weight(2);
    b.barycentrics = std::max({b.barycentrics, w0, w1, w2});
    const double dz = std::min(w1 * std::abs(s.z[1] - s.z[0]) + w2 * std::abs(s.z[2] - s.z[0]), s.z_range) +
                      10.0 * u * s.z_max + ray.moved_error + s.depth + kFlush;
    b.t = std::max(b.t, dz * std::abs(s.inverse_dz) + 4.0 * u * std::abs(t));
    b.position =
        std::max(b.position, std::min(w1 * w_l1 + w2 * w_l2, longest) +
                                 stretch * (12.0 * u * largest + 2.0 * u * s.reach + ray.moved_error + kFlush));
  });
  const glm::dvec3 normal = glm::cross(e1, e2);
  const double cross = glm::length(normal);
  b.normal = cross > 0.0 ? std::min(kMostApart, 8.0 * u * l1 * l2 / cross + 4.0 * u) : kMostApart;
  if (!place || !(cross > 0.0)) return b;
  leave(c, ray, ray.origin + (t - ray.t_origin) * ray.direction, normal / cross, t, b);
  return b;
}

}  // namespace

BoundsContext make_bounds_context(const Scene& scene, const SceneTree& tree) {
  BoundsContext c;
  c.scene = &scene;
  c.world.ball = scene.nodes.empty() ? bounding_ball(scene) : tree.groups.front().content;
  for (std::uint32_t p = 0; p < scene.world_triangle_count(); ++p) include_triangle(scene, p, c.world);
  for (std::uint32_t i = 0; i < scene.world_sphere_count(); ++i) include_sphere(scene.spheres[i], c.world);
  for (std::size_t p = 0; p < scene.parts.size(); ++p) {
    const Part& part = scene.parts[p];
    SpaceExtent& space = c.parts.emplace_back();
    space.ball = tree.part_balls[p];
    for (std::uint32_t i = 0; i < part.triangle_count; ++i) include_triangle(scene, part.first_triangle + i, space);
    for (std::uint32_t i = 0; i < part.sphere_count; ++i) include_sphere(scene.spheres[part.first_sphere + i], space);
  }
  std::vector<Ball> contents;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
    contents.push_back(scene.nodes[n].part == kNone ? tree.groups[n + 1].content : c.parts[scene.nodes[n].part].ball);
  c.spaces = make_placed_spaces(scene, contents);
  c.longest_edge = c.world.longest_edge;
  c.largest_radius = c.world.largest_radius;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].part == kNone) continue;
    const SpaceExtent& space = c.parts[scene.nodes[n].part];
    const double stretch = c.spaces.instances[n].stretch;
    c.longest_edge = std::max(c.longest_edge, stretch * space.longest_edge);
    c.largest_radius = std::max(c.largest_radius, stretch * space.largest_radius);
    const double rounding = lateral_within(space, 4.0 * space.ball.radius, moved_error(space.ball), 0.0);
    c.local_rounding = std::max(c.local_rounding, stretch * rounding);
    if (!(space.smallest_radius > 0.0)) continue;
    c.local_amplified = std::max(c.local_amplified, 2.0 * rounding / space.smallest_radius);
    c.least_radius = std::min(c.least_radius, stretch * space.smallest_radius);
  }
  return c;
}

PlacedRay place_ray(const BoundsContext& c, const Ray& ray, std::uint32_t instance, std::uint32_t left) {
  return place_ray(c.spaces, *c.scene, c.world.ball, ray, instance, left);
}

PlacedRay blurred(const BoundsContext& c, PlacedRay ray, double blur) {
  if (!(blur > 0.0)) return ray;
  const double local = ray.instance == kNone ? blur : blur * c.spaces.instances[ray.instance].inverse_stretch;
  ray.origin_error += glm::dvec3(local);
  ray.is_exact = false;
  return ray;
}

ValueBounds value_bounds(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive, double t) {
  return c.scene->is_triangle(primitive) ? triangle_bounds(c, ray, primitive, t)
                                         : sphere_bounds(c, ray, c.scene->sphere(primitive), t);
}

ValueBounds least_value_bounds(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive, double t) {
  ValueBounds b;
  if (ray.instance != kNone || ray.moved_error > 0.0) return b;
  // Each is a part of the bound, with M >= |t d| for triangles (the hit lies between the corners), z likewise, and
  // every height at most sqrt(3) times the longest edge.
  const double way = std::abs(t) * ray.length;
  if (c.scene->is_triangle(primitive)) {
    b.t = 14.0 * u * std::abs(t) * kLess;
    b.position = 2.0 * u * way * kLess;
    b.normal = 12.0 * u * kLess;
    b.barycentrics = (6.0 * u * way / (kRootOf3 * c.longest_edge) + 6.0 * u) * kLess;
    b.barycentrics = std::min(b.barycentrics, kLess);
    return b;
  }
  const Sphere& sphere = c.scene->sphere(primitive);
  const double reach = glm::length(glm::dvec3(sphere.center) - ray.origin);
  b.t = (12.0 * u * reach / ray.length + 4.0 * u * std::abs(t)) * kLess;
  b.position = 16.0 * u * reach * kLess;
  b.normal = std::min(kMostApart, 16.0 * u * reach / sphere.radius + 4.0 * u) * kLess;
  return b;
}

double lateral_bound(const BoundsContext& c, const PlacedRay& ray, std::uint32_t primitive) {
  if (!c.scene->is_triangle(primitive)) {
    const Sphere& sphere = c.scene->sphere(primitive);
    return lateral_of(see_sphere(ray, sphere), sphere.radius);
  }
  double lateral = 0.0;
  for_each_sight(c, ray, primitive, [&](const Seen& s) { lateral = std::max(lateral, lateral_of(s)); });
  return lateral;
}

double lateral_bound_of_space(const BoundsContext& c, const PlacedRay& ray) {
  const SpaceExtent& space = c.extent_of(ray.instance);
  const double distance = glm::length(ray.origin - space.ball.center) + space.ball.radius;
  const double reach = std::min(distance + glm::length(ray.origin_error), 4.0 * space.ball.radius);
  // t abreast of anything in the ball, along the largest component.
  const double displaced = ray.is_exact ? 0.0 : glm::length(displacement(ray, kRootOf3 * distance / ray.length));
  return lateral_within(space, reach, ray.moved_error, displaced);
}

double lateral_bound_of_scene(const BoundsContext& c, const Ray& ray, std::uint32_t left) {
  const PlacedRay world = place_ray(c, ray, kNone, left);
  const double bound = lateral_bound_of_space(c, world);
  if (c.spaces.instances.empty()) return bound;
  // A corner that the ray comes near lies at most an edge aside of it, so t abreast of it is at most this far.
  const Ball& ball = c.world.ball;
  const double start = std::min(glm::length(world.origin - ball.center), 3.0 * ball.radius);  // far rays are moved
  const double distance = start + ball.radius + 4.0 * c.longest_edge + 4.0 * c.largest_radius;
  const double entering =
      c.spaces.entering_scale * (glm::length(ball.center) + start + distance) + c.spaces.entering_offset +
      c.spaces.carried * (moved_error(ball) + glm::length(displacement(world, distance / world.length)));
  return std::max(
      bound, entering * (2.0 + c.local_amplified + 8.0 * u * (1.0 + entering / c.least_radius)) + c.local_rounding);
}

}  // namespace plumbline
