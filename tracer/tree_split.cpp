// SPDX-License-Identifier: MIT
// Binary splits: binned where there are many references, every position tried where there are few.
#include "tracer/tree_split.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr int kBins = 64;
/// Up to this many references every position along every axis is tried.
constexpr std::uint32_t kSweepCount = 64;
/// A subtree of at most this share of all references is one task.
constexpr std::uint32_t kTaskShare = 16;

float middle(const Box& box, int axis) { return 0.5f * box.lower[axis] + 0.5f * box.upper[axis]; }

/// The cost of a split's two sides; infinite where one is empty.
double split_cost(const Box& a, std::uint32_t a_count, const Box& b, std::uint32_t b_count) {
  if (a_count == 0 || b_count == 0) return std::numeric_limits<double>::infinity();
  return a_count * a.diagonal2() + b_count * b.diagonal2();
}

struct Bin {
  Box box;
  std::uint32_t count = 0;
};

/// Splits by bins of the boxes' middles. Returns the size of the first side, 0 where all middles fall together.
std::uint32_t split_binned(std::span<Reference> list) {
  glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
  for (const Reference& reference : list) {
    const glm::vec3 m = 0.5f * reference.box.lower + 0.5f * reference.box.upper;
    low = glm::min(low, m), high = glm::max(high, m);
  }
  glm::dvec3 scale(0.0);  // in double: one over a denormal extent has no float
  for (int axis = 0; axis < 3; ++axis)
    if (high[axis] > low[axis]) scale[axis] = kBins / (static_cast<double>(high[axis]) - low[axis]);
  const auto bin_of = [&](const Reference& reference, int axis) {
    const double at = (static_cast<double>(middle(reference.box, axis)) - low[axis]) * scale[axis];
    return std::min(static_cast<int>(at), kBins - 1);
  };
  std::array<std::array<Bin, kBins>, 3> bins;
  for (const Reference& reference : list)
    for (int axis = 0; axis < 3; ++axis) {
      Bin& bin = bins[axis][bin_of(reference, axis)];
      bin.box.add(reference.box);
      ++bin.count;
    }

  double best_cost = std::numeric_limits<double>::infinity();
  int best_axis = -1, best_bin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::array<Bin, kBins> above;  // above[i]: bins i and later
    Bin sum;
    for (int i = kBins - 1; i > 0; --i) {
      sum.box.add(bins[axis][i].box), sum.count += bins[axis][i].count;
      above[i] = sum;
    }
    sum = {};
    for (int i = 1; i < kBins; ++i) {
      sum.box.add(bins[axis][i - 1].box), sum.count += bins[axis][i - 1].count;
      const double cost = split_cost(sum.box, sum.count, above[i].box, above[i].count);
      if (cost < best_cost) best_cost = cost, best_axis = axis, best_bin = i;
    }
  }
  if (best_axis < 0) return 0;
  const auto second = std::stable_partition(
      list.begin(), list.end(), [&](const Reference& reference) { return bin_of(reference, best_axis) < best_bin; });
  return static_cast<std::uint32_t>(second - list.begin());
}

/// Splits at the best of all positions along the three axes and, as a fourth order, by size: what encloses its
/// neighbours is better kept apart. Never returns 0.
std::uint32_t split_swept(std::span<Reference> list) {
  struct Key {
    float value;
    std::uint32_t index;
    bool operator<(const Key& other) const { return value != other.value ? value < other.value : index < other.index; }
  };
  const std::uint32_t n = static_cast<std::uint32_t>(list.size());
  std::array<Key, kSweepCount> keys, best_keys;
  std::array<double, kSweepCount> above;  // above[i]: squared diagonal of all from i on
  double best_cost = std::numeric_limits<double>::infinity();
  std::uint32_t best_count = n / 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < n; ++i) keys[i] = {middle(list[i].box, axis), i};
    std::sort(keys.begin(), keys.begin() + n);
    Box box;
    for (std::uint32_t i = n - 1; i > 0; --i) {
      box.add(list[keys[i].index].box);
      above[i] = box.diagonal2();
    }
    box = {};
    bool better = axis == 0;
    for (std::uint32_t i = 1; i < n; ++i) {
      box.add(list[keys[i - 1].index].box);
      const double cost = i * box.diagonal2() + (n - i) * above[i];
      // Among equals the most even split, so that a thousand identical primitives stay balanced.
      const auto unevenness = [n](std::uint32_t count) { return count > n - count ? 2 * count - n : n - 2 * count; };
      if (cost < best_cost || (cost == best_cost && unevenness(i) < unevenness(best_count)))
        best_cost = cost, best_count = i, better = true;
    }
    if (better) std::copy(keys.begin(), keys.begin() + n, best_keys.begin());
  }
  std::vector<Reference> ordered(n);
  for (std::uint32_t i = 0; i < n; ++i) ordered[i] = list[best_keys[i].index];
  std::copy(ordered.begin(), ordered.end(), list.begin());
  return best_count;
}

/// Halves by count along the longest side of the box.
std::uint32_t split_halfway(std::span<Reference> list, const Box& box) {
  const glm::dvec3 size = glm::dvec3(box.upper) - glm::dvec3(box.lower);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = static_cast<std::uint32_t>(list.size() / 2);
  std::nth_element(list.begin(), list.begin() + half, list.end(), [&](const Reference& a, const Reference& b) {
    const float ma = middle(a.box, axis), mb = middle(b.box, axis);
    return ma != mb ? ma < mb : a.first_ball < b.first_ball;  // first_ball is unique: one order for all libraries
  });
  return half;
}

struct Splitter {
  std::vector<Reference>& list;
  std::vector<BinaryNode>& nodes;

  /// Builds everything below node `at`, or down to nodes of at most `stop` references, which are added to `stopped`.
  void build(std::uint32_t at, int depth, std::uint32_t stop, std::vector<std::pair<std::uint32_t, int>>& stopped) {
    BinaryNode& node = nodes[at];
    if (node.count <= stop) {
      stopped.emplace_back(at, depth);
      return;
    }
    const std::span<Reference> range(list.data() + node.first, node.count);
    for (const Reference& reference : range) node.box.add(reference.box);
    if (node.count == 1) return;
    std::uint32_t count = 0;
    if (depth < kMaxSplitDepth) count = node.count <= kSweepCount ? split_swept(range) : split_binned(range);
    if (count == 0) count = split_halfway(range, node.box);
    node.second_child = at + 2 * count;
    BinaryNode &low = nodes[at + 1], &high = nodes[node.second_child];
    low.first = node.first, low.count = count;
    high.first = node.first + count, high.count = node.count - count;
    build(at + 1, depth + 1, stop, stopped);
    build(node.second_child, depth + 1, stop, stopped);
  }
};

}  // namespace

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex error_lock;
  const auto worker = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(error_lock);
      if (!error) error = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads && static_cast<std::size_t>(i) < count; ++i) others.emplace_back(worker);
  worker();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
}

std::vector<std::uint32_t> task_roots(const std::vector<BinaryNode>& nodes) {
  std::vector<std::uint32_t> roots;
  const std::uint32_t stop = nodes[0].count / kTaskShare;
  for (std::uint32_t at = 0; at < nodes.size();) {
    const bool whole = nodes[at].count <= std::max(stop, 1u);
    if (whole) roots.push_back(at);
    at += whole ? 2 * nodes[at].count - 1 : 1;
  }
  return roots;
}

std::vector<BinaryNode> split_references(References& references, int threads) {
  std::vector<BinaryNode> nodes(references.list.empty() ? 0 : 2 * references.list.size() - 1);
  if (nodes.empty()) return nodes;
  nodes[0].count = static_cast<std::uint32_t>(references.list.size());
  Splitter splitter{references.list, nodes};
  std::vector<std::pair<std::uint32_t, int>> tasks, none;
  splitter.build(0, 0, nodes[0].count / kTaskShare, tasks);
  parallel_for(tasks.size(), threads, [&](std::size_t i) {
    std::vector<std::pair<std::uint32_t, int>> unused;
    splitter.build(tasks[i].first, tasks[i].second, 0, unused);
  });
  return nodes;
}

void fit_balls(std::vector<BinaryNode>& nodes, const References& references, int threads) {
  if (nodes.empty()) return;
  // The balls in the order of the references, so that each node's are one run; the end of each reference's run.
  std::vector<FloatBall> balls;
  std::vector<std::uint32_t> first_ball(references.list.size() + 1, 0);
  balls.reserve(references.balls.size());
  for (std::size_t i = 0; i < references.list.size(); ++i) {
    const Reference& reference = references.list[i];
    const auto begin = references.balls.begin() + reference.first_ball;
    balls.insert(balls.end(), begin, begin + reference.ball_count);
    first_ball[i + 1] = static_cast<std::uint32_t>(balls.size());
  }

  std::vector<BallSupport> supports(nodes.size());  // indices into `balls`
  const auto fit = [&](std::uint32_t at) {
    BinaryNode& node = nodes[at];
    const std::uint32_t first = first_ball[node.first], end = first_ball[node.first + node.count];
    const std::span<const FloatBall> range(balls.data() + first, end - first);
    std::array<std::uint32_t, 8> start;
    int start_count = 0;
    if (node.second_child != 0)
      for (const std::uint32_t child : {at + 1, node.second_child})
        for (int i = 0; i < supports[child].count; ++i) start[start_count++] = supports[child].ball[i] - first;
    BallSupport& support = supports[at];
    node.center =
        glm::vec3(smallest_ball_center(range, {start.data(), static_cast<std::size_t>(start_count)}, support));
    node.radius = enclosing_radius(range, node.center);
    for (int i = 0; i < support.count; ++i) support.ball[i] += first;
    if (!std::isfinite(node.radius))
      throw InputError("the scene is so large that a ball around it has no 32-bit radius; scale it down");
  };

  // Children stand behind their parents: going backwards, both are done before the node is.
  const std::vector<std::uint32_t> tasks = task_roots(nodes);
  const auto end_of = [&](std::uint32_t root) { return root + 2 * nodes[root].count - 1; };
  parallel_for(tasks.size(), threads, [&](std::size_t i) {
    for (std::uint32_t at = end_of(tasks[i]); at-- > tasks[i];) fit(at);
  });
  std::size_t tasks_left = tasks.size();
  for (std::uint32_t at = static_cast<std::uint32_t>(nodes.size()); at > 0;) {
    if (tasks_left > 0 && at == end_of(tasks[tasks_left - 1]))
      at = tasks[--tasks_left];
    else
      fit(--at);
  }
}

}  // namespace plumbline
