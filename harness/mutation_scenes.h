// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes and rays that mutants are asked with, and what is known of them: small, since every mutant is asked anew.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "harness/session.h"
#include "reference/embree.h"
#include "tracer/shader_patch.h"

namespace plumbline {

enum class MutationScene {
  mixed,           ///< spheres, a closed mesh, large, tiny and sliver triangles
  spheres,         ///< spheres alone
  triangles,       ///< triangles alone
  nested,          ///< the shipped scene of instances in instances
  spheres_placed,  ///< instances of spheres alone
  doubles,         ///< everything is there twice or more, in the world and in instances
  twins,           ///< the same without instances
  slats,           ///< triangles that all of the rays see edge-on
  scales,          ///< the shipped scene of instances of very different sizes
  speck,           ///< `mixed`, 2^-70 times as large
  giant,           ///< `nested`, 2^60 times as large, and off the origin
  apart,           ///< instances 2^-20, 1 and 2^20 times as large, in one another too
  pairs,           ///< instances 2^-15 as large as the world is, two at each place, and rays towards them
  heap,            ///< eight instances around the origin in a group 2^-45 as large as the world, and rays through it
  border,          ///< instances before large ones, and pairs of rays on either side of an octant's border
};
const char* name_of(MutationScene scene);
Scene mutation_scene(MutationScene scene);
/// The rays that a scene is made for, or some of every family.
std::vector<Ray> mutation_rays(MutationScene scene, const RaySource& source);
/// Rays that no family has, or few of: from as far as floats reach, towards the origin of the world or along an axis
/// (all of them exact), towards the ball and away from it; along axes and diagonals; with directions of denormal
/// numbers, and tiny components; with ends before the start and none at all.
std::vector<Ray> odd_rays(const Ball& ball);

/// Rays and what is known of them without a mutant.
struct MutationRays {
  std::vector<Ray> rays;
  std::size_t odd_from = 0;                     ///< of the plain ones: where those begin that no family has
  std::vector<ReferenceHit> truth;              ///< Embree's
  std::vector<Hit> brute_compact, brute_paper;  ///< loops over all primitives of the image of either layout
};

struct MutationStage {
  explicit MutationStage(const std::string& name, Scene scene) : stage(name, std::move(scene)) {}
  Stage stage;
  MutationRays plain;  ///< whose walks end in the first pass
  MutationRays rare;   ///< the others, and some of the plain ones between them
};

/// Cuts walks through such an image into slices, as a driver does that ends loops before their time: the rest of a walk
/// goes on in further passes. A slice is `steps` + 1 nodes, and a few where there are transforms.
std::vector<ShaderPatch> slices_of(const GeometryImage& image, int steps = 24);
/// Ends the loops of transforms, and those that bring far rays near, before their time, once an invocation has gone
/// through them so many times together, as a driver does that counts rounds (walk_state.glsl).
std::vector<ShaderPatch> loops_that_end(const GeometryImage& image, int rounds);

/// Adds patches to those of a context for as long as this lives. They come after a mutant, which is found by its place.
class AddedPatches {
 public:
  AddedPatches(GlContext& context, std::span<const ShaderPatch> patches);
  ~AddedPatches();
  AddedPatches(const AddedPatches&) = delete;
  AddedPatches& operator=(const AddedPatches&) = delete;

 private:
  GlContext& context_;
  const std::vector<ShaderPatch> before_;
};

/// Made when it is first asked for, in a context without patches.
const MutationStage& mutation_stage(GlContext& context, MutationScene scene);

/// The first ray whose answer fails by its verdict: what is wrong with it. Empty where none does. `passed` keeps
/// answers that have passed, for the same judge and rays, so that they are not judged again.
std::string first_failure(const Judge& judge, const MutationRays& rays, const std::vector<Hit>& hits,
                          std::vector<Hit>& passed);
/// The first ray that names a primitive although the same stands in the world, in an instance of a lower number, or has
/// a lower number itself (SEMANTICS 5).
std::string first_wrong_tie(const Scene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& hits);
/// The first ray whose answer is not `known`, bit for bit.
std::string first_difference(const MutationRays& rays, const std::vector<Hit>& hits, const std::vector<Hit>& known);

}  // namespace plumbline
