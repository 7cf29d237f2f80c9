// SPDX-License-Identifier: MIT
// All copies of a region hold the same tree: the same nodes with the same bounds, whatever the order of children.
#include <algorithm>
#include <map>

#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// Of each node the least payload below it, which no sibling shares.
std::vector<std::uint32_t> least_payloads(const CopyView& copy) {
  std::vector<std::uint32_t> least(copy.nodes.size(), kNone);
  for (auto i = static_cast<std::uint32_t>(copy.nodes.size()); i-- > 0;) {
    least[i] = copy.nodes[i].payload;
    for (std::uint32_t c = i + 1; c < copy.nodes[i].end; c = copy.nodes[c].end) least[i] = std::min(least[i], least[c]);
  }
  return least;
}

/// What stands for each node of the first copy in another; kNone where nothing does. `strays`: nodes of the other copy
/// that stand for none, or have other children than what they stand for.
struct Twins {
  std::vector<std::uint32_t> of;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> strays;  ///< (node here, node of the first copy)
};

/// Where the trees differ, leaves still stand for those that lead to the same.
void match_leaves(const CopyView& first, const CopyView& other, Twins& twins) {
  std::map<std::uint32_t, std::uint32_t> by_payload;
  for (std::uint32_t b = 0; b < other.nodes.size(); ++b)
    if (other.nodes[b].is_leaf && other.nodes[b].payload != kNone) by_payload.emplace(other.nodes[b].payload, b);
  for (std::uint32_t a = 0; a < first.nodes.size(); ++a) {
    if (twins.of[a] != kNone || !first.nodes[a].is_leaf) continue;
    if (const auto found = by_payload.find(first.nodes[a].payload); found != by_payload.end())
      twins.of[a] = found->second;
  }
}

Twins match(const CopyView& first, const std::vector<std::uint32_t>& first_least, const CopyView& other) {
  const std::vector<std::uint32_t> other_least = least_payloads(other);
  Twins twins;
  twins.of.assign(first.nodes.size(), kNone);
  std::vector<std::uint32_t> a_children, b_children;
  const auto children = [](const CopyView& copy, std::uint32_t begin, std::uint32_t end,
                           const std::vector<std::uint32_t>& least, std::vector<std::uint32_t>& list) {
    list.clear();
    for (std::uint32_t c = begin; c < end; c = copy.nodes[c].end) list.push_back(c);
    std::sort(list.begin(), list.end(), [&](std::uint32_t p, std::uint32_t q) { return least[p] < least[q]; });
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting{{kNone, kNone}};  // the root's own place comes first
  while (!waiting.empty()) {
    const auto [a, b] = waiting.back();
    waiting.pop_back();
    const auto size_a = static_cast<std::uint32_t>(first.nodes.size());
    const auto size_b = static_cast<std::uint32_t>(other.nodes.size());
    children(first, a == kNone ? 0 : a + 1, a == kNone ? size_a : first.nodes[a].end, first_least, a_children);
    children(other, b == kNone ? 0 : b + 1, b == kNone ? size_b : other.nodes[b].end, other_least, b_children);
    bool is_same = a_children.size() == b_children.size();
    if (a != kNone)
      is_same = is_same && first.nodes[a].is_leaf == other.nodes[b].is_leaf &&
                first.nodes[a].payload == other.nodes[b].payload;
    for (std::size_t i = 0; is_same && i < a_children.size(); ++i)
      is_same = first_least[a_children[i]] == other_least[b_children[i]];
    if (!is_same) {
      twins.strays.emplace_back(b == kNone ? 0 : b, a == kNone ? 0 : a);
      // A leaf and what is none have nothing to compare; the leaf may stand elsewhere.
      if (a != kNone && first.nodes[a].is_leaf != other.nodes[b].is_leaf) twins.of[a] = kNone;
      continue;
    }
    for (std::size_t i = 0; i < a_children.size(); ++i) {
      twins.of[a_children[i]] = b_children[i];
      waiting.emplace_back(a_children[i], b_children[i]);
    }
  }
  if (!twins.strays.empty()) match_leaves(first, other, twins);
  return twins;
}

class RegionCopies {
 public:
  RegionCopies(Examination& e, RegionView& region, Recorder& recorder) : e_(e), region_(region), recorder_(recorder) {}

  void check() {
    const std::vector<std::uint32_t> least = least_payloads(region_.copies[0]);
    twins_.resize(region_.copies.size());
    twins_[0].of.resize(region_.copies[0].nodes.size());
    for (std::uint32_t i = 0; i < twins_[0].of.size(); ++i) twins_[0].of[i] = i;
    for (std::size_t c = 1; c < region_.copies.size(); ++c)
      twins_[c] = match(region_.copies[0], least, region_.copies[c]);
    report_strays();
    for (std::uint32_t a = 0; a < twins_[0].of.size(); ++a) compare_bounds(a);
  }

 private:
  void find(std::size_t copy, std::uint32_t node, const std::string& message) {
    region_.copies_agree = false;
    if (region_.copies[copy].nodes.empty()) node = kNone;
    const std::size_t texel =
        unit_texel(e_.image, region_.copies[copy].start + (node == kNone ? 0 : node * node_units(e_.image)));
    recorder_.add(Rule::copies, texel, node,
                  "copy " + std::to_string(copy) + ", node " + std::to_string(node) + ": " + message);
  }

  /// Where most copies differ from the first at one node, it is the first that is wrong.
  void report_strays() {
    std::vector<std::uint32_t> places;
    for (const Twins& twins : twins_)
      for (const auto& [here, first] : twins.strays) places.push_back(first);
    std::sort(places.begin(), places.end());
    std::vector<std::uint32_t> wrong_in_first;
    for (std::size_t i = 0; i < places.size();) {
      std::size_t end = i;
      while (end < places.size() && places[end] == places[i]) ++end;
      if (2 * (end - i) > twins_.size()) wrong_in_first.push_back(places[i]);
      i = end;
    }
    for (const std::uint32_t node : wrong_in_first) find(0, node, "the other copies hold other things below it");
    for (std::size_t c = 1; c < twins_.size(); ++c)
      for (const auto& [here, first] : twins_[c].strays)
        if (!std::binary_search(wrong_in_first.begin(), wrong_in_first.end(), first))
          find(c, here, "it holds other things than node " + std::to_string(first) + " of copy 0");
  }

  bool same_bounds(std::size_t c, std::size_t d, std::uint32_t a) const {
    const std::uint32_t units = node_units(e_.image);
    const std::uint64_t p = region_.copies[c].start + twins_[c].of[a] * units;
    const std::uint64_t q = region_.copies[d].start + twins_[d].of[a] * units;
    for (std::uint32_t i = 0; i < units; ++i)
      if (!same_bits(texel_at(e_.image, p + i), texel_at(e_.image, q + i))) return false;
    return true;
  }

  void compare_bounds(std::uint32_t a) {
    bool differs = false;
    for (std::size_t c = 1; c < twins_.size() && !differs; ++c)
      differs = twins_[c].of[a] != kNone && !same_bounds(c, 0, a);
    if (!differs) return;
    // What most copies have is right.
    std::size_t best = 0, best_votes = 0;
    for (std::size_t c = 0; c < twins_.size(); ++c) {
      std::size_t votes = 0;
      for (std::size_t d = 0; d < twins_.size(); ++d)
        votes += twins_[c].of[a] != kNone && twins_[d].of[a] != kNone && same_bounds(c, d, a);
      if (votes > best_votes) best = c, best_votes = votes;
    }
    for (std::size_t c = 0; c < twins_.size(); ++c)
      if (twins_[c].of[a] != kNone && !same_bounds(c, best, a))
        find(c, twins_[c].of[a], "its bounds are not those that it has in copy " + std::to_string(best));
  }

  Examination& e_;
  RegionView& region_;
  Recorder& recorder_;
  std::vector<Twins> twins_;
};

}  // namespace

std::vector<std::uint32_t> twins_of(const CopyView& first, const CopyView& other) {
  return match(first, least_payloads(first), other).of;
}

void check_copies(Examination& e) {
  if (e.image.copy_count < 2) return;
  std::vector<Recorder> found(e.regions.size(), Recorder(e.image));
  for (std::size_t r = 0; r < e.regions.size(); ++r) RegionCopies(e, e.regions[r], found[r]).check();
  for (Recorder& one : found) e.recorder.merge(std::move(one));
}

}  // namespace plumbline
