// SPDX-License-Identifier: MIT
// The library of broken trees, explained: where a fault loses a ray, the walk names the very cell.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

#include "scenes/rays.h"
#include "tracer/broken_trees.h"
#include "tracer/image_view.h"
#include "tracer/probe.h"
#include "tracer/walk_analysis.h"

namespace plumbline {
namespace {

std::vector<Ray> some_rays(const Scene& scene, std::size_t of_each) {
  const RaySource source(scene);
  std::vector<Ray> rays;
  for (const RayFamily family : {RayFamily::camera, RayFamily::chords, RayFamily::aimed_vertices,
                                 RayFamily::aimed_edges, RayFamily::tangents, RayFamily::axis, RayFamily::inside}) {
    std::vector<Ray> some(of_each);
    generate_rays(source, family, 7, 0, some);
    rays.insert(rays.end(), some.begin(), some.end());
  }
  return rays;
}

/// Whether what a loss names is what the fault has changed: the node, the record of the transform, the primitive.
bool names_the_change(const Loss& loss, const BrokenTree& tree) {
  const GeometryImage &image = tree.broken, &sound = tree.sound;
  const auto differs = [&](std::size_t texel) {
    return texel < sound.texels.size() && !same_bits(image.texels[texel], sound.texels[texel]);
  };
  if (loss.cell != kNone)
    for (std::uint32_t unit = loss.cell; unit < loss.cell + node_units(image); ++unit)
      for (const int row : {0, 1})
        if (unit < unit_count(image) && (row == 0 || !is_compact(image)) && differs(unit_texel(image, unit, row)))
          return true;
  if (loss.transform != kNone && loss.transform < image.transform_count)
    for (std::uint32_t i = 0; i < kTransformTexels; ++i)
      if (differs(transform_texel(image, loss.transform, i))) return true;
  for (const std::uint32_t k : {loss.stored, loss.test ? loss.test->k : kNone})
    if (k != kNone)
      for (const std::size_t texel : primitive_texels(image, k))
        if (differs(texel)) return true;
  return false;
}

/// Whether it is an attribute that was changed, and no texel.
bool is_of_attributes(const BrokenTree& tree) {
  return std::equal(tree.sound.texels.begin(), tree.sound.texels.end(), tree.broken.texels.begin(),
                    tree.broken.texels.end(), same_bits);
}

/// A fault, the rays that it loses, and what the walks say of them.
struct Outcome {
  std::size_t lost = 0, explained = 0, named = 0, differing = 0;
  std::string sentence;
};

Outcome explain_fault(const BrokenTree& tree, Probe& probe, WalkRecorder& recorder) {
  const std::vector<Ray> rays = some_rays(tree.scene, 600);
  std::vector<Hit> sound(rays.size()), broken(rays.size());
  probe.set_image(tree.sound);
  probe.trace(rays, sound);
  probe.set_image(tree.broken);
  probe.trace(rays, broken);
  recorder.set_image(tree.broken);
  Outcome outcome;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool same = sound[i].kind == broken[i].kind && sound[i].primitive == broken[i].primitive &&
                      sound[i].instance == broken[i].instance;
    outcome.differing += !same;
    // Lost: what should be hit was not, and nothing in front of it either.
    if (same || sound[i].kind != HitKind::hit || (broken[i].kind == HitKind::hit && broken[i].t < sound[i].t)) continue;
    ++outcome.lost;
    if (outcome.explained == 6) continue;
    ++outcome.explained;
    const ExpectedHit expected{sound[i].instance, sound[i].primitive, static_cast<double>(sound[i].t)};
    const Loss loss = lost_at(tree.broken, recorder.record(rays[i], 20'000), expected,
                              tree.broken.primitive_start == tree.sound.primitive_start ? &tree.sound : nullptr);
    const bool is_named = names_the_change(loss, tree);
    outcome.named += is_named;
    if (outcome.sentence.empty() || !is_named) outcome.sentence = loss.sentence;
  }
  return outcome;
}

}  // namespace

TEST_CASE("of the library of broken trees every fault that loses a ray is named by the walk that lost it", "[walk]") {
  GlContext context;
  const BrokenTree any = sound_tree("nested", {});
  Probe probe(context, any.sound);
  WalkRecorder recorder(context, any.sound);
  const bool prints = std::getenv("PLUMBLINE_PRINT_TABLES") != nullptr;
  std::size_t losing = 0;
  for (const TreeFault& fault : tree_faults()) {
    const BrokenTree tree = break_tree(fault, 1);
    const Outcome outcome = explain_fault(tree, probe, recorder);
    if (prints)
      std::printf("%-34s lost %5zu  differ %5zu  named %zu of %zu  (%d, %d) %s\n", std::string(fault.name).c_str(),
                  outcome.lost, outcome.differing, outcome.named, outcome.explained, tree.x, tree.y,
                  outcome.sentence.c_str());
    losing += outcome.lost > 0;
    INFO(fault.name << " at (" << tree.x << ", " << tree.y << "): " << outcome.sentence);
    if (outcome.lost > 0) CHECK_FALSE(outcome.sentence.empty());
    if (!is_of_attributes(tree)) CHECK(outcome.named == outcome.explained);  // an attribute has no cell
  }
  CHECK(losing >= 30);
}

}  // namespace plumbline
