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
// lateral: |f| is compared with r:  D / r, and 4uM + sqrt... is not needed, for r + |f| >= r:  |r - |f|| <= D / (r +
// |f|) <= D / r.
#include "harness/bounds.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plumbline {
namespace {

constexpr double u = 0x1p-24;
/// What gradual underflow, flushed to zero, may take from one product of scaled coordinates: relative to the scene's
/// radius squared.
constexpr double kUnderflow = 0x1p-80;

/// What flushing denormal coordinates to zero may move a point by.
constexpr double kFlush = 0x1p-123;

/// The tracer moves an origin that is farther than this many radii from the ball's centre.
constexpr double kNear = 1.999;  ///< it decides in floats: a ray that is near by a hair may have been moved

bool is_moved(const BoundsContext& c, const Ray& ray) {
  return !(glm::length(glm::dvec3(ray.origin) - c.ball.center) <= kNear * c.ball.radius);
}
/// What the rounding of a moved origin comes to: 4uN.
double moved_error(const BoundsContext& c) { return 4.0 * u * (glm::length(c.ball.center) + 3.0 * c.ball.radius); }

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
  double moved = 0.0;  ///< 4uN, or 0
  double delta = 0.0;
};

Seen see(const BoundsContext& c, const Ray& ray, std::uint32_t primitive) {
  Seen s;
  const glm::dvec3 d(ray.direction);
  // The tracer's choice, between equal components too: along which axis z runs decides how z and weights share the
  // error.
  const glm::dvec3 size = glm::abs(d);
  const int kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  s.inverse_dz = 1.0 / d[kz];
  const double sx = d[kx] * s.inverse_dz, sy = d[ky] * s.inverse_dz;
  const auto corners = c.scene->corners(primitive);
  const bool moved = is_moved(c, ray);
  double z_min = 0.0, z_top = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - glm::dvec3(ray.origin);
    s.x[i] = a[kx] - sx * a[kz];
    s.y[i] = a[ky] - sy * a[kz];
    s.z[i] = a[kz];
    s.reach = std::max(s.reach, glm::length(a));
    s.extent = std::max(s.extent, std::sqrt(s.x[i] * s.x[i] + s.y[i] * s.y[i]));
    z_min = i ? std::min(z_min, s.z[i]) : s.z[i];
    z_top = i ? std::max(z_top, s.z[i]) : s.z[i];
  }
  if (moved) s.reach = std::min(s.reach, 4.0 * c.ball.radius);
  s.z_range = z_top - z_min;
  s.z_max = moved ? s.reach : std::max(std::abs(z_min), std::abs(z_top));
  s.shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double ex = s.x[j] - s.x[i], ey = s.y[j] - s.y[i];
    const double e = std::sqrt(ex * ex + ey * ey);
    s.opposite[(i + 2) % 3] = e;
    s.shortest = std::min(s.shortest, e);
  }
  s.det = std::abs((s.x[1] - s.x[0]) * (s.y[2] - s.y[0]) - (s.y[1] - s.y[0]) * (s.x[2] - s.x[0]));
  s.moved = moved ? moved_error(c) : 0.0;
  s.delta = 6.0 * u * s.reach + s.moved + kFlush;
  return s;
}

double lateral_of(const Seen& s) {
  return s.delta + 2.0 * u * s.extent * s.extent / std::max(s.shortest, 0x1p-9 * s.extent);
}

/// A sphere as the tracer sees it along the ray, in double.
struct SeenSphere {
  double reach = 0.0;   ///< M
  double off = 0.0;     ///< |f|
  double length = 0.0;  ///< |d|
  double moved = 0.0;   ///< 4uN, or 0
  double error = 0.0;   ///< D
};

SeenSphere see_sphere(const BoundsContext& c, const Ray& ray, const Sphere& sphere) {
  SeenSphere s;
  const glm::dvec3 d(ray.direction), m = glm::dvec3(sphere.center) - glm::dvec3(ray.origin);
  s.length = glm::length(d);
  const glm::dvec3 n = d / s.length;
  s.off = glm::length(m - glm::dot(m, n) * n);
  s.reach = glm::length(m);
  if (is_moved(c, ray)) {
    s.reach = std::min(s.reach, 4.0 * c.ball.radius);
    s.moved = moved_error(c);
  }
  const double r = sphere.radius, lateral = 4.0 * u * s.reach + s.moved + kFlush;
  const double second_order = 14.0 * u * s.reach + s.moved;
  s.error = 2.0 * s.off * lateral + second_order * second_order + 4.0 * u * s.off * s.off + 3.0 * u * r * r;
  return s;
}

}  // namespace

BoundsContext make_bounds_context(const Scene& scene) {
  BoundsContext c{&scene, bounding_ball(scene)};
  for (std::uint32_t p = 0; p < scene.triangles.size(); ++p) {
    const auto v = scene.corners(p);
    for (int i = 0; i < 3; ++i)
      c.longest_edge = std::max(c.longest_edge, glm::length(glm::dvec3(v[(i + 1) % 3]) - glm::dvec3(v[i])));
  }
  for (const Sphere& s : scene.spheres) c.largest_radius = std::max<double>(c.largest_radius, s.radius);
  for (const Sphere& s : scene.spheres)
    c.smallest_radius = c.smallest_radius > 0.0 ? std::min<double>(c.smallest_radius, s.radius) : s.radius;
  return c;
}

ValueBounds value_bounds(const BoundsContext& c, const Ray& ray, std::uint32_t primitive, double t) {
  ValueBounds b;
  if (!c.scene->is_triangle(primitive)) {
    const Sphere& sphere = c.scene->sphere(primitive);
    const SeenSphere s = see_sphere(c, ray, sphere);
    const double r = sphere.radius;
    const double h = std::sqrt(std::max(0.0, r * r - s.off * s.off));
    const double dh = (h > 0.0 ? std::min(s.error / h, std::sqrt(s.error)) : std::sqrt(s.error)) + 2.0 * u * h;
    const double along = 12.0 * u * s.reach + s.moved + dh + kFlush;
    const double largest = glm::length(glm::dvec3(sphere.center)) + r;
    b.t = (along + 4.0 * u * std::abs(t) * s.length) / s.length;
    b.position = along + 4.0 * u * s.reach + s.moved + 2.0 * u * largest;
    b.normal = std::min(2.0, b.position / r + 4.0 * u);
    return b;
  }
  const Seen s = see(c, ray, primitive);
  const auto v = c.scene->corners(primitive);
  const glm::dvec3 e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]), e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
  const double l1 = glm::length(e1), l2 = glm::length(e2), l3 = glm::length(e2 - e1);
  const double longest = std::max({l1, l2, l3});
  const double largest =
      std::max({glm::length(glm::dvec3(v[0])), glm::length(glm::dvec3(v[1])), glm::length(glm::dvec3(v[2]))});
  const double rho = std::min(4.0 * u * s.extent * s.extent / s.det, 0x1p11 * u) + 6.0 * u +
                     kUnderflow * c.ball.radius * c.ball.radius / s.det;
  const auto weight = [&](int i) {
    return std::min(1.0, s.delta * s.opposite[i] / s.det + rho);
  };  // det may be 0: then 1
  const double w0 = weight(0), w1 = weight(1), w2 = weight(2);
  b.barycentrics = std::max({w0, w1, w2});
  const double dz = std::min(w1 * std::abs(s.z[1] - s.z[0]) + w2 * std::abs(s.z[2] - s.z[0]), s.z_range) +
                    10.0 * u * s.z_max + s.moved + kFlush;
  b.t = dz * std::abs(s.inverse_dz) + 4.0 * u * std::abs(t);
  b.position = std::min(w1 * l1 + w2 * l2, longest) + 12.0 * u * largest + 2.0 * u * s.reach + s.moved + kFlush;
  const double cross = glm::length(glm::cross(e1, e2));
  b.normal = cross > 0.0 ? std::min(2.0, 8.0 * u * l1 * l2 / cross + 4.0 * u) : 2.0;
  return b;
}

double lateral_bound(const BoundsContext& c, const Ray& ray, std::uint32_t primitive) {
  if (c.scene->is_triangle(primitive)) return lateral_of(see(c, ray, primitive));
  const Sphere& sphere = c.scene->sphere(primitive);
  return see_sphere(c, ray, sphere).error / sphere.radius;
}

double lateral_bound_of_scene(const BoundsContext& c, const Ray& ray) {
  const double distance = glm::length(glm::dvec3(ray.origin) - c.ball.center) + c.ball.radius;
  const double reach = std::min(distance, 4.0 * c.ball.radius) + kFlush / u;
  // Triangles: as seen along the ray the extent is at most sqrt(3) times the longest edge and the bound; the term for
  // zeros is at most 2^10 uL.
  const double moved = is_moved(c, ray) ? moved_error(c) : 0.0;
  const double triangles = 6.0 * u * reach + moved + 0x1p10 * u * 2.0 * c.longest_edge;
  // Spheres: see_sphere with |f| about r.
  const double spheres = c.smallest_radius > 0.0 ? 24.0 * u * reach + 2.0 * moved +
                                                       std::pow(18.0 * u * reach + moved, 2) / c.smallest_radius
                                                 : 0.0;
  return std::max(triangles, spheres);
}

}  // namespace plumbline
