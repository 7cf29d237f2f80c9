// SPDX-License-Identifier: MIT
#include "tracer/inspect_rays.h"

#include <cmath>
#include <numbers>

#include "scenes/random.h"

namespace plumbline {

std::vector<Ray> random_lines(const GeometryImage& image, std::size_t count, std::uint64_t seed) {
  const double to_world = std::ldexp(1.0, -image.scale_exponent);
  const glm::dvec3 center = glm::dvec3(image.center) * to_world;
  const double radius = static_cast<double>(image.radius) * to_world;
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, name_hash("random lines"), i);
    const glm::dvec3 d = random.direction();
    // A point of the disc across the ball.
    const glm::dvec3 side = std::abs(d.x) < 0.7 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 u = glm::normalize(glm::cross(d, side)), v = glm::cross(d, u);
    const double r = radius * std::sqrt(random.uniform()), angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const glm::dvec3 across = r * (std::cos(angle) * u + std::sin(angle) * v);
    rays[i].origin = glm::vec3(center + across - 1.5 * radius * d);
    rays[i].direction = glm::vec3(d);
  }
  return rays;
}

std::vector<NodeLoad> node_loads(const InspectedImage& inspected, std::span<const NodeVisits> visits) {
  std::vector<NodeLoad> loads(inspected.nodes.size());
  const auto add = [&](NodeLoad& load, std::uint32_t unit) {
    if (unit < visits.size()) load.visits += visits[unit].visits, load.hits += visits[unit].hits;
  };
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const InspectedNode& node = inspected.nodes[i];
    NodeLoad& load = loads[i];
    add(load, node.unit);
    for (const std::vector<std::uint32_t>& twins : inspected.regions[node.region].twins) add(load, twins[node.number]);
    load.cost = kStepCost * static_cast<double>(load.visits);
    if (node.cluster == kNone) continue;
    load.primitive_tests = load.hits * node.primitives;
    load.cost +=
        kLeafCost * static_cast<double>(load.hits) + kPrimitiveCost * static_cast<double>(load.primitive_tests);
  }
  return loads;
}

HitPlaces::HitPlaces(const GeometryImage& image, const InspectedImage& inspected) {
  std::vector<Place> places(inspected.nodes.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const InspectedNode& node = inspected.nodes[i];
    if (node.parent != kNone) places[i] = places[node.parent];
    places[i].depth = node.depth;
    if (!std::isnan(node.overlap)) places[i].overlap += node.overlap;
    for (std::uint32_t k = node.cluster; k != kNone && k < node.cluster + node.primitives; ++k) {
      const auto primitive = primitive_of_label(texel_at(image, primitive_unit(image, k)).w);
      if (!primitive) continue;
      if (primitives_.size() <= *primitive) primitives_.resize(*primitive + 1);
      if (primitives_[*primitive].depth == 0) primitives_[*primitive] = places[i];
    }
  }
  for (std::uint32_t n = 0; n < inspected.entrance.size(); ++n) {
    const std::uint32_t node = inspected.entrance[n];
    entrances_.push_back(node == kNone ? Place{} : places[node]);
    const auto outer = whole_number(record_texel(image, n, 3).w);
    outer_.push_back(outer && *outer <= n ? *outer - 1u : kNone);  // parents have lower numbers
  }
}

HitPlaces::Place HitPlaces::place(const Hit& hit) const {
  Place place;
  if (hit.kind != HitKind::hit || hit.primitive >= primitives_.size()) return place;
  place = primitives_[hit.primitive];
  for (std::uint32_t n = hit.instance; n < entrances_.size(); n = outer_[n]) {
    place.depth += entrances_[n].depth;
    place.overlap += entrances_[n].overlap;
  }
  return place;
}

std::uint32_t HitPlaces::depth(const Hit& hit) const { return place(hit).depth; }
double HitPlaces::overlap(const Hit& hit) const { return place(hit).overlap; }

}  // namespace plumbline
