// SPDX-License-Identifier: MIT
// Building and refitting the trees over transforms.
#include "tracer/scene_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "scenes/error.h"
#include "tracer/bake.h"

namespace plumbline {
namespace {

/// A ball around balls: from the middle of their box a few steps towards the farthest one (Badoiu and Clarkson 2003),
/// the best of which is kept.
Ball fit_ball(std::span<const Ball> balls) {
  if (balls.empty()) return {};
  glm::dvec3 lower(balls[0].center - balls[0].radius), upper(balls[0].center + balls[0].radius);
  for (const Ball& ball : balls) {
    lower = glm::min(lower, ball.center - ball.radius);
    upper = glm::max(upper, ball.center + ball.radius);
  }
  if (balls.size() == 1) return balls[0];
  const auto farthest = [&](const glm::dvec3& from, double& distance) {
    std::size_t index = 0;
    distance = -1.0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const double d = glm::length(balls[i].center - from) + balls[i].radius;
      if (d > distance) distance = d, index = i;
    }
    return index;
  };
  glm::dvec3 center = 0.5 * (lower + upper);
  Ball best{center, 0.0};
  std::size_t far = farthest(center, best.radius);
  constexpr int kSteps = 6;
  for (int step = 0; step < kSteps; ++step) {
    center += (balls[far].center - center) / (step + 3.0);
    double radius = 0.0;
    far = farthest(center, radius);
    if (radius < best.radius) best = {center, radius};
  }
  best.radius *= 1.0 + 0x1p-40;  // the roundings of the distances
  return best;
}

/// What `ball` becomes in the outer space of a transform, rounding included.
Ball carried(const Transform& transform, const Ball& ball) {
  const TransformD t = to_double(transform);
  const glm::dvec3 center = transform_point(t, ball.center);
  const double rounding = 0x1p-48 * (glm::length(t.translation) + largest_stretch(t.linear) * glm::length(ball.center));
  return {center, largest_stretch(t.linear) * ball.radius + rounding};
}

double power_above(double x) {
  if (!(x > 0.0)) return 0.0;
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, exponent);
}

/// A part as a scene of its own, for the builder; primitives keep their order.
Scene scene_of(const Scene& scene, const Part& part) {
  Scene own;
  own.name = scene.name + ", part " + part.name;
  const auto begin = scene.triangles.begin() + part.first_triangle;
  own.triangles.assign(begin, begin + part.triangle_count);
  std::uint32_t first = kNone, last = 0;
  for (const Triangle& triangle : own.triangles)
    for (const std::uint32_t p : triangle.position) first = std::min(first, p), last = std::max(last, p);
  if (first != kNone) own.positions.assign(scene.positions.begin() + first, scene.positions.begin() + last + 1);
  for (Triangle& triangle : own.triangles)
    for (std::uint32_t& p : triangle.position) p -= first;
  const auto spheres = scene.spheres.begin() + part.first_sphere;
  own.spheres.assign(spheres, spheres + part.sphere_count);
  return own;
}

SphereTree build_part(const Scene& scene, const Part& part, const TreeOptions& options, int threads) {
  SphereTree tree = build_sphere_tree(scene_of(scene, part), options, threads);
  const auto triangles = static_cast<std::uint32_t>(scene.triangles.size());
  for (std::uint32_t& p : tree.references)
    p = p < part.triangle_count ? part.first_triangle + p : triangles + part.first_sphere + (p - part.triangle_count);
  return tree;
}

class GroupBuilder {
 public:
  GroupBuilder(const Scene& scene, SceneTree& tree, bool list) : scene_(scene), tree_(tree), list_(list) {}

  /// Innermost first, so that what a node shows is known before its place is.
  void build() {
    const auto count = static_cast<std::uint32_t>(scene_.nodes.size());
    tree_.groups.resize(count + 1);
    tree_.leaf.assign(count, kNone);
    std::vector<std::vector<std::uint32_t>> children(count + 1);
    for (std::uint32_t n = 0; n < count; ++n) children[group_of(scene_, n)].push_back(n);
    for (std::uint32_t g = count + 1; g-- > 0;) build_group(g, children[g]);
  }

 private:
  bool shows_anything(std::uint32_t node) const {
    const std::uint32_t part = scene_.nodes[node].part;
    return part != kNone ? !tree_.parts[part].nodes.empty() : !tree_.groups[node + 1].nodes.empty();
  }

  void build_group(std::uint32_t g, std::vector<std::uint32_t> members) {
    std::erase_if(members, [&](std::uint32_t n) { return !shows_anything(n); });
    if (members.empty()) return;
    std::vector<Ball> at_rest;
    Scene proxies;  // spheres in the places of the nodes at rest; only the order of the tree is taken from them
    proxies.name = scene_.name + ", its transforms";
    for (const std::uint32_t n : members) {
      const Node& node = scene_.nodes[n];
      const Ball& inner = node.part != kNone ? tree_.part_balls[node.part] : tree_.groups[n + 1].content;
      const Ball ball = carried(node.rest, inner);
      if (!(glm::length(ball.center) + ball.radius <= 0x1p126))
        throw InputError("scene " + scene_.name + ": the transform of node " + node.name +
                         " carries its geometry out of what 32 bits hold; scale it down");
      at_rest.push_back(ball);
      proxies.spheres.push_back({glm::vec3(ball.center), std::max(static_cast<float>(ball.radius), 0x1p-126f), 0});
    }
    GroupTree& group = tree_.groups[g];
    group.content = fit_ball(at_rest);  // for the group around it; refitted once everything stands
    if (list_) {
      group.nodes.resize(1);
      add_children(group, 0, static_cast<std::uint32_t>(members.size()));
      group.leaves = members;
      for (std::uint32_t i = 0; i < members.size(); ++i) group.nodes[1 + i].first_leaf = i;
      group.nodes[0].leaf_count = static_cast<std::uint32_t>(members.size());
    } else {
      TreeOptions options;
      options.leaf_size = 1, options.split_long = 0.0f;
      copy_tree(build_sphere_tree(proxies, options), members, group);
    }
    for (std::uint32_t i = 0; i < group.nodes.size(); ++i) {
      const GroupNode& node = group.nodes[i];
      if (node.is_leaf()) tree_.leaf[group.leaves[node.first_leaf]] = i;
      glm::dvec3 sum(0.0);
      for (std::uint32_t k = node.first_leaf; k < node.first_leaf + node.leaf_count; ++k) {
        const auto at = std::lower_bound(members.begin(), members.end(), group.leaves[k]) - members.begin();
        sum += glm::dvec3(proxies.spheres[static_cast<std::size_t>(at)].center);
      }
      group.nodes[i].rest_center = sum / static_cast<double>(node.leaf_count);
    }
  }

  static void add_children(GroupTree& group, std::uint32_t parent, std::uint32_t count) {
    const auto first = static_cast<std::uint32_t>(group.nodes.size());
    group.nodes[parent].first_child = first;
    group.nodes[parent].child_count = count;
    group.nodes.resize(first + count);
    for (std::uint32_t i = first; i < first + count; ++i) group.nodes[i].parent = parent, group.nodes[i].leaf_count = 1;
  }

  static void copy_tree(const SphereTree& from, const std::vector<std::uint32_t>& members, GroupTree& group) {
    group.nodes.resize(from.nodes.size());
    for (const std::uint32_t reference : from.references) group.leaves.push_back(members[reference]);
    for (std::uint32_t i = static_cast<std::uint32_t>(from.nodes.size()); i-- > 0;) {
      const TreeNode& node = from.nodes[i];
      GroupNode& copy = group.nodes[i];
      copy.first_child = node.first_child, copy.child_count = node.child_count;
      copy.first_leaf = node.is_leaf() ? node.first_reference : kNone;
      copy.leaf_count = node.reference_count;
      for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
        group.nodes[c].parent = i;
        copy.first_leaf = std::min(copy.first_leaf, group.nodes[c].first_leaf);
        copy.leaf_count += group.nodes[c].leaf_count;
      }
    }
  }

  const Scene& scene_;
  SceneTree& tree_;
  const bool list_;
};

/// Up to so many leaves a ball is fitted to the leaves, above that to the children's balls: a node that moves must not
/// cost a look at all others.
constexpr std::uint32_t kFitLeaves = 48;

double reach_from(const glm::dvec3& center, const Ball& ball) {
  return glm::length(ball.center - center) + ball.radius;
}

/// The farthest that any leaf below node i reaches from `center`, if that is more than `most`. Branches that cannot are
/// passed over, so the answer is that of looking at all leaves.
double farthest_reach(const GroupTree& group, std::uint32_t i, const glm::dvec3& center, double most) {
  const GroupNode& node = group.nodes[i];
  const double reach = reach_from(center, node.content);
  if (node.is_leaf()) return std::max(most, reach);
  if (!(reach * (1.0 + 0x1p-40) > most)) return most;
  for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c)
    most = farthest_reach(group, c, center, most);
  return most;
}

/// What stands in the group's space: what the tree's leaves show, and in the world its own geometry. It depends on
/// where things are, not on the shape of the tree, since it decides how far rays are moved.
void refit_content(SceneTree& tree, std::uint32_t g) {
  GroupTree& group = tree.groups[g];
  const bool has_world = g == 0 && !tree.world.nodes.empty();
  group.content = has_world ? tree.world_ball : Ball{};
  if (!group.nodes.empty()) {
    glm::dvec3 lower = group.nodes[0].lower, upper = group.nodes[0].upper;
    if (has_world) {
      lower = glm::min(lower, tree.world_ball.center - tree.world_ball.radius);
      upper = glm::max(upper, tree.world_ball.center + tree.world_ball.radius);
    }
    const glm::dvec3 center = 0.5 * (lower + upper);
    const double most = has_world ? reach_from(center, tree.world_ball) : 0.0;
    group.content = {center, farthest_reach(group, 0, center, most) * (1.0 + 0x1p-40)};
  }
  group.extent = power_above(group.content.radius);
}

/// What a ray that enters a part may hit there lies in its root's sphere, padded as the bake pads it.
Ball reach_of_part(const Scene& scene, const SceneTree& tree, std::uint32_t part) {
  const SphereTree& own = tree.parts[part];
  const TreeNode& root = own.nodes[0];
  double longest = 0.0;
  for (const std::uint32_t p : own.references) longest = std::max(longest, longest_edge(scene, p));
  const double radius = tree.part_balls[part].radius * (1.0 + 0x1p-20);  // as the bake rounds it
  return {glm::dvec3(root.center), (root.radius + kPadEdge * longest + kPadRadius * radius) * (1.0 + 0x1p-40)};
}

/// The ball of a leaf: what lies behind the transform, carried into the group's space, and what rounding may do to a
/// ray on its way in (bake.h).
Ball leaf_ball(const Scene& scene, const SceneTree& tree, std::uint32_t g, std::uint32_t n) {
  const Node& node = scene.nodes[n];
  Ball inner;
  if (node.part != kNone) {
    inner = tree.part_reach[node.part];
  } else {
    const GroupTree& below = tree.groups[n + 1];
    inner = {below.nodes[0].center, below.nodes[0].radius + kPadRadius * below.extent};
  }
  Ball ball = carried(node.transform, inner);
  ball.radius += transform_pad(node.transform, ball.center, tree.groups[g].extent);
  return ball;
}

void refit_leaf_content(const Scene& scene, SceneTree& tree, std::uint32_t g, std::uint32_t i) {
  GroupNode& leaf = tree.groups[g].nodes[i];
  const std::uint32_t n = tree.groups[g].leaves[leaf.first_leaf];
  const std::uint32_t part = scene.nodes[n].part;
  leaf.content = carried(scene.nodes[n].transform, part != kNone ? tree.part_balls[part] : tree.groups[n + 1].content);
}

/// The nodes that an inner node's ball is fitted to.
std::vector<std::uint32_t> below(const SceneTree& tree, const GroupTree& group, const GroupNode& node) {
  std::vector<std::uint32_t> nodes;
  if (node.leaf_count > kFitLeaves) {
    for (std::uint32_t c = 0; c < node.child_count; ++c) nodes.push_back(node.first_child + c);
  } else {
    for (std::uint32_t k = 0; k < node.leaf_count; ++k) nodes.push_back(tree.leaf[group.leaves[node.first_leaf + k]]);
  }
  return nodes;
}

void refit_inner_content(SceneTree& tree, std::uint32_t g, std::uint32_t i) {
  GroupTree& group = tree.groups[g];
  std::vector<Ball> balls;
  for (const std::uint32_t n : below(tree, group, group.nodes[i])) balls.push_back(group.nodes[n].content);
  GroupNode& node = group.nodes[i];
  node.content = fit_ball(balls);
  node.lower = group.nodes[node.first_child].lower, node.upper = group.nodes[node.first_child].upper;
  for (std::uint32_t c = node.first_child + 1; c < node.first_child + node.child_count; ++c) {
    node.lower = glm::min(node.lower, group.nodes[c].lower);
    node.upper = glm::max(node.upper, group.nodes[c].upper);
  }
}

/// The padded ball; what lies below must have its own.
void refit_reach(const Scene& scene, SceneTree& tree, std::uint32_t g, std::uint32_t i) {
  GroupTree& group = tree.groups[g];
  GroupNode& node = group.nodes[i];
  Ball ball;
  if (node.is_leaf()) {
    ball = leaf_ball(scene, tree, g, group.leaves[node.first_leaf]);
  } else {
    std::vector<Ball> balls;
    for (const std::uint32_t n : below(tree, group, node))
      balls.push_back({group.nodes[n].center, group.nodes[n].radius});
    ball = fit_ball(balls);
  }
  node.center = ball.center, node.radius = ball.radius;
}

}  // namespace

std::uint32_t group_of(const Scene& scene, std::uint32_t node) {
  const std::uint32_t parent = scene.nodes[node].parent;
  return parent == kNone ? 0 : parent + 1;
}

SceneTree build_scene_tree(const Scene& scene, const TreeOptions& options, bool list_at_root, int threads) {
  SceneTree tree;
  if (scene.parts.empty() && scene.nodes.empty()) {
    tree.world = build_sphere_tree(scene, options, threads);
    tree.world_ball = bounding_ball(scene);
    tree.groups.resize(1);
    return tree;
  }
  std::vector<std::uint32_t> depth(scene.nodes.size(), 1);
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    PLUMBLINE_ASSERT(node.parent == kNone || node.parent < n);
    PLUMBLINE_ASSERT(node.part == kNone || node.part < scene.parts.size());
    if (node.parent != kNone) depth[n] = depth[node.parent] + 1;
    if (depth[n] > kMaxDepth)
      throw InputError("scene " + scene.name + ": node " + node.name + " is nested " + std::to_string(depth[n]) +
                       " deep, but the tracer takes " + std::to_string(kMaxDepth) + "; flatten some of its groups");
    for (const Transform* t : {&node.transform, &node.rest})
      if (const std::string error = transform_error(*t); !error.empty())
        throw InputError("scene " + scene.name + ": the transform of node " + node.name + " " + error);
  }
  const Part world{"world", 0, scene.world_triangle_count(), 0, scene.world_sphere_count()};
  tree.world = build_part(scene, world, options, threads);
  tree.world_ball = bounding_ball(scene, world);
  std::vector<bool> is_placed(scene.parts.size(), false);
  for (const Node& node : scene.nodes)
    if (node.part != kNone) is_placed[node.part] = true;
  for (std::size_t p = 0; p < scene.parts.size(); ++p) {
    const Part& part = scene.parts[p];
    tree.parts.push_back(is_placed[p] ? build_part(scene, part, options, threads) : SphereTree{});
    tree.part_balls.push_back(bounding_ball(scene, part));
  }
  GroupBuilder(scene, tree, list_at_root).build();
  for (std::uint32_t p = 0; p < scene.parts.size(); ++p)
    tree.part_reach.push_back(tree.parts[p].nodes.empty() ? Ball{} : reach_of_part(scene, tree, p));
  refit_all_groups(scene, tree);
  return tree;
}

void refit_all_groups(const Scene& scene, SceneTree& tree) {
  for (std::uint32_t g = static_cast<std::uint32_t>(tree.groups.size()); g-- > 0;) {
    const std::vector<GroupNode>& nodes = tree.groups[g].nodes;
    // Children stand behind their parents.
    for (std::uint32_t i = static_cast<std::uint32_t>(nodes.size()); i-- > 0;)
      nodes[i].is_leaf() ? refit_leaf_content(scene, tree, g, i) : refit_inner_content(tree, g, i);
    refit_content(tree, g);
    for (std::uint32_t i = static_cast<std::uint32_t>(nodes.size()); i-- > 0;) refit_reach(scene, tree, g, i);
  }
}

std::vector<GroupPlace> refit_groups(const Scene& scene, std::span<const std::uint32_t> moved, SceneTree& tree,
                                     bool& rescaled) {
  rescaled = false;
  // Groups from the innermost outwards: a group's own number is above that of the group that it stands in. In each the
  // nodes to be refitted, those behind first.
  using Nodes = std::set<std::uint32_t, std::greater<>>;
  std::map<std::uint32_t, Nodes, std::greater<>> groups;
  const auto touch = [&](std::uint32_t n) {
    if (tree.leaf[n] == kNone) return;
    const std::uint32_t g = group_of(scene, n);
    for (std::uint32_t i = tree.leaf[n]; i != kNone; i = tree.groups[g].nodes[i].parent) groups[g].insert(i);
  };
  for (const std::uint32_t n : moved) touch(n);
  std::vector<GroupPlace> places;
  while (!groups.empty()) {
    const auto [g, nodes] = *groups.begin();
    groups.erase(groups.begin());
    GroupTree& group = tree.groups[g];
    const double extent = group.extent;
    for (const std::uint32_t i : nodes)
      group.nodes[i].is_leaf() ? refit_leaf_content(scene, tree, g, i) : refit_inner_content(tree, g, i);
    refit_content(tree, g);
    rescaled = rescaled || group.extent != extent;
    for (const std::uint32_t i : nodes) {
      refit_reach(scene, tree, g, i);
      places.push_back({g, i});
    }
    if (g > 0) touch(g - 1);
  }
  return places;
}

}  // namespace plumbline
