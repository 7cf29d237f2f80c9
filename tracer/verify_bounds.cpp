// SPDX-License-Identifier: MIT
// Bounds around primitives: every primitive lies within every volume above it, exactly, and by what the shader's
// rounding needs.
#include <algorithm>
#include <map>

#include "tracer/exact_containment.h"
#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {

double least_radius(const glm::vec4& ball) {
  const double moved = glm::length(glm::dvec3(glm::vec3(ball))) * 0x1p-24 * (1.0 + 0x1p-10);
  return std::max(0.0, (ball.w - moved) * (1.0 - 0x1p-22));
}

double region_radius(const Examination& e, const RegionView& region) {
  if (region.from.empty()) return least_radius(glm::vec4(e.image.center, e.image.radius));
  return least_radius(record_texel(e.image, region.from[0], 6));
}

double longest_edge(const StoredPrimitive& primitive) {
  if (!primitive.is_triangle) return 0.0;
  const glm::dvec3 a(primitive.a), b(primitive.b), c(primitive.c);
  return std::sqrt(std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)}));
}

double excess(const Volume& volume, double volume_radius, const glm::dvec3& point, double radius) {
  if (!volume.is_box) return glm::length(point - glm::dvec3(volume.center)) + radius - volume_radius;
  const glm::dvec3 below = glm::dvec3(volume.lower) - point, above = point - glm::dvec3(volume.upper);
  return std::max({below.x, below.y, below.z, above.x, above.y, above.z}) + radius;
}

namespace {

/// What a node fails to hold worst.
struct Failure {
  double excess = 0.0, needed = 0.0;
  std::uint32_t primitive = kNone;
  bool is_containment = false;
};

class CopyBounds {
 public:
  CopyBounds(const Examination& e, const RegionView& region, const CopyView& copy)
      : e_(e), image_(e.image), copy_(copy), radius_(region_radius(e, region)) {
    const auto count = static_cast<std::uint32_t>(copy.nodes.size());
    parent_ = parents_of(copy);
    volumes_.resize(count), radii_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      volumes_[i] = volume_at(image_, node_unit(e, copy, i));
      radii_[i] = std::sqrt(static_cast<double>(volumes_[i].radius2));
    }
  }

  void check(Recorder& recorder) {
    const auto count = static_cast<std::uint32_t>(copy_.nodes.size());
    const std::uint32_t chunks = count > 20000 ? 64 : 1;
    std::vector<std::map<std::uint32_t, Failure>> failures(chunks);
    parallel_for(chunks, e_.threads, [&](std::size_t chunk) {
      const auto end = static_cast<std::uint32_t>(std::uint64_t{count} * (chunk + 1) / chunks);
      for (auto i = static_cast<std::uint32_t>(std::uint64_t{count} * chunk / chunks); i < end; ++i)
        if (copy_.nodes[i].is_leaf && copy_.nodes[i].payload < image_.primitive_count) check_leaf(i, failures[chunk]);
    });
    std::map<std::uint32_t, Failure> all;
    for (const auto& one : failures)
      for (const auto& [node, failure] : one) note(all, node, failure);
    for (const auto& [node, failure] : all) report(node, failure, recorder);
  }

 private:
  void check_leaf(std::uint32_t leaf, std::map<std::uint32_t, Failure>& failures) const {
    const std::uint32_t first = copy_.nodes[leaf].payload;
    for (std::uint32_t k = first; k < cluster_end(e_, first); ++k)
      if (!e_.is_shared[k])  // parts of a triangle: check_split_triangles
        check_primitive(stored_primitive(image_, k), leaf, failures);
  }

  void check_primitive(const StoredPrimitive& p, std::uint32_t leaf, std::map<std::uint32_t, Failure>& failures) const {
    const double pad = kLeastPadEdge * longest_edge(p) + kLeastPadRadius * radius_;
    for (std::uint32_t i = leaf; i != kNone; i = parent_[i]) {
      const Volume& volume = volumes_[i];
      if (holds(volume, radii_[i], p, p.radius + pad)) continue;
      Failure failure;
      failure.needed = pad;
      failure.primitive = primitive_of_label(p.label).value_or(kNone);
      failure.is_containment = !holds_exactly(volume, p);
      failure.excess = excess(volume, radii_[i], glm::dvec3(p.a), p.radius);
      if (p.is_triangle)
        failure.excess = std::max({failure.excess, excess(volume, radii_[i], glm::dvec3(p.b), 0.0),
                                   excess(volume, radii_[i], glm::dvec3(p.c), 0.0)});
      note(failures, i, failure);
    }
  }

  /// True only where it is so: the factor covers the roundings of the squares and of the root. False where anything is
  /// NaN.
  static bool holds(const Volume& volume, double volume_radius, const StoredPrimitive& p, double radius) {
    if (!volume.is_box) {
      const double rest = volume_radius - radius, rest2 = rest * rest * (1.0 - 0x1p-49);
      const glm::dvec3 c(volume.center);
      const auto inside = [&](const glm::vec3& corner) {
        const glm::dvec3 d = glm::dvec3(corner) - c;
        return glm::dot(d, d) <= rest2;
      };
      return rest >= 0.0 && inside(p.a) && (!p.is_triangle || (inside(p.b) && inside(p.c)));
    }
    const auto inside = [&](const glm::vec3& corner) { return excess(volume, 0.0, glm::dvec3(corner), radius) <= 0.0; };
    return inside(p.a) && (!p.is_triangle || (inside(p.b) && inside(p.c)));
  }

  static bool holds_exactly(const Volume& v, const StoredPrimitive& p) {
    const auto inside = [&](const glm::vec3& corner) {
      return v.is_box ? box_holds_ball(v.lower, v.upper, corner, p.radius)
                      : ball_holds_ball(v.center, v.radius2, corner, p.radius);
    };
    return inside(p.a) && (!p.is_triangle || (inside(p.b) && inside(p.c)));
  }

  /// Keeps the worst, and what sticks out before what lies too near.
  static void note(std::map<std::uint32_t, Failure>& failures, std::uint32_t node, const Failure& failure) {
    Failure& worst = failures[node];
    if (worst.primitive == kNone || failure.is_containment > worst.is_containment ||
        (failure.is_containment == worst.is_containment && failure.excess > worst.excess))
      worst = failure;
  }

  void report(std::uint32_t node, const Failure& failure, Recorder& recorder) const {
    const std::string what =
        (volumes_[node].is_box ? "the box of node " : "the sphere of node ") + std::to_string(node);
    const std::string primitive =
        failure.primitive == kNone ? "a primitive" : "primitive " + std::to_string(failure.primitive);
    if (failure.is_containment)
      recorder.add(Rule::containment, node_texel(e_, copy_, node), node,
                   what + " is too small for " + primitive + ", which stands below it and sticks out by " +
                       shown(failure.excess));
    else
      recorder.add(Rule::padding, node_texel(e_, copy_, node), node,
                   what + " holds " + primitive + " with " + shown(-failure.excess) + " to spare, but rounding needs " +
                       shown(failure.needed));
  }

  const Examination& e_;
  const GeometryImage& image_;
  const CopyView& copy_;
  const double radius_;
  std::vector<Volume> volumes_;
  std::vector<double> radii_;
  std::vector<std::uint32_t> parent_;
};

}  // namespace

void check_bounds(Examination& e) {
  // The builder nests nodes some eighty deep at most; a chain as long as the scene would take the square of its length.
  constexpr std::size_t kMaxJudgedDepth = 1024;
  if (e.certificate.depth > kMaxJudgedDepth) {
    e.recorder.add(Rule::containment,
                   "nodes stand " + std::to_string(e.certificate.depth) + " deep, so their bounds are not looked at");
    leave_undecided(e, {Rule::containment, Rule::padding});
    return;
  }
  for (const RegionView& region : e.regions)
    for (std::size_t c = 0; c < region.copies.size(); ++c) {
      if (c > 0 && region.copies_agree) break;  // what holds in the first holds in all
      CopyBounds(e, region, region.copies[c]).check(e.recorder);
      check_split_triangles(e, region, region.copies[c], e.recorder);
    }
}

}  // namespace plumbline
