// SPDX-License-Identifier: MIT
#include "scenes/topology.h"

#include <bit>
#include <numeric>

#include "scenes/random.h"

namespace plumbline {
namespace {

/// Numbers different keys 0, 1, 2, ... in the order of their first appearance. Open addressing, at most half full.
template <typename Key, typename Hash>
class Numbering {
 public:
  Numbering(std::size_t most, Hash hash) : hash_(hash), slots_(std::bit_ceil(2 * most + 2), kNone) {}

  std::uint32_t number(const Key& key) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash_(key) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kNone) {
        slots_[slot] = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
        return slots_[slot];
      }
      if (keys_[slots_[slot]] == key) return slots_[slot];
    }
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(keys_.size()); }

 private:
  Hash hash_;
  std::vector<std::uint32_t> slots_;
  std::vector<Key> keys_;
};

/// A position within the world (0) or a part (1 + its number): equal numbers in two spaces are two places.
using VertexKey = std::array<std::uint32_t, 4>;

VertexKey vertex_key(const glm::vec3& p, std::uint32_t space) {
  // Adding +0 turns -0 into +0 and leaves every other number alone.
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f), space};
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

bool Topology::share_a_corner(std::uint32_t a, std::uint32_t b) const {
  if (a >= component.size() || b >= component.size()) return false;
  for (std::uint32_t i = 0; i < 9; ++i) {
    if (corner[3 * a + i / 3] == corner[3 * b + i % 3]) return true;
  }
  return false;
}

bool Topology::share_an_edge(std::uint32_t a, std::uint32_t b) const {
  if (a >= component.size() || b >= component.size()) return false;
  for (std::uint32_t i = 0; i < 9; ++i) {
    if (edge[3 * a + i / 3] != kNone && edge[3 * a + i / 3] == edge[3 * b + i % 3]) return true;
  }
  return false;
}

namespace {

/// Goes over each closed component from its first triangle, across edges. Two triangles face the same way where they
/// run along their shared edge in opposite directions.
void orient(Topology& topology) {
  const auto triangle_count = static_cast<std::uint32_t>(topology.component.size());
  topology.component_orientable = topology.component_closed;
  topology.turned.assign(triangle_count, 0);
  std::vector<std::uint8_t> seen(triangle_count, 0);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t first = 0; first < triangle_count; ++first) {
    if (seen[first] || !topology.is_closed(first)) continue;
    seen[first] = 1;
    waiting.assign(1, first);
    while (!waiting.empty()) {
      const std::uint32_t t = waiting.back();
      waiting.pop_back();
      for (std::uint32_t i = 0; i < 3; ++i) {
        const auto sides = topology.sides(t, static_cast<int>(i));
        const std::uint32_t side = 3 * t + i, other = sides[0] == side ? sides[1] : sides[0];
        const bool same_direction = topology.corner[side] == topology.corner[other];
        const std::uint8_t turned = topology.turned[t] ^ static_cast<std::uint8_t>(same_direction);
        if (!seen[other / 3]) {
          seen[other / 3] = 1;
          topology.turned[other / 3] = turned;
          waiting.push_back(other / 3);
        } else if (topology.turned[other / 3] != turned) {
          topology.component_orientable[topology.component[t]] = 0;
        }
      }
    }
  }
}

}  // namespace

Topology make_topology(const Scene& scene) {
  Topology topology;
  const auto triangle_count = static_cast<std::uint32_t>(scene.triangles.size());
  const std::size_t side_count = 3 * static_cast<std::size_t>(triangle_count);

  // Positions first, each once, then corners: many corners share a position by index already.
  const auto hash_vertex = [](const VertexKey& key) {
    return mix64((static_cast<std::uint64_t>(key[0]) << 32 | key[1]) ^
                 mix64(static_cast<std::uint64_t>(key[3]) << 32 | key[2]));
  };
  Numbering<VertexKey, decltype(hash_vertex)> vertices(scene.positions.size(), hash_vertex);
  std::vector<std::uint32_t> vertex_of(scene.positions.size(), kNone);
  topology.corner.reserve(side_count);
  std::uint32_t space = 0;
  for (std::uint32_t t = 0; t < triangle_count; ++t) {
    while (space < scene.parts.size() && t >= scene.parts[space].first_triangle) ++space;
    for (const std::uint32_t p : scene.triangles[t].position) {
      if (vertex_of[p] == kNone) vertex_of[p] = vertices.number(vertex_key(scene.positions[p], space));
      topology.corner.push_back(vertex_of[p]);
    }
  }
  topology.vertex_count = vertices.count();

  const auto hash_edge = [](std::uint64_t key) { return mix64(key); };
  Numbering<std::uint64_t, decltype(hash_edge)> edges(side_count, hash_edge);
  topology.edge.reserve(side_count);
  for (std::size_t side = 0; side < side_count; ++side) {
    const std::uint32_t a = topology.corner[side];
    const std::uint32_t b = topology.corner[side % 3 == 2 ? side - 2 : side + 1];
    const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    topology.edge.push_back(a == b ? kNone : edges.number(key));
  }
  topology.edge_count = edges.count();

  topology.edge_start.assign(topology.edge_count + 1, 0);
  for (const std::uint32_t e : topology.edge) {
    if (e != kNone) ++topology.edge_start[e + 1];
  }
  std::partial_sum(topology.edge_start.begin(), topology.edge_start.end(), topology.edge_start.begin());
  std::vector<std::uint32_t> next(topology.edge_start.begin(), topology.edge_start.end() - 1);
  topology.edge_sides.resize(topology.edge_start.back());
  for (std::uint32_t side = 0; side < side_count; ++side) {
    if (topology.edge[side] != kNone) topology.edge_sides[next[topology.edge[side]]++] = side;
  }

  std::vector<std::uint32_t> parent(triangle_count);
  std::iota(parent.begin(), parent.end(), 0u);
  for (std::uint32_t e = 0; e < topology.edge_count; ++e) {
    const std::uint32_t first = find_root(parent, topology.edge_sides[topology.edge_start[e]] / 3);
    for (std::uint32_t i = topology.edge_start[e] + 1; i < topology.edge_start[e + 1]; ++i) {
      parent[find_root(parent, topology.edge_sides[i] / 3)] = first;
    }
  }
  topology.component.resize(triangle_count);
  std::vector<std::uint32_t> number(triangle_count, kNone);
  for (std::uint32_t t = 0; t < triangle_count; ++t) {
    std::uint32_t& component = number[find_root(parent, t)];
    if (component == kNone) component = topology.component_count++;
    topology.component[t] = component;
  }
  topology.component_closed.assign(topology.component_count, 1);
  for (std::uint32_t side = 0; side < side_count; ++side) {
    const std::uint32_t e = topology.edge[side];
    if (e == kNone || topology.edge_start[e + 1] - topology.edge_start[e] != 2) {
      topology.component_closed[topology.component[side / 3]] = 0;
    }
  }
  orient(topology);
  return topology;
}

}  // namespace plumbline
