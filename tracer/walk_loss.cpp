// SPDX-License-Identifier: MIT
// Where a walk lost a primitive: the chain from the world's root to its leaf is followed through the steps, and where
// it ends before its end, the step that ended it is at fault.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "scenes/error.h"
#include "tracer/bake.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"
#include "tracer/walk_analysis.h"

namespace plumbline {
namespace {

/// What is known of the way to a leaf; `loss` where the walk did not get into it.
struct Passage {
  std::vector<Ancestor> chain;
  std::size_t leaf_step = kNoStep;
  std::optional<Loss> loss;
};

class Search {
 public:
  Search(const GeometryImage& image, const Walk& walk, const ExpectedHit& expected, const GeometryImage* sound)
      : image_(image), tree_(sound != nullptr ? *sound : image), walk_(walk), expected_(expected), sound_(sound) {
    astray_ = first_astray();
    for (std::size_t i = 0; i < astray_; ++i) {
      const WalkStep& step = walk.steps[i];
      visits_.emplace(key(step.space, step.cell), i);
      of_space_[step.space].push_back(i);
    }
  }

  Loss find() {
    const bool is_found = walk_.hit.kind == HitKind::hit && walk_.hit.primitive == expected_.primitive &&
                          walk_.hit.instance == expected_.instance;
    std::vector<Ancestor> chain;
    Loss loss = follow(chain);
    if (loss.kind == LossKind::unknown)
      if (const auto wrong = left_elsewhere()) loss = *wrong;
    if (is_found) loss = of_kind(LossKind::none);
    loss.chain = std::move(chain);
    return loss;
  }

 private:
  /// The first step outside of the region that the walk should be in; what follows it means nothing. The number of
  /// steps where there is none.
  std::size_t first_astray() const {
    auto copy = region_copy(tree_, kNone, walk_.start.copy);
    for (std::size_t i = 0; i < walk_.steps.size(); ++i) {
      const WalkStep& step = walk_.steps[i];
      if (!copy || step.cell < copy->begin || step.cell >= copy->end) return i;
      if ((step.cell - copy->begin) % node_units(tree_) != 0) return i;  // the middle of a node
      if (!step.changes.empty()) copy = region_copy(tree_, step.changes.back().space, step.changes.back().copy);
    }
    return walk_.steps.size();
  }

  /// The first transform that was left into another space than the one from which it was entered.
  std::optional<Loss> left_elsewhere() const {
    std::vector<std::uint32_t> spaces{kNone};
    for (std::size_t i = 0; i < walk_.steps.size(); ++i) {
      for (const SpaceChange& change : walk_.steps[i].changes) {
        if (change.kind == SpaceChange::Kind::entered || change.kind == SpaceChange::Kind::missed)
          spaces.push_back(change.node);
        if (change.kind != SpaceChange::Kind::left) continue;
        const bool is_inner = spaces.size() > 1 && spaces.back() == change.node;
        if (!is_inner || change.space != spaces[spaces.size() - 2])
          return at_transform(LossKind::way_out, i, change.node);
        spaces.pop_back();
      }
    }
    return std::nullopt;
  }

  static std::uint64_t key(std::uint32_t space, std::uint32_t cell) { return std::uint64_t{space} << 32 | cell; }

  /// From space to space and down the trees, as far as the walk came.
  Loss follow(std::vector<Ancestor>& chain) {
    const auto path = transforms_to(tree_, expected_.instance);
    if (!path) return of_kind(LossKind::absent);
    std::uint32_t space = kNone;
    std::uint32_t walked = walk_.start.copy;
    for (std::size_t level = 0;; ++level) {
      path_.assign(path->begin(), path->begin() + static_cast<std::ptrdiff_t>(level));
      const auto copy = region_copy(tree_, space, walked);
      if (!copy) return of_kind(LossKind::absent);
      if (level == path->size()) {
        const auto leaves = leaves_of_primitive(tree_, *copy, expected_.primitive);
        if (leaves.empty()) return of_kind(LossKind::absent);
        Passage best = best_of(space, *copy, leaves);
        chain.insert(chain.end(), best.chain.begin(), best.chain.end());
        return std::move(*best.loss);
      }
      const std::uint32_t node = (*path)[level];
      const auto leaves = leaves_of_transform(tree_, *copy, node);
      if (leaves.empty()) return of_kind(LossKind::absent);
      Passage way = passage(space, *copy, leaves.front());
      way.chain.back().transform = node;
      chain.insert(chain.end(), way.chain.begin(), way.chain.end());
      if (way.loss) return std::move(*way.loss);
      const SpaceChange* entered = change_at(way.leaf_step, SpaceChange::Kind::entered, node);
      if (entered == nullptr) return not_entered(way.leaf_step, node);
      space = node;
      walked = entered->copy;
    }
  }

  Loss of_kind(LossKind kind) const {
    Loss loss;
    loss.kind = kind;
    return loss;
  }
  /// A loss at a step.
  Loss at_step(LossKind kind, std::size_t step) const {
    const WalkStep& s = walk_.steps[step];
    Loss loss;
    loss.kind = kind;
    loss.step = step;
    loss.space = s.space, loss.cell = s.cell, loss.node = s.node, loss.x = s.x, loss.y = s.y;
    return loss;
  }
  Loss at_transform(LossKind kind, std::size_t step, std::uint32_t node) const {
    Loss loss = at_step(kind, step);
    loss.transform = node;
    if (sound_ != nullptr) loss.as_baked = same_record(node, 0, kTransformTexels);
    return loss;
  }

  bool same_record(std::uint32_t node, std::uint32_t first, std::uint32_t end) const {
    if (sound_ == nullptr || node >= image_.transform_count) return false;
    for (std::uint32_t i = first; i < end; ++i)
      if (!same_bits(record_texel(image_, node, i), record_texel(*sound_, node, i))) return false;
    return true;
  }

  /// The change at a step, or at the same leaf visited again.
  const SpaceChange* change_at(std::size_t step, SpaceChange::Kind kind, std::uint32_t node) const {
    for (std::size_t i = step; i < walk_.steps.size() && (i == step || walk_.steps[i].again); ++i)
      for (const SpaceChange& change : walk_.steps[i].changes)
        if (change.kind == kind && (node == kNone || change.node == node)) return &change;
    return nullptr;
  }

  /// Down the chain of a leaf.
  Passage passage(std::uint32_t space, const RegionCopy& copy, std::uint32_t leaf) const {
    Passage result;
    const std::vector<std::uint32_t> cells = chain_to(tree_, copy, leaf);
    for (const std::uint32_t cell : cells) {
      Ancestor ancestor;
      ancestor.space = space;
      ancestor.cell = cell;
      const auto texel = static_cast<std::uint32_t>(unit_texel(tree_, cell));
      ancestor.x = static_cast<int>(texel % static_cast<std::uint32_t>(tree_.width));
      ancestor.y = static_cast<int>(texel / static_cast<std::uint32_t>(tree_.width));
      ancestor.node = (cell - copy.begin) / node_units(tree_);
      const auto visit = visits_.find(key(space, cell));
      if (visit != visits_.end()) ancestor.step = visit->second;
      result.chain.push_back(ancestor);
    }
    for (const Ancestor& ancestor : result.chain) {
      if (ancestor.step == kNoStep) {
        result.loss = unreached(space, copy, ancestor);
        return result;
      }
      const WalkStep& step = walk_.steps[ancestor.step];
      if (step.test == NodeTest::hit) continue;
      result.loss = rejected(copy, result.chain, ancestor);
      return result;
    }
    result.leaf_step = result.chain.back().step;
    return result;
  }

  /// The leaf that is to blame, of all that hold the primitive.
  Passage best_of(std::uint32_t space, const RegionCopy& copy, const std::vector<std::uint32_t>& leaves) const {
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t leaf : leaves)
      if (holds_point(leaf)) candidates.push_back(leaf);
    if (candidates.empty()) candidates = leaves;
    std::optional<Passage> best;
    for (const std::uint32_t leaf : candidates) {
      Passage one = passage(space, copy, leaf);
      if (!one.loss) one.loss = in_leaf(one.leaf_step);
      // What got farther counts before what did not; of two volumes, the one that lacks less.
      const auto rank = [](const Passage& p) { return std::pair(p.loss->kind == LossKind::bounds, p.loss->shortfall); };
      if (!best || rank(one) < rank(*best)) best = std::move(one);
    }
    return std::move(*best);
  }

  /// Whether the volume of a leaf holds the point that is hit; true where that is not known.
  bool holds_point(std::uint32_t leaf) const {
    if (std::isnan(expected_.t)) return true;
    const double unit = std::ldexp(1.0, tree_.scale_exponent);
    glm::dvec3 p = (glm::dvec3(walk_.ray.origin) + expected_.t * glm::dvec3(walk_.ray.direction)) * unit;
    for (const std::uint32_t node : path_) {
      const glm::dvec4 rows[3] = {record_texel(tree_, node, 0), record_texel(tree_, node, 1),
                                  record_texel(tree_, node, 2)};
      const glm::dvec3 m = p - glm::dvec3(rows[0].w, rows[1].w, rows[2].w);
      p = {glm::dot(glm::dvec3(rows[0]), m), glm::dot(glm::dvec3(rows[1]), m), glm::dot(glm::dvec3(rows[2]), m)};
    }
    const Volume volume = volume_at(tree_, leaf);
    if (!volume.is_box) {
      const glm::dvec3 m = p - glm::dvec3(volume.center);
      return glm::dot(m, m) <= volume.radius2;
    }
    bool inside = true;
    for (int a = 0; a < 3; ++a) inside = inside && p[a] >= volume.lower[a] && p[a] <= volume.upper[a];
    return inside;
  }

  /// A node that the walk visited and did not enter.
  Loss rejected(const RegionCopy& copy, const std::vector<Ancestor>& chain, const Ancestor& ancestor) const {
    const WalkStep& step = walk_.steps[ancestor.step];
    if (step.test == NodeTest::beyond && !ended_behind(ancestor)) return at_step(LossKind::nearer, ancestor.step);
    if (step.test == NodeTest::end) {
      Loss loss = at_step(LossKind::link, ancestor.step);
      loss.expected_cell = ancestor.cell;
      if (sound_ != nullptr) loss.as_baked = false;
      return loss;
    }
    Loss loss = at_step(LossKind::bounds, ancestor.step);
    if (has_boxes(image_)) {
      loss.shortfall = static_cast<double>(step.enter) - static_cast<double>(step.leave);
    } else {
      loss.distance = std::sqrt(static_cast<double>(step.distance2));
      loss.radius = std::sqrt(static_cast<double>(step.radius2));
      loss.shortfall = loss.distance - loss.radius;
      loss.world_shortfall = loss.shortfall * scale_to_world(tree_, path_);
    }
    if (sound_ != nullptr) {
      loss.as_baked = same_volume(step.cell);
      if (*loss.as_baked) return blame_transform(std::move(loss));
      return loss;
    }
    // Nodes nest: one that ends behind what it stands in has a wrong link, and what it rejected need not be below it.
    std::uint32_t end = copy.end;
    for (const Ancestor& above : chain) {
      const NodeCell node = node_cell(image_, above.cell);
      if (above.cell == ancestor.cell) {
        if (node.is_leaf || node.out == kNone || node.out <= end) break;
        Loss link = at_step(LossKind::link, ancestor.step);
        link.reached_cell = node.out;
        return link;
      }
      if (node.out != kNone) end = std::min(end, node.out);
    }
    return blame_transform(std::move(loss));
  }

  /// Whether the walk ended in a hit behind the one that was expected, so that no hit it had found before can hide the
  /// node above that one. The nearest hit only comes nearer, and by bake.h (1) the shader has the expected primitive at
  /// most kPadEdge L + kPadRadius R behind its place, its longest edge L being no longer than the node is wide. t comes
  /// to the world by three roundings.
  bool ended_behind(const Ancestor& above) const {
    if (walk_.hit.kind != HitKind::hit) return false;
    const Volume volume = volume_at(tree_, above.cell);
    const double wide = volume.is_box ? glm::length(glm::dvec3(volume.upper) - glm::dvec3(volume.lower))
                                      : 2.0 * std::sqrt(static_cast<double>(volume.radius2));
    double radius = tree_.radius;
    glm::dvec3 d = glm::dvec3(walk_.ray.direction) * std::ldexp(1.0, tree_.scale_exponent);
    for (const std::uint32_t node : path_) {
      glm::dmat3 rows;
      for (int i = 0; i < 3; ++i) rows[i] = glm::dvec3(record_texel(tree_, node, static_cast<std::uint32_t>(i)));
      d = d * rows;  // by the transpose of what holds the rows as columns
      radius = record_texel(tree_, node, 6).w;
    }
    const double t = walk_.hit.t, allowed = (kPadEdge * wide + kPadRadius * radius) / glm::length(d);
    return t * (1.0 - 3.0 * 0x1p-24) > expected_.t + allowed;
  }

  bool same_volume(std::uint32_t cell) const {
    if (cell >= unit_count(image_)) return false;
    const std::uint32_t mask = is_compact(image_) ? (1u << image_.payload_bits) - 1u : 0u;
    const auto same = [&](std::uint32_t unit, bool has_word) {
      auto a = std::bit_cast<std::array<std::uint32_t, 4>>(texel_at(image_, unit));
      auto b = std::bit_cast<std::array<std::uint32_t, 4>>(texel_at(*sound_, unit));
      if (has_word) a[3] &= ~mask, b[3] &= ~mask;
      return a == b;
    };
    return same(cell, true) && (!has_boxes(image_) || same(cell + 1, false));
  }

  /// A volume or a primitive as it should be rejects what it should not: then the ray is wrong, perhaps since a
  /// transform above took it elsewhere.
  Loss blame_transform(Loss loss) const {
    for (const std::uint32_t node : path_) {
      const bool sound =
          sound_ != nullptr ? same_record(node, 0, 3) && same_record(node, 6, 7) : inverse_fits(image_, node);
      if (sound) continue;
      loss.kind = LossKind::way_in;
      loss.transform = node;
      if (sound_ != nullptr) loss.as_baked = false;
      break;
    }
    return loss;
  }

  /// The cell where the walk should go on behind a step, in its own space; kNone: an end.
  std::uint32_t next_expected(const WalkStep& step) const {
    const NodeCell node = node_cell(tree_, step.cell);
    if (node.is_end) return kNone;
    return step.test == NodeTest::hit && !node.is_leaf ? node.in : node.out;
  }

  /// A node that the walk never visited, though it was in the node above.
  Loss unreached(std::uint32_t space, const RegionCopy& copy, const Ancestor& ancestor) const {
    if (astray_ < walk_.steps.size() && walk_.steps[astray_].space == space && !of_space_.contains(space))
      return space == kNone ? at_step(LossKind::link, astray_) : at_transform(LossKind::way_in, astray_, space);
    Loss loss = first_wrong_way(space, copy, ancestor.cell);
    return loss.kind == LossKind::unknown && walk_.hit.kind == HitKind::capped ? capped() : loss;
  }

  /// A walk that does not end, without regard to the primitive.
  Loss capped() const {
    Loss loss = of_kind(LossKind::unknown);
    if (const auto copy = region_copy(tree_, kNone, walk_.start.copy)) loss = first_wrong_way(kNone, *copy, kNone);
    if (loss.kind == LossKind::unknown) loss.kind = LossKind::capped;
    return loss;
  }

  /// Among the ways that the walk took within a space, the first that is wrong and leads past `target`; else the first
  /// that is wrong.
  Loss first_wrong_way(std::uint32_t space, const RegionCopy& copy, std::uint32_t target) const {
    const auto list = of_space_.find(space);
    if (list == of_space_.end()) return of_kind(LossKind::unknown);
    const std::vector<std::size_t>& steps = list->second;
    if (const std::uint32_t first = walk_.steps[steps[0]].cell; first != copy.begin) {
      Loss loss = space == kNone ? at_step(LossKind::link, steps[0]) : at_transform(LossKind::way_in, steps[0], space);
      loss.expected_cell = copy.begin;
      loss.reached_cell = first;
      return loss;
    }
    std::optional<Loss> wrong;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const WalkStep& step = walk_.steps[steps[i]];
      const WalkStep* next = i + 1 < steps.size() ? &walk_.steps[steps[i + 1]] : nullptr;
      if (next != nullptr && next->again) continue;
      // Where the last step of all led is known if the walk ended there.
      if (next == nullptr && steps[i] + 1 == walk_.steps.size() && !step.ended) continue;
      const bool is_astray = next == nullptr && astray_ < walk_.steps.size() && walk_.steps[astray_].space == space;
      const std::uint32_t reached = next != nullptr ? next->cell : is_astray ? walk_.steps[astray_].cell : kNone;
      const std::uint32_t expected = next_expected(step);
      const bool is_last = step.cell + node_units(tree_) >= copy.end || is_astray;
      const bool lacks_end = is_compact(image_) && is_last && !is_astray && step.test != NodeTest::end;
      // All above the target was entered, so that no other node may lead past it; nor may a link lead back.
      const bool leads_past = target != kNone && step.cell < target && (reached == kNone || reached > target);
      const bool is_legal = reached == kNone || reached > step.cell;
      const SpaceChange* entered = change_at(steps[i], SpaceChange::Kind::entered, kNone);
      const bool never_left = entered != nullptr && !has_left(steps[i], entered->node);
      if (reached == expected && is_legal && !lacks_end && !leads_past && !is_astray && !never_left) continue;
      Loss loss = wrong_way(steps[i], expected, reached, is_last);
      if (leads_past || !is_legal) return loss;
      if (!wrong) wrong = std::move(loss);
    }
    return wrong ? *wrong : of_kind(LossKind::unknown);
  }

  /// A step that led to `reached` and not to `expected`.
  Loss wrong_way(std::size_t index, std::uint32_t expected, std::uint32_t reached, bool is_last) const {
    const WalkStep& step = walk_.steps[index];
    Loss loss;
    if (const SpaceChange* entered = change_at(index, SpaceChange::Kind::entered, kNone)) {
      const std::uint32_t inner = entered->node;
      if (!has_left(index, inner)) {
        if (index + 1 == astray_) return at_transform(LossKind::way_in, index, inner);
        const auto behind = region_copy(tree_, inner, entered->copy);
        return behind ? first_wrong_way(inner, *behind, kNone) : at_transform(LossKind::way_in, index, inner);
      }
      loss = at_transform(LossKind::way_out, index, inner);
    } else if (step.space != kNone && (is_last || expected == kNone)) {
      loss = at_transform(LossKind::way_out, index, step.space);  // here the region behind the transform should end
    } else {
      loss = at_step(LossKind::link, index);
      loss.as_baked = as_baked_link(step.cell);
    }
    loss.expected_cell = expected != reached ? expected : kNone;  // the image itself does not tell
    loss.reached_cell = reached;
    return loss;
  }

  std::optional<bool> as_baked_link(std::uint32_t cell) const {
    if (sound_ == nullptr) return std::nullopt;
    const NodeCell a = node_cell(image_, cell), b = node_cell(*sound_, cell);
    return a.is_end == b.is_end && a.is_leaf == b.is_leaf && a.in == b.in && a.out == b.out && a.cluster == b.cluster &&
           a.transform == b.transform;
  }

  bool has_left(std::size_t after, std::uint32_t node) const {
    for (std::size_t i = after; i < astray_; ++i)
      for (const SpaceChange& change : walk_.steps[i].changes)
        if (change.kind == SpaceChange::Kind::left && change.node == node) return true;
    return false;
  }

  /// A transform's leaf was hit, and the walk did not go in.
  Loss not_entered(std::size_t step, std::uint32_t node) const {
    if (change_at(step, SpaceChange::Kind::missed, node) != nullptr) {
      Loss loss = at_transform(LossKind::way_in, step, node);
      if (sound_ != nullptr) loss.as_baked = same_record(node, 0, 3) && same_record(node, 6, 7);
      return loss;
    }
    const WalkStep& s = walk_.steps[step];
    const bool leads_elsewhere = change_at(step, SpaceChange::Kind::entered, kNone) != nullptr ||
                                 change_at(step, SpaceChange::Kind::missed, kNone) != nullptr || !s.primitives.empty();
    if (!leads_elsewhere && walk_.hit.kind == HitKind::capped) return capped();
    Loss loss = at_step(LossKind::link, step);
    loss.as_baked = as_baked_link(s.cell);
    loss.transform = node;
    return loss;
  }

  /// The leaf was entered.
  Loss in_leaf(std::size_t step) const {
    const TestedPrimitive* tested = nullptr;
    for (std::size_t i = step; i < walk_.steps.size() && (i == step || walk_.steps[i].again); ++i)
      for (const TestedPrimitive& one : walk_.steps[i].primitives)
        if (one.primitive == expected_.primitive) tested = &one;
    if (tested == nullptr) {
      Loss loss = at_step(LossKind::leaf, step);
      if (sound_ != nullptr) loss.as_baked = as_baked_link(walk_.steps[step].cell);
      if (loss.as_baked.value_or(false)) {
        loss.stored = wrong_label(walk_.steps[step].cell);
        loss.as_baked = loss.stored == kNone;
      }
      return loss;
    }
    const bool lost = tested->outcome != PrimitiveTest::new_nearest && tested->outcome != PrimitiveTest::farther &&
                      tested->outcome != PrimitiveTest::tie_lost;
    if (!lost && walk_.hit.kind == HitKind::capped) return capped();
    Loss loss = at_step(lost ? LossKind::primitive : LossKind::nearer, step);
    loss.test = *tested;
    if (sound_ != nullptr) {
      loss.as_baked = true;
      const auto a = primitive_texels(image_, tested->k);
      for (const std::size_t texel : a)
        if (!same_bits(image_.texels[texel], sound_->texels[texel])) loss.as_baked = false;
    }
    // What was found at another t than it should be, behind something else, may be a transform's fault, too.
    if (loss.as_baked.value_or(true)) return blame_transform(std::move(loss));
    return loss;
  }

  /// The first stored primitive of a leaf's cluster, as the sound image has it, whose label is another; kNone: none.
  std::uint32_t wrong_label(std::uint32_t cell) const {
    for (std::uint32_t k = node_cell(*sound_, cell).cluster; k < sound_->primitive_count; ++k) {
      const float is = texel_at(image_, primitive_unit(image_, k)).w,
                  should_be = texel_at(*sound_, primitive_unit(*sound_, k)).w;
      if (std::bit_cast<std::uint32_t>(is) != std::bit_cast<std::uint32_t>(should_be)) return k;
      if (!(should_be > 0.0f)) break;
    }
    return kNone;
  }

  const GeometryImage& image_;
  const GeometryImage& tree_;  ///< what tells the structure
  const Walk& walk_;
  const ExpectedHit& expected_;
  const GeometryImage* sound_;
  std::size_t astray_ = 0;
  std::unordered_map<std::uint64_t, std::size_t> visits_;  ///< the first of each cell in each space
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> of_space_;
  std::vector<std::uint32_t> path_;  ///< the transforms that lead into the space at hand
};

void require_same_shape(const GeometryImage& a, const GeometryImage& b) {
  if (a.options.layout != b.options.layout || a.options.bounds != b.options.bounds || a.copy_count != b.copy_count ||
      a.width != b.width || a.height != b.height || a.copy_size != b.copy_size ||
      a.primitive_start != b.primitive_start || a.primitive_stride != b.primitive_stride ||
      a.primitive_count != b.primitive_count || a.transform_start != b.transform_start ||
      a.transform_count != b.transform_count || a.payload_bits != b.payload_bits)
    throw InputError("the geometry image of " + a.scene_name +
                     " can't be explained by one of another shape; bake the same scene with the same options");
}

}  // namespace

Loss lost_at(const GeometryImage& image, const Walk& walk, const ExpectedHit& expected, const GeometryImage* sound) {
  if (sound != nullptr) require_same_shape(image, *sound);
  Loss loss = Search(image, walk, expected, sound).find();
  loss.sentence = describe(loss, image, expected);
  return loss;
}

}  // namespace plumbline
