// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of an inspected image as a report shows them, and which nodes of two images are the same.
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "harness/inspect.h"

namespace plumbline {
namespace {

/// What names a node whatever the order of children: the least cluster or transform below it, which no sibling shares,
/// and how many nodes are.
using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

std::vector<std::pair<Key, std::uint32_t>> keys_of(const InspectedImage& image, const InspectedRegion& region) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> least(region.node_count, {kNone, kNone});
  std::vector<std::pair<Key, std::uint32_t>> keys;
  for (std::uint32_t k = region.node_count; k-- > 0;) {
    const std::uint32_t i = region.first_node + k;
    const InspectedNode& node = image.nodes[i];
    least[k] = std::min(least[k], {node.cluster, node.transform});
    if (node.parent != kNone) {
      auto& above = least[node.parent - region.first_node];
      above = std::min(above, least[k]);
    }
    keys.emplace_back(Key{least[k].first, least[k].second, node.end - i}, i);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

InspectedNodeRecord record_of(const GeometryImage& image, const Inspection& inspection, std::uint32_t i) {
  const InspectedNode& node = inspection.inspected.nodes[i];
  const NodeLoad& load = inspection.loads[i];
  InspectedNodeRecord r;
  r.region = node.region, r.number = node.number;
  const std::size_t texel = unit_texel(image, node.unit), width = static_cast<std::size_t>(image.width);
  r.x = static_cast<int>(texel % width), r.y = static_cast<int>(texel / width);
  r.depth = node.depth, r.children = node.children, r.is_leaf = node.is_leaf;
  r.transform = node.transform;
  r.behind = node.transform == kNone ? kNone : inspection.inspected.behind[node.transform];
  r.primitives = node.primitives;
  const Volume& v = node.volume;
  const glm::dvec3 lower(v.lower), upper(v.upper);
  const glm::dvec3 center = v.is_box ? (lower + upper) * 0.5 : glm::dvec3(v.center);
  for (int a = 0; a < 3; ++a) {
    r.center[static_cast<std::size_t>(a)] = center[a];
    r.half[static_cast<std::size_t>(a)] = v.is_box ? (upper[a] - lower[a]) * 0.5 : 0.0;
  }
  r.radius = node.radius, r.chance = node.chance, r.overlap = node.overlap, r.slack = node.slack;
  r.visits = load.visits, r.hits = load.hits, r.tests = load.primitive_tests, r.cost = load.cost;
  r.other_visits = std::numeric_limits<double>::quiet_NaN();
  return r;
}

/// The greatest depth down to which there are at most kMostOutlined nodes; at least 1.
std::uint32_t depth_to_keep(const InspectedImage& image) {
  std::vector<std::size_t> at;
  for (const InspectedNode& node : image.nodes) {
    if (at.size() <= node.depth) at.resize(node.depth + 1, 0);
    ++at[node.depth];
  }
  std::size_t sum = 0;
  for (std::uint32_t d = 1; d < at.size(); ++d) {
    sum += at[d];
    if (sum > kMostOutlined) return std::max(d - 1, 1u);
  }
  return std::numeric_limits<std::uint32_t>::max();
}

}  // namespace

std::vector<std::uint32_t> twins_between(const InspectedImage& a, const InspectedImage& b) {
  if (a.nodes.size() != b.nodes.size() || a.regions.size() != b.regions.size()) return {};
  std::vector<std::uint32_t> twins(a.nodes.size(), kNone);
  for (std::size_t r = 0; r < a.regions.size(); ++r) {
    const auto keys_a = keys_of(a, a.regions[r]), keys_b = keys_of(b, b.regions[r]);
    if (keys_a.size() != keys_b.size()) return {};
    for (std::size_t k = 0; k < keys_a.size(); ++k) {
      if (keys_a[k].first != keys_b[k].first) return {};
      twins[keys_a[k].second] = keys_b[k].second;
    }
  }
  return twins;
}

void list_nodes(const GeometryImage& image, std::size_t top, const std::vector<std::uint32_t>& twins,
                const std::vector<NodeLoad>& other, Inspection& inspection) {
  const std::vector<InspectedNode>& nodes = inspection.inspected.nodes;
  InspectedBake& record = inspection.record;
  const auto with_twin = [&](std::uint32_t i) {
    InspectedNodeRecord r = record_of(image, inspection, i);
    if (!twins.empty()) r.other_visits = static_cast<double>(other[twins[i]].visits);
    return r;
  };
  const std::uint32_t deepest = depth_to_keep(inspection.inspected);
  std::vector<std::uint32_t> kept(nodes.size(), kNone);
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].depth > deepest || record.outline.size() >= kMostOutlined) continue;
    if (nodes[i].parent != kNone && kept[nodes[i].parent] == kNone) continue;
    kept[i] = static_cast<std::uint32_t>(record.outline.size());
    record.outline.push_back(with_twin(i));
    if (nodes[i].parent != kNone) record.outline.back().parent = kept[nodes[i].parent];
  }
  record.kept_depth = record.outline.size() < nodes.size() ? deepest : 0;
  std::vector<std::uint32_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::size_t count = std::min(top, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::uint32_t a, std::uint32_t b) {
                      const double x = inspection.loads[a].cost, y = inspection.loads[b].cost;
                      return x != y ? x > y : a < b;
                    });
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = order[k];
    record.costliest.push_back(with_twin(i));
    if (nodes[i].parent != kNone) record.costliest.back().parent = nodes[nodes[i].parent].number;
  }
}

}  // namespace plumbline
