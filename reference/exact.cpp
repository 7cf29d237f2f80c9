// SPDX-License-Identifier: GPL-3.0-or-later
// Exact decisions with CGAL's number types: Mpzf, exact dyadic numbers, for signs of polynomials; Gmpq, exact
// fractions, for values. Square roots are never taken for a sign: they are squared away.
#include "reference/exact.h"

#include <CGAL/Gmpq.h>
#include <CGAL/Mpzf.h>

#include <cmath>

#include "reference/formulas.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

using CGAL::Gmpq;
using CGAL::Mpzf;
using Exact = Mpzf;

int sign_of(const Exact& x) { return static_cast<int>(x.sign()); }

int compare(const Exact& a, const Exact& b) { return a < b ? -1 : b < a ? 1 : 0; }

/// The sign of p + q sqrt(d), d >= 0.
int sign_of_surd(const Exact& p, const Exact& q, const Exact& d) {
  const int sign_p = sign_of(p), sign_root = sign_of(q) * sign_of(d);
  if (sign_root == 0 || sign_p == sign_root) return sign_p;
  if (sign_p == 0) return sign_root;
  return sign_p * compare(p * p, q * q * d);
}

/// The sign of p + q sqrt(d) - r sqrt(e), d and e >= 0, r of sign 1 or -1 only.
int sign_of_two_surds(const Exact& p, const Exact& q, const Exact& d, int r, const Exact& e) {
  const int left = sign_of_surd(p, q, d), right = r * sign_of(e);
  if (left != right) return left < right ? -1 : 1;
  if (left == 0) return 0;
  // Both sides have the same sign: compare their squares, (p^2 + q^2 d - e) + 2 p q sqrt(d).
  return left * sign_of_surd(p * p + q * q * d - e, p * q + p * q, d);
}

/// s of a meeting as (base + root_factor sqrt(radicand)) / divisor, divisor > 0.
struct Meeting {
  Exact base, root_factor, radicand, divisor;
};

Meeting meeting(const Line& line, const Solid& solid, Root root) {
  if (solid.is_sphere) {
    const auto terms = sphere_terms<Exact>(line, solid.corners[0], solid.radius);
    PLUMBLINE_ASSERT(sign_of(terms.discriminant) >= 0);
    return {terms.middle, Exact(root == Root::enter ? -1.0 : 1.0), terms.discriminant, terms.length2};
  }
  const auto terms = plane_terms<Exact>(line, solid.corners);
  PLUMBLINE_ASSERT(sign_of(terms.determinant) != 0);
  if (sign_of(terms.determinant) > 0) return {terms.numerator, Exact(0.0), Exact(0.0), terms.determinant};
  return {-Exact(terms.numerator), Exact(0.0), Exact(0.0), -Exact(terms.determinant)};
}

/// The nearest double. Its exponent must be that of a normal double, or the number zero.
double nearest_double(const Gmpq& x) {
  const int sign = static_cast<int>(CGAL::sign(x));
  if (sign == 0) return 0.0;
  mpz_t numerator, denominator, remainder;
  mpz_init(numerator), mpz_init(denominator), mpz_init(remainder);
  mpz_abs(numerator, mpq_numref(x.mpq()));
  mpz_set(denominator, mpq_denref(x.mpq()));
  // A quotient of 64 or 65 bits, its last bit set where the rest is not zero, rounds as the fraction does.
  const long shift =
      65 - static_cast<long>(mpz_sizeinbase(numerator, 2)) + static_cast<long>(mpz_sizeinbase(denominator, 2));
  if (shift > 0) mpz_mul_2exp(numerator, numerator, static_cast<mp_bitcnt_t>(shift));
  if (shift < 0) mpz_mul_2exp(denominator, denominator, static_cast<mp_bitcnt_t>(-shift));
  mpz_tdiv_qr(numerator, remainder, numerator, denominator);
  if (mpz_sgn(remainder) != 0) mpz_setbit(numerator, 0);
  mpz_tdiv_q_2exp(remainder, numerator, 33);
  mpz_tdiv_r_2exp(numerator, numerator, 33);
  // Both parts are exact doubles, so their sum is rounded once.
  const double rounded =
      static_cast<double>(mpz_get_ui(remainder)) * 0x1p33 + static_cast<double>(mpz_get_ui(numerator));
  mpz_clear(numerator), mpz_clear(denominator), mpz_clear(remainder);
  return sign * std::ldexp(rounded, static_cast<int>(-shift));
}

/// The square root of x >= 0 to a relative 2^-128.
Gmpq root_of(const Gmpq& x) {
  if (CGAL::sign(x) == CGAL::ZERO) return Gmpq(0);
  // sqrt(n / m) = sqrt(n m 4^k) / (m 2^k), with k so large that the integer root has at least 130 bits.
  Gmpq result;
  mpz_ptr numerator = mpq_numref(result.mpq()), denominator = mpq_denref(result.mpq());
  mpz_mul(numerator, mpq_numref(x.mpq()), mpq_denref(x.mpq()));
  const long bits = static_cast<long>(mpz_sizeinbase(numerator, 2));
  const mp_bitcnt_t k = bits < 262 ? static_cast<mp_bitcnt_t>((262 - bits + 1) / 2) : 0;
  mpz_mul_2exp(numerator, numerator, 2 * k);
  mpz_sqrt(numerator, numerator);
  mpz_mul_2exp(denominator, mpq_denref(x.mpq()), k);
  mpq_canonicalize(result.mpq());
  return result;
}

Gmpq fraction(const Exact& x) { return Gmpq(x); }

/// (p + q sqrt(d)) / divisor, without loss where the two terms cancel.
Gmpq surd_value(const Exact& p, const Exact& q, const Exact& d, const Exact& divisor) {
  const int sign_root = sign_of(q) * sign_of(d), sign_p = sign_of(p);
  if (sign_root == 0) return fraction(p) / fraction(divisor);
  const Gmpq root = root_of(fraction(q * q * d)) * Gmpq(sign_root);
  if (sign_p * sign_root >= 0) return (fraction(p) + root) / fraction(divisor);
  return fraction(p * p - q * q * d) / ((fraction(p) - root) * fraction(divisor));
}

}  // namespace

Solid solid_of(const Scene& scene, std::uint32_t primitive) {
  Solid solid;
  solid.is_sphere = !scene.is_triangle(primitive);
  if (solid.is_sphere) {
    solid.corners[0] = scene.sphere(primitive).center;
    solid.radius = scene.sphere(primitive).radius;
  } else {
    solid.corners = scene.corners(primitive);
  }
  return solid;
}

int exact_edge_sign(const Line& line, const glm::vec3& from, const glm::vec3& to) {
  return sign_of(edge_moment<Exact>(line, from, to));
}

int exact_facing(const Line& line, const Solid& triangle) {
  return sign_of(plane_terms<Exact>(line, triangle.corners).determinant);
}

bool exact_in_plane(const Line& line, const Solid& triangle) {
  // Without area the normal is zero, and so are both.
  const auto terms = plane_terms<Exact>(line, triangle.corners);
  return sign_of(terms.determinant) == 0 && sign_of(terms.numerator) == 0;
}

int exact_sphere_side(const Line& line, const Solid& sphere) {
  return sign_of(sphere_terms<Exact>(line, sphere.corners[0], sphere.radius).discriminant);
}

double exact_segment_distance(const Line& line, const glm::vec3& from, const glm::vec3& to) {
  const auto d = vec<Exact>(line.direction), a = from_line<Exact>(line, from), b = from_line<Exact>(line, to);
  // Seen along the line, rotated by a right angle and scaled by |d|.
  const auto start = cross(d, a), end = cross(d, b), edge = end - start;
  const Exact length2 = dot(d, d);
  const auto length = [&](const Vec<Exact>& v) {
    return nearest_double(root_of(fraction(dot(v, v)) / fraction(length2)));
  };
  if (sign_of(dot(start, edge)) >= 0) return length(start);
  if (sign_of(dot(end, edge)) <= 0) return length(end);
  const Exact moment = edge_moment<Exact>(line, from, to);
  return nearest_double(root_of(fraction(moment * moment) / fraction(dot(edge, edge))));
}

double exact_sphere_distance(const Line& line, const Solid& sphere) {
  // |r - l| = |r^2 - l^2| / (r + l) with l^2 = |m x d|^2 / d.d
  const auto terms = sphere_terms<Exact>(line, sphere.corners[0], sphere.radius);
  const Gmpq radius(static_cast<double>(sphere.radius));
  const Gmpq difference = fraction(terms.discriminant) / fraction(terms.length2);
  return std::fabs(nearest_double(difference / (radius + root_of(radius * radius - difference))));
}

int exact_compare_t(const Line& line, const Solid& solid, Root root, double limit) {
  const Meeting m = meeting(line, solid, root);
  return sign_of_surd(m.base + (Exact(line.shift) - Exact(limit)) * m.divisor, m.root_factor, m.radicand);
}

int exact_compare_t(const Line& line, const Solid& a, Root root_a, const Solid& b, Root root_b) {
  const Meeting ma = meeting(line, a, root_a), mb = meeting(line, b, root_b);
  if (a.is_sphere && b.is_sphere) {  // the divisor is d.d in both
    return sign_of_two_surds(ma.base - mb.base, ma.root_factor, ma.radicand, root_b == Root::enter ? -1 : 1,
                             mb.radicand);
  }
  // At most one of them has a root.
  const Exact difference = ma.base * mb.divisor - mb.base * ma.divisor;
  if (a.is_sphere) return sign_of_surd(difference, ma.root_factor * mb.divisor, ma.radicand);
  return sign_of_surd(difference, -Exact(mb.root_factor * ma.divisor), mb.radicand);
}

double exact_t(const Line& line, const Solid& solid, Root root) {
  const Meeting m = meeting(line, solid, root);
  return nearest_double(surd_value(m.base + Exact(line.shift) * m.divisor, m.root_factor, m.radicand, m.divisor)) *
         line.unit;
}

ReferenceHit exact_values_at(const Line& line, const Solid& solid, Root root) {
  ReferenceHit hit;
  hit.kind = HitKind::hit;
  const Meeting m = meeting(line, solid, root);
  const auto d = vec<Exact>(line.direction), point = vec<Exact>(line.point) + vec<Exact>(line.rest);
  hit.t = nearest_double(surd_value(m.base + Exact(line.shift) * m.divisor, m.root_factor, m.radicand, m.divisor)) *
          line.unit;
  const auto on_line = [&](const Exact& from, const Exact& slope, const Exact& divisor) {
    return nearest_double(surd_value(from * m.divisor + slope * m.base, slope * m.root_factor, m.radicand, divisor));
  };
  hit.position = {on_line(point.x, d.x, m.divisor), on_line(point.y, d.y, m.divisor), on_line(point.z, d.z, m.divisor)};
  if (solid.is_sphere) {
    const auto from_center = vec<Exact>(glm::dvec3(0.0)) - from_line<Exact>(line, solid.corners[0]);
    const Exact divisor = m.divisor * Exact(static_cast<double>(solid.radius));
    hit.normal = {on_line(from_center.x, d.x, divisor), on_line(from_center.y, d.y, divisor),
                  on_line(from_center.z, d.z, divisor)};
    return hit;
  }
  const auto& [v0, v1, v2] = solid.corners;
  const auto terms = plane_terms<Exact>(line, solid.corners);
  const Gmpq length = root_of(fraction(dot(terms.normal, terms.normal)));
  hit.normal = {nearest_double(fraction(terms.normal.x) / length), nearest_double(fraction(terms.normal.y) / length),
                nearest_double(fraction(terms.normal.z) / length)};
  const Gmpq determinant = fraction(terms.determinant);
  hit.barycentrics = {nearest_double(fraction(edge_moment<Exact>(line, v2, v0)) / determinant),
                      nearest_double(fraction(edge_moment<Exact>(line, v0, v1)) / determinant)};
  return hit;
}

}  // namespace plumbline
