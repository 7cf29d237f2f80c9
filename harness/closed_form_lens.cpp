// SPDX-License-Identifier: GPL-3.0-or-later
// Depth of field: the blur of a straight edge before, in, behind and far behind the plane of what is sharp
// (closed_forms.md, section 2).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/closed_forms.h"
#include "harness/quadrature.h"

namespace plumbline {
namespace {

constexpr int kWidth = 16, kHeight = 32;
constexpr float kFocus = 2.0f, kAperture = 0.2f;

/// A white background and a black half plane x > e at `distance` along the view. `blur` is what the picture spans, on
/// the plane at distance 1.
ClosedForm edge_at(Effects::Model model, float distance, double blur, double size) {
  const double wanted = 2.5 * blur / kWidth;
  ClosedForm form;
  form.scene = scene_for(model, {0, 0, 8}, {0, 0, 0}, {0, 1, 0}, kWidth, kHeight, wanted);
  Scene& scene = form.scene;
  scene.effects.depth_of_field = true;
  scene.camera.aperture = static_cast<float>(static_cast<double>(kAperture) * size);
  scene.camera.focus = kFocus;
  // Off the middle, so that a picture turned round is seen, and off the centres of pixels.
  const auto edge = static_cast<float>(0.37 * wanted * static_cast<double>(distance));
  const float z = 8.0f - distance;
  add_quad(scene, {glm::vec3{edge, -60, z}, {60, -60, z}, {60, 60, z}, {edge, 60, z}}, add_black(scene));

  const double pitch = pixel_of(scene.camera), e = static_cast<double>(edge),
               a = static_cast<double>(scene.camera.aperture);
  const double f = kFocus, d = 8.0 - static_cast<double>(z);
  Profile& profile = form.profile;
  profile.width = kWidth, profile.height = kHeight;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const double s = pitch * (column - 0.5 * (kWidth - 1));
      // The ray passes the edge on its black side where a (F - D) px + a (e - F s) pz > F (e - D s).
      const double black = lens_share(model, a * (f - d), a * (e - f * s), f * (e - d * s));
      profile.pixels.push_back(SampleMoments::chance(1.0 - black));
      profile.point_of.push_back(static_cast<std::uint32_t>(column));
    }
  for (int column = 0; column < kWidth; ++column) profile.place.push_back(column - 0.5 * (kWidth - 1));
  return form;
}

/// The mean over z in [-1, 1] of the share of x in [-1, 1] with a x + c z > b.
double square_above(double a, double c, double b) {
  if (a == 0.0 && c == 0.0) return b < 0.0 ? 1.0 : 0.0;
  // The square [-1, 1]^2 is the unit square twice as large.
  const double length = std::hypot(a, c);
  return 1.0 - square_below(a / length, c / length, 0.5 * b / length);
}

}  // namespace

double lens_share(Effects::Model model, double a, double c, double b) {
  if (model == Effects::Model::paper) return square_above(a, c, b);
  if (a == 0.0) return b < 0.0 ? 1.0 : 0.0;
  // The segment of the unit disc beyond a chord at s.
  const double s = std::clamp(b / std::fabs(a), -1.0, 1.0);
  return (std::acos(s) - s * std::sqrt(1.0 - s * s)) / std::numbers::pi;
}

std::vector<ClosedFormInfo> depth_of_field_forms() {
  struct Depth {
    const char* name;
    float distance;
    double blur;  ///< half-width on the plane at distance 1: a |F - D| / (F D); for what is sharp, any
    const char* proves;
  };
  const Depth depths[] = {
      {"edge_before", 1.0f, 0.1,
       "An edge at half the distance of what is sharp is blurred over its circle of confusion"},
      {"edge_in_focus", 2.0f, 0.1, "An edge at the distance of what is sharp has no blur: no sample crosses it"},
      {"edge_behind", 3.5f, 0.2 * 1.5 / 7.0, "An edge behind what is sharp is blurred over its circle of confusion"},
      {"edge_far", 14.0f, 0.2 * 12.0 / 28.0, "An edge far behind what is sharp is blurred almost over the lens itself"},
  };
  std::vector<ClosedFormInfo> forms;
  for (const auto model : {Effects::Model::paper, Effects::Model::physical})
    for (const Depth& depth : depths)
      forms.push_back(
          {"dof", "7.1", depth.name, model, depth.distance == kFocus ? "" : "aperture",
           "place across the edge (pixels)",
           std::string(depth.proves) + ", under the " + (model == Effects::Model::paper ? "cube" : "disc") + ".",
           [model, depth](double size) { return edge_at(model, depth.distance, depth.blur, size); }});
  return forms;
}

}  // namespace plumbline
