// SPDX-License-Identifier: MIT
// Smallest enclosing ball: a simplex-like walk from basis to basis, each step led by the farthest ball.
#include "tracer/miniball.h"

#include <cmath>

#include "scenes/error.h"
#include "tracer/tree_rounding.h"

namespace plumbline {
namespace {

/// The walk ends when the farthest ball sticks out by less than this share of the radius. The centre is rounded to
/// float afterwards, which costs as much.
constexpr double kTolerance = 0x1p-24;
/// A subset's ball may leave out another member of the basis by this share of the radius: the solver's own rounding.
constexpr double kSolverTolerance = 0x1p-36;
/// Each step makes the ball grow, so it cannot cycle but by rounding; real sets take fewer than 20 steps.
constexpr int kMaxSteps = 64;

struct DoubleBall {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

DoubleBall to_double(const FloatBall& ball) { return {glm::dvec3(ball.center), ball.radius}; }

double square(const glm::dvec3& v) { return glm::dot(v, v); }

/// The ball to which all `n` balls of `b` are tangent from inside and whose centre lies in the flat through their
/// centres. With q = centre - b0.centre, s = radius - b0.radius, a_j = b_j.centre - b0.centre and e_j = b_j.radius -
/// b0.radius,
///   |q| = s  and  |q - a_j| = s - e_j   give   2 a_j.q = |a_j|^2 - e_j^2 + 2 s e_j:
/// q is linear in s, q = u + s v, and |q|^2 = s^2 is a quadratic in s. False where there is none.
bool tangent_ball(const DoubleBall* b, int n, DoubleBall& result) {
  const int m = n - 1;
  glm::dvec3 a[3];
  double gram[3][5];  // rows of the system for q's coordinates along a_j: matrix, right side for u, right side for v
  for (int j = 0; j < m; ++j) a[j] = b[j + 1].center - b[0].center;
  for (int j = 0; j < m; ++j) {
    const double e = b[j + 1].radius - b[0].radius;
    for (int k = 0; k < m; ++k) gram[j][k] = glm::dot(a[j], a[k]);
    gram[j][3] = 0.5 * (gram[j][j] - e * e);
    gram[j][4] = e;
  }
  // Gauss-Jordan with the largest remaining diagonal as pivot: the matrix is symmetric and not negative.
  bool done[3] = {false, false, false};
  for (int step = 0; step < m; ++step) {
    int pivot = -1;
    for (int j = 0; j < m; ++j)
      if (!done[j] && (pivot < 0 || gram[j][j] > gram[pivot][pivot])) pivot = j;
    // A pivot that is all rounding means balls in a lower flat: a smaller subset does for them.
    if (!(gram[pivot][pivot] > 0x1p-40 * square(a[pivot]))) return false;
    done[pivot] = true;
    for (int j = 0; j < m; ++j) {
      if (j == pivot) continue;
      const double factor = gram[j][pivot] / gram[pivot][pivot];
      for (int k = 0; k < 5; ++k)
        if (k < m || k > 2) gram[j][k] -= factor * gram[pivot][k];
    }
  }
  glm::dvec3 u(0.0), v(0.0);
  for (int j = 0; j < m; ++j) {
    u += gram[j][3] / gram[j][j] * a[j];
    v += gram[j][4] / gram[j][j] * a[j];
  }
  // (1 - v.v) s^2 - 2 u.v s - u.u = 0; the larger root is the one with s >= 0 where v.v < 1.
  const double p = 1.0 - square(v), h = glm::dot(u, v), uu = square(u);
  const double discriminant = h * h + p * uu;
  if (!(p > 0.0) || !(discriminant >= 0.0)) return false;  // one of the balls holds another: a smaller subset does
  const double root = std::sqrt(discriminant);
  const double s = h > 0.0 ? (h + root) / p : (root - h > 0.0 ? uu / (root - h) : 0.0);
  result = {b[0].center + u + s * v, b[0].radius + s};
  return std::isfinite(result.radius);
}

/// How far the farthest of `balls` reaches from `center`, and which it is.
struct Farthest {
  double reach = 0.0;
  std::uint32_t ball = 0;
};
Farthest farthest_from(std::span<const FloatBall> balls, const glm::dvec3& center) {
  Farthest result;
  result.reach = -1.0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const DoubleBall ball = to_double(balls[i]);
    const double distance2 = square(ball.center - center), gap = result.reach - ball.radius;
    // distance + radius > reach, without a square root for those that are not
    if (gap < 0.0 || distance2 > gap * gap)
      result = {std::sqrt(distance2) + ball.radius, static_cast<std::uint32_t>(i)};
  }
  return result;
}

/// A basis while it walks.
struct Walk {
  DoubleBall ball;
  std::uint32_t index[4] = {};
  DoubleBall member[4];
  int count = 0;
};

/// Replaces the basis by that of basis and `pivot`, which sticks out of the ball and so belongs to the new basis. Of
/// the subsets that contain the pivot, the smallest tangent ball that holds the others is the smallest enclosing ball.
/// False where rounding leaves none that is larger than before.
bool pivot_step(Walk& walk, const DoubleBall& pivot, std::uint32_t pivot_index) {
  Walk best;
  best.ball.radius = std::numeric_limits<double>::infinity();
  for (unsigned subset = 0; subset < 1u << walk.count; ++subset) {
    DoubleBall chosen[5] = {pivot};
    std::uint32_t index[5] = {pivot_index};
    int n = 1;
    for (int i = 0; i < walk.count; ++i)
      if (subset >> i & 1u) chosen[n] = walk.member[i], index[n] = walk.index[i], ++n;
    DoubleBall candidate;
    if (n > 4 || !tangent_ball(chosen, n, candidate) || !(candidate.radius < best.ball.radius)) continue;
    bool holds_all = true;
    const double allowed = candidate.radius * (1.0 + kSolverTolerance);
    for (int i = 0; i < walk.count && holds_all; ++i)
      holds_all = std::sqrt(square(walk.member[i].center - candidate.center)) + walk.member[i].radius <= allowed;
    if (!holds_all) continue;
    best.ball = candidate;
    best.count = n;
    for (int i = 0; i < n; ++i) best.member[i] = chosen[i], best.index[i] = index[i];
  }
  if (!(best.ball.radius > walk.ball.radius)) return false;
  if (!std::isfinite(best.ball.radius)) return false;
  walk = best;
  return true;
}

void walk_to_end(std::span<const FloatBall> balls, std::span<const std::uint32_t> only, Walk& walk) {
  for (int step = 0; step < kMaxSteps; ++step) {
    Farthest farthest;
    if (only.empty()) {
      farthest = farthest_from(balls, walk.ball.center);
    } else {
      for (const std::uint32_t i : only) {
        const Farthest one = farthest_from(balls.subspan(i, 1), walk.ball.center);
        if (one.reach > farthest.reach) farthest = {one.reach, i};
      }
    }
    if (!(farthest.reach > walk.ball.radius * (1.0 + kTolerance))) return;
    if (!pivot_step(walk, to_double(balls[farthest.ball]), farthest.ball)) return;
  }
}

}  // namespace

glm::dvec3 smallest_ball_center(std::span<const FloatBall> balls, std::span<const std::uint32_t> start,
                                BallSupport& support) {
  PLUMBLINE_ASSERT(!balls.empty());
  Walk walk;
  walk.index[0] = start.empty() ? 0 : start[0];
  walk.member[0] = walk.ball = to_double(balls[walk.index[0]]);
  walk.count = 1;
  if (start.size() > 1) walk_to_end(balls, start, walk);
  walk_to_end(balls, {}, walk);
  support.count = walk.count;
  for (int i = 0; i < walk.count; ++i) support.ball[i] = walk.index[i];
  return walk.ball.center;
}

float enclosing_radius(std::span<const FloatBall> balls, const glm::vec3& center) {
  // Differences of floats, squares, sums and the root are each rounded by a share of at most 2^-53: together, with the
  // comparison against the reach so far, by less than 2^-50. A ball about the centre itself has no error.
  const glm::dvec3 c(center);
  double concentric = 0.0, reach = 0.0;
  for (const FloatBall& one : balls) {
    const DoubleBall ball = to_double(one);
    const double distance2 = square(ball.center - c), gap = reach - ball.radius;
    if (distance2 == 0.0)
      concentric = std::fmax(concentric, ball.radius);
    else if (gap < 0.0 || distance2 > gap * gap)
      reach = std::sqrt(distance2) + ball.radius;
  }
  return std::fmax(sum_up(concentric), sum_up(reach * (1.0 + 0x1p-50)));
}

}  // namespace plumbline
