// SPDX-License-Identifier: MIT
// Where two captured walks part.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <string>

#include "tracer/walk_analysis.h"

namespace plumbline {
namespace {

bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }
template <glm::length_t N>
bool same(const glm::vec<N, float>& a, const glm::vec<N, float>& b) {
  bool equal = true;
  for (glm::length_t i = 0; i < N; ++i) equal = equal && same(a[i], b[i]);
  return equal;
}

std::string number(float value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", static_cast<double>(value));
  return buffer;
}
template <typename T>
std::string versus(const std::string& what, const T& a, const T& b) {
  return what + " is " + a + " in the first, " + b + " in the second";
}

std::string place(const WalkStep& step) {
  return "cell (" + std::to_string(step.x) + ", " + std::to_string(step.y) + ")" +
         (step.space == kNone ? "" : " behind transform " + std::to_string(step.space));
}

/// What differs between two tests of primitives; empty: nothing.
std::string difference(const TestedPrimitive& a, const TestedPrimitive& b) {
  if (a.primitive != b.primitive || a.k != b.k)
    return versus("the primitive tested", std::to_string(a.primitive), std::to_string(b.primitive));
  const std::string of = " of primitive " + std::to_string(a.primitive);
  if (!same(a.t, b.t)) return versus("t" + of, number(a.t), number(b.t));
  if (a.outcome != b.outcome)
    return versus("the test" + of, std::string(name_of(a.outcome)), std::string(name_of(b.outcome)));
  if (!same(a.weights, b.weights) || !same(a.numbers, b.numbers) || !same(a.t_low, b.t_low))
    return "the numbers" + of + " differ";
  if (!same(a.nearest_before, b.nearest_before))
    return versus("the nearest hit before the test" + of, number(a.nearest_before), number(b.nearest_before));
  if (!same(a.nearest_after, b.nearest_after))
    return versus("the nearest hit after the test" + of, number(a.nearest_after), number(b.nearest_after));
  return {};
}

std::string difference(const SpaceChange& a, const SpaceChange& b) {
  if (a.kind != b.kind || a.node != b.node || a.space != b.space) return "the changes of space differ";
  if (!same(a.ray.o, b.ray.o) || !same(a.ray.d, b.ray.d) || !same(a.ray.t_scale, b.ray.t_scale) ||
      !same(a.ray.t_shift, b.ray.t_shift) || !same(a.ray.t_low, b.ray.t_low) || !same(a.ray.bound, b.ray.bound))
    return a.node == kNone ? "the ray differs" : "the ray at transform " + std::to_string(a.node) + " differs";
  return {};
}

std::string difference(const WalkStep& a, const WalkStep& b) {
  if (a.cell != b.cell || a.space != b.space) return "the first visits " + place(a) + ", the second " + place(b);
  if (!same(a.distance2, b.distance2))
    return versus("the squared distance from " + place(a), number(a.distance2), number(b.distance2));
  if (!same(a.radius2, b.radius2))
    return versus("the squared radius of " + place(a), number(a.radius2), number(b.radius2));
  if (!same(a.enter, b.enter) || !same(a.leave, b.leave)) return "the slabs of " + place(a) + " differ";
  if (!same(a.bound, b.bound)) return versus("the nearest hit at " + place(a), number(a.bound), number(b.bound));
  if (a.test != b.test)
    return versus("the test of " + place(a), std::string(name_of(a.test)), std::string(name_of(b.test)));
  if (!same(a.word, b.word)) return "the words of " + place(a) + " differ";
  if (!same(a.link, b.link)) return "the links taken at " + place(a) + " differ";
  for (std::size_t i = 0; i < std::min(a.primitives.size(), b.primitives.size()); ++i)
    if (std::string d = difference(a.primitives[i], b.primitives[i]); !d.empty()) return d + ", at " + place(a);
  if (a.primitives.size() != b.primitives.size())
    return "the first tests " + std::to_string(a.primitives.size()) + " primitives at " + place(a) + ", the second " +
           std::to_string(b.primitives.size());
  for (std::size_t i = 0; i < std::min(a.changes.size(), b.changes.size()); ++i)
    if (std::string d = difference(a.changes[i], b.changes[i]); !d.empty()) return d + ", at " + place(a);
  if (a.changes.size() != b.changes.size())
    return "the first changes space " + std::to_string(a.changes.size()) + " times at " + place(a) + ", the second " +
           std::to_string(b.changes.size());
  if (a.number != b.number || a.again != b.again) return "the count of steps at " + place(a) + " differs";
  return {};
}

}  // namespace

std::optional<Divergence> first_divergence(const Walk& a, const Walk& b) {
  if (std::string d = difference(a.start, b.start); !d.empty()) return Divergence{0, d + " at the start"};
  const std::size_t common = std::min(a.steps.size(), b.steps.size());
  for (std::size_t i = 0; i < common; ++i)
    if (std::string d = difference(a.steps[i], b.steps[i]); !d.empty()) return Divergence{i, std::move(d)};
  if (a.steps.size() == b.steps.size()) return std::nullopt;
  const bool first = a.steps.size() > b.steps.size();
  return Divergence{common, std::string(first ? "the second" : "the first") + " has ended; the other visits " +
                                place(first ? a.steps[common] : b.steps[common])};
}

}  // namespace plumbline
