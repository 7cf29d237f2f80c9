// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of one effect each whose pictures are known by analysis: for every pixel the mean and the variance of a
// sample, from SEMANTICS 6 and 7 and from neither renderer. Derivations stand in closed_forms.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/profile.h"
#include "scenes/scene.h"

namespace plumbline {

/// A scene with its effects and model set, at the size of its camera, and what it must show.
struct ClosedForm {
  Scene scene;
  double time = 0.0;  ///< of the picture, seconds
  Profile profile;
};

struct ClosedFormInfo {
  std::string effect;  ///< "soft_shadow", "dof", "glossy", "aa", "motion_blur"
  std::string paper;   ///< its section there
  std::string scene;   ///< "half_plane"
  Effects::Model model = Effects::Model::paper;
  std::string size;    ///< what `make` takes a multiple of: "light radius"; empty where nothing is scaled
  std::string axis;    ///< of the profile, with its unit
  std::string proves;  ///< one sentence
  std::function<ClosedForm(double size)> make;  ///< size: 1, or a multiple of the effect's size

  std::string name() const;  ///< "drt.closed_form.soft_shadow.half_plane.physical"
};

/// All of them, both models of each.
std::vector<ClosedFormInfo> closed_forms();

/// `info.make(1)` with Profile::slope filled in, by a difference of two sizes.
ClosedForm with_slope(const ClosedFormInfo& info);

// One file each.
std::vector<ClosedFormInfo> soft_shadow_forms();
std::vector<ClosedFormInfo> depth_of_field_forms();
std::vector<ClosedFormInfo> glossy_forms();
std::vector<ClosedFormInfo> antialias_forms();
std::vector<ClosedFormInfo> motion_blur_forms();

// What the forms are made of; public for their tests.

/// Of a light around `center` with radius (or half-side) `size`, seen from (x, y, 0): E[V], E[V c], E[V c^2], E[V c^3],
/// c being the cosine at the surface z = 0.
using LightMoments = std::array<double, 4>;
/// What has x >= edge at `height` hides the light.
LightMoments light_over_half_plane(Effects::Model model, const glm::dvec3& center, double size, double edge,
                                   double height, double x, double y);
/// The disc of `radius` around (0, 0, height) hides the light, whose centre is above (0, 0).
LightMoments light_over_disc(Effects::Model model, double center_height, double size, double radius, double height,
                             double x, double y, double tolerance = 1e-10);

/// The share of glossy reflections of a ray with direction d at the plane z = 0 whose direction r has u.r > 0.
double glossy_share(Effects::Model model, double glossy, const glm::dvec3& d, const glm::dvec3& u);

/// The share of places (px, py, pz) of the lens, z along the view, with a px + c pz > b.
double lens_share(Effects::Model model, double a, double c, double b);

/// The share of the unit square around (0, 0) with x cos + y sin < t.
double square_below(double cosine, double sine, double t);

// Building blocks of the forms.

/// Fills profile.pixels (its width and height are set) on all cores. `like` gives the same pair for pixels that are
/// alike; `of` is asked once for each pair.
void fill_pixels(Profile& profile, const std::function<std::pair<int, int>(int column, int row)>& like,
                 const std::function<SampleMoments(int column, int row)>& of);

/// Fills profile.point_of and profile.place with `points` points of equally many pixels, ordered by `place`.
void gather_evenly(Profile& profile, int points, const std::function<double(int column, int row)>& place);

/// An empty scene with only one effect on, seen by a camera whose pixels have the side `pixel` at distance 1. Its light
/// lights nothing.
Scene scene_for(Effects::Model model, const glm::vec3& from, const glm::vec3& at, const glm::vec3& up, int width,
                int height, double pixel);
/// The pixel's side at distance 1 that the camera's float angle really gives (SEMANTICS 4.1).
double pixel_of(const Camera& camera);
std::uint32_t add_white(Scene& scene);
std::uint32_t add_black(Scene& scene);
/// Two triangles.
void add_quad(Scene& scene, const std::array<glm::vec3, 4>& corners, std::uint32_t material);

}  // namespace plumbline
