// SPDX-License-Identifier: MIT
// A certificate for a geometry image, without tracing a ray: what holds for every walk through it, and what does not.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/geometry_image.h"

namespace plumbline {

/// What an image must keep.
struct VerifyRule {
  std::string_view name;    ///< stable: "link_target"
  std::string_view says;    ///< one sentence: what must hold
  std::string_view effect;  ///< one sentence: what an image that breaks it does to a ray
  /// What must be given for the rule to be judged: the image alone, the scene too, or its tree as well.
  enum class Needs { image, scene, tree } needs = Needs::image;
};

/// All rules, in the order in which their findings stand.
std::span<const VerifyRule> verify_rules();

struct Finding {
  std::string rule;            ///< VerifyRule::name
  int x = -1, y = -1;          ///< texel; in layout `paper` the upper one of the cell; -1: an attribute of the image
  std::uint32_t node = kNone;  ///< number within its copy of the region; of a record: of the scene's node;
                               ///< of a primitive: its number in the scene; kNone: none of these
  std::string message;         ///< what is wrong, with the numbers
  std::string_view effect;     ///< VerifyRule::effect
};

/// Of some numbers.
struct Spread {
  double min = 0.0, median = 0.0, max = 0.0;
  std::size_t count = 0;
};

struct Certificate {
  /// By rule, then in the order of the image; at most kMaxFindings of each rule.
  std::vector<Finding> findings;
  std::map<std::string, std::uint64_t> counts;  ///< findings of each rule that has any, those not kept too
  /// Rules that could not be decided, in whole or in part: what they need is broken, or work would have had no end.
  /// Why stands in a finding, of one of them or of the rule that is broken. Rules that need a scene or a tree that was
  /// not given are not among them.
  std::set<std::string> undecided;
  std::uint64_t longest_walk = 0;  ///< nodes visited at most; traversal ends after so many
  std::size_t regions = 0, nodes = 0, leaves = 0, transforms = 0, primitives = 0;  ///< of one copy of each region
  std::size_t depth = 0;            ///< nodes above one another in one region, at most
  std::size_t split_triangles = 0;  ///< that stand in several leaves, which together cover them
  std::uint64_t denormals = 0;      ///< coordinates that the scene itself has so small: legal
  Spread slack;  ///< radius of nodes over that of the smallest ball around the primitives below: padding and
                 ///< packing are in it. Of nodes with bounds `sphere` above primitives that are not split.
  double seconds = 0.0;
  bool is_sound() const { return counts.empty(); }
};

inline constexpr std::size_t kMaxFindings = 64;

/// Judges an image, whatever it holds: every index is checked, every walk ends. What it says rests on the image's
/// texels alone, and on the scene and its tree where they are given (a tree without its scene is not looked at). Where
/// links are broken, what follows from them is said as far as it can be. `threads` 0: one per core.
///
/// Containment of primitives is decided exactly. That bounds also hold the padding that the shader's rounding needs
/// (bake.h), and what stands behind transforms, is decided in double: its error is less than 2^-30 of that padding.
Certificate certify(const GeometryImage& image, const Scene* scene = nullptr, const SceneTree* tree = nullptr,
                    int threads = 0);

/// What is wrong with the sizes and counts that the attributes tell, whatever the texels hold and however many there
/// are: the first part of certify(). Empty where an image of this size can be as they say.
std::vector<std::string> attribute_errors(const GeometryImage& image);

}  // namespace plumbline
