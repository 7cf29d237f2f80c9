// SPDX-License-Identifier: MIT
// What the parts of certify() share: the image as regions of nodes, and what was found. Each part has a file of its
// own.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "tracer/image_view.h"
#include "tracer/verify.h"

namespace plumbline {

/// The rules, in the order of verify_rules().
enum class Rule {
  metadata,
  link_target,
  chain_end,
  cycle,
  no_end,
  unreached,
  visited_twice,
  copies,
  thread,
  containment,
  padding,
  ball,
  transform_balance,
  record,
  inverse,
  label,
  word,
  texel_nan,
  texel_denormal,
  texel_unused,
  primitive_bits,
  primitive_missing,
  matrix_bits,
  light_bits,
};

/// Collects findings: all are counted, the first of each rule kept.
class Recorder {
 public:
  explicit Recorder(const GeometryImage& image) : image_(&image) {}
  /// `texel` names the cell.
  void add(Rule rule, std::size_t texel, std::uint32_t node, std::string message);
  /// About an attribute.
  void add(Rule rule, std::string message) { add_at(rule, -1, -1, kNone, std::move(message)); }
  void merge(Recorder&& other);
  std::uint64_t count() const { return total_; }
  std::uint64_t count(Rule rule) const { return rule_count(rule); }
  /// Sorts what was found into the certificate.
  void finish(Certificate& certificate);

 private:
  struct Entry {
    Rule rule;
    Finding finding;
  };
  void add_at(Rule rule, int x, int y, std::uint32_t node, std::string message);
  std::uint64_t rule_count(Rule rule) const;

  const GeometryImage* image_;
  std::vector<Entry> entries_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

/// A node of a copy. Nodes stand depth first: below node i stand those from i + 1 to before `end`. Where a link is
/// broken, `end` is what makes a tree of it all the same.
struct NodeView {
  std::uint32_t end = 0;
  std::uint32_t payload = kNone;  ///< of a leaf: primitive k, or primitive_count + n; kNone: broken
  bool is_leaf = false;
};

struct CopyView {
  std::uint32_t start = 0;  ///< unit of the first node
  std::vector<NodeView> nodes;
};

struct RegionView {
  std::uint32_t start = 0, copy_size = 0;  ///< units
  std::vector<CopyView> copies;
  std::vector<std::uint32_t> from;  ///< scene nodes whose records lead here; empty: the world
  bool copies_agree = true;         ///< all hold the same nodes with the same bounds
  bool has_transforms = false;      ///< leads to other regions
};

/// Where a scene node's leaf stands.
struct LeafView {
  std::uint32_t region = kNone, node = kNone;  ///< node of copy 0; kNone: nowhere
  std::array<std::uint32_t, 8> unit{};         ///< in each copy
};

struct Examination {
  const GeometryImage& image;
  const Scene* scene;
  const SceneTree* tree;
  int threads;
  Certificate& certificate;
  Recorder recorder;
  std::vector<RegionView> regions;         ///< the world first
  std::vector<std::uint32_t> behind;       ///< of each record: the region that it leads to; kNone: none
  std::vector<LeafView> leaves;            ///< of each record
  std::vector<std::uint32_t> inner_first;  ///< regions such that those behind a region's transforms stand before it;
                                           ///< empty where transforms lead in circles
  std::vector<bool> is_shared;             ///< of each stored primitive: it is a triangle that is stored more than once
  /// Of each stored primitive: where its cluster ends. It does before a primitive to which a leaf leads, too, whatever
  /// the labels say, so that all clusters together are no longer than the primitives. check_clusters() fills it.
  std::vector<std::uint32_t> cluster_ends;
};

inline std::uint32_t node_unit(const Examination& e, const CopyView& copy, std::uint32_t node) {
  return copy.start + node * node_units(e.image);
}
inline std::size_t node_texel(const Examination& e, const CopyView& copy, std::uint32_t node) {
  return unit_texel(e.image, node_unit(e, copy, node));
}

/// Behind the last primitive of a leaf's cluster. Every loop over clusters ends here.
inline std::uint32_t cluster_end(const Examination& e, std::uint32_t payload) { return e.cluster_ends[payload]; }

/// Of each node the one around it; kNone: a root. verify_links.cpp
std::vector<std::uint32_t> parents_of(const CopyView& copy);

/// Notes rules as not decided in Certificate::undecided.
void leave_undecided(const Examination& e, std::initializer_list<Rule> rules);

// The parts, in their order.

/// False, with findings, where sizes and counts do not fit one another: then nothing else is looked at.
bool check_metadata(Examination& e);
/// Fills `regions`, `behind`, `leaves`: links, reach, ends. verify_links.cpp, verify_regions.cpp
void check_links(Examination& e);
/// One copy of a region from its texels.
CopyView read_copy(const GeometryImage& image, std::uint32_t start, std::uint32_t copy_size, Recorder& recorder);
/// All copies hold the same. verify_copies.cpp
void check_copies(Examination& e);
/// Labels and clusters; numbers that must not be; spare texels. verify_texels.cpp
void check_clusters(Examination& e);
void check_texels(Examination& e);
/// Ways in and out of transforms, and matrices. verify_records.cpp
void check_records(Examination& e);
/// Bounds around primitives, and around what stands behind transforms. verify_bounds.cpp, verify_spaces.cpp
void check_bounds(Examination& e);
void check_spaces(Examination& e);
/// Against the scene and its tree. verify_scene.cpp, verify_tree.cpp
void check_scene(Examination& e);
void check_tree(Examination& e);
/// The certificate's `slack`. verify_slack.cpp
void measure_slack(Examination& e);
/// Of each node of a region's first copy: its sphere's radius over that of the smallest ball around the primitives
/// below; 0 where Certificate::slack leaves it out. Clusters must have been checked.
std::vector<double> node_slack(const Examination& e, const RegionView& region);
/// Of each node of a copy the one that stands for it in another copy of the region; kNone: none does. verify_copies.cpp
std::vector<std::uint32_t> twins_of(const CopyView& first, const CopyView& other);

// What the bounds' parts share.

/// The least padding that bake.h derives, in the units of a space: for a primitive with edges of length up to `edge`,
/// in a space of radius `radius`. The bake rounds these up to kPadEdge and kPadRadius.
inline constexpr double kLeastPadEdge = 6.0 * 256 * 1.734 * 0x1p-24;     // (1): 6 * 2^8 u M, M <= 1.001 sqrt(3) L
inline constexpr double kLeastPadRadius = (37.0 * 3.3 + 1.5) * 0x1p-24;  // (25 + 12) u D + 1.5 u R
inline constexpr double kLeastPadNode = (12.0 * 3.3 + 1.5) * 0x1p-24;    // (2) alone
/// The radius of a region's space: at most the true one, for a ball's float radius covers its centre's rounding.
double least_radius(const glm::vec4& ball);
double region_radius(const Examination& e, const RegionView& region);
double longest_edge(const StoredPrimitive& primitive);

/// By how much a volume fails to hold the ball (point, radius); at most 0 where it holds it.
double excess(const Volume& volume, double volume_radius, const glm::dvec3& point, double radius);

/// Whether the triangles that stand in several leaves of a region are covered. verify_parts.cpp
void check_split_triangles(const Examination& e, const RegionView& region, const CopyView& copy, Recorder& recorder);

/// "3.1e-4"
std::string shown(double value);

}  // namespace plumbline
