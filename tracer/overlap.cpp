// SPDX-License-Identifier: MIT
#include "tracer/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

namespace plumbline {
namespace {

double radius_of(const Volume& ball) { return std::sqrt(static_cast<double>(ball.radius2)); }
double ball_volume(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

double lens(const Volume& p, const Volume& q) {
  const double a = radius_of(p), b = radius_of(q), d = glm::length(glm::dvec3(p.center) - glm::dvec3(q.center));
  if (d >= a + b) return 0.0;
  if (d <= std::abs(a - b)) return ball_volume(std::min(a, b));
  const double depth = a + b - d;
  return std::numbers::pi * depth * depth * (d * d + 2.0 * d * (a + b) - 3.0 * (a - b) * (a - b)) / (12.0 * d);
}

double box_volume(const glm::dvec3& lower, const glm::dvec3& upper) {
  const glm::dvec3 size = upper - lower;
  return std::max(size.x, 0.0) * std::max(size.y, 0.0) * std::max(size.z, 0.0);
}

}  // namespace

double volume_of(const Volume& v) {
  return v.is_box ? box_volume(glm::dvec3(v.lower), glm::dvec3(v.upper)) : ball_volume(radius_of(v));
}

double shared_volume(const Volume& a, const Volume& b) {
  if (!a.is_box) return lens(a, b);
  return box_volume(glm::max(glm::dvec3(a.lower), glm::dvec3(b.lower)),
                    glm::min(glm::dvec3(a.upper), glm::dvec3(b.upper)));
}

double sibling_overlap(const Volume& parent, std::span<const Volume> children) {
  const double whole = volume_of(parent);
  if (!(whole > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  constexpr std::size_t kPairsPerChild = 256;
  double shared = 0.0;
  if (children.size() <= kPairsPerChild) {
    for (std::size_t i = 0; i < children.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) shared += shared_volume(children[i], children[j]);
    return shared / whole;
  }
  // Along the x axis: each with those that begin before it ends.
  struct Extent {
    double begin, end;
    std::size_t child;
  };
  std::vector<Extent> extents;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const Volume& v = children[i];
    const double center = v.center.x, begin = v.is_box ? v.lower.x : center - radius_of(v),
                 end = v.is_box ? v.upper.x : center + radius_of(v);
    if (!(begin <= end)) return std::numeric_limits<double>::quiet_NaN();
    extents.push_back({begin, end, i});
  }
  std::sort(extents.begin(), extents.end(),
            [](const Extent& a, const Extent& b) { return std::tie(a.begin, a.child) < std::tie(b.begin, b.child); });
  std::size_t pairs_left = kPairsPerChild * children.size();
  for (std::size_t i = 0; i < extents.size(); ++i)
    for (std::size_t j = i + 1; j < extents.size() && extents[j].begin <= extents[i].end; ++j) {
      if (pairs_left-- == 0) return std::numeric_limits<double>::quiet_NaN();
      shared += shared_volume(children[extents[i].child], children[extents[j].child]);
    }
  return shared / whole;
}

}  // namespace plumbline
