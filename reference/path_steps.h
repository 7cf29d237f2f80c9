// SPDX-License-Identifier: GPL-3.0-or-later
// The steps that a sample is made of, by SEMANTICS 6.2, 6.6 and 6.7, each a function of its own: sample_color strings
// them together, and a comparison of single steps calls them one by one.
#pragma once

#include "reference/sample.h"

namespace plumbline {

/// A ray of a sample, in double; the direction is of unit length.
struct PathRay {
  glm::dvec3 origin{0.0}, direction{0.0};
  std::uint32_t number = 1, bounce = 0;  ///< SEMANTICS 6.1
};
Ray rounded(const PathRay& ray);

/// A sample's random numbers, and all that says what they are used for.
struct SampleNumbers {
  const PreparedScene& prepared;
  const RandomSource& numbers;
  Draw sample;  ///< pixel and frame
};

/// The ray through the sample's place in its pixel (SEMANTICS 6.2).
PathRay primary_ray(const SampleNumbers& numbers);

/// Where the hit of ray `ray` perceives light k to be (SEMANTICS 6.6, point 2).
glm::dvec3 light_place(const SampleNumbers& numbers, std::uint32_t ray, std::uint32_t k);
/// What is known before a shadow ray is sent: at_light, below or averted; `lit` where one is needed.
LightOutcome faces_light(const Surface& surface, const glm::dvec3& place);
Ray shadow_ray(const Surface& surface, const glm::dvec3& place);
/// The light's intensity at every distance.
glm::dvec3 brightness_of(const Scene& scene, const Light& light);
/// Diffuse term and highlight of a light that is seen, for brightness 1. `direction`: of the ray that hit, unit length.
glm::dvec3 shine(const Surface& surface, const glm::dvec3& place, const glm::dvec3& direction);

/// What is added to the normal before it is made of unit length; zero where the reflection is sharp.
glm::dvec3 normal_perturbation(const SampleNumbers& numbers, const Surface& surface, std::uint32_t ray);

/// The rays that leave a hit (SEMANTICS 6.7). The flags of `event` that tell of them are set, where there is one.
PathRay reflected_ray(const SampleNumbers& numbers, const Surface& surface, const PathRay& path,
                      RayEvent* event = nullptr);
PathRay refracted_ray(const Surface& surface, const PathRay& path, RayEvent* event = nullptr);

}  // namespace plumbline
