// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/layers.h"

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

/// Whether `got` is the line into which the record of `node` takes `outer`. By bake.h (3) an origin is off by at most
/// 5 u |inverse| |o - T| per component and a direction by 4 u |inverse| |d|. A walk derives the ray from the world's,
/// so that the errors of up to kMaxDepth = 2^6 transforms add up, and |o - T| may be smaller than the terms that it
/// came of, which are at most the image's size: 2^9 u covers sqrt(3) * 5 * 2^6.
bool is_taken_to(const GeometryImage& image, std::uint32_t node, const Line& outer, const Line& got) {
  glm::dvec3 rows[3], shift{0.0};
  double norm = 0.0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const glm::dvec4 row(record_texel(image, node, i));
    rows[i] = glm::dvec3(row);
    shift[static_cast<int>(i)] = row.w;
    norm += glm::dot(rows[i], rows[i]);
  }
  norm = std::sqrt(norm);
  const auto times = [&](const glm::dvec3& v) {
    return glm::dvec3(glm::dot(rows[0], v), glm::dot(rows[1], v), glm::dot(rows[2], v));
  };
  const glm::dvec3 o = times(outer.o - shift), d = times(outer.d);
  const double length = glm::length(d), got_length = glm::length(got.d);
  if (!(length > 0.0 && got_length > 0.0)) return false;
  const double most = 0x1p9 * 0x1p-24 * norm;
  const double turned = glm::length(got.d / got_length - d / length);
  if (!(turned <= most * glm::length(outer.d) / length)) return false;
  // Origins may lie anywhere on the line: a ray from afar is moved.
  const glm::dvec3 m = got.o - o;
  const double beside = glm::length(m - glm::dot(m, d) / (length * length) * d);
  const double reach = glm::length(outer.o - shift) + glm::length(glm::dvec3(image.center)) + image.radius;
  return beside <= most * reach + turned * glm::length(m);
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
  std::vector<std::pair<std::uint32_t, Line>> spaces{{kNone, line_of(walk.start.ray)}};
  for (const WalkStep& step : walk.steps) {
    for (const SpaceChange& change : step.changes) {
      const Line line = line_of(change.ray);
      switch (change.kind) {
        case SpaceChange::Kind::entered:
        case SpaceChange::Kind::missed:
          if (change.node >= image.transform_count) return change.node;
          if (!is_taken_to(image, change.node, spaces.back().second, line)) return change.node;
          spaces.emplace_back(change.node, line);
          break;
        case SpaceChange::Kind::left: {
          if (spaces.size() < 2) return change.node;
          const Line inner = spaces.back().second;
          spaces.pop_back();
          // What comes out must go in again where it came from.
          if (change.node >= image.transform_count || !is_taken_to(image, change.node, line, inner)) return change.node;
          spaces.back().second = line;
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
  const bool is_placed = e.tracer.instance != kNone || e.expected.instance != kNone;
  if (e.brute_same) {
    if (is_placed && ray_led_astray(*e.image, *e.walk) != kNone) return Layer::transform;
    const bool found = e.tracer.kind == HitKind::hit && e.tracer.primitive == e.expected.primitive;
    return is_placed && found ? Layer::transform : Layer::primitive_arithmetic;
  }
  // A volume or a link that is as baked loses a ray only where the ray is not what it should be, or by its test.
  const bool as_baked = e.loss != nullptr && e.loss->as_baked.value_or(false);
  if (as_baked && is_placed && ray_led_astray(*e.image, *e.walk) != kNone) return Layer::transform;
  if (as_baked && e.loss->kind == LossKind::link && e.loss->transform != kNone) return Layer::transform;  // not entered
  if (e.loss == nullptr) return e.tracer.instance != kNone ? Layer::transform : Layer::tree;
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
  return is_placed && ray_led_astray(*e.image, *e.walk) != kNone ? Layer::transform : Layer::tree;
}

}  // namespace plumbline
