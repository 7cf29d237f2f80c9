// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's hits: Embree finds the primitive, double precision gives the values. The only file that names Embree
// is embree.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "scenes/ray.h"
#include "scenes/scene.h"

namespace plumbline {

enum class SphereMode {
  exact_user,  ///< spheres as user geometry, intersected in double precision (the truth)
  embree,      ///< Embree's own sphere primitive (a cross-check)
};

class EmbreeScene {
 public:
  explicit EmbreeScene(const Scene& scene, SphereMode spheres = SphereMode::exact_user);
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
  void intersect(std::span<const Ray> rays, std::span<ReferenceHit> hits) const;

  /// rtcIntersect1 on each ray as given and nothing else, on all cores: what the benchmark times. Returns the number of
  /// hits.
  std::size_t intersect_only(std::span<const Ray> rays) const;

  static std::string version();  ///< "Embree 3.13.5"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
