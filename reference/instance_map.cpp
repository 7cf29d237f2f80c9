// SPDX-License-Identifier: GPL-3.0-or-later
// Brings lines into instances' spaces and boxes out of them. The maps themselves are made in exact.cpp.
#include "reference/instance_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace plumbline {

namespace {

long double value_of(long double x) { return x; }
long double value_of(const BoundedT& x) { return x.value; }
long double scaled(long double x, long double power_of_two) { return x * power_of_two; }

template <class N>
N number(const BoundedT& x) {
  if constexpr (std::is_same_v<N, BoundedT>) return x;
  if constexpr (std::is_same_v<N, long double>) return x.value;
}
template <class N>
Vec<N> numbers(const Vec<BoundedT>& v) {
  return {number<N>(v.x), number<N>(v.y), number<N>(v.z)};
}

template <class N>
Vec<N> times(const std::array<Vec<BoundedT>, 3>& rows, const Vec<N>& v) {
  return {dot(numbers<N>(rows[0]), v), dot(numbers<N>(rows[1]), v), dot(numbers<N>(rows[2]), v)};
}

glm::dvec3 rounded(const Vec<long double>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
template <class N>
Vec<long double> values(const Vec<N>& v) {
  return {value_of(v.x), value_of(v.y), value_of(v.z)};
}

double largest(const glm::dvec3& v) { return std::fmax(std::fmax(std::fabs(v.x), std::fabs(v.y)), std::fabs(v.z)); }

/// Fills all of `line` but the errors.
template <class N>
LineOf<N> bring(const Ray& ray, const InstanceMap& map, const Ball& ball, Line& line) {
  LineOf<N> wide{};
  wide.point = times<N>(map.inverse_rows, vec<N>(glm::dvec3(ray.origin)) - numbers<N>(map.translation));
  const Vec<N> d = times<N>(map.inverse_rows, vec<N>(glm::dvec3(ray.direction)));

  const Vec<long double> size = values(d);
  // Clamped for the sake of a direction that is lost to rounding, or overflows.
  const int exponent = std::clamp(
      std::ilogb(std::fmax(std::fmax(std::fabs(size.x), std::fabs(size.y)), std::fabs(size.z))), -16000, 16000);
  const long double unit = std::ldexp(1.0L, -exponent);
  wide.direction = {scaled(d.x, unit), scaled(d.y, unit), scaled(d.z, unit)};
  line.direction = rounded(values(wide.direction));
  line.unit = static_cast<double>(unit);
  line.t_max = static_cast<double>(ray.t_max * std::ldexp(1.0L, exponent));

  line.shift = shift_near(rounded(values(wide.point)), line.direction, ball);
  if (line.shift != 0.0) wide.point = wide.point + wide.direction * N(line.shift);
  const Vec<long double> point = values(wide.point);
  line.point = rounded(point);
  line.rest = rounded(point - vec<long double>(line.point));
  return wide;
}

}  // namespace

std::vector<InstanceMap> instance_maps(const Scene& scene) {
  const std::vector<std::uint32_t> instances = instances_of(scene);
  std::vector<InstanceMap> maps(instances.size());
  tbb::parallel_for(std::size_t{0}, maps.size(), [&](std::size_t i) { maps[i] = instance_map(scene, instances[i]); });
  return maps;
}

Line plain_local_line(const Ray& ray, const InstanceMap& map, const Ball& ball) {
  Line line;
  bring<long double>(ray, map, ball, line);
  return line;
}

LocalLine local_line(const Ray& ray, const InstanceMap& map, const Ball& ball) {
  LocalLine local;
  Line& line = local.line;
  LineOf<BoundedT>& wide = local.wide;
  wide = bring<BoundedT>(ray, map, ball, line);
  // What is lost in double: the errors carried so far, and the direction's rounding. The point's 64 bits are point and
  // rest, without loss. A sum of three and its conversion round by far less than the factor allows for.
  const glm::dvec3 direction_lost = rounded(values(wide.direction) - vec<long double>(line.direction));
  const Vec<long double> point_error{wide.point.x.error, wide.point.y.error, wide.point.z.error},
      direction_error{wide.direction.x.error, wide.direction.y.error, wide.direction.z.error};
  line.point_error = largest(rounded(point_error)) * (1.0 + 0x1p-40) + 0x1p-350;
  line.direction_error = (largest(rounded(direction_error)) + largest(direction_lost)) * (1.0 + 0x1p-40) + 0x1p-200;
  // Beyond these limits a bound would be of no use, or a double would overflow; any line will do then.
  const bool kept = line.direction_error < 0x1p-10 && largest(line.point) < 0x1p200 && line.point_error < 0x1p200 &&
                    line.unit > 0x1p-600 && line.unit < 0x1p600 && std::fabs(line.shift) < 0x1p600;
  if (kept) return local;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  line.point = line.rest = glm::dvec3(0.0);
  line.direction = {1.0, 0.0, 0.0};
  line.unit = 1.0, line.shift = 0.0, line.t_max = static_cast<double>(ray.t_max);
  line.point_error = line.direction_error = kInfinity;
  const BoundedT unknown(0.0L, static_cast<long double>(kInfinity));
  wide.point = wide.direction = {unknown, unknown, unknown};
  return local;
}

glm::dvec3 normal_to_world(const InstanceMap& map, const glm::dvec3& normal) {
  glm::dvec3 result(0.0);
  for (int i = 0; i < 3; ++i) result += normal[i] * rounded(values(map.inverse_rows[static_cast<std::size_t>(i)]));
  return result / glm::length(result);
}

BoxD world_box(const InstanceMap& map, const BoxD& local) {
  const glm::dvec3 center = 0.5 * (local.lower + local.upper), half = 0.5 * (local.upper - local.lower);
  BoxD box;
  for (int axis = 0; axis < 3; ++axis) {
    double middle = map.to_world.translation[axis], extent = 0.0, size = std::fabs(middle);
    for (int column = 0; column < 3; ++column) {
      const double entry = map.to_world.linear[column][axis];
      middle += entry * center[column];
      extent += std::fabs(entry) * half[column];
      size += std::fabs(entry) * (std::fabs(center[column]) + half[column]);
    }
    // Centre and half size cost a rounding or two each, the entries one unit in the last place, the sums three
    // products and four additions each, and the ends one more: below 16 * 2^-53 of `size` in all.
    const double reach = extent + 0x1p-48 * size;
    box.lower[axis] = middle - reach, box.upper[axis] = middle + reach;
  }
  return box;
}

}  // namespace plumbline
