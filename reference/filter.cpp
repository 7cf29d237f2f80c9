// SPDX-License-Identifier: GPL-3.0-or-later
// The filters before exact arithmetic, each with the derivation of its error bound.
#include "reference/filter.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;

double largest(const glm::dvec3& v) { return std::fmax(std::fmax(std::fabs(v.x), std::fabs(v.y)), std::fabs(v.z)); }

/// `v` as seen from the line's point; off by at most u (2 |result| + |rest|) in each component.
glm::dvec3 seen_from(const Line& line, const glm::vec3& v) { return (glm::dvec3(v) - line.point) - line.rest; }

}  // namespace

const ExactLine& Filter::exact() {
  if (!exact_) exact_ = map_ == nullptr ? ExactLine(world_) : ExactLine(world_, map_->chain);
  return *exact_;
}

void Filter::set_slacks() {
  moment_slope_ = 104.0 * kUnit + 8.0 * line_.direction_error;
  moment_slack_ = 104.0 * kUnit * largest(line_.rest) + 14.0 * line_.point_error;
}

TrianglePass Filter::pass_triangle(const Solid& triangle) {
  const glm::dvec3& d = line_.direction;
  std::array<int, 3> side;
  // Moments E = (d x a) . e in double. With every |d_k| <= 2, A = max |a_k|, X = max |e_k|:
  //   a is off by u (2 A + rest), e by u X;
  //   d x a has components below 4 A, off by 4 u (2 A + rest) + 8 u A (two products, one difference) = 16 u A + 4 u
  //   rest; E is off by 3 X (16 u A + 4 u rest) + 12 A u X, and by its own 3 products and 2 sums, at most 36 u A X: 96
  //   u A X + 12 u rest X in all. 104 leaves room for the terms in u^2 and the roundings of the bound itself.
  // A line that is itself off by p in its point and by q < 2^-10 in its direction, in each component, adds:
  //   to d x a 2 (2 p + q (A + p)), to E 3 X times that, 6 q A X + 12.1 p X: 8 and 14 leave room likewise.
  for (int i = 0; i < 3; ++i) {
    const glm::vec3 &from = triangle.corners[i], &to = triangle.corners[i == 2 ? 0 : i + 1];
    const glm::dvec3 a = seen_from(line_, from), e = glm::dvec3(to) - glm::dvec3(from);
    const double moment = glm::dot(glm::cross(d, a), e);
    const double error = (moment_slope_ * largest(a) + moment_slack_) * largest(e);
    side[i] = moment > error ? 1 : moment < -error ? -1 : 0;
  }
  const auto shows = [&](int sign) { return side[0] == sign || side[1] == sign || side[2] == sign; };
  if (!(shows(1) && shows(-1))) {
    for (int i = 0; i < 3; ++i) {
      if (side[i] != 0) continue;
      side[i] = exact_edge_sign(decide_exactly(), triangle.corners[i], triangle.corners[(i + 1) % 3]);
      if (shows(1) && shows(-1)) break;
    }
  }
  const bool beside = shows(1) && shows(-1);
  return {!beside && (shows(1) || shows(-1)), beside};
}

int Filter::facing(const Solid& triangle) {
  const int sign =
      with_bounded([&](const auto& line) { return plane_terms(line, triangle.corners).determinant.sign(); });
  if (sign != 0) return sign;
  return exact_facing(decide_exactly(), triangle);
}

bool Filter::in_plane(const Solid& triangle) {
  const bool outside = with_bounded([&](const auto& line) {
    const auto terms = plane_terms(line, triangle.corners);
    return terms.determinant.sign() != 0 || terms.numerator.sign() != 0;
  });
  if (outside) return false;
  return exact_in_plane(decide_exactly(), triangle);
}

int Filter::sphere_side(const Solid& sphere) {
  const int sign = with_bounded(
      [&](const auto& line) { return sphere_terms(line, sphere.corners[0], sphere.radius).discriminant.sign(); });
  if (sign != 0) return sign;
  return exact_sphere_side(decide_exactly(), sphere);
}

double Filter::segment_distance(const glm::vec3& from, const glm::vec3& to) {
  const glm::dvec3& d = line_.direction;
  const glm::dvec3 a = seen_from(line_, from);
  // Seen along the line (rotated by a right angle and scaled by |d|) the segment runs from `start` along `edge`. Its
  // nearest point is taken on the segment as computed, so an edge almost parallel to the line, whose `edge` is small
  // and badly known, does no harm: everything stays off by some 60 u times the largest coordinate, which the last line
  // compares with.
  const glm::dvec3 start = glm::cross(d, a), edge = glm::cross(d, glm::dvec3(to) - glm::dvec3(from));
  const double length2 = glm::dot(edge, edge);
  const double where = length2 > 0.0 ? std::clamp(-glm::dot(start, edge) / length2, 0.0, 1.0) : 0.0;
  const double distance = glm::length(start + where * edge) / glm::length(d);
  const double scale = largest(a) + largest(line_.rest) + largest(glm::dvec3(to) - glm::dvec3(from));
  // What the line itself is off by moves the distance by at most 4 (p + q scale), see pass_triangle.
  if (distance > 0x1p-28 * scale + 0x1p22 * (line_.point_error + line_.direction_error * scale)) return distance;
  return exact_segment_distance(decide_exactly(), from, to);
}

double Filter::sphere_distance(const Solid& sphere) {
  // |r - l| = |r^2 - l^2| / (r + l)
  const Bounded<double> difference = with_bounded([&](const auto& line) {
    const auto terms = sphere_terms(line, sphere.corners[0], sphere.radius);
    return terms.discriminant / terms.length2;
  });
  if (difference.error <= 0x1p-20 * std::fabs(difference.value)) {
    const double radius = sphere.radius;
    return std::fabs(difference.value) / (radius + std::sqrt(std::fmax(radius * radius - difference.value, 0.0)));
  }
  return exact_sphere_distance(decide_exactly(), sphere);
}

BoundedT Filter::s_of(const Solid& solid, Root root) const {
  if (!solid.is_sphere) {
    return with_wide([&](const auto& line) {
      const auto terms = plane_terms(line, solid.corners);
      return terms.numerator / terms.determinant;
    });
  }
  return with_wide([&](const auto& line) {
    const auto terms = sphere_terms(line, solid.corners[0], solid.radius);
    const BoundedT half = sqrt(terms.discriminant);
    return (root == Root::enter ? terms.middle - half : terms.middle + half) / terms.length2;
  });
}

int Filter::compare_t(const Solid& solid, Root root, const BoundedT& t, double limit) {
  if (std::isinf(limit)) return limit > 0.0 ? -1 : 1;
  const int sign = (t - BoundedT(limit)).sign();
  if (sign != 0) return sign;
  return exact_compare_t(decide_exactly(), solid, root, limit);
}

int Filter::compare_t(const Solid& a, Root root_a, const BoundedT& t_a, Filter& filter_b, const Solid& b, Root root_b,
                      const BoundedT& t_b) {
  const int sign = (t_a - t_b).sign();
  if (sign != 0) return sign;
  return exact_compare_t(decide_exactly(), a, root_a, filter_b.exact(), b, root_b);
}

double Filter::ray_t(const Solid& solid, Root root, const BoundedT& t) {
  // 2^-54 and the half ulp of rounding make less than one unit in the last place.
  if (std::isfinite(t.value) && t.error <= 0x1p-54L * std::fabs(t.value)) return static_cast<double>(t.value);
  return exact_t(decide_exactly(), solid, root);
}

}  // namespace plumbline
