// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals for the closed forms: Gauss-Legendre for what is analytic, adaptive Gauss-Kronrod in pieces for what has
// kinks at known places.
#pragma once

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace plumbline {

/// Of an analytic integrand whose nearest singularity is more than a length of the interval away: exact to 1e-12.
template <class F>
double integrate_smooth(F f, double from, double to) {
  if (!(from < to)) return 0.0;
  return boost::math::quadrature::gauss<double, 15>::integrate(f, from, to);
}

/// Of an integrand that is smooth but for square roots and kinks at the ends and at `splits` (in any order; those
/// outside are ignored). Each piece is stretched by x = middle - half cos(a), which takes square roots at its ends out.
template <class F>
double integrate_pieces(F f, double from, double to, std::vector<double> splits = {}, double tolerance = 1e-11) {
  if (!(from < to)) return 0.0;
  std::erase_if(splits, [&](double s) { return !(s > from && s < to); });
  std::sort(splits.begin(), splits.end());
  splits.push_back(to);
  double sum = 0.0, left = from;
  for (const double right : splits) {
    const double middle = 0.5 * (left + right), half = 0.5 * (right - left);
    if (half > 0.0)
      sum += boost::math::quadrature::gauss_kronrod<double, 21>::integrate(
          [&](double a) { return f(middle - half * std::cos(a)) * half * std::sin(a); }, 0.0, std::numbers::pi, 12,
          tolerance);
    left = right;
  }
  return sum;
}

/// Real roots of a x^2 + b x + c, also where a is 0.
inline std::vector<double> quadratic_roots(double a, double b, double c) {
  const double discriminant = b * b - 4.0 * a * c;
  if (!(discriminant >= 0.0)) return {};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  std::vector<double> roots;
  if (a != 0.0) roots.push_back(q / a);
  if (q != 0.0) roots.push_back(c / q);
  return roots;
}

}  // namespace plumbline
