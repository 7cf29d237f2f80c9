// SPDX-License-Identifier: MIT
// The links of one copy of a region: where each of them lands, and what walks follow where some land wrongly.
//
// Nodes stand depth first, so the way in is the next node, and a way out must lead forward, no farther than the way out
// of the node around it. Where all links do, a walk that enters everything visits each node once, one that enters
// nothing ends, no walk is longer than the copy, and what a way out skips is what stands below the node.
#include <algorithm>

#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

/// Where a link leads within a copy of n nodes: a node's number, n for the end, kNone for neither.
struct Ways {
  std::vector<std::uint32_t> in, out;
};

class CopyReader {
 public:
  CopyReader(const GeometryImage& image, std::uint32_t start, std::uint32_t count, Recorder& recorder)
      : image_(image), start_(start), count_(count), recorder_(recorder) {
    copy_.start = start;
    copy_.nodes.resize(count);
    ways_.in.resize(count), ways_.out.resize(count);
  }

  CopyView read() {
    const std::uint64_t before = recorder_.count();
    for (std::uint32_t i = 0; i < count_; ++i) is_compact(image_) ? read_compact(i) : read_paper(i);
    if (is_compact(image_))
      check_end();
    else if (count_ == 1 && ways_.in[0] == count_ && ways_.out[0] == count_)
      count_ = 0, copy_.nodes.clear();  // an empty region
    nest();
    if (recorder_.count() != before) follow_walks();
    return std::move(copy_);
  }

 private:
  std::size_t texel_of(std::uint32_t i) const { return unit_texel(image_, start_ + i * node_units(image_)); }
  void find(Rule rule, std::uint32_t i, const std::string& message) {
    recorder_.add(rule, texel_of(i), i, "node " + std::to_string(i) + ": " + message);
  }

  /// Notes where the way out of node i leads.
  void set_out(std::uint32_t i, std::uint32_t target) {
    ways_.out[i] = target;
    if (target == kNone) return;
    if (target <= i)
      find(Rule::cycle, i, "the way out leads back to node " + std::to_string(target));
    else if (copy_.nodes[i].is_leaf && target != i + 1)
      find(target == count_ ? Rule::chain_end : Rule::link_target, i,
           "the way on from this leaf leads to " + named(target) + ", not to the next");
    else if (!copy_.nodes[i].is_leaf && target == i + 1)
      find(Rule::link_target, i, "the way out is the way in: nothing stands below this inner node");
  }
  std::string named(std::uint32_t target) const {
    return target == count_ ? "the end" : "node " + std::to_string(target);
  }

  bool is_leaf_payload(std::uint32_t payload) const {
    return payload < image_.primitive_count + image_.transform_count;
  }

  void read_compact(std::uint32_t i) {
    NodeView& node = copy_.nodes[i];
    const std::uint32_t word = std::bit_cast<std::uint32_t>(image_.texels[texel_of(i)].w);
    const std::uint32_t mask = (1u << image_.payload_bits) - 1u, payload = word & mask;
    node.is_leaf = word >> 31 != 0;
    ways_.in[i] = i + 1;
    if (word == kEndWord) {
      ways_.in[i] = ways_.out[i] = count_;
      return find(Rule::chain_end, i,
                  "an end stands before the last of the copy's " + std::to_string(count_) + " nodes");
    }
    if (has_boxes(image_) && (word & 0x7fffffffu & ~mask) != (kWordBase & ~mask))
      find(Rule::word, i, "the word has bits that are neither payload nor leaf");
    if (node.is_leaf) {
      if (is_leaf_payload(payload))
        node.payload = payload;
      else
        find(Rule::link_target, i,
             "the leaf's payload " + std::to_string(payload) + " is no primitive and no transform");
      return set_out(i, i + 1);
    }
    const std::uint32_t distance = payload / node_units(image_);
    if (payload % node_units(image_) != 0) {
      ways_.out[i] = kNone;
      return find(Rule::link_target, i,
                  "the way out leads by " + std::to_string(payload) + " texels into the middle of a node");
    }
    if (payload > (count_ - i) * node_units(image_)) {
      ways_.out[i] = kNone;
      return find(Rule::link_target, i, "the way out leads by " + std::to_string(payload) + " texels out of the copy");
    }
    set_out(i, i + distance);
  }

  void check_end() {
    const std::size_t at = texel_of(count_);
    if (std::bit_cast<std::uint32_t>(image_.texels[at].w) != kEndWord)
      recorder_.add(Rule::no_end, at, kNone, "no end stands behind the copy's " + std::to_string(count_) + " nodes");
  }

  struct Target {
    int kind = 1;  ///< above 0: no legal link
    std::uint64_t cell = 0;
  };
  /// What a link leads to; only the exact centre of a cell's upper texel is legal.
  Target target_of(glm::vec2 link) const {
    const double kind = std::floor(link.x), width = image_.width, height = image_.height;
    if (!(kind >= kLinkEnd && kind <= 0.0)) return {};
    const double x = (link.x - kind) * width - 0.5, y = (link.y * height - 0.5) / 2.0;
    if (!(x >= 0.0 && x < width && y >= 0.0 && y < height / 2.0) || x != std::floor(x) || y != std::floor(y)) return {};
    return {static_cast<int>(kind),
            static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image_.width) + static_cast<std::uint64_t>(x)};
  }
  /// The node of this copy that stands at a cell.
  std::uint32_t node_at(std::uint64_t cell) const {
    const std::uint64_t units = node_units(image_);
    if (cell < start_ || (cell - start_) % units != 0 || (cell - start_) / units >= count_) return kNone;
    return static_cast<std::uint32_t>((cell - start_) / units);
  }

  void read_paper(std::uint32_t i) {
    const glm::vec4 links = texel_at(image_, start_ + i * node_units(image_), 1);
    read_way_in(i, target_of({links.x, links.y}));
    const Target out = target_of({links.z, links.w});
    ways_.out[i] = kNone;
    if (out.kind == kLinkEnd) {
      if (out.cell != 0) find(Rule::chain_end, i, "the way out ends in a cell of its own, not in cell 0");
      return set_out(i, count_);
    }
    if (out.kind != 0) return find(Rule::link_target, i, "the way out leads to no node: " + told(links.z, links.w));
    if (const std::uint32_t node = node_at(out.cell); node != kNone) return set_out(i, node);
    if (out.cell == start_ + std::uint64_t{count_} * node_units(image_))
      return find(Rule::chain_end, i, "the way out leads to what follows the copy, where the chain should have ended");
    find(Rule::link_target, i, "the way out leads out of the copy: " + told(links.z, links.w));
  }

  static std::string told(float x, float y) { return "(" + shown(x) + ", " + shown(y) + ")"; }

  void read_way_in(std::uint32_t i, const Target& in) {
    NodeView& node = copy_.nodes[i];
    node.is_leaf = in.kind != 0;
    ways_.in[i] = kNone;
    if (in.kind == 0) {
      ways_.in[i] = node_at(in.cell);
      if (ways_.in[i] == kNone)
        find(Rule::link_target, i, "the way in leads out of the copy");
      else if (ways_.in[i] <= i)
        find(Rule::cycle, i, "the way in leads back to node " + std::to_string(ways_.in[i]));
      else if (ways_.in[i] != i + 1)
        find(Rule::link_target, i, "the way in leads to node " + std::to_string(ways_.in[i]) + ", not to the next");
      return;
    }
    if (in.kind == kLinkEnd) {
      ways_.in[i] = count_;
      if (count_ > 1) find(Rule::chain_end, i, "the way in ends the walk");
      return;
    }
    const bool is_transform = in.kind == kLinkTransform;
    const std::uint64_t base = is_transform ? image_.transform_start : image_.primitive_start;
    const std::uint64_t size = is_transform ? record_units(image_) : image_.primitive_stride;
    const std::uint64_t count = is_transform ? image_.transform_count : image_.primitive_count;
    if (in.kind > 0 || in.cell < base || (in.cell - base) % size != 0 || (in.cell - base) / size >= count)
      return find(
          Rule::link_target, i,
          in.kind > 0 ? "the way in is not the centre of a cell" : "the way in leads to no primitive and no transform");
    const auto number = static_cast<std::uint32_t>((in.cell - base) / size);
    if (!is_transform && stored_primitive(image_, number).is_triangle != (in.kind == kLinkTriangle))
      return find(Rule::link_target, i, "the way in leads to a primitive of another kind than it says");
    node.payload = is_transform ? image_.primitive_count + number : number;
  }

  /// Makes `end` of the ways out: within the node around.
  void nest() {
    std::vector<std::uint32_t> around{count_};
    for (std::uint32_t i = 0; i < count_; ++i) {
      while (around.back() <= i) around.pop_back();
      NodeView& node = copy_.nodes[i];
      node.end = i + 1;
      if (node.is_leaf) continue;
      const std::uint32_t out = ways_.out[i];
      if (out == kNone || out <= i) continue;
      if (out > around.back())
        find(out == count_ ? Rule::chain_end : Rule::link_target, i,
             "the way out leads to " + named(out) + ", past " + named(around.back()) +
                 ", to which the node around it leads");
      node.end = std::min(out, around.back());
      around.push_back(node.end);
    }
  }

  /// What comes of broken links.
  void follow_walks() {
    if (count_ == 0) return;
    std::vector<std::uint8_t> seen(count_, 0);
    std::uint32_t at = 0, last = 0;
    for (; at < count_ && seen[at] == 0; last = at, at = copy_.nodes[last].is_leaf ? ways_.out[last] : ways_.in[last])
      seen[at] = 1;
    if (at < count_) {
      find(Rule::visited_twice, at, "a walk that enters everything comes back to it from node " + std::to_string(last));
    } else if (at != count_) {
      find(Rule::no_end, last, "a walk that enters everything leaves the copy here");
    }
    for (std::uint32_t i = 0; i < count_; ++i)
      if (seen[i] == 0) find(Rule::unreached, i, "no walk that enters everything comes here");
    std::uint32_t steps = 0;
    for (at = 0; at < count_ && steps < count_; ++steps) last = at, at = ways_.out[at];
    if (at != count_) find(Rule::no_end, last, "a walk that enters nothing does not end");
  }

  const GeometryImage& image_;
  const std::uint32_t start_;
  std::uint32_t count_;
  Recorder& recorder_;
  CopyView copy_;
  Ways ways_;
};

}  // namespace

std::vector<std::uint32_t> parents_of(const CopyView& copy) {
  std::vector<std::uint32_t> parents(copy.nodes.size(), kNone), around;
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    while (!around.empty() && copy.nodes[around.back()].end <= i) around.pop_back();
    if (!around.empty()) parents[i] = around.back();
    if (copy.nodes[i].end > i + 1) around.push_back(i);
  }
  return parents;
}

CopyView read_copy(const GeometryImage& image, std::uint32_t start, std::uint32_t copy_size, Recorder& recorder) {
  const std::uint32_t nodes = (copy_size - (is_compact(image) ? 1 : 0)) / node_units(image);
  return CopyReader(image, start, nodes, recorder).read();
}

}  // namespace plumbline
