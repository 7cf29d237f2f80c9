// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/walk_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/error.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"

namespace plumbline {
namespace {

constexpr double kNearDraw = 0x1p-15;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Line {
  glm::dvec3 o{0.0}, d{0.0};
};

/// What a space is measured by: its ball.
struct Extent {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

class Walker {
 public:
  Walker(const GeometryImage& image, bool any) : image_(image), any_(any) {}

  ModelWalk walk(const Ray& ray) {
    PLUMBLINE_ASSERT(image_.scale_exponent == 0);
    best_ = static_cast<double>(ray.t_max);
    if (best_ > 0.0) walk_space(kNone, {glm::dvec3(ray.origin), glm::dvec3(ray.direction)});
    return result_;
  }

 private:
  /// Which of two numbers is greater, and whether that is clear.
  bool less(double a, double b, double draw) {
    if (!(std::abs(a - b) > draw)) result_.is_clear = false;
    return a < b;
  }

  Extent extent_of(std::uint32_t space) const {
    if (space == kNone) return {glm::dvec3(image_.center), static_cast<double>(image_.radius)};
    const glm::dvec4 ball(record_texel(image_, space, 6));
    return {glm::dvec3(ball), ball.w};
  }

  /// Rays from afar are asked first whether they come near what stands in a space.
  bool passes_by(const Line& line, const Extent& extent) {
    const glm::dvec3 m = extent.center - line.o;
    const double along = glm::dot(m, line.d) / glm::dot(line.d, line.d);
    if (less(glm::length(m), 2.0 * extent.radius, kNearDraw * extent.radius)) return false;
    if (less(along * glm::length(line.d), 0.0, kNearDraw * extent.radius)) return true;
    return less(1.25 * extent.radius, glm::length(m - along * line.d), kNearDraw * extent.radius);
  }

  void walk_space(std::uint32_t space, const Line& line) {
    const Extent extent = extent_of(space);
    if (passes_by(line, extent)) return;
    // What 32 bits may lose anywhere on the way.
    const double draw = kNearDraw * (4.0 * extent.radius + glm::length(extent.center));
    std::uint32_t octant = 0;
    for (int a = 0; a < 3; ++a) octant |= line.d[a] < 0.0 ? 1u << a : 0u;
    for (int a = 0; a < 3; ++a)
      if (std::abs(line.d[a]) < 1e-6 * glm::length(line.d)) result_.is_clear = false;
    const auto copy = region_copy(image_, space, image_.copy_count > 1 ? octant : 0);
    PLUMBLINE_ASSERT(copy);
    for (std::uint32_t cell = copy->begin; result_.is_clear && !is_done_;) {
      if (cell == kNone) {
        if (is_compact(image_)) ++result_.steps;  // the end's texel
        return;
      }
      ++result_.steps;
      const NodeCell node = node_cell(image_, cell);
      if (node.is_end) return;
      const bool is_hit = meets(volume_at(image_, cell), line, draw);
      if (is_hit && node.cluster != kNone) test_cluster(node.cluster, line, draw);
      if (is_hit && node.transform != kNone) enter(node.transform, line);
      cell = is_hit && !node.is_leaf ? node.in : node.out;
    }
  }

  bool meets(const Volume& volume, const Line& line, double draw) {
    if (!volume.is_box) {
      const glm::dvec3 m = glm::dvec3(volume.center) - line.o;
      const double s = std::clamp(glm::dot(m, line.d) / glm::dot(line.d, line.d), 0.0, best_);
      return less(glm::length(m - s * line.d), std::sqrt(static_cast<double>(volume.radius2)), draw);
    }
    // An axis along which the ray does not move leaves its walk unclear.
    double enter = 0.0, leave = best_, enter_draw = 0.0, leave_draw = 0.0;
    for (int a = 0; a < 3; ++a) {
      double t0 = (static_cast<double>(volume.lower[a]) - line.o[a]) / line.d[a];
      double t1 = (static_cast<double>(volume.upper[a]) - line.o[a]) / line.d[a];
      if (t0 > t1) std::swap(t0, t1);
      const double axis_draw = draw / std::abs(line.d[a]);
      if (t0 > enter) enter = t0, enter_draw = axis_draw;
      if (t1 < leave) leave = t1, leave_draw = axis_draw;
    }
    return less(enter, leave, enter_draw + leave_draw + draw / glm::length(line.d));
  }

  void test_cluster(std::uint32_t first, const Line& line, double draw) {
    for (std::uint32_t k = first;; ++k) {
      const StoredPrimitive p = stored_primitive(image_, k);
      ++result_.tests;
      const double t = p.is_triangle ? meet_triangle(p, line, draw) : meet_sphere(p, line, draw);
      const double t_draw = draw / glm::length(line.d);
      if (t < kInfinity && less(t, best_, t_draw)) best_ = t, is_done_ = any_;
      if (p.label < 0.0f) return;
    }
  }

  /// The t of the first hit above 0; infinite for none.
  double meet_sphere(const StoredPrimitive& p, const Line& line, double draw) {
    const double d2 = glm::dot(line.d, line.d);
    const glm::dvec3 m = glm::dvec3(p.a) - line.o;
    const double foot = glm::dot(m, line.d) / d2, r = p.radius;
    const glm::dvec3 f = m - foot * line.d;
    if (less(r, glm::length(f), 64.0 * draw * draw / r + draw)) return kInfinity;
    const double half = std::sqrt(std::max(0.0, r * r - glm::dot(f, f)) / d2), t_draw = 64.0 * draw / std::sqrt(d2);
    if (less(0.0, foot - half, t_draw)) return foot - half;
    return less(0.0, foot + half, t_draw) ? foot + half : kInfinity;
  }

  double meet_triangle(const StoredPrimitive& p, const Line& line, double draw) {
    const glm::dvec3 a = glm::dvec3(p.a) - line.o, b = glm::dvec3(p.b) - line.o, c = glm::dvec3(p.c) - line.o;
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double speed = glm::length(line.d), facing = glm::dot(n, line.d) / speed;
    // Distances from the edges' lines, across the ray; positive inside.
    const auto beside = [&](const glm::dvec3& from, const glm::dvec3& to) {
      const glm::dvec3 across = glm::cross(to - from, line.d / speed);
      return glm::dot(from, across) / std::max(glm::length(across), 1e-300) * (facing < 0.0 ? -1.0 : 1.0);
    };
    const double inside = std::min({beside(a, b), beside(b, c), beside(c, a)});
    if (inside < -4.0 * draw) return kInfinity;
    // Seen edge-on, or near an edge: not for this model. The shader's measure is the projected area over the square of
    // the farthest projected corner, along an axis that shortens neither by more than sqrt(3).
    const auto from_line = [&](const glm::dvec3& p2) { return glm::length(glm::cross(p2, line.d / speed)); };
    const double farthest = std::max({from_line(a), from_line(b), from_line(c)});
    if (inside < 4.0 * draw || std::abs(facing) < 0x1p-5 * farthest * farthest) result_.is_clear = false;
    const double t = glm::dot(a, n) / (facing * speed);
    return less(0.0, t, 64.0 * draw / speed) ? t : kInfinity;
  }

  void enter(std::uint32_t node, const Line& line) {
    ++result_.transforms;
    const glm::dvec4 rows[3] = {glm::dvec4(record_texel(image_, node, 0)), glm::dvec4(record_texel(image_, node, 1)),
                                glm::dvec4(record_texel(image_, node, 2))};
    const glm::dvec3 from = line.o - glm::dvec3(rows[0].w, rows[1].w, rows[2].w);
    Line inner;
    for (int a = 0; a < 3; ++a)
      inner.o[a] = glm::dot(glm::dvec3(rows[a]), from), inner.d[a] = glm::dot(glm::dvec3(rows[a]), line.d);
    walk_space(node, inner);
  }

  const GeometryImage& image_;
  bool any_ = false, is_done_ = false;
  double best_ = 0.0;
  ModelWalk result_;
};

}  // namespace

ModelWalk model_walk(const GeometryImage& image, const Ray& ray, bool any) { return Walker(image, any).walk(ray); }

}  // namespace plumbline
