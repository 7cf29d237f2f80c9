// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/variants.h"

namespace plumbline {

std::string variant_name(const BakeOptions& o) {
  std::string name = o.layout == Layout::paper ? "paper" : "compact";
  name += o.bounds == Bounds::sphere ? "_sphere" : "_aabb";
  name += o.links == Links::threaded ? "_threaded" : "_octant";
  if (o.transform_list == TransformList::root) name += "_list";
  if (o.transform_out == TransformOut::inverse) name += "_inverse";
  return name;
}

std::vector<Variant> all_variants(bool placed) {
  std::vector<Variant> variants;
  const BakeOptions standard;
  for (const Layout layout : {Layout::paper, Layout::compact})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
      for (const Links links : {Links::threaded, Links::octant}) {
        BakeOptions o = standard;
        o.layout = layout, o.bounds = bounds, o.links = links;
        if (variant_name(o) == variant_name(standard)) continue;
        variants.push_back({variant_name(o), "Layout, bounds and links of the geometry image.", o});
        if (!placed) continue;
        o.transform_list = TransformList::root;
        variants.push_back({variant_name(o), "Layout, bounds and links, and all transforms in a list at the root.", o});
      }
  const auto add = [&](const std::string& name, const std::string& what, auto change) {
    BakeOptions o = standard;
    change(o);
    variants.push_back({name, what, o});
  };
  for (const int size : {1, 2, 3, 5, 8})
    add("leaf_" + std::to_string(size), "At most " + std::to_string(size) + " primitives in a leaf.",
        [&](BakeOptions& o) { o.tree.leaf_size = size; });
  for (const int width : {2, 3, 8})
    add("width_" + std::to_string(width), "At most " + std::to_string(width) + " children in a node.",
        [&](BakeOptions& o) { o.tree.width = width; });
  add("split", "Long triangles are split before the build.", [](BakeOptions& o) { o.tree.split_long = 0.1f; });
  add("image_2048", "An image of 2048 texels a row.", [](BakeOptions& o) { o.width = 2048; });
  add("image_64", "An image that starts at 64 texels a row and grows.", [](BakeOptions& o) { o.width = 64; });
  if (placed)
    add("list", "All transforms in a list at the root, as in the paper.",
        [](BakeOptions& o) { o.transform_list = TransformList::root; });
  return variants;
}

VariantTrees::VariantTrees(const Scene& scene, const SceneTree& standard) : scene_(scene), standard_(standard) {}

const SceneTree& VariantTrees::of(const BakeOptions& options) {
  const bool list = options.transform_list == TransformList::root;
  if (options.tree == TreeOptions{} && !list) return standard_;
  for (const Built& b : built_)
    if (b.options == options.tree && b.list == list) return *b.tree;
  built_.push_back({options.tree, list, std::make_unique<SceneTree>(build_scene_tree(scene_, options.tree, list))});
  return *built_.back().tree;
}

}  // namespace plumbline
