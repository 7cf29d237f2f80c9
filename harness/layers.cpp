// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/layers.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tracer/image_view.h"

namespace plumbline {
namespace {

/// A ray in double.
struct Line {
  glm::dvec3 o{0.0}, d{0.0};
};
Line line_of(const SpaceRay& ray) { return {glm::dvec3(ray.o), glm::dvec3(ray.d)}; }

constexpr double u = 0x1p-24;

double norm_of(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

/// A node's record: into its space by inverse (x - shift). Norms are Frobenius', that no matrix of absolute values
/// exceeds.
struct Way {
  glm::dmat3 inverse{1.0};
  glm::dvec3 shift{0.0};
  double in_norm = 1.0, condition = 1.0;  ///< |inverse|, and that times |matrix|
  double out_norm = 1.0;
  double extent = 0.0;  ///< no moved origin is farther from the space's own than this: |centre| + 3 R of its ball
};
Way way_of(const GeometryImage& image, std::uint32_t node) {
  Way way;
  glm::dmat3 rows, out;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec4 row(record_texel(image, node, static_cast<std::uint32_t>(i)));
    rows[i] = glm::dvec3(row);
    way.shift[i] = row.w;
    out[i] = glm::dvec3(record_texel(image, node, static_cast<std::uint32_t>(3 + i)));
  }
  way.inverse = glm::transpose(rows);
  way.in_norm = norm_of(rows);
  way.out_norm = norm_of(out);
  way.condition = way.in_norm * way.out_norm;
  const glm::dvec4 ball(record_texel(image, node, 6));
  way.extent = glm::length(glm::dvec3(ball)) + 3.0 * std::abs(ball.w);
  return way;
}

/// A space that a walk is in. What leaving transforms by their inverses has added to the ray's error since it came in:
/// to its origin, in units of the space, and to its direction, as an angle. Zero where rays are restored: they come
/// back bit by bit.
struct Space {
  std::uint32_t node = kNone;
  Line line;
  double beside = 0.0, turned = 0.0;
};

/// Whether the record of the last space takes the line of the one before it to its own, but for rounding. By bake.h
/// (3), with norms for the matrices, entering puts the origin off by at most 5 u |A| |o - T| and the direction by 4 u
/// |A| |d|; an origin that is moved near the space's ball is rounded, by 2 u extent a component (placed_ray.cpp). What
/// the outer ray has drifted by counts twice: the inner one is derived from the world's where it was moved, else from
/// it.
bool is_taken_in(const GeometryImage& image, const std::vector<Space>& spaces) {
  double beside = 0.0, drift_turned = 0.0;
  for (std::size_t i = 0; i + 1 < spaces.size(); ++i) {
    const Way way = spaces[i].node == kNone ? Way{} : way_of(image, spaces[i].node);
    beside = way.in_norm * beside + spaces[i].beside;
    drift_turned = way.condition * drift_turned + spaces[i].turned;
  }
  const Line &outer = spaces[spaces.size() - 2].line, &got = spaces.back().line;
  const Way way = way_of(image, spaces.back().node);
  const glm::dvec3 o = way.inverse * (outer.o - way.shift), d = way.inverse * outer.d;
  const double length = glm::length(d), got_length = glm::length(got.d);
  if (!(length > 0.0 && got_length > 0.0)) return false;
  // Unit vectors of a and b differ by at most 2 |a - b| / |a|.
  const double turned = glm::length(got.d / got_length - d / length);
  const double stretch = way.in_norm * glm::length(outer.d) / length;
  if (!(turned <= 2.0 * stretch * (4.0 * u + 2.0 * drift_turned))) return false;
  // Origins may lie anywhere on the line: a ray from afar is moved.
  const glm::dvec3 m = got.o - o;
  const double off = glm::length(m - glm::dot(m, d) / (length * length) * d);
  const double origin = way.in_norm * (5.0 * u * glm::length(outer.o - way.shift) + 2.0 * beside);
  return off <= origin + 4.0 * u * way.extent + turned * glm::length(m);
}

/// Leaves the last space for `line`. By placed_ray.cpp the origin is off by 9 u K |o - T| + u |T| + |L| Q' |o - T| and
/// the direction by 7 u K |d| + |L| Q' |d|, with K = |L||A|; Q', the rounding of the inverse in double, is at most
/// 2^-50 |A| K^3 (cofactors are at most |L|^2, the determinant's terms |L|^3, and 1 / |D| at most |A|^3).
void leave(const GeometryImage& image, const Line& line, std::vector<Space>& spaces) {
  const Space inner = spaces.back();
  spaces.pop_back();
  Space& outer = spaces.back();
  outer.line = line;
  if (image.options.transform_out != TransformOut::inverse) return;
  const Way way = way_of(image, inner.node);
  const double k = way.condition, q = 0x1p-50 * k * k * k;
  outer.beside +=
      way.out_norm * inner.beside + k * (9.0 * u + q) * glm::length(line.o - way.shift) + u * glm::length(way.shift);
  outer.turned += k * (inner.turned + 7.0 * u + q);
}

/// The test by which a walk found its hit, and the ray of that space.
struct Finding {
  const TestedPrimitive* test = nullptr;
  Line line;
};
Finding finding_of(const Walk& walk) {
  Finding found;
  Line line = line_of(walk.start.ray);
  std::uint32_t space = kNone;
  for (const WalkStep& step : walk.steps) {
    for (const TestedPrimitive& test : step.primitives)
      if (test.outcome == PrimitiveTest::new_nearest && test.primitive == walk.hit.primitive &&
          space == walk.hit.instance)
        found = {&test, line};
    for (const SpaceChange& change : step.changes) line = line_of(change.ray), space = change.space;
  }
  return found;
}

/// Whether t and weights of a test belong to one point of the stored primitive, and to the right one, by bake.h (1):
/// the point at t lies within e + 25 u D of the one that a triangle's weights stand for, and within 20 u D of a sphere.
/// D is the distance to the farthest corner. e is 6 u M^3 / |det| in the projection along an axis, which stretches M by
/// sqrt 3 at most and det by 1 at least; 4 u M where the edge functions were computed exactly.
bool fits_captured_ray(const GeometryImage& image, const Finding& found) {
  const TestedPrimitive& test = *found.test;
  const StoredPrimitive p = stored_primitive(image, test.k);
  const double length = glm::length(found.line.d), t = test.t;
  const glm::dvec3 along = found.line.d / length, at = found.line.o + t * found.line.d;
  if (!p.is_triangle) {
    const glm::dvec3 m = at - glm::dvec3(p.a);
    const double allowed = 20.0 * u * (glm::length(glm::dvec3(p.a) - found.line.o) + p.radius);
    if (!(std::abs(glm::length(m) - p.radius) <= allowed)) return false;
    // The second root counts only where the first, as far before the perpendicular's foot, lies before the ray.
    const double behind_foot = glm::dot(m, along);
    const bool is_second = behind_foot > allowed;
    return !is_second || !(t * length - 2.0 * behind_foot > test.t_low * length + 2.0 * allowed);
  }
  const glm::dvec3 corners[3] = {glm::dvec3(p.a), glm::dvec3(p.b), glm::dvec3(p.c)};
  double far = 0.0, across = 0.0;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 m = corner - found.line.o;
    far = std::max(far, glm::length(m));
    across = std::max(across, glm::length(m - glm::dot(m, along) * along));
  }
  const double area = std::abs(glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), along));
  const double stretched = std::sqrt(3.0) * across;
  const double e = test.resolved ? 4.0 * u * stretched : 6.0 * u * stretched * stretched * stretched / area;
  const glm::dvec2 w(test.weights);
  const glm::dvec3 point = (1.0 - w.x - w.y) * corners[0] + w.x * corners[1] + w.y * corners[2];
  return glm::length(at - point) <= e + 25.0 * u * far;
}

/// Whether the normal of a hit points to the other side than the stored primitive's, seen from its space. Of a matrix
/// that mirrors nothing no mistake with transforms does that.
bool is_turned(const GeometryImage& image, const Walk& walk, const Finding& found) {
  const StoredPrimitive p = stored_primitive(image, found.test->k);
  glm::dvec3 local = p.is_triangle ? glm::cross(glm::dvec3(p.b) - glm::dvec3(p.a), glm::dvec3(p.c) - glm::dvec3(p.a))
                                   : found.line.o + static_cast<double>(found.test->t) * found.line.d - glm::dvec3(p.a);
  std::uint32_t node = walk.hit.instance;
  for (std::uint32_t depth = 0; node != kNone && node < image.transform_count && depth < kMaxDepth; ++depth) {
    const Way way = way_of(image, node);
    if (!(glm::determinant(way.inverse) > 0.0)) return false;
    local = glm::transpose(way.inverse) * local;
    const float parent = record_texel(image, node, 3).w;
    node = parent >= 1.0f ? static_cast<std::uint32_t>(parent) - 1 : kNone;
  }
  const glm::dvec3 got(walk.hit.normal);
  // As good as opposite: beyond 2^-10 of a right angle's cosine nothing but a sign is at fault.
  return glm::dot(glm::normalize(local), got) < 0.0 && glm::length(glm::cross(glm::normalize(local), got)) <= 0x1p-10;
}

bool is_stored_as_baked(const LayerEvidence& e, std::uint32_t k) {
  if (e.sound == nullptr || k >= e.sound->primitive_count) return true;
  for (const std::size_t texel : primitive_texels(*e.image, k))
    if (!same_bits(e.image->texels[texel], e.sound->texels[texel])) return false;
  return true;
}

/// Of the nodes around an instance, whether a record's matrices are other ones than were baked.
bool has_other_matrix(const LayerEvidence& e, std::uint32_t node) {
  if (e.sound == nullptr) return false;
  for (std::uint32_t depth = 0; node != kNone && node < e.sound->transform_count && depth < kMaxDepth; ++depth) {
    for (std::uint32_t i = 0; i < 6; ++i)
      if (!same_bits(record_texel(*e.image, node, i), record_texel(*e.sound, node, i))) return true;
    const float parent = record_texel(*e.sound, node, 3).w;
    node = parent >= 1.0f ? static_cast<std::uint32_t>(parent) - 1 : kNone;
  }
  return false;
}

bool is_led_astray(const LayerEvidence& e) {
  return e.image->transform_count > 0 && ray_led_astray(*e.image, *e.walk) != kNone;
}

/// The right primitive with wrong values: what is stored, the way there, the primitive's own arithmetic, or the way
/// out.
Layer layer_of_values(const LayerEvidence& e) {
  const Finding found = finding_of(*e.walk);
  if (found.test != nullptr && !is_stored_as_baked(e, found.test->k)) return Layer::tree;
  if (is_led_astray(e) || has_other_matrix(e, e.tracer.instance)) return Layer::transform;
  if (e.tracer.instance == kNone || found.test == nullptr) return Layer::primitive_arithmetic;
  const bool fits = fits_captured_ray(*e.image, found) && !is_turned(*e.image, *e.walk, found);
  return fits ? Layer::transform : Layer::primitive_arithmetic;
}

/// Something was hit where nothing should be.
Layer layer_of_extra(const LayerEvidence& e) {
  if (is_led_astray(e) || has_other_matrix(e, e.tracer.instance)) return Layer::transform;
  return Layer::tree;
}

}  // namespace

std::string_view name_of(Layer layer) {
  switch (layer) {
    case Layer::none:
      break;
    case Layer::tree:
      return "tree";
    case Layer::links:
      return "links";
    case Layer::bounds:
      return "bounds";
    case Layer::transform:
      return "transform";
    case Layer::primitive_arithmetic:
      return "primitive arithmetic";
    case Layer::driver:
      return "driver";
  }
  return "";
}

std::uint32_t ray_led_astray(const GeometryImage& image, const Walk& walk) {
  std::vector<Space> spaces{{kNone, line_of(walk.start.ray)}};
  for (const WalkStep& step : walk.steps) {
    for (const SpaceChange& change : step.changes) {
      const Line line = line_of(change.ray);
      switch (change.kind) {
        case SpaceChange::Kind::entered:
        case SpaceChange::Kind::missed:
          if (change.node >= image.transform_count) return change.node;
          spaces.push_back({change.node, line});
          if (!is_taken_in(image, spaces)) return change.node;
          break;
        case SpaceChange::Kind::left: {
          if (spaces.size() < 2 || change.node != spaces.back().node) return change.node;
          Space inner = spaces.back();
          leave(image, line, spaces);
          // What comes out must go in again where it came from.
          inner.beside = inner.turned = 0.0;
          spaces.push_back(inner);
          if (!is_taken_in(image, spaces)) return change.node;
          spaces.pop_back();
          break;
        }
        case SpaceChange::Kind::started:
        case SpaceChange::Kind::resumed:
          break;
      }
    }
  }
  return kNone;
}

Layer layer_of(const LayerEvidence& e) {
  const Hit& walked = e.walk->hit;
  if (!e.walk->driver_agrees || walked.kind != e.tracer.kind || walked.primitive != e.tracer.primitive ||
      walked.instance != e.tracer.instance)
    return Layer::driver;
  const bool is_primitive = e.tracer.kind == HitKind::hit && e.tracer.primitive == e.expected.primitive;
  if (is_primitive && e.tracer.instance == e.expected.instance) return layer_of_values(e);
  // No step found it in the space that is named: what came out of its space has lost its way.
  if (is_primitive && finding_of(*e.walk).test == nullptr && e.walk->skipped == 0) return Layer::transform;
  const bool is_placed = e.tracer.instance != kNone || e.expected.instance != kNone;
  if (e.brute_same) return is_placed && is_led_astray(e) ? Layer::transform : Layer::primitive_arithmetic;
  // A volume or a link that is as baked loses a ray only where the ray is not what it should be, or by its test.
  const bool as_baked = e.loss != nullptr && e.loss->as_baked.value_or(false);
  if (as_baked && is_placed && is_led_astray(e)) return Layer::transform;
  if (as_baked && e.loss->kind == LossKind::link && e.loss->transform != kNone) return Layer::transform;  // not entered
  if (e.loss == nullptr) return layer_of_extra(e);
  switch (e.loss->kind) {
    case LossKind::bounds:
      return Layer::bounds;
    case LossKind::link:
    case LossKind::capped:
      return Layer::links;
    case LossKind::way_in:
    case LossKind::way_out:
      return Layer::transform;
    case LossKind::primitive:
      if (!e.loss->as_baked.value_or(false)) return Layer::tree;
      return is_placed ? Layer::transform : Layer::primitive_arithmetic;
    case LossKind::nearer:
      // It was tested, and is nearer than what was kept: the comparison is wrong, whatever the order of the tests.
      if (e.loss->test && e.loss->test->outcome == PrimitiveTest::farther &&
          e.loss->test->t_world < e.loss->test->nearest_before)
        return Layer::primitive_arithmetic;
      break;
    case LossKind::none:
    case LossKind::leaf:
    case LossKind::absent:
    case LossKind::unknown:
      break;
  }
  return is_placed && is_led_astray(e) ? Layer::transform : Layer::tree;
}

}  // namespace plumbline
