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

/// Sets `line.unit` and t_max for a direction of such a size; returns the unit.
long double set_units(const Ray& ray, const Vec<long double>& d, Line& line) {
  // Clamped for the sake of a direction that is lost to rounding, or overflows.
  const int exponent =
      std::clamp(std::ilogb(std::fmax(std::fmax(std::fabs(d.x), std::fabs(d.y)), std::fabs(d.z))), -16000, 16000);
  const long double unit = std::ldexp(1.0L, -exponent);
  line.unit = static_cast<double>(unit);
  line.t_max = static_cast<double>(ray.t_max * std::ldexp(1.0L, exponent));
  return unit;
}

/// A point of 64 bits as `point` and `rest`, without loss.
void set_point(const Vec<long double>& point, Line& line) {
  line.point = rounded(point);
  line.rest = rounded(point - vec<long double>(line.point));
}

/// Fills all of `line` but the errors.
template <class N>
LineOf<N> bring(const Ray& ray, const InstanceMap& map, const Ball& ball, Line& line) {
  LineOf<N> wide{};
  wide.point = times<N>(map.inverse_rows, vec<N>(glm::dvec3(ray.origin)) - numbers<N>(map.translation));
  const Vec<N> d = times<N>(map.inverse_rows, vec<N>(glm::dvec3(ray.direction)));
  const long double unit = set_units(ray, values(d), line);
  wide.direction = {scaled(d.x, unit), scaled(d.y, unit), scaled(d.z, unit)};
  line.direction = rounded(values(wide.direction));
  line.shift = shift_near(rounded(values(wide.point)), line.direction, ball);
  if (line.shift != 0.0) wide.point = wide.point + wide.direction * N(line.shift);
  set_point(values(wide.point), line);
  return wide;
}

/// Fills the errors of `line` from those of `wide`.
void bound_line(const Ray& ray, LocalLine& local) {
  Line& line = local.line;
  LineOf<BoundedT>& wide = local.wide;
  // What is lost in double: the errors carried so far, and the direction's rounding. A sum of three and its conversion
  // round by far less than the factor allows for.
  const glm::dvec3 direction_lost = rounded(values(wide.direction) - vec<long double>(line.direction));
  const Vec<long double> point_error{wide.point.x.error, wide.point.y.error, wide.point.z.error},
      direction_error{wide.direction.x.error, wide.direction.y.error, wide.direction.z.error};
  line.point_error = largest(rounded(point_error)) * (1.0 + 0x1p-40) + 0x1p-350;
  line.direction_error = (largest(rounded(direction_error)) + largest(direction_lost)) * (1.0 + 0x1p-40) + 0x1p-200;
  // Beyond these limits a bound would be of no use, or a double would overflow; any line will do then.
  const bool kept = line.direction_error < 0x1p-10 && largest(line.point) < 0x1p200 && line.point_error < 0x1p200 &&
                    line.unit > 0x1p-600 && line.unit < 0x1p600 && std::fabs(line.shift) < 0x1p600;
  if (kept) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  line.point = line.rest = glm::dvec3(0.0);
  line.direction = {1.0, 0.0, 0.0};
  line.unit = 1.0, line.shift = 0.0, line.t_max = static_cast<double>(ray.t_max);
  line.point_error = line.direction_error = kInfinity;
  const BoundedT unknown(0.0L, static_cast<long double>(kInfinity));
  wide.point = wide.direction = {unknown, unknown, unknown};
}

/// 113 bits; gcc computes it in software.
__extension__ using Quad = __float128;

Quad magnitude(const Quad& x) { return x < 0 ? -x : x; }

std::array<Quad, 3> sum(const Vec<BoundedT>& v, const Vec<long double>& rest) {
  return {static_cast<Quad>(v.x.value) + rest.x, static_cast<Quad>(v.y.value) + rest.y,
          static_cast<Quad>(v.z.value) + rest.z};
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
  local.wide = bring<BoundedT>(ray, map, ball, local.line);
  bound_line(ray, local);
  return local;
}

LocalLine fine_local_line(const Ray& ray, const InstanceMap& map, const Ball& ball) {
  using Three = std::array<Quad, 3>;
  const Three origin{ray.origin.x, ray.origin.y, ray.origin.z},
      direction{ray.direction.x, ray.direction.y, ray.direction.z},
      translation = sum(map.translation, map.translation_rest);
  Three point{}, way{}, point_size{}, way_size{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Three row = sum(map.inverse_rows[i], map.inverse_rest[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      point[i] += row[k] * (origin[k] - translation[k]);
      way[i] += row[k] * direction[k];
      point_size[i] += magnitude(row[k]) * (magnitude(origin[k]) + magnitude(translation[k]));
      way_size[i] += magnitude(row[k]) * magnitude(direction[k]);
    }
  }

  LocalLine local;
  Line& line = local.line;
  const auto extended = [](const Three& v) {
    return Vec<long double>{static_cast<long double>(v[0]), static_cast<long double>(v[1]),
                            static_cast<long double>(v[2])};
  };
  const long double unit = set_units(ray, extended(way), line);
  for (std::size_t i = 0; i < 3; ++i) way[i] *= unit, way_size[i] *= unit;
  line.direction = rounded(extended(way));
  line.shift = shift_near(rounded(extended(point)), line.direction, ball);
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] += line.shift * way[i];
    point_size[i] += magnitude(line.shift) * way_size[i];
  }
  // Of a sum of three products of numbers that have a few roundings of 2^-113 each, less than sixteen in all, and of
  // the move. The conversion takes half a unit in the last place more.
  const auto bounded = [](const Quad& x, const Quad& size) {
    const auto value = static_cast<long double>(x);
    return BoundedT(value, 0x1p-106L * static_cast<long double>(size) + BoundedT::kUnit * std::fabs(value));
  };
  local.wide.point = {bounded(point[0], point_size[0]), bounded(point[1], point_size[1]),
                      bounded(point[2], point_size[2])};
  local.wide.direction = {bounded(way[0], way_size[0]), bounded(way[1], way_size[1]), bounded(way[2], way_size[2])};
  set_point(values(local.wide.point), line);
  bound_line(ray, local);
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
