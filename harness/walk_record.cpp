// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/walk_record.h"

#include <algorithm>

#include "scenes/error.h"

namespace plumbline {
namespace {

static_assert(kNone == kNoNumber);

std::array<float, 2> array_of(const glm::vec2& v) { return {v.x, v.y}; }
std::array<float, 3> array_of(const glm::vec3& v) { return {v.x, v.y, v.z}; }
std::array<float, 4> array_of(const glm::vec4& v) { return {v.x, v.y, v.z, v.w}; }
glm::vec2 vector_of(const std::array<float, 2>& a) { return {a[0], a[1]}; }
glm::vec3 vector_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
glm::vec4 vector_of(const std::array<float, 4>& a) { return {a[0], a[1], a[2], a[3]}; }

const char* kind_name(SpaceChange::Kind kind) {
  switch (kind) {
    case SpaceChange::Kind::started:
      return "started";
    case SpaceChange::Kind::resumed:
      return "resumed";
    case SpaceChange::Kind::entered:
      return "entered";
    case SpaceChange::Kind::missed:
      return "missed";
    case SpaceChange::Kind::left:
      break;
  }
  return "left";
}

/// The value of an enumeration, from 0 to `last`, that has this name.
template <typename E, typename Name>
E value_named(const std::string& name, E last, const Name& name_of_value, const std::string& file) {
  for (int i = 0; i <= static_cast<int>(last); ++i)
    if (name == name_of_value(static_cast<E>(i))) return static_cast<E>(i);
  throw InputError(file + ": '" + name + "' is nothing that a walk tells; write the walk again with `explain --json`");
}

PrimitiveStepRecord record_of(const TestedPrimitive& p) {
  PrimitiveStepRecord r;
  r.primitive = p.primitive, r.stored = p.k;
  r.outcome = name_of(p.outcome);
  r.is_sphere = p.is_sphere, r.is_last = p.is_last, r.resolved = p.resolved;
  r.t = p.t, r.t_world = p.t_world, r.t_low = p.t_low;
  r.nearest_before = p.nearest_before, r.nearest_after = p.nearest_after;
  r.weights = array_of(p.weights), r.numbers = array_of(p.numbers);
  return r;
}
TestedPrimitive primitive_of(const PrimitiveStepRecord& r, const std::string& file) {
  TestedPrimitive p;
  p.primitive = r.primitive, p.k = r.stored;
  p.outcome = value_named(
      r.outcome, PrimitiveTest::not_a_number, [](PrimitiveTest t) { return name_of(t); }, file);
  p.is_sphere = r.is_sphere, p.is_last = r.is_last, p.resolved = r.resolved;
  p.t = r.t, p.t_world = r.t_world, p.t_low = r.t_low;
  p.nearest_before = r.nearest_before, p.nearest_after = r.nearest_after;
  p.weights = vector_of(r.weights), p.numbers = vector_of(r.numbers);
  return p;
}

SpaceStepRecord record_of(const SpaceChange& c) {
  return {kind_name(c.kind), c.node,        c.space,       c.copy,      array_of(c.ray.o),
          array_of(c.ray.d), c.ray.t_scale, c.ray.t_shift, c.ray.t_low, c.ray.bound};
}
SpaceChange change_of(const SpaceStepRecord& r, const std::string& file) {
  SpaceChange c;
  c.kind = value_named(r.kind, SpaceChange::Kind::left, kind_name, file);
  c.node = r.node, c.space = r.space, c.copy = r.copy;
  c.ray = {vector_of(r.o), vector_of(r.d), r.t_scale, r.t_shift, r.t_low, r.bound};
  return c;
}

bool has_new_nearest(const WalkStep& step) {
  return std::any_of(step.primitives.begin(), step.primitives.end(),
                     [](const TestedPrimitive& p) { return p.outcome == PrimitiveTest::new_nearest; });
}

}  // namespace

std::string way_taken(const WalkStep& step, bool has_hit) {
  if (has_new_nearest(step)) return "new nearest";
  for (const SpaceChange& change : step.changes) {
    if (change.kind == SpaceChange::Kind::entered) return "transform in";
    if (change.kind == SpaceChange::Kind::missed) return "transform missed";
    if (change.kind == SpaceChange::Kind::left) return "transform out";
  }
  if (!step.primitives.empty()) return "leaf tested";
  switch (step.test) {
    case NodeTest::hit:
      return "entered";
    case NodeTest::missed:
      return "miss";
    case NodeTest::behind:
      return "behind";
    case NodeTest::beyond:
      return has_hit ? "beyond nearest" : "beyond t_max";
    case NodeTest::end:
      return "end";
    case NodeTest::not_a_number:
      break;
  }
  return "not a number";
}

StepRecord record_of(const WalkStep& s, bool has_hit) {
  StepRecord r;
  r.number = s.number, r.again = s.again, r.space = s.space, r.cell = s.cell, r.x = s.x, r.y = s.y;
  r.copy = s.copy, r.node = s.node;
  r.test = name_of(s.test), r.reason = way_taken(s, has_hit);
  r.bound = s.bound, r.distance2 = s.distance2, r.radius2 = s.radius2, r.foot = s.foot;
  r.line_distance2 = s.line_distance2, r.enter = s.enter, r.leave = s.leave, r.word = s.word;
  r.link = array_of(s.link);
  for (const TestedPrimitive& p : s.primitives) r.primitives.push_back(record_of(p));
  for (const SpaceChange& c : s.changes) r.changes.push_back(record_of(c));
  r.ended = s.ended, r.next = s.next;
  return r;
}

void record_walk(const Walk& walk, const Loss& loss, std::size_t most, ExplanationRecord& record) {
  std::vector<StepRecord> steps;
  bool has_hit = false;
  for (const WalkStep& step : walk.steps) {
    steps.push_back(record_of(step, has_hit));
    has_hit = has_hit || has_new_nearest(step);
    steps.back().notable = has_new_nearest(step) || !step.changes.empty() || step.again || step.ended;
  }
  for (const Ancestor& ancestor : loss.chain)
    if (ancestor.step < steps.size()) steps[ancestor.step].on_chain = steps[ancestor.step].notable = true;
  if (loss.step < steps.size()) steps[loss.step].notable = true;
  if (!steps.empty()) steps.front().notable = steps.back().notable = true;

  record.start = record_of(walk.start);
  record.total_steps = walk.steps.empty() ? 0 : std::max<std::uint64_t>(walk.hit.steps, walk.steps.size());
  record.skipped = walk.skipped;
  record.driver_agrees = walk.driver_agrees;
  if (steps.size() <= most) {
    record.steps = std::move(steps);
    return;
  }
  // Indices into the steps (of the chain, of the fault) are those of what is kept.
  const auto notable = static_cast<std::size_t>(
      std::count_if(steps.begin(), steps.end(), [](const StepRecord& s) { return s.notable; }));
  std::size_t others = most > notable ? most - notable : 0, left = most;
  std::vector<std::uint32_t> kept_as(steps.size(), kNoNumber);
  for (std::size_t i = 0; i < steps.size() && left > 0; ++i) {
    const bool is_fault = i == loss.step;
    if (!steps[i].notable && others == 0) continue;
    if (!steps[i].notable) --others;
    if (left == 1 && !is_fault && loss.step > i && loss.step < steps.size()) continue;  // room for the fault
    --left;
    kept_as[i] = static_cast<std::uint32_t>(record.steps.size());
    record.steps.push_back(std::move(steps[i]));
  }
  const auto renumber = [&](std::uint32_t& index) {
    if (index < kept_as.size()) index = kept_as[index];
  };
  for (AncestorRecord& ancestor : record.chain) renumber(ancestor.step);
  renumber(record.fault.step);
  for (ShapeRecord& shape : record.slice.shapes) renumber(shape.step);
}

Walk walk_of(const ExplanationRecord& record, const std::string& file) {
  Walk walk;
  walk.start = change_of(record.start, file);
  for (const StepRecord& r : record.steps) {
    WalkStep s;
    s.number = r.number, s.again = r.again, s.space = r.space, s.cell = r.cell, s.x = r.x, s.y = r.y;
    s.copy = r.copy, s.node = r.node;
    s.test = value_named(
        r.test, NodeTest::not_a_number, [](NodeTest t) { return name_of(t); }, file);
    s.bound = r.bound, s.distance2 = r.distance2, s.radius2 = r.radius2, s.foot = r.foot;
    s.line_distance2 = r.line_distance2, s.enter = r.enter, s.leave = r.leave, s.word = r.word;
    s.link = vector_of(r.link);
    for (const PrimitiveStepRecord& p : r.primitives) s.primitives.push_back(primitive_of(p, file));
    for (const SpaceStepRecord& c : r.changes) s.changes.push_back(change_of(c, file));
    s.ended = r.ended, s.next = r.next;
    walk.steps.push_back(std::move(s));
  }
  return walk;
}

std::string shape_of(const GeometryImage& image) {
  const auto number = [](const char* name, std::uint64_t value) {
    return std::string(", ") + name + " " + std::to_string(value);
  };
  return std::string(name_of(image.options.layout)) + " " + name_of(image.options.bounds) + " " +
         name_of(image.options.links) + number("width", static_cast<std::uint64_t>(image.width)) +
         number("height", static_cast<std::uint64_t>(image.height)) + number("copies", image.copy_count) +
         number("copy size", image.copy_size) + number("primitives from", image.primitive_start) +
         number("each", image.primitive_stride) + number("in all", image.primitive_count) +
         number("transforms from", image.transform_start) + number("in all", image.transform_count);
}

}  // namespace plumbline
