// SPDX-License-Identifier: MIT
// Captured walks for readers.
#include <cmath>
#include <cstdio>
#include <string>

#include "tracer/image_view.h"
#include "tracer/walk_analysis.h"
#include "tracer/walk_trace.h"

namespace plumbline {
namespace {

std::string number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

}  // namespace

const char* name_of(NodeTest test) {
  switch (test) {
    case NodeTest::hit:
      return "hit";
    case NodeTest::missed:
      return "missed";
    case NodeTest::behind:
      return "behind";
    case NodeTest::beyond:
      return "beyond";
    case NodeTest::end:
      return "end";
    case NodeTest::not_a_number:
      break;
  }
  return "not_a_number";
}

const char* name_of(PrimitiveTest test) {
  switch (test) {
    case PrimitiveTest::new_nearest:
      return "new_nearest";
    case PrimitiveTest::outside:
      return "outside";
    case PrimitiveTest::behind:
      return "behind";
    case PrimitiveTest::farther:
      return "farther";
    case PrimitiveTest::tie_lost:
      return "tie_lost";
    case PrimitiveTest::edge_on:
      return "edge_on";
    case PrimitiveTest::not_a_number:
      break;
  }
  return "not_a_number";
}

const char* name_of(LossKind kind) {
  switch (kind) {
    case LossKind::none:
      return "none";
    case LossKind::nearer:
      return "nearer";
    case LossKind::bounds:
      return "bounds";
    case LossKind::link:
      return "link";
    case LossKind::way_in:
      return "way_in";
    case LossKind::way_out:
      return "way_out";
    case LossKind::leaf:
      return "leaf";
    case LossKind::primitive:
      return "primitive";
    case LossKind::capped:
      return "capped";
    case LossKind::absent:
      return "absent";
    case LossKind::unknown:
      break;
  }
  return "unknown";
}

std::string describe(const Loss& loss, const GeometryImage& image, const ExpectedHit& expected) {
  const auto short_number = [](double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.3g", value);
    return std::string(buffer);
  };
  const auto cell = [&](std::uint32_t c) {
    if (c == kNone || c >= unit_count(image))
      return std::string(c == kNone ? "the end" : "a place outside of the image");
    const std::size_t texel = unit_texel(image, c), width = static_cast<std::size_t>(image.width);
    return "cell (" + std::to_string(texel % width) + ", " + std::to_string(texel / width) + ")";
  };
  const std::string transform = "transform " + std::to_string(loss.transform);
  std::string node = (loss.node == kNone ? "what was read" : "node " + std::to_string(loss.node)) + " at cell (" +
                     std::to_string(loss.x) + ", " + std::to_string(loss.y) + ")";
  if (loss.space != kNone) node += " behind transform " + std::to_string(loss.space);
  std::string primitive = "primitive " + std::to_string(expected.primitive);
  if (expected.instance != kNone) primitive += " of instance " + std::to_string(expected.instance);
  const std::string is_hit = " is hit" + (std::isnan(expected.t) ? "" : " at t = " + number(expected.t));
  std::string text;
  switch (loss.kind) {
    case LossKind::none:
      return primitive + is_hit + ", and was found";
    case LossKind::nearer:
      text = loss.test ? primitive + " was found at t = " + number(static_cast<double>(loss.test->t)) +
                             " of its space, and something nearer or of a lower number beside it"
                       : node + " above " + primitive + " lies behind a hit that was found before";
      return text;
    case LossKind::bounds: {
      std::string amount = short_number(loss.shortfall) + " (units of its space";
      if (!std::isnan(loss.world_shortfall)) amount += ", " + short_number(loss.world_shortfall) + " of the world";
      amount += ")";
      const std::string below = "; " + primitive + " below it" + is_hit;
      if (has_boxes(image))
        text = "box of " + node + " rejected the ray" + below + "; the box is left " + short_number(loss.shortfall) +
               " in t before it is entered";
      else if (std::isnan(loss.shortfall))
        text = "sphere of " + node + " rejected the ray" + below + "; the test compared a NaN";
      else if (loss.as_baked.value_or(true))  // as baked, or not known: then it need not be the sphere's fault
        text = "sphere of " + node + " rejected the ray by " + amount + below;
      else
        text = "sphere of " + node + " rejected the ray" + below + "; the sphere is too small by " + amount;
      break;
    }
    case LossKind::link:
      text = loss.transform != kNone
                 ? "leaf " + node + " does not lead to what it should, past " + primitive
                 : "a link of " + node + " leads " + (loss.reached_cell <= loss.cell ? "back " : "") + "to " +
                       cell(loss.reached_cell) +
                       (loss.expected_cell == kNone ? "" : ", not to " + cell(loss.expected_cell)) + ", past " +
                       primitive;
      text += ", which" + is_hit;
      break;
    case LossKind::way_in:
      text = "the way in of " + transform + " is wrong, seen at " + node + "; " + primitive + " behind it" + is_hit;
      break;
    case LossKind::way_out:
      text = loss.space == loss.transform
                 ? transform + " is not left where it should be, at " + node
                 : transform + " was left to " + cell(loss.reached_cell) + ", not to " + cell(loss.expected_cell);
      text += "; " + primitive + is_hit;
      break;
    case LossKind::leaf:
      text = "leaf " + node + " was entered, but " + primitive + ", which" + is_hit + ", was not tested there";
      if (loss.stored != kNone) {
        const auto unit = static_cast<std::uint32_t>(primitive_unit(image, loss.stored));
        text += "; the label at " + cell(unit) + " is not the sound one";
      }
      break;
    case LossKind::primitive:
      text = "the test of " + primitive + " in leaf " + node + " says " + name_of(loss.test->outcome) + "; it" + is_hit;
      break;
    case LossKind::capped:
      text = "the walk did not end within " + std::to_string(image.cell_count) + " nodes; " + primitive + is_hit;
      break;
    case LossKind::absent:
      text = "the image does not hold " + primitive + ", which" + is_hit;
      break;
    case LossKind::unknown:
      text = "what was captured does not tell where " + primitive + ", which" + is_hit + ", was lost";
      break;
  }
  if (loss.as_baked.value_or(false))
    text += "; the image is as baked there: the arithmetic, the driver or the ray is at fault";
  return text;
}

std::string describe(const WalkStep& step, Bounds bounds) {
  std::string text =
      std::to_string(step.number) + ": cell (" + std::to_string(step.x) + ", " + std::to_string(step.y) + ")";
  if (step.node != kNone) text += ", node " + std::to_string(step.node);
  if (step.space != kNone) text += " behind transform " + std::to_string(step.space);
  text += ": ";
  text += name_of(step.test);
  if (step.test != NodeTest::end) {
    text += bounds == Bounds::aabb ? " (slabs " + number(step.enter) + " to " + number(step.leave)
                                   : " (distance^2 " + number(step.distance2) + ", radius^2 " + number(step.radius2);
    text += ", nearest so far " + number(step.bound) + ")";
  }
  if (step.again) text += ", once more";
  for (const TestedPrimitive& tested : step.primitives) {
    text += "; primitive " + (tested.primitive == kNone ? "without a number" : std::to_string(tested.primitive)) +
            ": " + name_of(tested.outcome) + " at t = " + number(tested.t);
  }
  for (const SpaceChange& change : step.changes) {
    const std::string node = std::to_string(change.node);
    switch (change.kind) {
      case SpaceChange::Kind::started:
        break;
      case SpaceChange::Kind::resumed:
        text += "; goes on in another pass";
        break;
      case SpaceChange::Kind::entered:
        text += "; enters transform " + node;
        break;
      case SpaceChange::Kind::missed:
        text += "; misses all behind transform " + node;
        break;
      case SpaceChange::Kind::left:
        text += "; leaves transform " + node;
        break;
    }
  }
  if (step.ended) text += "; the end";
  return text;
}

}  // namespace plumbline
