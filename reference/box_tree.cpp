// SPDX-License-Identifier: GPL-3.0-or-later
// Builds the arbiter's tree of boxes, and tests boxes so that rounding can only ever let one too many pass.
#include "reference/box_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr std::uint32_t kLeafSize = 4, kBins = 16, kParallelFrom = 4096;
constexpr int kMaxSahDepth = 48;  ///< deeper ranges are halved, so no path exceeds 48 + 32 levels

void grow(Box& box, const Box& other) {
  box.lower = glm::min(box.lower, other.lower);
  box.upper = glm::max(box.upper, other.upper);
}

/// Half the surface, in double so that no scale overflows; zero for an empty box.
double half_area(const Box& box) {
  const glm::dvec3 size = glm::dvec3(box.upper) - glm::dvec3(box.lower);
  return size.x < 0.0 ? 0.0 : size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Twice the centre: no rounding of consequence, no overflow.
glm::dvec3 doubled_center(const Box& box) { return glm::dvec3(box.lower) + glm::dvec3(box.upper); }

struct Builder {
  const std::vector<Box>& boxes;
  BoxTree& tree;

  /// Parts order[begin, end) at the best of the bins' boundaries, or in the middle where bins do not tell.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, int depth) const {
    const auto first = tree.order.begin() + begin, last = tree.order.begin() + end;
    glm::dvec3 lower(INFINITY), upper(-INFINITY);
    for (auto it = first; it != last; ++it) {
      lower = glm::min(lower, doubled_center(boxes[*it]));
      upper = glm::max(upper, doubled_center(boxes[*it]));
    }
    const glm::dvec3 size = upper - lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = [&] {
      std::nth_element(first, first + (end - begin) / 2, last, [&](std::uint32_t a, std::uint32_t b) {
        const double ca = doubled_center(boxes[a])[axis], cb = doubled_center(boxes[b])[axis];
        return ca < cb || (ca == cb && a < b);
      });
      return begin + (end - begin) / 2;
    };
    if (!(size[axis] > 0.0) || !std::isfinite(size[axis]) || depth > kMaxSahDepth) return middle();

    const double to_bin = kBins / size[axis];
    const auto bin_of = [&](std::uint32_t i) {
      const double bin = (doubled_center(boxes[i])[axis] - lower[axis]) * to_bin;
      return std::min(static_cast<std::uint32_t>(bin), kBins - 1);
    };
    std::array<Box, kBins> bin_box{};
    std::array<std::uint32_t, kBins> bin_count{};
    for (auto it = first; it != last; ++it) {
      const std::uint32_t bin = bin_of(*it);
      grow(bin_box[bin], boxes[*it]);
      ++bin_count[bin];
    }
    std::array<double, kBins> cost_right{};
    Box box;
    std::uint32_t count = 0;
    for (std::uint32_t bin = kBins - 1; bin > 0; --bin) {
      grow(box, bin_box[bin]);
      cost_right[bin] = (count += bin_count[bin]) * half_area(box);
    }
    box = Box{};
    count = 0;
    double best_cost = INFINITY;
    std::uint32_t best = 0;
    for (std::uint32_t bin = 1; bin < kBins; ++bin) {
      grow(box, bin_box[bin - 1]);
      count += bin_count[bin - 1];
      const double cost = count * half_area(box) + cost_right[bin];
      if (cost < best_cost && count > 0 && count < end - begin) best_cost = cost, best = bin;
    }
    if (best == 0) return middle();
    return begin + static_cast<std::uint32_t>(
                       std::partition(first, last, [&](std::uint32_t i) { return bin_of(i) < best; }) - first);
  }

  /// Builds the node of order[begin, end) in slot `slot`; its subtree takes at most end - begin - 1 slots.
  void build(std::uint32_t begin, std::uint32_t end, std::uint32_t slot, int depth) const {
    const std::uint32_t middle = split(begin, end, depth);
    BoxNode& node = tree.nodes[slot];
    const std::array<std::uint32_t, 3> cuts{begin, middle, end};
    const std::array<std::uint32_t, 2> slots{slot + 1, slot + (middle - begin)};
    const auto build_child = [&](int child) {
      const std::uint32_t from = cuts[child], to = cuts[child + 1];
      for (std::uint32_t i = from; i < to; ++i) grow(node.box[child], boxes[tree.order[i]]);
      if (to - from <= kLeafSize) {
        node.first[child] = from;
        node.count[child] = to - from;
      } else {
        node.first[child] = slots[child];
        build(from, to, slots[child], depth + 1);
      }
    };
    if (end - begin >= kParallelFrom) {
      tbb::parallel_invoke([&] { build_child(0); }, [&] { build_child(1); });
    } else {
      build_child(0);
      build_child(1);
    }
  }
};

}  // namespace

BoxTree build_box_tree(const std::vector<Box>& boxes) {
  BoxTree tree;
  const auto count = static_cast<std::uint32_t>(boxes.size());
  tree.order.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) tree.order[i] = i;
  for (const Box& box : boxes) grow(tree.bounds, box);
  if (count <= kLeafSize) return tree;
  tree.nodes.resize(count);
  Builder{boxes, tree}.build(0, count, 0, 0);
  return tree;
}

SlabLine::SlabLine(const Line& line, const Box& bounds, double reach, double first_s, double last_s) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;
  // Where the line is within the bounds, |s| is at most how far they reach from the point, for one component of the
  // direction is at least 1.
  double line_pad = 0.0;
  if (line.point_error > 0.0) {
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double bound = std::fmax(std::fabs(bounds.lower[axis]), std::fabs(bounds.upper[axis]));
      farthest = std::fmax(farthest, bound + std::fabs(line.point[axis]) + reach);
    }
    line_pad = 2.0 * (line.point_error + line.direction_error * farthest);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double largest_bound = std::fmax(std::fabs(bounds.lower[axis]), std::fabs(bounds.upper[axis]));
    const double pad = reach + 16.0 * kUnit * (largest_bound + std::fabs(line.point[axis]) + reach) + line_pad;
    before[axis] = line.point[axis] + pad;
    behind[axis] = line.point[axis] - pad;
    inverse[axis] = 1.0 / line.direction[axis];
    if (line.direction[axis] == 0.0) inverse[axis] = INFINITY;  // of -0 too
  }
  // s itself is compared with limits that carry a rounding or two of their own.
  first = first_s - 4.0 * kUnit * std::fabs(first_s);
  last = last_s + 4.0 * kUnit * std::fabs(last_s);
}

}  // namespace plumbline
