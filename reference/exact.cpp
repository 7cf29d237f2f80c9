// SPDX-License-Identifier: GPL-3.0-or-later
// Exact decisions with CGAL's number types: Mpzf, exact dyadic numbers, for signs of polynomials; Gmpq, exact
// fractions, for values. Square roots are never taken for a sign: they are squared away.
#include "reference/exact.h"

#include <CGAL/Gmpq.h>
#include <CGAL/Mpzf.h>

#include <cmath>

#include "reference/formulas.h"
#include "reference/instance_map.h"
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

/// A number as an extended one and what that lacks, to 2^-120 of it.
struct TwoParts {
  BoundedT first;
  long double rest = 0.0L;
};

/// The quotient n / m, m > 0.
TwoParts extended(const Exact& n, const Exact& m) {
  const int sign = sign_of(n);
  if (sign == 0) return {BoundedT(0.0)};
  const Gmpq quotient = fraction(n) / fraction(m);
  mpz_t bits, denominator, rest;
  mpz_init(bits), mpz_init(denominator), mpz_init(rest);
  mpz_abs(bits, mpq_numref(quotient.mpq()));
  mpz_set(denominator, mpq_denref(quotient.mpq()));
  const auto length = [](const mpz_t& x) { return static_cast<long>(mpz_sizeinbase(x, 2)); };
  const long shift = 128 - length(bits) + length(denominator);
  if (shift > 0) mpz_mul_2exp(bits, bits, static_cast<mp_bitcnt_t>(shift));
  if (shift < 0) mpz_mul_2exp(denominator, denominator, static_cast<mp_bitcnt_t>(-shift));
  mpz_tdiv_qr(bits, rest, bits, denominator);  // 128 or 129 bits
  bool whole = mpz_sgn(rest) == 0;
  const long low_bits = length(bits) - 64;
  mpz_tdiv_r_2exp(rest, bits, static_cast<mp_bitcnt_t>(low_bits));
  mpz_tdiv_q_2exp(bits, bits, static_cast<mp_bitcnt_t>(low_bits));
  whole = whole && mpz_sgn(rest) == 0;
  mpz_tdiv_q_2exp(rest, rest, 1);  // at most 64 bits
  const auto number = [&](const mpz_t& x, long exponent) {
    return static_cast<long double>(sign) *
           std::ldexp(static_cast<long double>(mpz_get_ui(x)), static_cast<int>(exponent));
  };
  const long double first = number(bits, low_bits - shift);
  const TwoParts parts{{first, whole ? 0.0L : std::fabs(first) * 0x1p-63L}, number(rest, 1 - shift)};
  mpz_clear(bits), mpz_clear(denominator), mpz_clear(rest);
  return parts;
}

struct ExactMap {
  std::array<Vec<Exact>, 3> linear;  ///< rows
  Vec<Exact> translation;
};

ExactMap exact_map(const Transform& transform) {
  ExactMap map;
  for (int row = 0; row < 3; ++row) {
    const glm::mat3& m = transform.linear;
    map.linear[static_cast<std::size_t>(row)] = vec<Exact>({m[0][row], m[1][row], m[2][row]});
  }
  map.translation = vec<Exact>(glm::dvec3(transform.translation));
  return map;
}

Vec<Exact> times(const std::array<Vec<Exact>, 3>& rows, const Vec<Exact>& v) {
  return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
}
std::array<Vec<Exact>, 3> transposed(const std::array<Vec<Exact>, 3>& rows) {
  const auto& [a, b, c] = rows;
  return {Vec<Exact>{a.x, b.x, c.x}, Vec<Exact>{a.y, b.y, c.y}, Vec<Exact>{a.z, b.z, c.z}};
}

ExactMap exact_map(std::span<const Transform> chain) {
  PLUMBLINE_ASSERT(!chain.empty());
  ExactMap map = exact_map(chain.front());
  for (const Transform& transform : chain.subspan(1)) {
    const ExactMap inner = exact_map(transform);
    map.translation = times(map.linear, inner.translation) + map.translation;
    const auto columns = transposed(inner.linear);
    for (Vec<Exact>& row : map.linear) row = {dot(row, columns[0]), dot(row, columns[1]), dot(row, columns[2])};
  }
  return map;
}

/// L^-1 = rows / scale, scale > 0.
struct ExactInverse {
  std::array<Vec<Exact>, 3> rows;
  Exact scale;
};

ExactInverse inverse_of(const std::array<Vec<Exact>, 3>& linear) {
  // The adjugate's columns are cross products of the rows.
  const auto& [a, b, c] = linear;
  ExactInverse inverse{transposed({cross(b, c), cross(c, a), cross(a, b)}), dot(a, cross(b, c))};
  const int sign = sign_of(inverse.scale);
  PLUMBLINE_ASSERT(sign != 0);
  if (sign > 0) return inverse;
  inverse.scale = -inverse.scale;
  for (Vec<Exact>& row : inverse.rows) row = {-row.x, -row.y, -row.z};
  return inverse;
}

}  // namespace

struct ExactLine::Impl {
  Line world;
  LineOf<Exact> line;                 ///< of the space, from the world line's point, in its units
  std::array<Vec<Exact>, 3> inverse;  ///< rows of L^-1 times line.scale; meaningless in the world
  Exact shift;                        ///< of the world's line: t = (shift + s) * world.unit
};

ExactLine::ExactLine(const Line& world) : impl_(std::make_unique<Impl>()) {
  impl_->world = world;
  impl_->line.point = vec<Exact>(world.point) + vec<Exact>(world.rest);
  impl_->line.direction = vec<Exact>(world.direction);
  impl_->shift = Exact(world.shift);
}

ExactLine::ExactLine(const Line& world, std::span<const Transform> chain) : ExactLine(world) {
  const ExactMap map = exact_map(chain);
  const ExactInverse inverse = inverse_of(map.linear);
  LineOf<Exact>& line = impl_->line;
  line.point = times(inverse.rows, line.point - map.translation);
  line.direction = times(inverse.rows, line.direction);
  line.scale = inverse.scale;
  line.has_scale = true;
  impl_->inverse = inverse.rows;
}

ExactLine::~ExactLine() = default;
ExactLine::ExactLine(ExactLine&&) noexcept = default;
ExactLine& ExactLine::operator=(ExactLine&&) noexcept = default;

namespace {

/// s of a meeting as (base + root_factor sqrt(radicand)) / divisor, divisor > 0.
struct Meeting {
  Exact base, root_factor, radicand, divisor;
};

Meeting meeting(const ExactLine& line, const Solid& solid, Root root) {
  if (solid.is_sphere) {
    const auto terms = sphere_terms(line->line, solid.corners[0], solid.radius);
    PLUMBLINE_ASSERT(sign_of(terms.discriminant) >= 0);
    return {terms.middle, Exact(root == Root::enter ? -1.0 : 1.0), terms.discriminant, terms.length2};
  }
  const auto terms = plane_terms(line->line, solid.corners);
  PLUMBLINE_ASSERT(sign_of(terms.determinant) != 0);
  if (sign_of(terms.determinant) > 0) return {terms.numerator, Exact(0.0), Exact(0.0), terms.determinant};
  return {-Exact(terms.numerator), Exact(0.0), Exact(0.0), -Exact(terms.determinant)};
}

/// t from the ray's origin, in units of the world line's direction.
Gmpq value_of(const ExactLine& line, const Meeting& m) {
  return surd_value(m.base + line->shift * m.divisor, m.root_factor, m.radicand, m.divisor);
}

double length_of(const Vec<Exact>& v, const Exact& divisor2) {
  return nearest_double(root_of(fraction(dot(v, v)) / fraction(divisor2)));
}

/// `v` of the instance's space in the world, of unit length.
glm::dvec3 unit_normal(const ExactLine& line, const std::array<Gmpq, 3>& v) {
  std::array<Gmpq, 3> n = v;
  if (line->line.has_scale) {
    const auto& [a, b, c] = line->inverse;
    n[0] = fraction(a.x) * v[0] + fraction(b.x) * v[1] + fraction(c.x) * v[2];
    n[1] = fraction(a.y) * v[0] + fraction(b.y) * v[1] + fraction(c.y) * v[2];
    n[2] = fraction(a.z) * v[0] + fraction(b.z) * v[1] + fraction(c.z) * v[2];
  }
  const Gmpq length = root_of(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return {nearest_double(n[0] / length), nearest_double(n[1] / length), nearest_double(n[2] / length)};
}

}  // namespace

InstanceMap instance_map(const Scene& scene, std::uint32_t instance) {
  PLUMBLINE_ASSERT(instance < scene.nodes.size() && scene.nodes[instance].part != kNone);
  InstanceMap result;
  result.instance = instance;
  result.part = scene.nodes[instance].part;
  for (const std::uint32_t node : chain_of(scene, instance)) result.chain.push_back(scene.nodes[node].transform);
  const ExactMap map = exact_map(result.chain);
  const ExactInverse inverse = inverse_of(map.linear);
  const Exact one(1.0);
  const auto round = [](const Vec<Exact>& v, const Exact& divisor, Vec<BoundedT>& first, Vec<long double>& rest) {
    const TwoParts x = extended(v.x, divisor), y = extended(v.y, divisor), z = extended(v.z, divisor);
    first = {x.first, y.first, z.first};
    rest = {x.rest, y.rest, z.rest};
    return glm::dvec3(static_cast<double>(x.first.value), static_cast<double>(y.first.value),
                      static_cast<double>(z.first.value));
  };
  result.to_world.translation = round(map.translation, one, result.translation, result.translation_rest);
  for (std::size_t row = 0; row < 3; ++row) {
    round(inverse.rows[row], inverse.scale, result.inverse_rows[row], result.inverse_rest[row]);
    Vec<BoundedT> first;
    Vec<long double> rest;
    const glm::dvec3 linear = round(map.linear[row], one, first, rest);
    for (int column = 0; column < 3; ++column) result.to_world.linear[column][static_cast<int>(row)] = linear[column];
  }
  return result;
}

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

int exact_edge_sign(const ExactLine& line, const glm::vec3& from, const glm::vec3& to) {
  return sign_of(edge_moment(line->line, from, to));
}

int exact_facing(const ExactLine& line, const Solid& triangle) {
  return sign_of(plane_terms(line->line, triangle.corners).determinant);
}

bool exact_in_plane(const ExactLine& line, const Solid& triangle) {
  // Without area the normal is zero, and so are both.
  const auto terms = plane_terms(line->line, triangle.corners);
  return sign_of(terms.determinant) == 0 && sign_of(terms.numerator) == 0;
}

int exact_sphere_side(const ExactLine& line, const Solid& sphere) {
  return sign_of(sphere_terms(line->line, sphere.corners[0], sphere.radius).discriminant);
}

double exact_segment_distance(const ExactLine& line, const glm::vec3& from, const glm::vec3& to) {
  const Vec<Exact>&d = line->line.direction, a = line->line.see(from), b = line->line.see(to);
  // Seen along the line, rotated by a right angle and scaled by |d|, and twice by the line's scale.
  const auto start = cross(d, a), end = cross(d, b), edge = end - start;
  const Exact plain2 = dot(d, d), &scale = line->line.scale;
  const Exact length2 = line->line.has_scale ? Exact(plain2 * scale * scale) : plain2;
  if (sign_of(dot(start, edge)) >= 0) return length_of(start, length2);
  if (sign_of(dot(end, edge)) <= 0) return length_of(end, length2);
  const Exact moment = edge_moment(line->line, from, to);
  return nearest_double(root_of(fraction(moment * moment) / fraction(dot(edge, edge))));
}

double exact_sphere_distance(const ExactLine& line, const Solid& sphere) {
  // |r - l| = |r^2 - l^2| / (r + l) with l^2 = |m x d|^2 / d.d
  const auto terms = sphere_terms(line->line, sphere.corners[0], sphere.radius);
  const Exact& scale = line->line.scale;
  const Exact length2 = line->line.has_scale ? Exact(terms.length2 * scale * scale) : terms.length2;
  const Gmpq radius(static_cast<double>(sphere.radius));
  const Gmpq difference = fraction(terms.discriminant) / fraction(length2);
  return std::fabs(nearest_double(difference / (radius + root_of(radius * radius - difference))));
}

int exact_compare_t(const ExactLine& line, const Solid& solid, Root root, double limit) {
  const Meeting m = meeting(line, solid, root);
  const Exact in_units = Exact(limit) * Exact(1.0 / line->world.unit);
  return sign_of_surd(m.base + (line->shift - in_units) * m.divisor, m.root_factor, m.radicand);
}

int exact_compare_t(const ExactLine& line_a, const Solid& a, Root root_a, const ExactLine& line_b, const Solid& b,
                    Root root_b) {
  const Meeting ma = meeting(line_a, a, root_a), mb = meeting(line_b, b, root_b);
  if (&*line_a == &*line_b && a.is_sphere && b.is_sphere) {  // the divisor is d.d in both
    return sign_of_two_surds(ma.base - mb.base, ma.root_factor, ma.radicand, root_b == Root::enter ? -1 : 1,
                             mb.radicand);
  }
  // s is the same in all spaces.
  const Exact difference = ma.base * mb.divisor - mb.base * ma.divisor;
  if (!b.is_sphere) return sign_of_surd(difference, ma.root_factor * mb.divisor, ma.radicand);
  if (!a.is_sphere) return sign_of_surd(difference, -Exact(mb.root_factor * ma.divisor), mb.radicand);
  return sign_of_two_surds(difference, ma.root_factor * mb.divisor, ma.radicand, root_b == Root::enter ? -1 : 1,
                           ma.divisor * ma.divisor * mb.radicand);
}

double exact_t(const ExactLine& line, const Solid& solid, Root root) {
  return nearest_double(value_of(line, meeting(line, solid, root))) * line->world.unit;
}

ReferenceHit exact_values_at(const ExactLine& line, const Solid& solid, Root root) {
  ReferenceHit hit;
  hit.kind = HitKind::hit;
  const Meeting m = meeting(line, solid, root);
  hit.t = nearest_double(value_of(line, m)) * line->world.unit;
  const auto on_line = [&](const Exact& from, const Exact& slope, const Exact& divisor) {
    return surd_value(from * m.divisor + slope * m.base, slope * m.root_factor, m.radicand, divisor);
  };
  const auto d = vec<Exact>(line->world.direction),
             point = vec<Exact>(line->world.point) + vec<Exact>(line->world.rest);
  hit.position = {nearest_double(on_line(point.x, d.x, m.divisor)), nearest_double(on_line(point.y, d.y, m.divisor)),
                  nearest_double(on_line(point.z, d.z, m.divisor))};
  if (solid.is_sphere) {
    const Vec<Exact> center = line->line.see(solid.corners[0]), &direction = line->line.direction;
    if (!line->line.has_scale) {  // the length is known
      const Exact divisor = m.divisor * Exact(static_cast<double>(solid.radius));
      hit.normal = {nearest_double(on_line(-Exact(center.x), direction.x, divisor)),
                    nearest_double(on_line(-Exact(center.y), direction.y, divisor)),
                    nearest_double(on_line(-Exact(center.z), direction.z, divisor))};
      return hit;
    }
    hit.normal = unit_normal(
        line, {on_line(-Exact(center.x), direction.x, m.divisor), on_line(-Exact(center.y), direction.y, m.divisor),
               on_line(-Exact(center.z), direction.z, m.divisor)});
    return hit;
  }
  const auto& [v0, v1, v2] = solid.corners;
  const auto terms = plane_terms(line->line, solid.corners);
  hit.normal = unit_normal(line, {fraction(terms.normal.x), fraction(terms.normal.y), fraction(terms.normal.z)});
  const Gmpq determinant =
      line->line.has_scale ? fraction(terms.determinant * line->line.scale) : fraction(terms.determinant);
  hit.barycentrics = {nearest_double(fraction(edge_moment(line->line, v2, v0)) / determinant),
                      nearest_double(fraction(edge_moment(line->line, v0, v1)) / determinant)};
  return hit;
}

}  // namespace plumbline
