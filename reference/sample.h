// SPDX-License-Identifier: GPL-3.0-or-later
// The colour of one sample: its whole tree of rays, with all effects, by SEMANTICS 6.1 to 6.7; and a record of what
// happened on the way, for comparing it with another's sample of the same random numbers.
#pragma once

#include <vector>

#include "reference/embree.h"
#include "reference/random_source.h"
#include "reference/surface.h"
#include "scenes/camera.h"

namespace plumbline {

/// A scene at one time, ready for samples.
struct PreparedScene {
  const Scene* scene = nullptr;  ///< with at least one light
  const EmbreeScene* hits = nullptr;
  std::vector<InstanceView> views;
  CameraFrame camera;
  double aperture = 0.0, focus = 1.0;  ///< world units
  Effects effects;
};

/// Why a light does or does not reach a hit (SEMANTICS 6.6, points 3 and 4), in the order in which it is asked.
enum class LightOutcome : std::uint8_t {
  at_light,  ///< the light stands at the hit itself
  below,     ///< below the surface on the viewer's side: n_g.l <= 0
  averted,   ///< n.l <= 0
  shadowed,  ///< the shadow ray hit something
  lit,
};

/// One ray of a sample. What is not of a hit is as it was made.
struct RayEvent {
  std::uint32_t ray = 0;  ///< 1 to 63, SEMANTICS 6.1
  std::uint32_t instance = kNone;
  std::uint32_t primitive = kNone;  ///< kNone: background
  bool from_outside = false;        ///< d.N <= 0
  bool reflected_above = true;      ///< false: the reflected direction was mirrored at the geometric plane
  bool refracted_below = true;      ///< the same of the refracted direction
  bool totally_reflected = false;   ///< there was no refracted direction
  friend bool operator==(const RayEvent&, const RayEvent&) = default;
};

/// All that decides a sample's colour but numbers that vary continuously. Two records can be compared as they are.
struct SampleRecord {
  std::vector<RayEvent> rays;        ///< in the order of tracing: after a reflected ray all that follows from it
  std::vector<LightOutcome> lights;  ///< for each hit of `rays`, in that order, each light of the scene
  friend bool operator==(const SampleRecord&, const SampleRecord&) = default;
};

/// The colour of the sample of pixel (x, y) in a frame. `record` may be null. Any number of threads may ask at once.
glm::dvec3 sample_color(const PreparedScene& prepared, const RandomSource& numbers, std::uint32_t x, std::uint32_t y,
                        std::uint32_t frame, SampleRecord* record = nullptr);

/// What a ray hits first, the ground included; SEMANTICS 6.8.
ReferenceHit first_hit(const PreparedScene& prepared, const Ray& ray);

}  // namespace plumbline
