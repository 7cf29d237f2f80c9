// SPDX-License-Identifier: GPL-3.0-or-later
// Moves rays to the scene without rounding them.
#include "reference/line.h"

#include <bit>
#include <cmath>

namespace plumbline {

namespace {

/// The 29 leading bits: their product with a float's 24 is exact in a double's 53.
double leading_bits(double x) { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~0xffffffull); }

}  // namespace

double shift_near(const glm::dvec3& point, const glm::dvec3& direction, const Ball& ball) {
  const glm::dvec3 to_center = ball.center - point;
  if (glm::dot(to_center, to_center) <= 9.0 * ball.radius * ball.radius) return 0.0;
  const double length_squared = glm::dot(direction, direction);
  return leading_bits(glm::dot(to_center, direction) / length_squared - 2.0 * ball.radius / std::sqrt(length_squared));
}

Line line_near(const Ray& ray, const Ball& ball) {
  Line line;
  const glm::dvec3 direction(ray.direction), origin(ray.origin);
  const double largest = std::fmax(std::fmax(std::fabs(direction.x), std::fabs(direction.y)), std::fabs(direction.z));
  // 2^-e where largest is in [2^e, 2^(e+1)), from its exponent; a float is never a denormal double.
  const std::uint64_t exponent = std::bit_cast<std::uint64_t>(largest) >> 52;
  line.unit = std::bit_cast<double>((2046 - exponent) << 52);
  line.direction = direction * line.unit;
  line.t_max = static_cast<double>(ray.t_max) * std::bit_cast<double>(exponent << 52);
  line.point = origin;

  line.shift = shift_near(origin, line.direction, ball);
  if (line.shift == 0.0) return line;
  for (int axis = 0; axis < 3; ++axis) {
    // Knuth's two-sum: a + b = sum + error exactly. The product is exact, see leading_bits.
    const double a = origin[axis], b = line.shift * line.direction[axis];
    const double sum = a + b, b_part = sum - a;
    line.point[axis] = sum;
    line.rest[axis] = (a - (sum - b_part)) + (b - b_part);
  }
  return line;
}

}  // namespace plumbline
