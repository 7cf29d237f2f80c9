// SPDX-License-Identifier: MIT
// The image as regions: where records say that they stand, how transforms lead from one to the other, and the longest
// walk through all of them.
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// Where a record says that the region behind it stands.
struct Claim {
  std::uint64_t start = 0, size = 0;  ///< units; of one copy
  std::vector<std::uint32_t> records;
  bool is_refused = false;
};

class RegionReader {
 public:
  explicit RegionReader(Examination& e) : e_(e), image_(e.image) {}

  void read() {
    e_.behind.assign(image_.transform_count, kNone);
    e_.leaves.assign(image_.transform_count, {});
    collect_claims();
    refuse_overlaps();
    read_copies();
    if (e_.recorder.count(Rule::metadata) > 0) return;
    connect();
    check_reach();
    order_inner_first();
    count_longest_walk();
  }

 private:
  std::uint64_t end_of(const Claim& claim) const { return claim.start + claim.size * image_.copy_count; }
  bool has_shape(std::uint64_t size) const {
    return is_compact(image_) ? size % node_units(image_) == 1 % node_units(image_) && size > 0
                              : size > 0 && size % node_units(image_) == 0;
  }
  void blame(std::uint32_t n, std::uint32_t texel, const std::string& message) {
    e_.recorder.add(Rule::record, transform_texel(image_, n, texel), n, "record " + std::to_string(n) + ": " + message);
  }

  bool is_unused(std::uint32_t n) const {
    for (std::uint32_t i = 0; i < kTransformTexels; ++i)
      if (!is_zero_bits(record_texel(image_, n, i))) return false;
    return true;
  }

  void collect_claims() {
    claims_.push_back({0, image_.copy_size, {}, false});
    if (!has_shape(image_.copy_size)) {
      e_.recorder.add(Rule::metadata, "the world's copies of " + std::to_string(image_.copy_size) +
                                          " units do not consist of whole nodes");
      return;
    }
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> known;
    for (std::uint32_t n = 0; n < image_.transform_count; ++n) {
      if (is_unused(n)) continue;
      const auto start = whole_number(record_texel(image_, n, 4).w), size = whole_number(record_texel(image_, n, 5).w);
      if (!start || !size || !has_shape(*size) || end_of({*start, *size, {}, false}) > image_.primitive_start) {
        blame(n, !start || *start >= image_.primitive_start ? 4 : 5,
              "no region stands at " + shown(record_texel(image_, n, 4).w) + " with copies of " +
                  shown(record_texel(image_, n, 5).w) + " units");
        continue;
      }
      const auto [at, is_new] = known.try_emplace({*start, *size}, claims_.size());
      if (is_new) claims_.push_back({*start, *size, {}, false});
      claims_[at->second].records.push_back(n);
    }
  }

  /// Regions stand side by side, so of two that overlap the one that fits its neighbours less is wrong.
  void refuse_overlaps() {
    std::set<std::uint64_t> starts{image_.primitive_start, image_.primitive_start - 1}, ends{0};
    for (const Claim& claim : claims_) starts.insert(claim.start), ends.insert(end_of(claim));
    const auto rank = [&](const Claim& claim) {  // the world first, then what fits, then what many records say
      return std::tuple(claim.start == 0 && claim.records.empty(),
                        ends.contains(claim.start) + starts.contains(end_of(claim)), claim.records.size());
    };
    std::vector<std::size_t> order(claims_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank(claims_[a]) > rank(claims_[b]); });
    std::map<std::uint64_t, std::uint64_t> taken;  // start to end
    for (const std::size_t i : order) {
      Claim& claim = claims_[i];
      const auto next = taken.upper_bound(claim.start);
      claim.is_refused = (next != taken.end() && next->first < end_of(claim)) ||
                         (next != taken.begin() && std::prev(next)->second > claim.start);
      if (!claim.is_refused) {
        taken[claim.start] = end_of(claim);
        continue;
      }
      // Where the start is a region's, the size is what is wrong.
      for (const std::uint32_t n : claim.records)
        blame(n, taken.contains(claim.start) ? 5 : 4,
              "the region at " + std::to_string(claim.start) + " with copies of " + std::to_string(claim.size) +
                  " units would overlap another");
    }
  }

  void read_copies() {
    if (e_.recorder.count(Rule::metadata) > 0) return;
    for (const Claim& claim : claims_) {
      if (claim.is_refused) continue;
      RegionView region;
      region.start = static_cast<std::uint32_t>(claim.start), region.copy_size = static_cast<std::uint32_t>(claim.size);
      region.copies.resize(image_.copy_count);
      for (const std::uint32_t n : claim.records) e_.behind[n] = static_cast<std::uint32_t>(e_.regions.size());
      e_.regions.push_back(std::move(region));
    }
    const std::size_t tasks = e_.regions.size() * image_.copy_count;
    std::vector<Recorder> found(tasks, Recorder(image_));
    parallel_for(tasks, image_.primitive_start > (1u << 15) ? e_.threads : 1, [&](std::size_t task) {
      RegionView& region = e_.regions[task / image_.copy_count];
      const auto copy = static_cast<std::uint32_t>(task % image_.copy_count);
      region.copies[copy] = read_copy(image_, region.start + copy * region.copy_size, region.copy_size, found[task]);
    });
    for (Recorder& one : found) e_.recorder.merge(std::move(one));
  }

  /// Walks from region to region through the leaves of their first copies.
  void connect() {
    std::vector<std::uint32_t> waiting{0};
    reached_.assign(e_.regions.size(), false);
    reached_[0] = true;
    for (std::size_t w = 0; w < waiting.size(); ++w) {
      const std::uint32_t r = waiting[w];
      const CopyView& copy = e_.regions[r].copies[0];
      for (std::uint32_t i = 0; i < copy.nodes.size(); ++i) {
        const std::uint32_t n = transform_of(copy.nodes[i]);
        if (n == kNone) continue;
        e_.regions[r].has_transforms = true;
        if (e_.leaves[n].node != kNone) {
          e_.recorder.add(Rule::visited_twice, node_texel(e_, copy, i), i,
                          "node " + std::to_string(i) + " leads to transform " + std::to_string(n) +
                              ", which stands in another leaf already");
          continue;
        }
        e_.leaves[n].region = r, e_.leaves[n].node = i;
        if (is_unused(n)) blame(n, 4, "a leaf leads to it, but it is empty");
        const std::uint32_t q = e_.behind[n];
        if (q == kNone) continue;
        e_.regions[q].from.push_back(n);
        if (!reached_[q]) waiting.push_back(q);
        reached_[q] = true;
      }
    }
    for (std::uint32_t n = 0; n < image_.transform_count; ++n) note_leaves(n);
  }

  std::uint32_t transform_of(const NodeView& node) const {
    if (!node.is_leaf || node.payload == kNone || node.payload < image_.primitive_count) return kNone;
    return node.payload - image_.primitive_count;
  }

  /// The leaves of a transform in all copies. Those of a region's other copies are found when its first leaf is.
  void note_leaves(std::uint32_t n) {
    const std::uint32_t r = e_.leaves[n].region;
    if (r == kNone || noted_.contains(r)) return;
    noted_.insert(r);
    for (std::uint32_t c = 0; c < image_.copy_count; ++c) {
      const CopyView& copy = e_.regions[r].copies[c];
      for (std::uint32_t i = 0; i < copy.nodes.size(); ++i)
        if (const std::uint32_t m = transform_of(copy.nodes[i]); m != kNone && e_.leaves[m].region == r)
          e_.leaves[m].unit[c] = node_unit(e_, copy, i);
    }
  }

  void check_reach() {
    for (std::uint32_t n = 0; n < image_.transform_count; ++n)
      if (e_.leaves[n].node == kNone && !is_unused(n))
        e_.recorder.add(Rule::unreached, transform_texel(image_, n, 0), n,
                        "no leaf leads to record " + std::to_string(n) + ", which holds something");
    std::vector<std::pair<std::uint64_t, std::uint64_t>> spans;
    for (std::size_t r = 0; r < e_.regions.size(); ++r) {
      const RegionView& region = e_.regions[r];
      spans.emplace_back(region.start, region.start + std::uint64_t{region.copy_size} * image_.copy_count);
      if (!reached_[r])
        e_.recorder.add(Rule::unreached, unit_texel(image_, region.start), kNone,
                        "no transform that is reached leads to the region at " + std::to_string(region.start));
    }
    std::sort(spans.begin(), spans.end());
    std::uint64_t at = 0;
    spans.emplace_back(image_.primitive_start, image_.primitive_start);
    for (const auto& [start, end] : spans) {
      check_gap(at, start);
      at = std::max(at, end);
    }
  }

  /// Between regions stand only those of parts that nothing shows, which are empty, and in layout `paper` a cell that
  /// is left free before the primitives.
  void check_gap(std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t unit = from; unit < to; ++unit) {
      const glm::vec4& top = texel_at(image_, unit);
      if (is_compact(image_) ? same_bits(top, end_texel(image_))
                             : is_zero_bits(top) && (is_zero_bits(texel_at(image_, unit, 1)) ||
                                                     same_bits(texel_at(image_, unit, 1), end_texel(image_))))
        continue;
      e_.recorder.add(Rule::unreached, unit_texel(image_, unit), kNone,
                      "no region that is reached holds unit " + std::to_string(unit));
    }
  }

  /// Depth first through the regions; a region that is met while it is on the way stands within itself.
  void order_inner_first() {
    enum State : std::uint8_t { kNew, kOnTheWay, kDone };
    std::vector<State> state(e_.regions.size(), kNew);
    std::vector<std::vector<std::uint32_t>> leads(e_.regions.size());  // records of the leaves in each region
    for (std::uint32_t n = 0; n < image_.transform_count; ++n)
      if (e_.leaves[n].node != kNone && e_.behind[n] != kNone) leads[e_.leaves[n].region].push_back(n);
    struct Place {
      std::uint32_t region;
      std::size_t next;
    };
    std::vector<Place> way{{0, 0}};
    state[0] = kOnTheWay;
    bool has_circle = false;
    while (!way.empty()) {
      Place& place = way.back();
      if (place.next == leads[place.region].size()) {
        state[place.region] = kDone;
        e_.inner_first.push_back(place.region);
        way.pop_back();
        continue;
      }
      const std::uint32_t n = leads[place.region][place.next++], q = e_.behind[n];
      if (state[q] == kOnTheWay) {
        has_circle = true;
        e_.recorder.add(Rule::cycle, transform_texel(image_, n, 4), n,
                        "record " + std::to_string(n) + " leads to a space that it stands in itself");
      } else if (state[q] == kNew) {
        state[q] = kOnTheWay;
        way.push_back({q, 0});
      }
    }
    if (has_circle) e_.inner_first.clear();
  }

  void count_longest_walk() {
    Certificate& certificate = e_.certificate;
    certificate.regions = e_.regions.size();
    certificate.transforms = image_.transform_count, certificate.primitives = image_.primitive_count;
    std::vector<std::uint64_t> steps(e_.regions.size(), 0);
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    for (const std::uint32_t r : e_.inner_first) {
      const CopyView& copy = e_.regions[r].copies[0];
      steps[r] = std::max<std::uint64_t>(copy.nodes.size() + (is_compact(image_) ? 1 : 0), 1);
      for (const NodeView& node : copy.nodes)
        if (const std::uint32_t n = transform_of(node); n != kNone && e_.behind[n] != kNone)
          steps[r] = std::min(steps[r] + steps[e_.behind[n]], kMost);
    }
    for (const RegionView& region : e_.regions) {
      const std::vector<std::uint32_t> parent = parents_of(region.copies[0]);
      std::vector<std::size_t> depth(parent.size(), 1);
      for (std::size_t i = 0; i < parent.size(); ++i) {
        if (parent[i] != kNone) depth[i] = depth[parent[i]] + 1;
        certificate.depth = std::max(certificate.depth, depth[i]);
        certificate.leaves += region.copies[0].nodes[i].is_leaf;
      }
      certificate.nodes += parent.size();
    }
    certificate.longest_walk = steps[0];
    if (!e_.inner_first.empty() && image_.cell_count != steps[0])
      e_.recorder.add(Rule::metadata, "the longest walk is said to visit " + std::to_string(image_.cell_count) +
                                          " nodes, but it visits " + std::to_string(steps[0]));
  }

  Examination& e_;
  const GeometryImage& image_;
  std::vector<Claim> claims_;
  std::vector<bool> reached_;
  std::set<std::uint32_t> noted_;
};

}  // namespace

void check_links(Examination& e) { RegionReader(e).read(); }

}  // namespace plumbline
