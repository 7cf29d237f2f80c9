// SPDX-License-Identifier: MIT
// The records of transforms: what they say of the spaces on either side, the places where rays come out, and that the
// two matrices are each other's inverses.
#include <algorithm>
#include <limits>

#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

struct Matrices {
  glm::dmat3 forward, back;  ///< rows as columns: [row][column]
};
Matrices matrices_of(const GeometryImage& image, std::uint32_t n) {
  Matrices m;
  for (std::uint32_t row = 0; row < 3; ++row) {
    m.back[static_cast<int>(row)] = glm::dvec3(glm::vec3(record_texel(image, n, row)));
    m.forward[static_cast<int>(row)] = glm::dvec3(glm::vec3(record_texel(image, n, 3 + row)));
  }
  return m;
}

/// By how much inverse times matrix may miss the identity, for each entry. The inverse is adjugate by determinant in
/// double, then rounded to float. With A the cofactors' sums of absolute products and Q the largest entry of A^T |L|: a
/// cofactor is off by 2 * 2^-53 of A and the determinant by 5 * 2^-53 of Q, so that the double inverse times L misses
/// the identity by less than 2^-49 Q / |det|, and the determinant as computed here is off by no more; rounding to float
/// adds 2^-24 of |L^-1| |L|, or 2^-150 where it leaves a denormal.
glm::dmat3 inverse_bound(const Matrices& m) {
  const glm::dmat3& l = m.forward;
  double det = 0.0, q = 0.0;
  glm::dmat3 a;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      a[i][k] = std::abs(l[i1][k1] * l[i2][k2]) + std::abs(l[i1][k2] * l[i2][k1]);
      if (i == 0) det += l[0][k] * (l[i1][k1] * l[i2][k2] - l[i1][k2] * l[i2][k1]);
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      q = std::max(q, a[0][i] * std::abs(l[0][j]) + a[1][i] * std::abs(l[1][j]) + a[2][i] * std::abs(l[2][j]));
  glm::dmat3 bound;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double product = 0.0, size = 0.0;
      for (int k = 0; k < 3; ++k) product += std::abs(m.back[i][k] * l[k][j]), size += std::abs(l[k][j]);
      bound[i][j] = (0x1p-24 * product + 0x1p-150 * size) * (1.0 + 0x1p-20) + 0x1p-48 * q / std::abs(det);
    }
  return bound;
}

class Records {
 public:
  explicit Records(Examination& e) : e_(e), image_(e.image) {}

  void check() {
    for (std::uint32_t n = 0; n < image_.transform_count; ++n) {
      if (e_.leaves[n].node == kNone) continue;
      check_parent(n);
      check_places(n);
      check_contents(n);
      check_inverse(n);
      check_sharing(n);
    }
  }

 private:
  void find(Rule rule, std::uint32_t n, std::uint32_t texel, const std::string& message) {
    e_.recorder.add(rule, transform_texel(image_, n, texel), n, "record " + std::to_string(n) + ": " + message);
  }
  std::string space_of(std::uint32_t parent) const {
    return parent == 0 ? "the world" : "the space of node " + std::to_string(parent - 1);
  }

  /// The space to which a ray comes back must be the one in which the leaf stands.
  void check_parent(std::uint32_t n) {
    const float stored = record_texel(image_, n, 3).w;
    const auto parent = whole_number(stored);
    if (!parent || *parent > n) {  // parents have lower numbers
      find(Rule::transform_balance, n, 3,
           "the way out leads to node " + shown(stored) + " - 1, which cannot be around it");
      return;
    }
    const std::uint32_t outer = *parent == 0 ? 0 : e_.behind[*parent - 1];
    if (outer != e_.leaves[n].region)
      find(Rule::transform_balance, n, 3,
           "the way out leads to " + space_of(*parent) + ", but the leaf stands elsewhere");
    const auto depth_of = [&](std::uint32_t m) { return record_texel(image_, m, 7).z; };
    const float depth = *parent == 0 ? 1.0f : depth_of(*parent - 1) + 1.0f;
    if (!(depth_of(n) == depth && depth <= static_cast<float>(kMaxDepth)))
      find(Rule::record, n, 7,
           "its depth is said to be " + shown(depth_of(n)) + ", but " + space_of(*parent) + " around it makes it " +
               shown(depth));
  }

  void check_places(std::uint32_t n) {
    for (std::uint32_t c = 0; c < 8; ++c) {
      const float place = record_texel(image_, n, 8 + c / 4)[static_cast<int>(c % 4)];
      if (c >= image_.copy_count) {
        if (std::bit_cast<std::uint32_t>(place) != 0)
          find(Rule::texel_unused, n, 8 + c / 4, "it tells of a leaf in copy " + std::to_string(c) + ", which is none");
      } else if (!(place == static_cast<float>(e_.leaves[n].unit[c]))) {
        find(Rule::transform_balance, n, 8 + c / 4,
             "in copy " + std::to_string(c) + " the way out leads behind " + shown(place) +
                 ", but the leaf stands at " + std::to_string(e_.leaves[n].unit[c]));
      }
    }
  }

  /// Clusters of a region: the first primitive, and how many.
  std::pair<std::uint32_t, std::uint32_t> primitives_of(const RegionView& region) const {
    std::uint32_t first = kNone, count = 0;
    for (const NodeView& node : region.copies[0].nodes) {
      if (!node.is_leaf || node.payload >= image_.primitive_count) continue;
      first = std::min(first, node.payload);
      count += cluster_end(e_, node.payload) - node.payload;
    }
    return {count == 0 ? 0 : first, count};
  }

  void check_contents(std::uint32_t n) {
    const glm::vec4 texel = record_texel(image_, n, 7);
    if (std::bit_cast<std::uint32_t>(texel.w) != 0) find(Rule::texel_unused, n, 7, "R7.w is " + shown(texel.w));
    if (e_.behind[n] == kNone) return;  // reported
    const std::uint32_t r = e_.behind[n];
    if (counted_.size() < e_.regions.size()) counted_.resize(e_.regions.size(), {kNone, 0});
    if (counted_[r].first == kNone) counted_[r] = primitives_of(e_.regions[r]);
    const auto [first, count] = counted_[r];
    if (!(texel.x == static_cast<float>(first) && texel.y == static_cast<float>(count)))
      find(Rule::record, n, 7,
           "it tells of " + shown(texel.y) + " primitives from " + shown(texel.x) + " on, but " +
               std::to_string(count) + " from " + std::to_string(first) + " on stand behind it");
  }

  void check_inverse(std::uint32_t n) {
    const Matrices m = matrices_of(image_, n);
    const glm::dmat3 bound = inverse_bound(m);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        double entry = 0.0;
        for (int k = 0; k < 3; ++k) entry += m.back[i][k] * m.forward[k][j];
        const double miss = std::abs(entry - (i == j ? 1.0 : 0.0));
        if (miss <= bound[i][j]) continue;
        find(Rule::inverse, n, static_cast<std::uint32_t>(i),
             "entry (" + std::to_string(i) + ", " + std::to_string(j) + ") of inverse times matrix is " + shown(entry) +
                 ", off by " + shown(miss) + " where rounding explains " + shown(bound[i][j]));
        return;
      }
  }

  /// A region that several records lead to is a part's: all say the same of it, and it leads nowhere else.
  void check_sharing(std::uint32_t n) {
    if (e_.behind[n] == kNone) return;
    const RegionView& region = e_.regions[e_.behind[n]];
    if (region.from.size() < 2) return;
    const std::uint32_t first = region.from[0];
    if (n != first && !same_bits(record_texel(image_, n, 6), record_texel(image_, first, 6)))
      find(Rule::ball, n, 6,
           "the ball is not the one of record " + std::to_string(first) + ", which leads to the same region");
    if (n != first && region.has_transforms)
      find(Rule::transform_balance, n, 4,
           "it leads to the group behind record " + std::to_string(first) + ", from which rays come out there");
  }

  Examination& e_;
  const GeometryImage& image_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> counted_;
};

}  // namespace

void check_records(Examination& e) { Records(e).check(); }

}  // namespace plumbline
