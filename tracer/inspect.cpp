// SPDX-License-Identifier: MIT
#include "tracer/inspect.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <thread>

#include "scenes/error.h"
#include "tracer/overlap.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// A random line through a ball meets a convex body inside it with the share of their surfaces.
double chance_in(const InspectedRegion& region, const Volume& volume) {
  const double whole = region.radius * region.radius;
  double share = static_cast<double>(volume.radius2) / whole;
  if (volume.is_box) {
    const glm::dvec3 s = glm::dvec3(volume.upper) - glm::dvec3(volume.lower);
    share = 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x) / (4.0 * std::numbers::pi * whole);
  }
  return share >= 0.0 && share <= 1.0 ? share : 1.0;  // a ball of radius 0, NaN: every line
}

/// How far a volume reaches from a point.
double reach(const Volume& volume, const glm::dvec3& point) {
  if (!volume.is_box)
    return glm::length(glm::dvec3(volume.center) - point) + std::sqrt(static_cast<double>(volume.radius2));
  const glm::dvec3 lower = glm::abs(glm::dvec3(volume.lower) - point),
                   upper = glm::abs(glm::dvec3(volume.upper) - point);
  return glm::length(glm::max(lower, upper));
}

class Reader {
 public:
  Reader(const Examination& e, InspectedImage& inspected) : e_(e), image_(e.image), out_(inspected) {}

  void read() {
    out_.behind = e_.behind;
    out_.inner_first = e_.inner_first;
    for (std::uint32_t r = 0; r < e_.regions.size(); ++r) add_region(r);
    out_.entrance.assign(image_.transform_count, kNone);
    for (std::uint32_t i = 0; i < out_.nodes.size(); ++i)
      if (out_.nodes[i].transform < image_.transform_count) out_.entrance[out_.nodes[i].transform] = i;
  }

 private:
  void add_region(std::uint32_t r) {
    const RegionView& view = e_.regions[r];
    const CopyView& copy = view.copies[0];
    InspectedRegion region;
    region.start = view.start, region.copy_size = view.copy_size;
    region.first_node = static_cast<std::uint32_t>(out_.nodes.size());
    region.node_count = static_cast<std::uint32_t>(copy.nodes.size());
    region.from = view.from;
    region.center = glm::dvec3(image_.center), region.radius = image_.radius;
    if (!view.from.empty()) {
      const glm::vec4& ball = record_texel(image_, view.from[0], 6);
      region.center = glm::dvec3(glm::vec3(ball)), region.radius = ball.w;
      // The record's ball is tight around what may be hit; bounding volumes reach farther.
      for (std::uint32_t i = 0; i < region.node_count; i = copy.nodes[i].end)
        region.radius = std::max(region.radius, reach(volume_at(image_, node_unit(e_, copy, i)), region.center));
    }
    for (std::size_t c = 1; c < view.copies.size(); ++c) {
      std::vector<std::uint32_t> twins = twins_of(copy, view.copies[c]);
      for (std::uint32_t& twin : twins)
        if (twin != kNone) twin = node_unit(e_, view.copies[c], twin);
      region.twins.push_back(std::move(twins));
    }
    const std::vector<std::uint32_t> parents = parents_of(copy);
    for (std::uint32_t i = 0; i < region.node_count; ++i) add_node(r, region, copy, i, parents[i]);
    finish_nodes(region);
    if (e_.recorder.count() == 0 && !has_boxes(image_)) {
      const std::vector<double> slack = node_slack(e_, view);
      for (std::uint32_t i = 0; i < region.node_count; ++i) out_.nodes[region.first_node + i].slack = slack[i];
    }
    out_.regions.push_back(std::move(region));
  }

  void add_node(std::uint32_t r, const InspectedRegion& region, const CopyView& copy, std::uint32_t i,
                std::uint32_t parent) {
    const NodeView& view = copy.nodes[i];
    InspectedNode node;
    node.region = r, node.number = i;
    node.unit = node_unit(e_, copy, i);
    node.end = region.first_node + view.end;
    if (parent != kNone) {
      node.parent = region.first_node + parent;
      node.depth = out_.nodes[node.parent].depth + 1;
      ++out_.nodes[node.parent].children;
    }
    node.is_leaf = view.is_leaf;
    if (view.is_leaf && view.payload < image_.primitive_count) {
      node.cluster = view.payload;
      node.primitives = cluster_end(e_, view.payload) - view.payload;
    } else if (view.is_leaf && view.payload != kNone) {
      node.transform = view.payload - image_.primitive_count;
    }
    node.volume = volume_at(image_, node.unit);
    node.radius = node.volume.is_box ? glm::length(glm::dvec3(node.volume.upper) - glm::dvec3(node.volume.lower)) / 2.0
                                     : std::sqrt(static_cast<double>(node.volume.radius2));
    node.chance = chance_in(region, node.volume);
    out_.nodes.push_back(node);
  }

  /// What depends on the nodes below.
  void finish_nodes(const InspectedRegion& region) {
    std::vector<Volume> children;
    for (std::uint32_t i = region.first_node + region.node_count; i-- > region.first_node;) {
      InspectedNode& node = out_.nodes[i];
      if (node.parent != kNone) out_.nodes[node.parent].primitives += node.primitives;
      children.clear();
      for (std::uint32_t c = i + 1; c < node.end; c = out_.nodes[c].end) children.push_back(out_.nodes[c].volume);
      node.overlap =
          children.size() < 2 ? std::numeric_limits<double>::quiet_NaN() : sibling_overlap(node.volume, children);
    }
  }

  const Examination& e_;
  const GeometryImage& image_;
  InspectedImage& out_;
};

}  // namespace

InspectedImage inspect_image(const GeometryImage& image, int threads) {
  if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Certificate certificate;
  Examination e{image, nullptr, nullptr, threads, certificate, Recorder(image), {}, {}, {}, {}, {}, {}};
  InspectedImage inspected;
  const bool is_readable = check_metadata(e);
  if (is_readable) check_links(e);
  if (is_readable && e.recorder.count(Rule::metadata) == 0) {
    check_clusters(e);
    Reader(e, inspected).read();
  }
  e.recorder.finish(certificate);
  constexpr std::size_t kMostFaults = 8;
  for (const Finding& finding : certificate.findings) {
    if (inspected.faults.size() == kMostFaults) break;
    inspected.faults.push_back(
        finding.rule +
        (finding.x < 0 ? "" : " at texel (" + std::to_string(finding.x) + ", " + std::to_string(finding.y) + ")") +
        ": " + finding.message);
  }
  for (const auto& [rule, count] : certificate.counts) inspected.fault_count += count;
  if (inspected.regions.empty())
    throw InputError("the geometry image of " + image.scene_name +
                     " cannot be taken apart: " + (inspected.faults.empty() ? "it is empty" : inspected.faults[0]));
  return inspected;
}

}  // namespace plumbline
