// SPDX-License-Identifier: MIT
// The library of broken trees: sound geometry images with one fault each, made on purpose, to see who finds it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "tracer/geometry_image.h"

namespace plumbline {

struct TreeFault {
  std::string_view name;  ///< stable: "sphere_too_small.leaf"
  std::string_view does;  ///< one sentence: what is changed
  std::string_view rule;  ///< the rule of verify that must find it (VerifyRule::name); empty: none
  /// The least that certify() must be given to find it. `rays`: with the image alone it finds nothing, but rays differ;
  /// with the scene it finds `rule`. `nobody`: no ray can be answered differently, and neither finds anything.
  enum class Finder { image, scene, tree, rays, nobody } finder = Finder::image;
  std::string_view scene;  ///< "triangles", "spheres", "split" or "nested"
  Layout layout = Layout::compact;
  Bounds bounds = Bounds::sphere;
  Links links = Links::threaded;
};

/// All faults, in a fixed order.
std::span<const TreeFault> tree_faults();

struct BrokenTree {
  Scene scene;
  SceneTree tree;
  GeometryImage sound, broken;
  int x = -1, y = -1;  ///< texel of the cell that must be named (in layout `paper` the upper one); -1: an attribute
};

/// Bakes the fault's scene and breaks the image; the seed chooses among the places where the fault can be made.
BrokenTree break_tree(const TreeFault& fault, std::uint64_t seed);

/// A sound image of one of the scenes that faults are made in, by name.
BrokenTree sound_tree(std::string_view scene, const BakeOptions& options);

}  // namespace plumbline
