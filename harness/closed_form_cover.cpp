// SPDX-License-Identifier: GPL-3.0-or-later
// Anti-aliasing and motion blur: the part of a pixel, or of the shutter's time, that something covers (closed_forms.md,
// sections 4 and 5).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/closed_forms.h"

namespace plumbline {
namespace {

/// Parallel black bars in the plane at distance 1, turned by an angle that no row or column of pixels has.
ClosedForm slanted_bars(Effects::Model model) {
  constexpr int kSide = 24, kPoints = 16;
  constexpr double kAngle = 17.0 * std::numbers::pi / 180.0, kPeriod = 2.7, kBar = 1.2;  // pixels
  ClosedForm form;
  Scene& scene = form.scene;
  scene = scene_for(model, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, kSide, kSide, 0.05);
  scene.effects.antialias = true;
  const double pitch = pixel_of(scene.camera), cosine = std::cos(kAngle), sine = std::sin(kAngle);
  const std::uint32_t black = add_black(scene);
  constexpr int kBars = 10;  // on either side: beyond the corners of the picture
  for (int k = -kBars; k <= kBars; ++k) {
    const auto corner = [&](double across, double along) {
      return glm::vec3(
          glm::dvec3(pitch * (across * cosine - along * sine), pitch * (across * sine + along * cosine), 0.0));
    };
    const double from = k * kPeriod + 0.1, to = from + kBar;
    add_quad(scene, {corner(from, -40.0), corner(to, -40.0), corner(to, 40.0), corner(from, 40.0)}, black);
  }
  Profile& profile = form.profile;
  profile.width = profile.height = kSide;
  // Of a pixel's centre, across the bars.
  const auto across_of = [&](int column, int row) {
    return (column - 0.5 * (kSide - 1)) * cosine + (0.5 * (kSide - 1) - row) * sine;
  };
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const double across = across_of(column, row);
      double black_part = 0.0;
      for (int k = -kBars; k <= kBars; ++k) {
        const double from = k * kPeriod + 0.1 - across;
        black_part += square_below(cosine, sine, from + kBar) - square_below(cosine, sine, from);
      }
      profile.pixels.push_back(SampleMoments::chance(1.0 - black_part));
    }
  gather_evenly(profile, kPoints, [&](int column, int row) {
    const double periods = (across_of(column, row) - 0.1) / kPeriod;
    return (periods - std::floor(periods)) * kPeriod;
  });
  return form;
}

/// Black stripes on the ground that run to the horizon: from one in several pixels to hundreds in one.
ClosedForm far_stripes(Effects::Model model) {
  constexpr int kWidth = 8, kHeight = 24, kStripes = 400;
  ClosedForm form;
  Scene& scene = form.scene;
  scene = scene_for(model, {0, 0, 1}, {0, 4, 0.125f}, {0, 0, 1}, kWidth, kHeight, 0.02);
  scene.effects.antialias = true;
  const std::uint32_t black = add_black(scene);
  const auto near_end = [](int k) { return 2.0f + static_cast<float>(k); };
  constexpr float kStripe = 0.375f;
  for (int k = 0; k < kStripes; ++k) {
    const float near_y = near_end(k), far_y = near_y + kStripe;
    add_quad(scene, {glm::vec3{-50, near_y, 0}, {50, near_y, 0}, {50, far_y, 0}, {-50, far_y, 0}}, black);
  }
  // The view is tilted down by `tilt`. A place of the ground at distance y stands at tan(tilt - atan(1 / y)) above the
  // middle of the picture, on the plane at distance 1, whatever its x.
  const double pitch = pixel_of(scene.camera), tilt = std::atan(0.875 / 4.0);
  const auto height_of = [&](float y) { return std::tan(tilt - std::atan(1.0 / static_cast<double>(y))); };
  Profile& profile = form.profile;
  profile.width = kWidth, profile.height = kHeight;
  for (int row = 0; row < kHeight; ++row) {
    const double middle = pitch * (0.5 * (kHeight - 1) - row), low = middle - 0.5 * pitch, high = middle + 0.5 * pitch;
    double covered = 0.0;
    for (int k = 0; k < kStripes; ++k)
      covered +=
          std::max(0.0, std::min(high, height_of(near_end(k) + kStripe)) - std::max(low, height_of(near_end(k))));
    for (int column = 0; column < kWidth; ++column) {
      profile.pixels.push_back(SampleMoments::chance(1.0 - covered / pitch));
      profile.point_of.push_back(static_cast<std::uint32_t>(row));
    }
    profile.place.push_back(row);
  }
  return form;
}

/// A black bar that moves along x at constant speed, longer than the shutter is open.
ClosedForm moving_bar(Effects::Model model, double size) {
  constexpr int kWidth = 24, kHeight = 4;
  constexpr double kOpen = 0.5, kTime = 2.0, kBar = 0.34, kSpeed = 0.75;  // seconds, lengths per second
  ClosedForm form;
  form.time = kTime;
  Scene& scene = form.scene;
  scene = scene_for(model, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, kWidth, kHeight, 0.0625);
  scene.effects.motion_blur = true;
  scene.camera.shutter_open = static_cast<float>(kOpen);
  scene.camera.shutter_close = static_cast<float>(kOpen + size);
  const auto half = static_cast<float>(0.5 * kBar);
  add_quad(scene, {glm::vec3{-half, -2, 0}, {half, -2, 0}, {half, 2, 0}, {-half, 2, 0}}, add_black(scene));
  scene.parts.push_back({"bar", 0, 2, 0, 0});
  scene.nodes.push_back({"bar", kNone, 0, {}, {}});
  // Its middle is at `start` when the shutter opens.
  const double start = -0.36, before = 0.5, after = 1.5;
  Animation animation;
  animation.node = 0;
  animation.translation = {{kTime + kOpen - before, {start - kSpeed * before, 0, 0}},
                           {kTime + kOpen + after, {start + kSpeed * after, 0, 0}}};
  scene.animation.push_back(animation);

  const double pitch = pixel_of(scene.camera);
  const double shutter =
      static_cast<double>(scene.camera.shutter_close) - static_cast<double>(scene.camera.shutter_open);
  Profile& profile = form.profile;
  profile.width = kWidth, profile.height = kHeight;
  for (int column = 0; column < kWidth; ++column) {
    const double x = pitch * (column - 0.5 * (kWidth - 1));
    profile.place.push_back(x);
    // Covered while |x - start - speed shutter w| <= bar / 2.
    const double middle = (x - start) / (kSpeed * shutter), reach = 0.5 * kBar / (kSpeed * shutter);
    profile.exposed.push_back({std::clamp(middle - reach, 0.0, 1.0), std::clamp(middle + reach, 0.0, 1.0)});
  }
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const Profile::Interval& w = profile.exposed[static_cast<std::size_t>(column)];
      profile.pixels.push_back(SampleMoments::chance(1.0 - (w.to - w.from)));
      profile.point_of.push_back(static_cast<std::uint32_t>(column));
    }
  return form;
}

}  // namespace

double square_below(double cosine, double sine, double t) {
  // x cos + y sin is a sum of two independent uniform numbers, of widths p <= q: its distribution is a trapezoid's.
  const double a = std::fabs(cosine), b = std::fabs(sine), p = std::min(a, b), q = std::max(a, b);
  const double half = 0.5 * (p + q), flat = 0.5 * (q - p);
  if (t <= -half) return 0.0;
  if (t >= half) return 1.0;
  if (t < -flat) return (t + half) * (t + half) / (2.0 * p * q);
  if (t > flat) return 1.0 - (half - t) * (half - t) / (2.0 * p * q);
  return 0.5 + t / q;
}

std::vector<ClosedFormInfo> antialias_forms() {
  std::vector<ClosedFormInfo> forms;
  for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
    forms.push_back({"aa", "7", "slanted_bars", model, "", "place across the bars (pixels)",
                     "A pixel is as dark as the part of it that slanted bars cover: its samples are uniform in it.",
                     [model](double) { return slanted_bars(model); }});
    forms.push_back({"aa", "7", "far_stripes", model, "", "row of the picture (0: the horizon)",
                     "Stripes that run to the horizon, hundreds in a pixel, have the right mean: no aliasing bias.",
                     [model](double) { return far_stripes(model); }});
  }
  return forms;
}

std::vector<ClosedFormInfo> motion_blur_forms() {
  std::vector<ClosedFormInfo> forms;
  for (const auto model : {Effects::Model::paper, Effects::Model::physical})
    forms.push_back({"motion_blur", "6", "moving_bar", model, "shutter's duration", "place along the way (lengths)",
                     "A bar at constant speed covers each place for its exact share of the shutter's time.",
                     [model](double size) { return moving_bar(model, size); }});
  return forms;
}

}  // namespace plumbline
