// SPDX-License-Identifier: MIT
// The image against the scene: primitives and matrices are the scene's, bit for bit but for exact powers of two, and
// nothing is missing.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tracer/tree_references.h"
#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// Radii in [2^-20, 2^20] are kept, others brought into [0.5, 1).
int space_exponent(double radius) {
  if (radius == 0.0 || (radius >= 0x1p-20 && radius <= 0x1p20)) return 0;
  int exponent = 0;
  std::frexp(radius, &exponent);
  return -exponent;
}

glm::vec3 scaled(const glm::vec3& v, int exponent) {
  return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

/// A ball in a space's units: the centre rounded to the nearest float, the radius upwards by what that moved and up to
/// the next float.
glm::vec4 stored_ball(const Ball& ball, int exponent) {
  const glm::vec3 center(glm::dvec3(std::ldexp(ball.center.x, exponent), std::ldexp(ball.center.y, exponent),
                                    std::ldexp(ball.center.z, exponent)));
  const double radius =
      (std::ldexp(ball.radius, exponent) + glm::length(glm::dvec3(center)) * 0x1p-24) * (1.0 + 0x1p-50);
  const auto nearest = static_cast<float>(radius);
  return {center, nearest < radius ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest};
}

bool same(const glm::vec3& a, const glm::vec3& b) { return same_bits(glm::vec4(a, 0.0f), glm::vec4(b, 0.0f)); }

std::string told(const glm::vec3& v) { return "(" + shown(v.x) + ", " + shown(v.y) + ", " + shown(v.z) + ")"; }

class AgainstScene {
 public:
  explicit AgainstScene(Examination& e) : e_(e), image_(e.image), scene_(*e.scene) {}

  void check() {
    if (image_.transform_count != scene_.nodes.size()) {
      e_.recorder.add(Rule::metadata, "the image has " + std::to_string(image_.transform_count) +
                                          " transforms, but the scene has " + std::to_string(scene_.nodes.size()) +
                                          " nodes");
      leave_undecided(e_, {Rule::primitive_bits, Rule::primitive_missing, Rule::matrix_bits});
      return;
    }
    check_world_scale();
    number_parts();
    for (const Part& part : scene_.parts) {
      part_balls_.push_back(bounding_ball(scene_, part));
      part_exponents_.push_back(space_exponent(part_balls_.back().radius));
    }
    for (std::uint32_t r = 0; r < e_.regions.size(); ++r) check_region(r);
    check_missing();
    for (std::uint32_t n = 0; n < scene_.nodes.size(); ++n)
      if (e_.leaves[n].node != kNone) check_record(n);
    check_lights();
  }

 private:
  void check_lights() {
    if (image_.light_count != scene_.lights.size()) {
      e_.recorder.add(Rule::light_bits, "the image has " + std::to_string(image_.light_count) +
                                            " lights, but the scene has " + std::to_string(scene_.lights.size()));
      return;
    }
    for (std::uint32_t l = 0; l < image_.light_count; ++l) {
      const Light& light = scene_.lights[l];
      const glm::vec4 expected[] = {{light.position, light.radius},
                                    {light.has_color ? light.color : glm::vec3(0.0f), light.has_color ? 1.0f : 0.0f}};
      for (std::uint32_t i = 0; i < kLightTexels; ++i)
        if (!same_bits(image_.texels[light_texel(image_, l, i)], expected[i]))
          e_.recorder.add(Rule::light_bits, light_texel(image_, l, i), l,
                          "light " + std::to_string(l) + ": its " + (i == 0 ? "position or radius" : "colour") +
                              " is not the scene's " + told(glm::vec3(expected[i])) + ", " + shown(expected[i].w));
    }
  }

  void check_world_scale() {
    world_exponent_ = image_.scale_exponent;
    const bool is_plain = scene_.nodes.empty();
    if (!is_plain && e_.tree == nullptr) return;
    const Ball ball = is_plain ? bounding_ball(scene_) : e_.tree->groups[0].content;
    world_exponent_ = space_exponent(is_plain ? ball.radius : e_.tree->groups[0].extent);
    if (image_.scale_exponent != world_exponent_)
      e_.recorder.add(Rule::metadata, "the scale is said to be 2^" + std::to_string(image_.scale_exponent) +
                                          ", but the scene's is 2^" + std::to_string(world_exponent_));
    const glm::vec4 expected = stored_ball(ball, world_exponent_);
    if (!same_bits(expected, glm::vec4(image_.center, image_.radius)))
      e_.recorder.add(Rule::ball, "the image's ball is not the scene's, which has the centre " +
                                      told(glm::vec3(expected)) + " and the radius " + shown(expected.w));
  }

  std::uint32_t part_of(std::uint32_t primitive) const { return parts_.empty() ? kNone : parts_[primitive]; }

  void number_parts() {
    if (scene_.parts.empty()) return;
    parts_.assign(scene_.primitive_count(), kNone);
    const auto triangles = static_cast<std::uint32_t>(scene_.triangles.size());
    for (std::uint32_t p = 0; p < scene_.parts.size(); ++p) {
      const Part& part = scene_.parts[p];
      std::fill_n(parts_.begin() + part.first_triangle, part.triangle_count, p);
      std::fill_n(parts_.begin() + triangles + part.first_sphere, part.sphere_count, p);
    }
  }

  void check_region(std::uint32_t r) {
    const RegionView& region = e_.regions[r];
    std::vector<std::uint32_t> stored;
    for (const NodeView& node : region.copies[0].nodes) {
      if (!node.is_leaf || node.payload >= image_.primitive_count) continue;
      for (std::uint32_t k = node.payload; k < cluster_end(e_, node.payload); ++k) stored.push_back(k);
    }
    std::uint32_t part = kNone;
    if (!region.from.empty()) {
      const auto first = stored.empty() ? std::nullopt : primitive_of_label(stored_primitive(image_, stored[0]).label);
      if (first && *first < scene_.primitive_count()) part = part_of(*first);
      for (const std::uint32_t n : region.from)
        if (scene_.nodes[n].part != part)
          e_.recorder.add(Rule::record, transform_texel(image_, n, 4), n,
                          "record " + std::to_string(n) + ": it leads to another part than the scene's node does");
    }
    if (stored.empty()) return;
    const int exponent = part == kNone ? world_exponent_ : part_exponents_[part];
    const std::size_t chunks = stored.size() > 20000 ? 64 : 1;
    std::vector<Recorder> found(chunks, Recorder(image_));
    parallel_for(chunks, e_.threads, [&](std::size_t chunk) {
      for (std::size_t i = stored.size() * chunk / chunks; i < stored.size() * (chunk + 1) / chunks; ++i)
        check_primitive(stored[i], part, exponent, found[chunk]);
    });
    for (Recorder& one : found) e_.recorder.merge(std::move(one));
    seen_.resize(scene_.primitive_count(), false);
    for (const std::uint32_t k : stored)
      if (const auto p = primitive_of_label(stored_primitive(image_, k).label); p && *p < seen_.size())
        seen_[*p] = true;
  }

  void check_primitive(std::uint32_t k, std::uint32_t part, int exponent, Recorder& recorder) const {
    const StoredPrimitive stored = stored_primitive(image_, k);
    const auto p = primitive_of_label(stored.label);
    if (!p) return;  // reported
    const std::size_t texel = primitive_texels(image_, k)[0];
    const auto find = [&](const std::string& message) {
      recorder.add(Rule::primitive_bits, texel, *p, "primitive " + std::to_string(*p) + ": " + message);
    };
    if (*p >= scene_.primitive_count())
      return find("the scene has no more than " + std::to_string(scene_.primitive_count()));
    if (part_of(*p) != part) return find("the scene has it in another space");
    if (stored.is_triangle != scene_.is_triangle(*p)) return find("the scene has another kind there");
    if (!stored.is_triangle) {
      const Sphere& sphere = scene_.sphere(*p);
      const float radius = std::ldexp(sphere.radius, exponent);
      if (!same(stored.a, scaled(sphere.center, exponent)) || !same(glm::vec3(stored.radius), glm::vec3(radius)))
        find("the sphere is " + told(stored.a) + ", " + shown(stored.radius) + ", but the scene's " +
             told(scaled(sphere.center, exponent)) + ", " + shown(radius));
      return;
    }
    const auto corners = scene_.corners(*p);
    const glm::vec3* here[] = {&stored.a, &stored.b, &stored.c};
    for (std::size_t i = 0; i < 3; ++i)
      if (!same(*here[i], scaled(corners[i], exponent)))
        return find("corner " + std::to_string(i) + " is " + told(*here[i]) + ", but the scene's " +
                    told(scaled(corners[i], exponent)));
  }

  bool has_extent(std::uint32_t p) const {
    if (!scene_.is_triangle(p)) return scene_.sphere(p).radius > 0.0f;
    const auto corners = scene_.corners(p);
    return !has_no_area(corners[0], corners[1], corners[2]);
  }

  /// What is placed must be there, and what shows something must have a leaf.
  void check_missing() {
    seen_.resize(scene_.primitive_count(), false);
    std::vector<bool> is_placed(scene_.parts.size(), false), shows(scene_.nodes.size(), false);
    for (const Node& node : scene_.nodes)
      if (node.part != kNone) is_placed[node.part] = true;
    const auto check_range = [&](std::uint32_t first, std::uint32_t count) {
      bool any = false;
      for (std::uint32_t p = first; p < first + count; ++p) {
        if (seen_[p]) any = true;
        if (seen_[p] || !has_extent(p)) continue;
        any = true;
        e_.recorder.add(Rule::primitive_missing, "primitive " + std::to_string(p) + " stands nowhere in the image");
      }
      return any;
    };
    const auto triangles = static_cast<std::uint32_t>(scene_.triangles.size());
    check_range(0, scene_.world_triangle_count());
    check_range(triangles, scene_.world_sphere_count());
    for (std::uint32_t part = 0; part < scene_.parts.size(); ++part) {
      if (!is_placed[part]) continue;
      const Part& p = scene_.parts[part];
      const bool any_triangle = check_range(p.first_triangle, p.triangle_count);
      is_placed[part] = check_range(triangles + p.first_sphere, p.sphere_count) || any_triangle;
    }
    for (std::size_t n = scene_.nodes.size(); n-- > 0;) {  // children first
      const Node& node = scene_.nodes[n];
      if (node.part != kNone) shows[n] = is_placed[node.part];
      if (shows[n] && node.parent != kNone) shows[node.parent] = true;
      if (shows[n] && e_.leaves[n].node == kNone)
        e_.recorder.add(Rule::unreached, transform_texel(image_, static_cast<std::uint32_t>(n), 0),
                        static_cast<std::uint32_t>(n), "node " + scene_.nodes[n].name + " stands in no leaf");
    }
  }

  /// The exponent of the space behind a node. A group's follows from its tree; without one it is what the matrix says.
  int inner_exponent(std::uint32_t n) const {
    const Node& node = scene_.nodes[n];
    if (node.part != kNone) return part_exponents_[node.part];
    if (e_.tree != nullptr) return space_exponent(e_.tree->groups[n + 1].extent);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        const float here = record_texel(image_, n, static_cast<std::uint32_t>(3 + row))[column];
        const float there = node.transform.linear[column][row];
        if (std::isfinite(here) && here != 0.0f && there != 0.0f)
          return outer_exponent(n) - (std::ilogb(here) - std::ilogb(there));
      }
    return 0;
  }
  int outer_exponent(std::uint32_t n) const {
    const std::uint32_t parent = scene_.nodes[n].parent;
    return parent == kNone ? world_exponent_ : inner_exponent(parent);
  }

  void check_record(std::uint32_t n) {
    const Node& node = scene_.nodes[n];
    const auto find = [&](Rule rule, std::uint32_t i, const std::string& message) {
      e_.recorder.add(rule, transform_texel(image_, n, i), n, "record " + std::to_string(n) + ": " + message);
    };
    const float parent = node.parent == kNone ? 0.0f : static_cast<float>(node.parent + 1);
    if (record_texel(image_, n, 3).w != parent)
      find(Rule::transform_balance, 3, "the way out does not lead to the scene's parent");
    const int outer = outer_exponent(n), inner = inner_exponent(n);
    const TransformD forward = to_double(node.transform), back = inverse(forward);
    for (std::uint32_t row = 0; row < 3; ++row) {
      const auto r = static_cast<int>(row);
      glm::vec3 in, out;
      for (int column = 0; column < 3; ++column) {
        in[column] = static_cast<float>(std::ldexp(back.linear[column][r], inner - outer));
        out[column] = static_cast<float>(std::ldexp(forward.linear[column][r], outer - inner));
      }
      const auto t = static_cast<float>(std::ldexp(forward.translation[r], outer));
      if (!same(glm::vec3(record_texel(image_, n, row)), in))
        find(Rule::matrix_bits, row, "row " + std::to_string(row) + " of the inverse is not the scene's " + told(in));
      if (!same(glm::vec3(record_texel(image_, n, row).w), glm::vec3(t)))
        find(Rule::matrix_bits, row,
             "component " + std::to_string(row) + " of the translation is not the scene's " + shown(t));
      if (!same(glm::vec3(record_texel(image_, n, 3 + row)), out))
        find(Rule::matrix_bits, 3 + row,
             "row " + std::to_string(row) + " of the matrix is not the scene's " + told(out));
    }
    if (node.part == kNone && e_.tree == nullptr) return;
    const glm::vec4 ball =
        stored_ball(node.part != kNone ? part_balls_[node.part] : e_.tree->groups[n + 1].content, inner);
    if (!same_bits(record_texel(image_, n, 6), ball))
      find(Rule::ball, 6,
           "the ball is not the one of what the scene has there: " + told(glm::vec3(ball)) + ", " + shown(ball.w));
  }

  Examination& e_;
  const GeometryImage& image_;
  const Scene& scene_;
  int world_exponent_ = 0;
  std::vector<Ball> part_balls_;
  std::vector<int> part_exponents_;
  std::vector<std::uint32_t> parts_;  ///< of each primitive; empty where there are none
  std::vector<bool> seen_;
};

}  // namespace

void check_scene(Examination& e) { AgainstScene(e).check(); }

}  // namespace plumbline
