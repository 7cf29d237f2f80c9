// SPDX-License-Identifier: MIT
// Clusters of primitives and their labels, and numbers that must not be: NaN, denormals, and what nothing reads.
#include <algorithm>
#include <limits>

#include "tracer/sphere_tree.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

std::string named(std::uint32_t k) { return "stored primitive " + std::to_string(k); }

class Clusters {
 public:
  explicit Clusters(Examination& e) : e_(e), image_(e.image) {}

  void check() {
    find_starts();
    find_ends();
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k) check_primitive(k);
    check_repeats();
  }

 private:
  std::size_t texel_of(std::uint32_t k) const { return primitive_texels(image_, k)[0]; }
  float label(std::uint32_t k) const { return image_.texels[texel_of(k)].w; }
  std::uint32_t number_of(std::uint32_t k) const { return primitive_of_label(label(k)).value_or(kNone); }
  void find(Rule rule, std::uint32_t k, const std::string& message) {
    e_.recorder.add(rule, texel_of(k), number_of(k), named(k) + ": " + message);
  }

  void find_starts() {
    region_.assign(image_.primitive_count, kNone);
    for (std::uint32_t r = 0; r < e_.regions.size(); ++r) {
      const CopyView& copy = e_.regions[r].copies[0];
      for (std::uint32_t i = 0; i < copy.nodes.size(); ++i) {
        const std::uint32_t k = copy.nodes[i].payload;
        if (!copy.nodes[i].is_leaf || k >= image_.primitive_count) continue;
        if (region_[k] == kNone)
          region_[k] = r;
        else
          e_.recorder.add(
              Rule::visited_twice, node_texel(e_, copy, i), i,
              "node " + std::to_string(i) + " leads to " + named(k) + ", to which another leaf leads already");
      }
    }
  }

  void find_ends() {
    std::vector<bool> starts(image_.primitive_count, false), is_shared(image_.primitive_count, false);
    // Copies may lead to others where the image is broken. What several leaves of one copy lead to is reported.
    for (std::uint32_t c = 0; c < image_.copy_count; ++c) {
      std::vector<bool> seen(image_.primitive_count, false);
      for (const RegionView& region : e_.regions) {
        if (c >= region.copies.size()) continue;
        for (const NodeView& node : region.copies[c].nodes) {
          if (!node.is_leaf || node.payload >= image_.primitive_count) continue;
          if (seen[node.payload]) is_shared[node.payload] = true;
          seen[node.payload] = starts[node.payload] = true;
        }
      }
    }
    e_.cluster_ends.assign(image_.primitive_count, image_.primitive_count);
    for (std::uint32_t k = image_.primitive_count; k-- > 0;) {
      const bool ends = k + 1 == image_.primitive_count || starts[k + 1] || label(k) < 0.0f;
      e_.cluster_ends[k] = ends ? k + 1 : e_.cluster_ends[k + 1];
    }
    // Many leaves that lead to one long cluster would each walk all of it.
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k)
      if (is_shared[k] && e_.cluster_ends[k] - k > static_cast<std::uint32_t>(kMaxLeafSize)) {
        e_.cluster_ends[k] = k + static_cast<std::uint32_t>(kMaxLeafSize);
        leave_undecided(e_, {Rule::containment, Rule::padding, Rule::ball});
      }
  }

  void check_primitive(std::uint32_t k) {
    const bool starts = region_[k] != kNone, must_start = k == 0 || label(k - 1) < 0.0f;
    if (starts && !must_start)
      find(Rule::label, k - 1, "its label does not end the cluster, but a leaf leads to the next");
    if (!starts && must_start) {
      if (k > 0) find(Rule::label, k - 1, "its label ends a cluster, but no leaf leads to the next");
      find(Rule::unreached, k, "no leaf leads to it");
    }
    if (!starts) region_[k] = must_start ? kNone : region_[k - 1];
    if (!primitive_of_label(label(k)))
      find(Rule::label, k, "the label is " + shown(label(k)) + ", no whole number of a primitive");
    if (k + 1 == image_.primitive_count && !(label(k) < 0.0f)) find(Rule::label, k, "the last cluster does not end");
    const float kind = image_.texels[primitive_texels(image_, k)[1]].w;
    const bool has_triangles = image_.primitive_stride == primitive_stride(image_.options.layout, true);
    if (kind != kKindSphere && (kind != kKindTriangle || !has_triangles))
      find(Rule::label, k,
           "its kind is " + shown(kind) + ", which is none" + (has_triangles ? "" : " in an image of spheres"));
  }

  /// A triangle may be stored several times, in one space, with the same bits.
  void check_repeats() {
    std::vector<std::uint64_t> order;
    order.reserve(image_.primitive_count);
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k)
      if (const std::uint32_t p = number_of(k); p != kNone) order.push_back(std::uint64_t{p} << 32 | k);
    std::sort(order.begin(), order.end());
    e_.is_shared.assign(image_.primitive_count, false);
    std::uint32_t triangles = 0, spheres = 0;
    std::uint32_t first = kNone;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto k = static_cast<std::uint32_t>(order[i]);
      const bool repeats = i > 0 && order[i] >> 32 == order[i - 1] >> 32;
      const StoredPrimitive here = stored_primitive(image_, k);
      if (!repeats) {
        first = k;
        ++(here.is_triangle ? triangles : spheres);
        continue;
      }
      const StoredPrimitive other = stored_primitive(image_, first);
      if (!here.is_triangle || !other.is_triangle) {
        find(Rule::label, k, "it bears the label of " + named(first) + ", and one of them is a sphere");
        continue;
      }
      if (region_[k] != region_[first])
        find(Rule::label, k, "it bears the label of " + named(first) + ", which stands in another space");
      else if (!(here.a == other.a && here.b == other.b && here.c == other.c))
        find(Rule::label, k, "it bears the label of " + named(first) + ", whose corners are others");
      else
        e_.certificate.split_triangles += !e_.is_shared[first], e_.is_shared[k] = e_.is_shared[first] = true;
    }
    const auto demand = [&](std::uint32_t found, std::uint32_t told, const char* what) {
      if (found != told)
        e_.recorder.add(Rule::metadata, "the image is said to hold " + std::to_string(told) + " " + what +
                                            ", but it holds " + std::to_string(found));
    };
    demand(static_cast<std::uint32_t>(std::count(region_.begin(), region_.end(), 0u)), image_.world_primitives,
           "primitives in the world");
    demand(triangles, image_.triangle_count, "triangles");
    demand(spheres, image_.sphere_count, "spheres");
  }

  Examination& e_;
  const GeometryImage& image_;
  std::vector<std::uint32_t> region_;  ///< of each stored primitive, as far as it is reached
};

bool is_finite(float value) { return (std::bit_cast<std::uint32_t>(value) & 0x7f800000u) != 0x7f800000u; }
bool is_denormal(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) & 0x7fffffffu;
  return bits != 0 && bits < 0x00800000u;
}
bool has_denormal(const glm::vec3& v) { return is_denormal(v.x) || is_denormal(v.y) || is_denormal(v.z); }

class Texels {
 public:
  explicit Texels(Examination& e) : e_(e), image_(e.image) {
    for (std::size_t r = 0; r < e.regions.size(); ++r) region_starts_.emplace_back(e.regions[r].start, r);
    std::sort(region_starts_.begin(), region_starts_.end());
  }

  void check() {
    check_finite();
    check_behind();
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k) check_primitive(k);
    for (std::uint32_t k = 0; k < image_.primitive_count; ++k) check_radius(k);
    for (const RegionView& region : e_.regions)
      for (const CopyView& copy : region.copies) check_copy(region, copy);
  }

 private:
  void find(Rule rule, std::size_t texel, std::uint32_t node, const std::string& message) {
    e_.recorder.add(rule, texel, node, message);
  }
  void demand_zero(float value, std::size_t texel, std::uint32_t node, const char* what) {
    if (std::bit_cast<std::uint32_t>(value) != 0)
      find(Rule::texel_unused, texel, node, std::string(what) + " is " + shown(value) + ", but means nothing");
  }

  void check_finite() {
    for (std::size_t at = 0; at < image_.texels.size(); ++at) {
      const glm::vec4& texel = image_.texels[at];
      if (is_finite(texel.x) && is_finite(texel.y) && is_finite(texel.z) && is_finite(texel.w)) continue;
      // An end is what check_links finds in its place, or not.
      if (is_compact(image_) && at < image_.primitive_start && std::bit_cast<std::uint32_t>(texel.w) == kEndWord &&
          is_finite(texel.x) && is_finite(texel.y) && is_finite(texel.z))
        continue;
      find(Rule::texel_nan, at, node_of(at),
           "the texel holds (" + shown(texel.x) + ", " + shown(texel.y) + ", " + shown(texel.z) + ", " +
               shown(texel.w) + ")");
    }
  }

  /// The number of the node, record or primitive that a texel belongs to.
  std::uint32_t node_of(std::size_t texel) const {
    const std::size_t width = static_cast<std::size_t>(image_.width);
    const std::uint64_t unit = is_compact(image_) ? texel : texel / width / 2 * width + texel % width;
    const std::uint64_t lights = image_.transform_start + std::uint64_t{record_units(image_)} * image_.transform_count;
    if (unit >= lights) return static_cast<std::uint32_t>((unit - lights) / light_units(image_));
    if (unit >= image_.transform_start)
      return static_cast<std::uint32_t>((unit - image_.transform_start) / record_units(image_));
    if (unit >= image_.primitive_start) {
      const auto k = static_cast<std::uint32_t>((unit - image_.primitive_start) / image_.primitive_stride);
      return primitive_of_label(stored_primitive(image_, k).label).value_or(kNone);
    }
    const auto behind =
        std::upper_bound(region_starts_.begin(), region_starts_.end(), std::pair(unit, e_.regions.size()));
    if (behind == region_starts_.begin()) return kNone;
    const RegionView& region = e_.regions[std::prev(behind)->second];
    if (unit >= region.start + std::uint64_t{region.copy_size} * image_.copy_count) return kNone;
    return static_cast<std::uint32_t>((unit - region.start) % region.copy_size / node_units(image_));
  }

  /// Behind the last unit that is used.
  void check_behind() {
    const std::uint64_t end = image_.transform_start + std::uint64_t{record_units(image_)} * image_.transform_count +
                              std::uint64_t{light_units(image_)} * image_.light_count;
    for (std::uint64_t unit = end; unit < unit_count(image_); ++unit)
      for (int row = 0; row < (is_compact(image_) ? 1 : 2); ++row)
        if (!is_zero_bits(texel_at(image_, unit, row)))
          find(Rule::texel_unused, unit_texel(image_, unit, row), kNone,
               "a texel behind the last that is used is not zero");
  }

  void check_primitive(std::uint32_t k) {
    const auto at = primitive_texels(image_, k);
    const StoredPrimitive primitive = stored_primitive(image_, k);
    const glm::vec4 &p1 = image_.texels[at[1]], &p2 = image_.texels[at[2]];
    const std::uint32_t number = primitive_of_label(primitive.label).value_or(kNone);
    if (primitive.is_triangle) {
      demand_zero(p2.w, at[2], number, "P2.w of a triangle");
      demand_zero(p1.w, at[1], number, "the kind of a triangle");  // -0 too
      for (const glm::vec3& corner : {primitive.a, primitive.b, primitive.c}) note_scale(corner);
    } else {
      demand_zero(p1.y, at[1], number, "P1.y of a sphere");
      demand_zero(p1.z, at[1], number, "P1.z of a sphere");
      if (at[2] != at[1])
        for (int i = 0; i < 4; ++i) demand_zero(p2[i], at[2], number, "P2 of a sphere");
      note_scale(primitive.a);
      if (!(primitive.radius >= 0.0f))
        find(Rule::label, at[1], number, "a sphere's radius is " + shown(primitive.radius));
      if (primitive.radius == 0.0f)
        find(Rule::texel_denormal, at[1], number, "the sphere's radius is 0: it was too small for a float");
    }
    if (!is_compact(image_) && image_.primitive_stride == 2)
      for (int i = 0; i < 4; ++i)
        demand_zero(texel_at(image_, primitive_unit(image_, k) + 1, 1)[i], at[1], number, "the texel below P1");
  }

  /// A radius that is denormal in the scene already is legal, one that bringing the scene to scale made so is not. The
  /// image alone does not tell which it is: without the scene it is found.
  void check_radius(std::uint32_t k) {
    const StoredPrimitive primitive = stored_primitive(image_, k);
    if (!is_denormal(primitive.radius) || least_ <= kSmall) return;
    const std::uint32_t number = primitive_of_label(primitive.label).value_or(kNone);
    if (!scene_allows_radius(number))
      find(Rule::texel_denormal, primitive_texels(image_, k)[1], number,
           "the sphere's radius is denormal, and no coordinate of a primitive is that small");
  }

  bool scene_allows_radius(std::uint32_t number) const {
    return e_.scene != nullptr && number < e_.scene->primitive_count() && !e_.scene->is_triangle(number) &&
           is_denormal(e_.scene->sphere(number).radius);
  }

  /// Coordinates as small as the scene has them are legal.
  void note_scale(const glm::vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (v[axis] != 0.0f) least_ = std::min(least_, std::fabs(v[axis]));
      e_.certificate.denormals += is_denormal(v[axis]);
    }
  }

  void check_copy(const RegionView& region, const CopyView& copy) {
    const auto count = static_cast<std::uint32_t>(copy.nodes.size());
    for (std::uint32_t i = 0; i < count; ++i) check_node(copy, i);
    const std::uint64_t end = copy.start + std::uint64_t{count} * node_units(image_);
    if (is_compact(image_)) {
      for (int axis = 0; axis < 3; ++axis)
        demand_zero(texel_at(image_, end)[axis], end, kNone, "a coordinate of the end");
    } else if (count == 0) {
      for (std::uint32_t unit = copy.start; unit < copy.start + region.copy_size; ++unit)
        for (int row = 0; row < 2; ++row)
          if (row == 0 || unit > copy.start)
            for (int i = 0; i < 4; ++i)
              demand_zero(texel_at(image_, unit, row)[i], unit_texel(image_, unit), kNone,
                          "a texel of an empty region");
    }
  }

  void check_node(const CopyView& copy, std::uint32_t i) {
    const std::size_t at = node_texel(e_, copy, i);
    const std::uint32_t unit = node_unit(e_, copy, i);
    const Volume volume = volume_at(image_, unit);
    if (volume.is_box) {
      demand_zero(texel_at(image_, unit + 1).w, at, i, "the w of a box's upper corner");
      if (!is_compact(image_)) {
        demand_zero(texel_at(image_, unit).w, at, i, "the w of a box's lower corner");
        for (int axis = 0; axis < 4; ++axis)
          demand_zero(texel_at(image_, unit + 1, 1)[axis], at, i, "the texel below a box's upper corner");
      }
    } else if (is_denormal(volume.radius2)) {
      find(Rule::texel_denormal, at, i, "node " + std::to_string(i) + ": the squared radius is denormal");
    }
    // A primitive's coordinates tell what the scene's scale is.
    const bool is_small =
        volume.is_box ? has_denormal(volume.lower) || has_denormal(volume.upper) : has_denormal(volume.center);
    if (is_small && least_ > kSmall)
      find(Rule::texel_denormal, at, i,
           "node " + std::to_string(i) + ": a coordinate is denormal, and none of a primitive is that small");
  }

  /// A scene that has coordinates below this may well have denormal ones after scaling and fitting.
  static constexpr float kSmall = 0x1p-100f;

  Examination& e_;
  const GeometryImage& image_;
  std::vector<std::pair<std::uint64_t, std::size_t>> region_starts_;  ///< ascending, with the region's number
  float least_ = std::numeric_limits<float>::max();                   ///< of the primitives' coordinates that are not 0
};

}  // namespace

void check_clusters(Examination& e) { Clusters(e).check(); }
void check_texels(Examination& e) { Texels(e).check(); }

}  // namespace plumbline
