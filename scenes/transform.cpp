// SPDX-License-Identifier: MIT
#include "scenes/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumbline {

TransformD to_double(const Transform& transform) {
  return {glm::dmat3(transform.linear), glm::dvec3(transform.translation)};
}

TransformD compose(const TransformD& outer, const TransformD& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}

TransformD inverse(const TransformD& transform) {
  const glm::dmat3 linear = glm::inverse(transform.linear);
  return {linear, -(linear * transform.translation)};
}

double largest_stretch(const glm::dmat3& linear) {
  // The largest eigenvalue of the symmetric matrix A = L^T L by its characteristic polynomial in trigonometric form
  // (Smith 1961, "Eigenvalues of a symmetric 3 x 3 matrix", CACM 4(4)). All of its terms are at most the eigenvalue
  // itself, so it is good to a few units in the last place; the last factor rounds it up.
  double scale = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) scale = std::max(scale, std::abs(linear[column][row]));
  if (!(scale > 0.0)) return 0.0;
  const glm::dmat3 unit = linear / scale;
  const glm::dmat3 a = glm::transpose(unit) * unit;
  const double middle = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
  const glm::dmat3 b = a - middle * glm::dmat3(1.0);
  double squares = 0.0;
  for (int column = 0; column < 3; ++column) squares += glm::dot(b[column], b[column]);
  const double spread = std::sqrt(squares / 6.0);
  double largest = middle;
  if (spread > 0.0) {
    const double half_det = std::clamp(glm::determinant(b / spread) / 2.0, -1.0, 1.0);
    largest = middle + 2.0 * spread * std::cos(std::acos(half_det) / 3.0);
  }
  return scale * std::sqrt(largest) * (1.0 + 0x1p-40);
}

const char* transform_error(const Transform& transform) {
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(transform.linear[i][axis])) return "holds a value that is not finite";
    }
    if (!std::isfinite(transform.translation[i])) return "holds a value that is not finite";
  }
  // In long double products of three floats keep their range; a determinant that is lost in rounding counts as zero,
  // since no 32-bit inverse would mean anything.
  using Real = long double;
  const auto m = [&](int column, int row) { return static_cast<Real>(transform.linear[column][row]); };
  Real det = 0, size = 0;
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    det += m(c, 0) * (m(d, 1) * m(e, 2) - m(d, 2) * m(e, 1));
    size += std::fabs(m(c, 0)) * (std::fabs(m(d, 1) * m(e, 2)) + std::fabs(m(d, 2) * m(e, 1)));
  }
  if (!(std::fabs(det) > 16 * std::numeric_limits<Real>::epsilon() * size)) return "is singular";
  const TransformD inverted = inverse(to_double(transform));
  constexpr double kMax = std::numeric_limits<float>::max();
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(inverted.linear[column][row]) <= kMax)) return "is singular";
  return "";
}

}  // namespace plumbline
