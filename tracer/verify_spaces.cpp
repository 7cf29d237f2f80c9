// SPDX-License-Identifier: MIT
// Bounds around transforms: what stands behind a leaf that leads into another space, carried out of it, lies within the
// volumes above that leaf; and the balls that far rays are moved near to hold what stands there.
//
// A volume is proved to hold what stands in a region by descending from the region's roots: what lies in a node that
// the volume holds needs no second look. Spaces nest, so maps are composed on the way, in double; what that errs by,
// some 2^-45 of the coordinates, is far below the padding.
#include <algorithm>

#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// The map from a region's space to that of a volume.
struct Map {
  TransformD out;
  double stretch = 1.0;  ///< at least the factor by which lengths grow
  double pad = 0.0;      ///< of the transforms on the way, in the volume's space
};

/// Why a volume does not hold what it should.
struct Escape {
  bool found = false;
  std::uint32_t primitive = kNone;
  double excess = 0.0;
};

/// Nodes that are looked at, for each node of the image and for any image.
constexpr std::uint64_t kVisitsPerNode = 4096, kVisitsAtLeast = std::uint64_t{1} << 24;

double radius_of(const Volume& volume) { return std::sqrt(static_cast<double>(volume.radius2)); }

class Spaces {
 public:
  explicit Spaces(Examination& e) : e_(e), image_(e.image) {}

  void check() {
    // Where spaces are no tree there is no end to them; that is reported already.
    bool is_tree = !e_.inner_first.empty() && e_.recorder.count(Rule::visited_twice) == 0;
    for (const RegionView& region : e_.regions)
      if (region.has_transforms && region.from.size() > 1) is_tree = false;
    if (!is_tree) return leave_undecided(e_, {Rule::containment, Rule::padding, Rule::ball});
    visits_left_ = kVisitsAtLeast + kVisitsPerNode * e_.certificate.nodes;
    for (std::uint32_t n = 0; n < image_.transform_count; ++n)
      if (e_.leaves[n].node != kNone && e_.behind[n] != kNone) check_leaf(n);
    check_balls();
    if (visits_left_ > 0) return;
    leave_undecided(e_, {Rule::containment, Rule::padding, Rule::ball});
    e_.recorder.add(Rule::containment,
                    "whether all that stands behind transforms lies within the volumes above is not decided: it takes "
                    "more nodes to look at than are allowed");
  }

 private:
  TransformD forward_of(std::uint32_t n) const {
    TransformD t;
    for (std::uint32_t row = 0; row < 3; ++row) {
      const glm::vec4 r = record_texel(image_, n, 3 + row);
      for (int column = 0; column < 3; ++column) t.linear[column][static_cast<int>(row)] = r[column];
      t.translation[static_cast<int>(row)] = record_texel(image_, n, row).w;
    }
    return t;
  }

  /// The padding of a transform's leaf, by (3) of bake.h: k u (5 |o - T| + 4 * 3.3 R) with |o - T| <= 3.3 R + |c - T|.
  double least_transform_pad(std::uint32_t n, const glm::dvec3& center, double radius) const {
    double norm2 = 0.0;
    for (std::uint32_t row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        double entry = 0.0;
        for (std::uint32_t k = 0; k < 3; ++k)
          entry += std::abs(static_cast<double>(record_texel(image_, n, 3 + row)[static_cast<int>(k)]) *
                            record_texel(image_, n, k)[column]);
        norm2 += entry * entry;
      }
    return 0x1p-24 * std::sqrt(norm2) * (29.7 * radius + 5.0 * glm::length(center - forward_of(n).translation));
  }

  glm::dvec3 middle(const Volume& volume) const {
    return volume.is_box ? 0.5 * (glm::dvec3(volume.lower) + glm::dvec3(volume.upper)) : glm::dvec3(volume.center);
  }
  Volume leaf_volume(std::uint32_t n) const {
    return volume_at(image_, node_unit(e_, e_.regions[e_.leaves[n].region].copies[0], e_.leaves[n].node));
  }

  /// `map` after the way out of transform n.
  Map behind(const Map& map, std::uint32_t n, bool padded) const {
    const TransformD out = forward_of(n);
    Map result;
    result.out = compose(map.out, out);
    // The product is what bounds carried level by level have, the composed map's own stretch may be less.
    result.stretch = std::min(map.stretch * largest_stretch(out.linear), largest_stretch(result.out.linear));
    result.pad = map.pad;
    if (padded)
      result.pad += map.stretch *
                    least_transform_pad(n, middle(leaf_volume(n)), region_radius(e_, e_.regions[e_.leaves[n].region]));
    return result;
  }

  void check_leaf(std::uint32_t n) {
    const LeafView& leaf = e_.leaves[n];
    const RegionView& region = e_.regions[leaf.region];
    const double node_pad = kLeastPadNode * region_radius(e_, region);
    Map map = behind({}, n, true);
    map.pad += node_pad;
    for (std::size_t c = 0; c < region.copies.size(); ++c) {
      if (c > 0 && region.copies_agree) break;
      const CopyView& copy = region.copies[c];
      if (leaf.unit[c] < copy.start) continue;
      const std::uint32_t first = (leaf.unit[c] - copy.start) / node_units(image_);
      if (first >= copy.nodes.size()) continue;
      if (parents_.size() <= leaf.region) parents_.resize(e_.regions.size());
      std::vector<std::vector<std::uint32_t>>& parents = parents_[leaf.region];
      parents.resize(region.copies.size());
      if (parents[c].empty()) parents[c] = parents_of(copy);
      for (std::uint32_t i = first; i != kNone; i = parents[c][i]) {
        const Volume volume = volume_at(image_, node_unit(e_, copy, i));
        const Escape escape = escape_of(volume, radius_of(volume), e_.behind[n], map, true);
        if (!escape.found) continue;
        const Escape bare = escape_of(volume, radius_of(volume), e_.behind[n], behind({}, n, false), false);
        const std::string what = std::string(volume.is_box ? "the box" : "the sphere") + " of node " +
                                 std::to_string(i) + ", above the leaf of transform " + std::to_string(n) + ", ";
        e_.recorder.add(bare.found ? Rule::containment : Rule::padding, node_texel(e_, copy, i), i,
                        bare.found ? what + "is too small for " + told(bare)
                                   : what + "has less to spare than rounding needs for " + told(escape));
      }
    }
  }

  static std::string told(const Escape& escape) {
    return (escape.primitive == kNone ? std::string("what stands there")
                                      : "primitive " + std::to_string(escape.primitive)) +
           ", which sticks out by " + shown(escape.excess);
  }

  /// Whether a volume holds what stands in a region: `padded` with what a ray may hit around it.
  Escape escape_of(const Volume& volume, double volume_radius, std::uint32_t region, const Map& map, bool padded) {
    struct Place {
      std::uint32_t region;
      Map map;
    };
    std::vector<Place> spaces{{region, map}};
    while (!spaces.empty()) {
      const Place place = spaces.back();
      spaces.pop_back();
      const RegionView& here = e_.regions[place.region];
      const CopyView& copy = here.copies[0];
      const double radius = region_radius(e_, here);
      for (std::uint32_t i = 0; i < copy.nodes.size();) {
        const NodeView& node = copy.nodes[i];
        if (visits_left_ == 0) return {};  // not decided: check() says so
        --visits_left_;
        if (holds_node(volume, volume_radius, volume_at(image_, node_unit(e_, copy, i)), place.map)) {
          i = node.end;
          continue;
        }
        ++i;
        if (!node.is_leaf || node.payload == kNone) continue;
        if (node.payload >= image_.primitive_count) {
          const std::uint32_t n = node.payload - image_.primitive_count;
          if (e_.behind[n] != kNone && e_.leaves[n].node != kNone)
            spaces.push_back({e_.behind[n], behind(place.map, n, padded)});
          continue;
        }
        for (std::uint32_t k = node.payload; k < cluster_end(e_, node.payload); ++k) {
          if (visits_left_ == 0) return {};
          --visits_left_;
          const StoredPrimitive p = stored_primitive(image_, k);
          const double pad = padded ? kLeastPadEdge * longest_edge(p) + kLeastPadRadius * radius : 0.0;
          const double miss = primitive_excess(volume, volume_radius, p, place.map, pad);
          if (!(miss <= 0.0)) return {true, primitive_of_label(p.label).value_or(kNone), miss};
        }
      }
    }
    return {};
  }

  /// The node's own volume has the padding of what stands below it.
  bool holds_node(const Volume& volume, double volume_radius, const Volume& node, const Map& map) const {
    const glm::dvec3 center = transform_point(map.out, middle(node));
    double radius = 0.0;
    if (node.is_box) {
      const glm::dvec3 half = 0.5 * (glm::dvec3(node.upper) - glm::dvec3(node.lower));
      radius = map.stretch * glm::length(half);
    } else {
      radius = map.stretch * radius_of(node);
    }
    return excess(volume, volume_radius, center, radius + map.pad) <= 0.0;
  }

  static double primitive_excess(const Volume& volume, double volume_radius, const StoredPrimitive& p, const Map& map,
                                 double pad) {
    const double radius = map.stretch * (p.radius + pad) + map.pad;
    const auto at = [&](const glm::vec3& point) {
      const glm::dvec3 carried = transform_point(map.out, glm::dvec3(point));
      // Composing a few maps and applying them: each level costs some roundings of what is summed.
      const double rounding = 0x1p-44 * (glm::length(carried) + glm::length(map.out.translation));
      return excess(volume, volume_radius, carried, radius - rounding);
    };
    return p.is_triangle ? std::max({at(p.a), at(p.b), at(p.c)}) : at(p.a);
  }

  /// The balls of the image and of the records hold what stands there, without padding.
  void check_balls() {
    const auto escape_from = [&](const glm::vec4& texel, std::uint32_t region) {
      Volume ball;
      ball.center = glm::vec3(texel);
      return texel.w >= 0.0f ? escape_of(ball, texel.w, region, {}, false) : Escape{true, kNone, 0.0};
    };
    if (const Escape escape = escape_from(glm::vec4(image_.center, image_.radius), 0); escape.found)
      e_.recorder.add(Rule::ball, "the image's ball is too small for " + told(escape));
    std::vector<bool> done(e_.regions.size(), false);
    for (std::uint32_t n = 0; n < image_.transform_count; ++n) {
      const std::uint32_t r = e_.behind[n];
      if (r == kNone || e_.leaves[n].node == kNone || done[r]) continue;
      done[r] = true;  // other records that lead here have the same ball: check_records
      if (const Escape escape = escape_from(record_texel(image_, n, 6), r); escape.found)
        e_.recorder.add(Rule::ball, transform_texel(image_, n, 6), n,
                        "record " + std::to_string(n) + ": the ball is too small for " + told(escape));
    }
  }

  Examination& e_;
  const GeometryImage& image_;
  std::vector<std::vector<std::vector<std::uint32_t>>> parents_;  ///< by region and copy
  std::uint64_t visits_left_ = 0;
};

}  // namespace

void check_spaces(Examination& e) { Spaces(e).check(); }

}  // namespace plumbline
