// SPDX-License-Identifier: MIT
// Triangles that stand in several leaves: each point of such a triangle must lie in all the volumes above one of them.
//
// The triangle is cut as long as no leaf holds a piece whole. Volumes are convex, so a piece lies in one where its
// corners do. Cutting across the middle of the longest side is what the builder does (tree_references.cpp): in a sound
// image the pieces are the parts that it has made. The cut corners are rounded, by less than 2^-42 of the largest
// coordinate for up to 64 cuts one above the other, as is derived there; every corner is given that radius.
#include <algorithm>
#include <map>

#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

constexpr int kMaxCuts = 64;
/// Pieces of a triangle that are looked at before it is given up, for each leaf that it stands in and for any triangle.
constexpr std::size_t kPiecesPerLeaf = 64, kPiecesAtLeast = 4096;
/// Nodes that are looked at for all triangles of a region together, for each of its nodes and for any region.
constexpr std::uint64_t kVisitsPerNode = 4096, kVisitsAtLeast = std::uint64_t{1} << 24;

struct Piece {
  std::vector<glm::dvec3> corners;
  int cuts = 0;
};

double longest_side(const Piece& piece) {
  glm::dvec3 lower = piece.corners[0], upper = lower;
  for (const glm::dvec3& corner : piece.corners) lower = glm::min(lower, corner), upper = glm::max(upper, corner);
  return std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
}

/// The two sides of the middle of the longest side of its box; false where nothing is left to cut.
bool cut(const Piece& piece, Piece& low, Piece& high) {
  glm::dvec3 lower = piece.corners[0], upper = lower;
  for (const glm::dvec3& corner : piece.corners) lower = glm::min(lower, corner), upper = glm::max(upper, corner);
  const glm::dvec3 size = upper - lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const double plane = lower[axis] + 0.5 * size[axis];
  if (!(lower[axis] < plane && plane < upper[axis]) || piece.cuts >= kMaxCuts) return false;
  for (Piece* side : {&low, &high}) side->corners.clear(), side->cuts = piece.cuts + 1;
  for (std::size_t i = 0; i < piece.corners.size(); ++i) {
    const glm::dvec3 &p = piece.corners[i], &q = piece.corners[(i + 1) % piece.corners.size()];
    if (p[axis] <= plane) low.corners.push_back(p);
    if (p[axis] >= plane) high.corners.push_back(p);
    if ((p[axis] < plane && q[axis] > plane) || (p[axis] > plane && q[axis] < plane)) {
      const double t = (plane - p[axis]) / (q[axis] - p[axis]);
      glm::dvec3 v = p + t * (q - p);
      v[axis] = plane;
      low.corners.push_back(v), high.corners.push_back(v);
    }
  }
  return true;
}

struct SharedTriangle {
  StoredPrimitive triangle;
  std::vector<std::uint32_t> leaves;
};

/// What is said of a triangle.
enum class Covered { yes, no, not_decided };

/// A volume that fails to hold a piece, and by how much.
struct Failing {
  std::uint32_t node = kNone;
  double excess = 0.0;
};

class Cover {
 public:
  Cover(const Examination& e, const RegionView& region, const CopyView& copy)
      : e_(e),
        copy_(copy),
        radius_(region_radius(e, region)),
        parent_(parents_of(copy)),
        above_(copy.nodes.size(), 0.0f),
        visits_left_(kVisitsAtLeast + kVisitsPerNode * copy.nodes.size()),
        blame_left_(kVisitsAtLeast) {}

  void check(Recorder& recorder) {
    std::map<std::uint32_t, SharedTriangle> triangles;
    for (std::uint32_t i = 0; i < copy_.nodes.size(); ++i) {
      const std::uint32_t first = copy_.nodes[i].payload;
      if (!copy_.nodes[i].is_leaf || first >= e_.image.primitive_count) continue;
      for (std::uint32_t k = first; k < cluster_end(e_, first); ++k) {
        if (!e_.is_shared[k]) continue;
        const StoredPrimitive primitive = stored_primitive(e_.image, k);
        SharedTriangle& shared = triangles[*primitive_of_label(primitive.label)];
        shared.triangle = primitive;
        shared.triangle.label = std::fabs(primitive.label);
        shared.leaves.push_back(i);
      }
    }
    for (const auto& [number, shared] : triangles) check_triangle(number, shared, recorder);
  }

 private:
  void check_triangle(std::uint32_t number, const SharedTriangle& shared, Recorder& recorder) {
    double largest = 0.0;
    for (const glm::vec3& corner : {shared.triangle.a, shared.triangle.b, shared.triangle.c})
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(static_cast<double>(corner[axis])));
    for (const std::uint32_t leaf : shared.leaves)
      for (std::uint32_t i = leaf; i != kNone && above_[i] != shared.triangle.label; i = parent_[i])
        above_[i] = shared.triangle.label;
    const double rounding = 0x1p-42 * largest;
    const double pad = kLeastPadEdge * longest_edge(shared.triangle) + kLeastPadRadius * radius_;
    Failing failing, bare;
    const Covered padded = find_uncovered(shared, pad + rounding, failing);
    if (padded == Covered::yes) return;
    const Covered covered =
        padded == Covered::not_decided ? padded : find_uncovered(shared, rounding, bare);  // without padding
    if (covered == Covered::not_decided) {
      leave_undecided(e_, {Rule::containment, Rule::padding});
      const std::uint32_t leaf = shared.leaves[0];
      return recorder.add(Rule::containment, node_texel(e_, copy_, leaf), leaf,
                          "whether triangle " + std::to_string(number) + ", which stands in " +
                              std::to_string(shared.leaves.size()) +
                              " leaves, is covered by them is not decided: it takes more steps than are allowed");
    }
    const bool sticks_out = covered == Covered::no;
    if (sticks_out) failing = bare;
    const std::string what = "node " + std::to_string(failing.node) + ": of triangle " + std::to_string(number) +
                             ", which stands in " + std::to_string(shared.leaves.size()) + " leaves, a piece ";
    recorder.add(
        sticks_out ? Rule::containment : Rule::padding, node_texel(e_, copy_, failing.node), failing.node,
        what +
            (sticks_out ? "lies in none of them; here it sticks out by "
                        : "lies nearer to the surface of the volumes above each than rounding needs; here by ") +
            shown(failing.excess));
  }

  /// Where not all is covered, `failing` is the volume to blame.
  Covered find_uncovered(const SharedTriangle& shared, double radius, Failing& failing) {
    const Piece whole{{glm::dvec3(shared.triangle.a), glm::dvec3(shared.triangle.b), glm::dvec3(shared.triangle.c)}, 0};
    const std::size_t most = kPiecesAtLeast + kPiecesPerLeaf * shared.leaves.size();
    std::vector<Piece> waiting{whole};
    for (std::size_t pieces = 0; !waiting.empty(); ++pieces) {
      const Piece piece = std::move(waiting.back());
      waiting.pop_back();
      if (is_held(piece, shared, radius, visits_left_)) continue;
      Piece low, high;
      if (pieces >= most || visits_left_ == 0) return Covered::not_decided;
      if (!cut(piece, low, high)) {
        failing = blamed(whole, piece, shared, radius);
        return Covered::no;
      }
      waiting.push_back(std::move(low)), waiting.push_back(std::move(high));
    }
    return Covered::yes;
  }

  /// Of the leaves the one that would have to grow least to cover all that none covers, and the volume above it that
  /// fails worst. What is not covered is looked at in pieces of a share of the triangle; where that takes too long, it
  /// is the first of the leaves, and what fails there to hold a piece that none holds.
  Failing blamed(const Piece& whole, const Piece& uncovered, const SharedTriangle& shared, double radius) {
    constexpr double kShare = 1.0 / 64.0;
    constexpr std::size_t kMostPieces = 256;
    const double small = kShare * longest_side(whole);
    std::vector<Piece> waiting{whole}, open;
    while (!waiting.empty() && open.size() < kMostPieces && blame_left_ > 0) {
      const Piece piece = std::move(waiting.back());
      waiting.pop_back();
      if (is_held(piece, shared, radius, blame_left_)) continue;
      Piece low, high;
      if (longest_side(piece) <= small || !cut(piece, low, high)) {
        open.push_back(piece);
        continue;
      }
      waiting.push_back(std::move(low)), waiting.push_back(std::move(high));
    }
    Failing nearest;
    for (const std::uint32_t leaf : shared.leaves) {
      Failing worst;
      for (const Piece& piece : open) {
        if (blame_left_ == 0) break;
        if (const Failing here = failing_at(piece, leaf, radius); worst.node == kNone || here.excess > worst.excess)
          worst = here;
      }
      if (blame_left_ == 0 || open.empty()) return failing_at(uncovered, shared.leaves[0], radius);
      if (nearest.node == kNone || worst.excess < nearest.excess) nearest = worst;
    }
    return nearest;
  }

  /// Down from the roots, through volumes that hold the piece, to one of the triangle's leaves.
  bool is_held(const Piece& piece, const SharedTriangle& shared, double radius, std::uint64_t& visits_left) const {
    for (std::uint32_t i = 0; i < copy_.nodes.size() && visits_left > 0; --visits_left) {
      if (above_[i] != shared.triangle.label) {
        i = copy_.nodes[i].end;
        continue;
      }
      const Volume volume = volume_at(e_.image, node_unit(e_, copy_, i));
      const double volume_radius = std::sqrt(static_cast<double>(volume.radius2));
      const bool holds = std::all_of(piece.corners.begin(), piece.corners.end(), [&](const glm::dvec3& corner) {
        return excess(volume, volume_radius, corner, radius) <= 0.0;
      });
      if (holds && std::binary_search(shared.leaves.begin(), shared.leaves.end(), i)) return true;
      i = holds ? i + 1 : copy_.nodes[i].end;
    }
    return false;
  }

  /// The volume above a leaf that fails worst.
  Failing failing_at(const Piece& piece, std::uint32_t leaf, double radius) {
    Failing worst;
    for (std::uint32_t i = leaf; i != kNone; i = parent_[i]) {
      if (blame_left_ > 0) --blame_left_;
      const Volume volume = volume_at(e_.image, node_unit(e_, copy_, i));
      const double volume_radius = std::sqrt(static_cast<double>(volume.radius2));
      for (const glm::dvec3& corner : piece.corners) {
        const double miss = excess(volume, volume_radius, corner, radius);
        if (worst.node == kNone || !(miss <= worst.excess)) worst = {i, miss};
      }
    }
    return worst;
  }

  const Examination& e_;
  const CopyView& copy_;
  const double radius_;
  const std::vector<std::uint32_t> parent_;
  std::vector<float> above_;   ///< of each node: the triangle that was last looked at of those that stand below it
  std::uint64_t visits_left_;  ///< to decide
  std::uint64_t blame_left_;   ///< to find whom to blame
};

}  // namespace

void check_split_triangles(const Examination& e, const RegionView& region, const CopyView& copy, Recorder& recorder) {
  Cover(e, region, copy).check(recorder);
}

}  // namespace plumbline
