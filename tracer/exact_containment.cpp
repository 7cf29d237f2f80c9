// SPDX-License-Identifier: MIT
// First in double, where the error has a bound; what that leaves open is decided by expansions: sums of doubles that
// hold a value without error (Shewchuk 1997).
#include "tracer/exact_containment.h"

#include <array>
#include <cmath>
#include <vector>

#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

/// An exact sum. Its components do not overlap and ascend in magnitude, so the last tells the sign.
///
/// Nothing over- or underflows: what is added are products of up to four floats, multiples of 2^-596 below 2^514.
class Expansion {
 public:
  void add(double term) {
    std::size_t kept = 0;
    for (const double component : components_) {
      const auto [sum, error] = exact_sum(component, term);
      term = sum;
      if (error != 0.0) components_[kept++] = error;
    }
    components_.resize(kept);
    if (term != 0.0) components_.push_back(term);
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(product);
    add(std::fma(a, b, -product));
  }
  int sign() const { return components_.empty() ? 0 : components_.back() > 0.0 ? 1 : -1; }
  const std::vector<double>& components() const { return components_; }

 private:
  std::vector<double> components_;
};

/// The terms of radius2 - |a - b|^2, multiplied out.
std::array<double, 10> rest_of(double radius2, const glm::vec3& a, const glm::vec3& b) {
  std::array<double, 10> terms{radius2};
  for (int axis = 0; axis < 3; ++axis) {
    const double p = a[axis], q = b[axis];
    const auto at = static_cast<std::size_t>(1 + 3 * axis);
    terms[at] = -p * p, terms[at + 1] = 2.0 * p * q, terms[at + 2] = -q * q;
  }
  return terms;
}

/// More than the relative error of |a - b|^2 in double: a rounding for each difference counts twice, one follows for
/// its square and two for the sums, 2^-53 each.
constexpr double kSquareError = 0x1p-50;

double distance2(const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(d, d);
}

}  // namespace

bool ball_holds_point(const glm::vec3& center, double radius2, const glm::vec3& point) {
  const double d2 = distance2(center, point);
  if (d2 * (1.0 + 2.0 * kSquareError) < radius2) return true;
  if (d2 > radius2 * (1.0 + 2.0 * kSquareError)) return false;
  return exact_sign(rest_of(radius2, center, point)) >= 0;
}

bool ball_holds_ball(const glm::vec3& center, double radius2, const glm::vec3& inner, float inner_radius) {
  if (inner_radius == 0.0f) return ball_holds_point(center, radius2, inner);
  const double r = inner_radius, d2 = distance2(center, inner);
  if (!(radius2 >= r * r)) return false;
  const double gap = std::sqrt(radius2) - r;  // off by at most 2^-52 of the root
  const double error = 0x1p-51 * std::sqrt(radius2);
  if (gap > error && d2 * (1.0 + 2.0 * kSquareError) < (gap - error) * (gap - error)) return true;
  if (d2 > (gap + error) * (gap + error) * (1.0 + 2.0 * kSquareError)) return false;
  // d <= R - r with r <= R: squared, d^2 <= R^2 - 2 r R + r^2, so 2 r R <= E = R^2 + r^2 - d^2; squared again.
  Expansion e;
  for (const double term : rest_of(radius2, center, inner)) e.add(term);
  e.add(r * r);
  if (e.sign() < 0) return false;
  Expansion difference;  // E^2 - 4 r^2 R^2
  for (const double a : e.components())
    for (const double b : e.components()) difference.add_product(a, b);
  difference.add_product(-4.0 * r * r, radius2);
  return difference.sign() >= 0;
}

bool box_holds_ball(const glm::vec3& lower, const glm::vec3& upper, const glm::vec3& inner, float inner_radius) {
  for (int axis = 0; axis < 3; ++axis) {
    const double c = inner[axis], r = inner_radius;
    const std::array<double, 3> below{c, -r, -static_cast<double>(lower[axis])};
    const std::array<double, 3> above{static_cast<double>(upper[axis]), -c, -r};
    if (exact_sign(below) < 0 || exact_sign(above) < 0) return false;
  }
  return true;
}

}  // namespace plumbline
