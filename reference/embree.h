// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's hits: Embree finds the primitive, double precision gives the values. The only file that names Embree
// is embree.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

enum class SphereMode {
  exact_user,  ///< spheres as user geometry, intersected in double precision (the truth)
  embree,      ///< Embree's own sphere primitive (a cross-check)
};

/// How a scene's instances come to be: two truths that share no arithmetic.
enum class Placement {
  instanced,  ///< one tree for each part; rays are taken into an instance's space by its exactly composed map
  flattened,  ///< all is brought into the world by maps composed in double, and is one tree
};

class EmbreeScene {
 public:
  /// `flattened` needs exact_user, and throws InputError for scenes that show more than kMostFlattened (geometry.h)
  /// primitives.
  explicit EmbreeScene(const Scene& scene, SphereMode spheres = SphereMode::exact_user,
                       Placement placement = Placement::instanced);
  ~EmbreeScene();
  EmbreeScene(EmbreeScene&&) noexcept;
  EmbreeScene& operator=(EmbreeScene&&) noexcept;

  /// The nearest hit of each ray, on all cores (TBB). `hits` is as long as `rays`; undefined rays are told, not traced.
  ///
  /// Embree, which computes in 32 bits, names the primitive; where several share the least t it may name any of them.
  /// Values are computed in double from the ray as given. Before Embree sees it a ray that starts more than two scene
  /// radii outside the scene is moved to it in double precision, its direction is scaled by a power of two, and scenes
  /// of a radius beyond 2^20 or below 2^-20 are scaled likewise. Embree's word stands even where it errs: if double
  /// precision finds no valid hit on the named primitive, t and weights are clamped to what is valid (triangle_values
  /// in hit_values.h).
  ///
  /// In scenes with instances each instance that Embree's tree of their boxes gives (boxes padded for the rounding of
  /// the ray, so none is lost) is asked in its part's tree, with the ray taken into its space in extended precision and
  /// moved to the part as above; of what they and the world name the least t in double counts, among equals the world
  /// and then the lowest instance. So an instance far from the world's origin, or tiny, is traced as exactly as a scene
  /// of its own. Values: the local line's numbers are off by at most 2^-59 |L^-1| (|o| + |T|) (component by component,
  /// instance_map.h), the values in the instance's space by a few 2^-53 of the coordinates of part and line there, and
  /// the way out, L p + T, by 2^-50 (|L| |p| + |T|): all far below 2^-40 of the coordinates involved. Flattened corners
  /// are off by a few 2^-53 (|L| |p| + |T|); Embree sees them rounded to 32 bits.
  void intersect(std::span<const Ray> rays, std::span<ReferenceHit> hits) const;

  /// The same of one ray, in the calling thread; any number of threads may ask at once. For the renderer, whose rays
  /// depend on each other.
  ReferenceHit first_hit(const Ray& ray) const;
  /// Whether a ray hits anything at all; false for an undefined one. As first_hit, but any hit ends the search.
  bool is_blocked(const Ray& ray) const;

  /// Takes the nodes' transforms from `scene`, which must be the one that this was made of but for them; the parts'
  /// trees stay. Not while others trace, and not where instances were flattened.
  void move_nodes(const Scene& scene);

  /// rtcIntersect1 on each ray as given and nothing else, on all cores: what the benchmark times. Instances are
  /// Embree's own here (RTC_GEOMETRY_TYPE_INSTANCE, the composed maps rounded to 32 bits). Returns the number of hits.
  std::size_t intersect_only(std::span<const Ray> rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
