// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/slice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "harness/exact_view.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"

namespace plumbline {
namespace {

using Point = std::array<double, 2>;

/// The plane of the picture, in world units: origin + x along + y across.
struct Plane {
  glm::dvec3 origin{0.0}, along{1.0, 0.0, 0.0}, across{0.0, 1.0, 0.0};
  glm::dvec3 normal() const { return glm::cross(along, across); }
};

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// From the world, in its own units, to a space in image units, by the image's records.
std::optional<TransformD> into_space(const GeometryImage& image, std::uint32_t space) {
  TransformD map;
  const double unit = std::ldexp(1.0, image.scale_exponent);
  map.linear = glm::dmat3(unit);
  if (space == kNone) return map;
  const auto path = transforms_to(image, space);
  if (!path) return std::nullopt;
  for (const std::uint32_t node : *path) {
    glm::dmat3 rows(0.0);
    glm::dvec3 shift(0.0);
    for (int i = 0; i < 3; ++i) {
      const glm::dvec4 row(record_texel(image, node, static_cast<std::uint32_t>(i)));
      rows[i] = glm::dvec3(row);
      shift[i] = row.w;
    }
    const glm::dmat3 inverse = glm::transpose(rows);
    map = compose({inverse, -(inverse * shift)}, map);
  }
  if (!is_finite(map.linear[0]) || !is_finite(map.linear[1]) || !is_finite(map.linear[2]) ||
      !is_finite(map.translation))
    return std::nullopt;
  return map;
}

/// Where the plane cuts a ball of a space: (x, y) with |M (x, y) + m| = r is an ellipse, and with Q = M^T M its centre
/// is -Q^-1 M^T m; its half axes are the roots of what is left of r^2 over Q's eigenvalues.
bool cut_ball(const TransformD& map, const Plane& plane, const glm::dvec3& center, double radius2, ShapeRecord& shape) {
  const glm::dvec3 a = transform_vector(map, plane.along), b = transform_vector(map, plane.across);
  const glm::dvec3 m = transform_point(map, plane.origin) - center;
  const double qaa = glm::dot(a, a), qab = glm::dot(a, b), qbb = glm::dot(b, b);
  const double va = glm::dot(a, m), vb = glm::dot(b, m), det = qaa * qbb - qab * qab;
  if (!(det > 0.0)) return false;
  shape.is_ellipse = true;
  shape.x = -(qbb * va - qab * vb) / det;
  shape.y = -(qaa * vb - qab * va) / det;
  const glm::dvec3 nearest = m + shape.x * a + shape.y * b;
  const double left = radius2 - glm::dot(nearest, nearest);
  if (!(left >= 0.0)) return false;
  const double mean = 0.5 * (qaa + qbb), apart = std::hypot(0.5 * (qaa - qbb), qab);
  shape.rx = std::sqrt(left / std::max(mean - apart, det / (mean + apart)));
  shape.ry = std::sqrt(left / (mean + apart));
  // The larger half axis belongs to the smaller eigenvalue.
  shape.angle = 0.5 * std::atan2(-2.0 * qab, qbb - qaa);
  return std::isfinite(shape.x) && std::isfinite(shape.y) && std::isfinite(shape.rx);
}

/// Where the plane cuts a box of a space: a square around everything, cut by six half planes.
bool cut_box(const TransformD& map, const Plane& plane, const Volume& box, double extent, ShapeRecord& shape) {
  std::vector<Point> polygon{{-extent, -extent}, {extent, -extent}, {extent, extent}, {-extent, extent}};
  const glm::dvec3 a = transform_vector(map, plane.along), b = transform_vector(map, plane.across);
  const glm::dvec3 o = transform_point(map, plane.origin);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const double limit = sign < 0.0 ? -static_cast<double>(box.lower[axis]) : static_cast<double>(box.upper[axis]);
      const auto above = [&](const Point& p) { return sign * (o[axis] + p[0] * a[axis] + p[1] * b[axis]) - limit; };
      std::vector<Point> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double fp = above(p), fq = above(q);
        if (fp <= 0.0) kept.push_back(p);
        if ((fp <= 0.0) == (fq <= 0.0)) continue;
        const double s = fp / (fp - fq);
        kept.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])});
      }
      polygon = std::move(kept);
    }
  }
  if (polygon.size() < 3) return false;
  shape.points = std::move(polygon);
  return true;
}

/// A primitive where the scene places it.
bool cut_primitive(const Scene& scene, std::uint32_t instance, std::uint32_t primitive, const Plane& plane,
                   ShapeRecord& shape) {
  if (primitive >= scene.primitive_count()) return false;
  const TransformD place = instance == kNone ? TransformD{} : to_world(scene, instance);
  if (!scene.is_triangle(primitive)) {
    const auto& sphere = scene.spheres[primitive - scene.triangles.size()];
    const double r = sphere.radius;
    return cut_ball(inverse(place), plane, glm::dvec3(sphere.center), r * r, shape);
  }
  const auto corners = scene.corners(primitive);
  glm::dvec3 world[3];
  double side[3];
  for (int i = 0; i < 3; ++i) {
    world[i] = transform_point(place, glm::dvec3(corners[static_cast<std::size_t>(i)])) - plane.origin;
    side[i] = glm::dot(world[i], plane.normal());
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if ((side[i] <= 0.0) == (side[j] <= 0.0)) continue;
    const glm::dvec3 p = world[i] + side[i] / (side[i] - side[j]) * (world[j] - world[i]);
    shape.points.push_back({glm::dot(p, plane.along), glm::dot(p, plane.across)});
  }
  return shape.points.size() == 2;
}

/// The middle of a primitive in the world.
glm::dvec3 middle_of(const Scene& scene, std::uint32_t instance, std::uint32_t primitive) {
  glm::dvec3 middle(0.0);
  if (scene.is_triangle(primitive)) {
    for (const glm::vec3& corner : scene.corners(primitive)) middle += glm::dvec3(corner) / 3.0;
  } else {
    middle = glm::dvec3(scene.spheres[primitive - scene.triangles.size()].center);
  }
  return instance == kNone ? middle : transform_point(to_world(scene, instance), middle);
}

std::string node_label(const WalkStep& step) {
  return (step.node == kNone ? "" : "node " + std::to_string(step.node) + " at ") + "cell (" + std::to_string(step.x) +
         ", " + std::to_string(step.y) + ")" +
         (step.space == kNone ? "" : " behind transform " + std::to_string(step.space));
}

}  // namespace

SliceRecord slice_of(const GeometryImage& image, const Scene& scene, const Walk& walk, const Loss& loss,
                     const SliceMarks& marks, std::size_t most) {
  SliceRecord slice;
  if (!is_defined(walk.ray)) return slice;
  slice.length = glm::length(glm::dvec3(walk.ray.direction));
  std::map<std::uint32_t, std::optional<TransformD>> maps;
  const auto map_of = [&](std::uint32_t space) -> const std::optional<TransformD>& {
    return maps.try_emplace(space, into_space(image, space)).first->second;
  };

  // The plane goes through the middle of what matters; where that lies on the ray any plane does.
  Plane plane;
  plane.origin = glm::dvec3(walk.ray.origin);
  plane.along = glm::dvec3(walk.ray.direction) / slice.length;
  const bool is_truth = marks.truth.primitive != kNone && marks.truth.primitive < scene.primitive_count();
  std::vector<glm::dvec3> middles;
  if (loss.cell != kNone && loss.cell + node_units(image) <= unit_count(image)) {
    if (const auto& map = map_of(loss.space)) {
      const Volume v = volume_at(image, loss.cell);
      const glm::dvec3 c = v.is_box ? 0.5 * (glm::dvec3(v.lower) + glm::dvec3(v.upper)) : glm::dvec3(v.center);
      middles.push_back(transform_point(inverse(*map), c));
    }
  }
  if (is_truth) middles.push_back(middle_of(scene, marks.truth.instance, marks.truth.primitive));
  middles.push_back(bounding_ball(scene).center);
  glm::dvec3 across(0.0);
  for (const glm::dvec3& middle : middles) {
    const glm::dvec3 m = middle - plane.origin;
    const glm::dvec3 beside = m - glm::dot(m, plane.along) * plane.along;
    // Within a 2^-20 of its distance the direction is rounding's.
    if (is_finite(beside) && glm::length(beside) > 0x1p-20 * glm::length(m)) {
      across = glm::normalize(beside);
      break;
    }
  }
  if (across == glm::dvec3(0.0)) {
    const glm::dvec3 other = std::abs(plane.along.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    across = glm::normalize(glm::cross(plane.along, other));
  }
  plane.across = across;

  std::set<std::size_t> on_chain;
  for (const Ancestor& a : loss.chain)
    if (a.step != kNoStep) on_chain.insert(a.step);
  std::vector<std::size_t> order(walk.steps.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto rank = [&](std::size_t i) {
    return i == loss.step ? 0 : on_chain.contains(i) ? 1 : walk.steps[i].test == NodeTest::hit ? 2 : 3;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  const Ball ball = bounding_ball(scene);
  const double extent = 4.0 * (glm::length(ball.center - plane.origin) + ball.radius);
  for (const std::size_t i : order) {
    const WalkStep& step = walk.steps[i];
    if (step.test == NodeTest::end || step.again || step.cell + node_units(image) > unit_count(image)) continue;
    if (slice.shapes.size() >= most) {
      ++slice.left_out;
      continue;
    }
    const auto& map = map_of(step.space);
    ShapeRecord shape;
    shape.role = i == loss.step && loss.cell != kNone ? "fault" : step.test == NodeTest::hit ? "entered" : "rejected";
    shape.label = node_label(step);
    shape.step = static_cast<std::uint32_t>(i);
    const Volume volume = volume_at(image, step.cell);
    const bool is_cut =
        map && (volume.is_box ? cut_box(*map, plane, volume, extent, shape)
                              : cut_ball(*map, plane, glm::dvec3(volume.center), volume.radius2, shape));
    if (is_cut)
      slice.shapes.push_back(std::move(shape));
    else
      ++slice.not_cut;
  }
  std::reverse(slice.shapes.begin(), slice.shapes.end());  // what matters most is drawn last

  const auto add_primitive = [&](const char* role, std::uint32_t instance, std::uint32_t primitive, double t) {
    const std::string name = primitive_name(scene, instance, primitive);
    ShapeRecord shape;
    shape.role = role, shape.label = name;
    if (cut_primitive(scene, instance, primitive, plane, shape)) slice.shapes.push_back(std::move(shape));
    char text[40];
    std::snprintf(text, sizeof text, " at t = %.9g", t);
    slice.marks.push_back({role, name + text, t * slice.length});
  };
  slice.marks.push_back({"origin", "the ray's origin", 0.0});
  if (std::isfinite(walk.ray.t_max))
    slice.marks.push_back({"t_max", "t_max", static_cast<double>(walk.ray.t_max) * slice.length});
  const Hit& answer = marks.answer;
  const bool is_answer = answer.kind == HitKind::hit && answer.primitive < scene.primitive_count();
  if (is_answer && !(is_truth && answer.primitive == marks.truth.primitive && answer.instance == marks.truth.instance))
    add_primitive("answer", answer.instance, answer.primitive, static_cast<double>(answer.t));
  if (is_truth) add_primitive("truth", marks.truth.instance, marks.truth.primitive, marks.truth.t);
  return slice;
}

}  // namespace plumbline
