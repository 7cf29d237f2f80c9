// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps while it goes from case to case: the GL context, and one scene at a time with everything that both
// tracers build of it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/variants.h"
#include "harness/verdict.h"
#include "reference/arbiter.h"
#include "reference/embree.h"
#include "scenes/rays.h"
#include "scenes/scene.h"
#include "scenes/topology.h"
#include "tracer/geometry_image.h"
#include "tracer/gl_context.h"
#include "tracer/probe.h"
#include "tracer/scene_tree.h"

namespace plumbline {

/// A scene and what both sides need of it. Built in one go; immovable, since its parts point at one another.
class Stage {
 public:
  Stage(const std::string& spec, Scene scene);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const std::string spec;  ///< what loads it again: a path, or "sphereflake:4"
  const Scene scene;
  const Topology topology;
  const Arbiter arbiter;
  const EmbreeScene embree;
  const SceneTree tree;  ///< of the default variant
  const Judge judge;
  const GeometryImage image;  ///< of the default variant
  RaySource rays;             ///< tangents aim at the spheres of `tree`; `secondary` rays are captured by Session

  /// The default variant but for how rays leave transforms. That of `inverse` is baked when it is first asked for.
  const GeometryImage& image_of(TransformOut out) const;
  /// Judges answers of that variant.
  Judge judge_of(TransformOut out) const;

 private:
  mutable std::unique_ptr<const GeometryImage> inverse_image_;
};

class Session {
 public:
  Session();
  ~Session();

  GlContext& context() { return context_; }
  /// The stage of a scene; keeps the last one only.
  Stage& stage(const std::string& spec);
  /// The stage of a scene that is already in memory.
  Stage& stage(const std::string& spec, Scene scene);
  /// The default variant's probe with the stage's image uploaded, or that of the other way out of transforms.
  Probe& probe(const Stage& stage, TransformOut out = BakeOptions{}.transform_out);
  /// The same with bundles of `size` rays.
  Probe& bundles(const Stage& stage, int size, TransformOut out = BakeOptions{}.transform_out);
  /// The brute-force layer over the stage's image.
  Probe& brute_force(const Stage& stage);
  /// A variant's probe with `image` uploaded; programs are compiled once per kind of image.
  Probe& probe(const GeometryImage& image);

 private:
  Stage& install(std::unique_ptr<Stage> stage);
  Probe& program(const GeometryImage& image, Traversal traversal, int bundle = 1);

  GlContext context_;
  std::unique_ptr<Stage> stage_;
  std::map<std::string, std::unique_ptr<Probe>> programs_;
  std::map<std::string, const GeometryImage*> uploaded_;
};

/// The rays that a renderer would send on from what the camera sees: mirrored at the surface, and towards each light.
/// From `count` camera rays, traced by the production tracer itself.
std::vector<Ray> capture_secondary_rays(Session& session, const Stage& stage, std::size_t count);

}  // namespace plumbline
