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
  // The largest eigenvalue of the symmetric matrix A = L^T L by Jacobi's rotations (Golub and Van Loan, section 8.5.3):
  // unlike the characteristic polynomial, they do not lose half of the digits where two eigenvalues are nearly one.
  double scale = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) scale = std::max(scale, std::abs(linear[column][row]));
  if (!(scale > 0.0)) return 0.0;
  const glm::dmat3 unit = linear / scale;
  glm::dmat3 a = glm::transpose(unit) * unit;
  constexpr int kMostSweeps = 16;  // convergence is quadratic: 4 or 5 do
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        const int r = 3 - p - q;
        const double rp = a[r][p], rq = a[r][q];
        a[p][p] -= t * a[p][q];
        a[q][q] += t * a[p][q];
        a[p][q] = a[q][p] = 0.0;
        a[r][p] = a[p][r] = c * rp - s * rq;
        a[r][q] = a[q][r] = s * rp + c * rq;
      }
    }
    const double rest = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    if (!(rest > 0x1p-60 * (a[0][0] + a[1][1] + a[2][2]))) break;
  }
  // What is left beside the diagonal moves an eigenvalue by no more than its sum (Gershgorin). Forming A and some 15
  // rotations err by less than 2^-45 of the largest eigenvalue; the last factor covers that.
  double largest = 0.0;
  for (int i = 0; i < 3; ++i)
    largest = std::max(largest, a[i][i] + std::abs(a[i][(i + 1) % 3]) + std::abs(a[i][(i + 2) % 3]));
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
