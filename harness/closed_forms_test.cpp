// SPDX-License-Identifier: GPL-3.0-or-later
// The closed forms against simpler ones, against sums that must be 1, and against plain sampling of their definitions.
#include "harness/closed_forms.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "harness/closed_form_cases.h"
#include "harness/quadrature.h"
#include "scenes/camera.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr auto kPaper = Effects::Model::paper, kPhysical = Effects::Model::physical;

/// Uniform in the ball or cube of half-side 1, by rejection: not the way of either renderer.
glm::dvec3 in_body(Effects::Model model, Random& random) {
  for (;;) {
    const glm::dvec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (model == kPaper || glm::dot(p, p) < 1.0) return p;
  }
}

/// Whether a mean of n samples is within 4.5 standard errors of what is expected: a right one is not once in 150,000.
bool agrees(double mean, double variance, double n, double expected) {
  return std::fabs(mean - expected) <= 4.5 * std::sqrt(variance / n);
}

}  // namespace

TEST_CASE("Light over an edge: shares are those of a cap and of a cube cut by a plane") {
  for (const double x : {-0.9, -0.2, 0.0, 0.4, 1.05}) {
    CAPTURE(x);
    // The plane through (x, y, 0) and the edge x = 0.1 at height 2 is s from the centre (0, 0, 4).
    const double s = (2.0 * x - (x - 0.1) * 4.0) / std::hypot(2.0, x - 0.1);
    const double cap = s <= -1.0 ? 0.0 : s >= 1.0 ? 1.0 : 0.5 + 0.75 * s - 0.25 * s * s * s;
    CHECK(light_over_half_plane(kPhysical, {0, 0, 4}, 1.0, 0.1, 2.0, x, 0.7)[0] == Approx(cap).margin(1e-12));
    // Of the cube, seen at z, what is left of the plane; for |x| < 0.4 it cuts top and bottom, so the mean is linear.
    if (std::fabs(x) <= 0.4)
      CHECK(light_over_half_plane(kPaper, {0, 0, 4}, 1.0, 0.1, 2.0, x, 0.7)[0] ==
            Approx(0.5 + 0.5 * (0.2 - x)).margin(1e-12));
  }
}

TEST_CASE("Light over a disc: on the axis, without a disc, and to 1e-9") {
  // On the axis the disc hides the cone r < k z, k = radius / height. A circle of radius r at height z adds 2 pi z
  // (sqrt(z^2 + r^2) - z) of the cosine.
  const auto on_axis = [](double k, bool weighted) {
    const auto inner = [&](double z, double r) {
      return weighted ? 2.0 * kPi * z * (std::sqrt(z * z + r * r) - z) : kPi * r * r;
    };
    const auto slice = [&](double z) {
      const double widest = std::sqrt(std::max(0.0, 1.0 - (z - 4.0) * (z - 4.0)));
      return inner(z, widest) - inner(z, std::min(widest, k * z));
    };
    return integrate_pieces(slice, 3.0, 5.0, quadratic_roots(1.0 + k * k, -8.0, 15.0)) / (4.0 / 3.0 * kPi);
  };
  for (const double radius : {0.1, 0.3, 0.49, 0.8}) {
    CAPTURE(radius);
    const LightMoments m = light_over_disc(kPhysical, 4.0, 1.0, radius, 2.0, 0.0, 0.0);
    CHECK(m[0] == Approx(on_axis(0.5 * radius, false)).margin(1e-9));
    CHECK(m[1] == Approx(on_axis(0.5 * radius, true)).margin(1e-9));
  }
  for (const auto model : {kPaper, kPhysical}) {
    // A disc far smaller than 1e-9 of the light, against an edge far away: the other integrator.
    const LightMoments disc = light_over_disc(model, 4.0, 1.0, 1e-6, 2.0, 0.6, -0.3);
    const LightMoments plane = light_over_half_plane(model, {0, 0, 4}, 1.0, 100.0, 2.0, 0.6, -0.3);
    for (std::size_t power = 0; power < 3; ++power) CHECK(disc[power] == Approx(plane[power]).margin(1e-9));
    CHECK(disc[3] == Approx(plane[3]).margin(1e-5));
    for (const glm::dvec2 p : {glm::dvec2{0.3, 0.7}, {1.1, 0.2}, {0.4, 0.4}, {1.3, 1.2}}) {
      CAPTURE(p.x, p.y);
      const LightMoments m = light_over_disc(model, 4.0, 1.0, 0.8, 2.0, p.x, p.y);
      const LightMoments fine = light_over_disc(model, 4.0, 1.0, 0.8, 2.0, p.x, p.y, 1e-12);
      for (std::size_t power = 0; power < 3; ++power) CHECK(m[power] == Approx(fine[power]).margin(1e-9));
    }
  }
}

TEST_CASE("Lights are seen as often as rays to random points of them pass") {
  constexpr int kSamples = 100'000;
  for (const auto model : {kPaper, kPhysical})
    for (const glm::dvec2 p : {glm::dvec2{0.3, 0.7}, {-0.6, -1.1}, {1.0, 0.2}}) {
      CAPTURE(model == kPaper, p.x, p.y);
      Random random(1, name_hash("light"), 0);
      double plane = 0.0, disc = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        const glm::dvec3 q = glm::dvec3(0, 0, 4) + in_body(model, random), from(p, 0.0);
        const glm::dvec3 at = from + 2.0 / q.z * (q - from);
        const double cosine = q.z / glm::length(q - from);
        plane += at.x < 0.1 ? cosine : 0.0;
        disc += std::hypot(at.x, at.y) > 0.5 ? cosine : 0.0;
      }
      const auto check = [&](double sum, const LightMoments& m) {
        CHECK(agrees(sum / kSamples, m[2] - m[1] * m[1], kSamples, m[1]));
      };
      check(plane, light_over_half_plane(model, {0, 0, 4}, 1.0, 0.1, 2.0, p.x, p.y));
      check(disc, light_over_disc(model, 4.0, 1.0, 0.5, 2.0, p.x, p.y));
    }
}

TEST_CASE("Glossy lobes: shares of a step and of its other side make 1, and plain sampling agrees") {
  constexpr int kSamples = 100'000;
  const glm::dvec3 views[] = {{0.1, -0.05, -1.0}, {0.8, 0.1, -0.15}};
  const glm::dvec3 steps[] = {{1, 0, -0.15}, {-0.3, 0, 1}, {0.2, 1, -0.4}};
  for (const auto model : {kPaper, kPhysical})
    for (const glm::dvec3& view : views) {
      const glm::dvec3 d = glm::normalize(view);
      for (const glm::dvec3& u : steps) {
        CAPTURE(model == kPaper, d.z, u.x, u.z);
        const double share = glossy_share(model, 0.25, d, u);
        CHECK(share + glossy_share(model, 0.25, d, -u) == Approx(1.0).margin(1e-8));
        Random random(1, name_hash("glossy"), 0);
        double beyond = 0.0;
        for (int i = 0; i < kSamples; ++i) {
          const glm::dvec3 n = glm::normalize(glm::dvec3(0, 0, 1) + 0.25 * in_body(model, random));
          glm::dvec3 r = d - 2.0 * glm::dot(d, n) * n;
          r.z = std::fabs(r.z);
          beyond += glm::dot(u, r) > 0.0;
        }
        CHECK(agrees(beyond / kSamples, share * (1.0 - share), kSamples, share));
      }
      CHECK(glossy_share(model, 0.25, d, {0, 0, 1}) == Approx(1.0).margin(1e-8));
    }
}

TEST_CASE("At the grazing angle of its scene a good part of a lobe points below the mirror") {
  for (const auto model : {kPaper, kPhysical}) {
    Random random(1, name_hash("below"), 0);
    const glm::dvec3 d = glm::normalize(glm::dvec3(1.5, 0, -0.3));
    int below = 0;
    for (int i = 0; i < 10'000; ++i) {
      const glm::dvec3 n = glm::normalize(glm::dvec3(0, 0, 1) + 0.3 * in_body(model, random));
      below += d.z - 2.0 * glm::dot(d, n) * n.z < 0.0;
    }
    CHECK(below > 1000);
  }
}

TEST_CASE("Lens and pixel: areas cut by a line") {
  CHECK(square_below(1.0, 0.0, 0.2) == 0.7);
  CHECK(square_below(std::sqrt(0.5), std::sqrt(0.5), 0.0) == Approx(0.5).margin(1e-15));
  // The corner above x + y = 0.75 is a triangle of side 0.25.
  CHECK(1.0 - square_below(std::sqrt(0.5), std::sqrt(0.5), 0.75 * std::sqrt(0.5)) ==
        Approx(0.5 * 0.25 * 0.25).margin(1e-15));
  CHECK(lens_share(kPaper, 0.2, 0.0, 0.1) == Approx(0.25).margin(1e-15));
  CHECK(lens_share(kPaper, -0.2, 0.0, 0.1) == Approx(0.25).margin(1e-15));
  CHECK(lens_share(kPaper, 0.0, 0.0, -0.1) == 1.0);
  CHECK(lens_share(kPaper, 0.2, 0.1, 0.0) == Approx(0.5).margin(1e-15));
  CHECK(lens_share(kPhysical, 0.2, 9.0, 0.2) == 0.0);
  CHECK(lens_share(kPhysical, 0.2, 9.0, 0.0) == Approx(0.5).margin(1e-15));
  CHECK(lens_share(kPhysical, -1.0, 0.0, 0.5) == Approx(1.0 / 3.0 - std::sqrt(3.0) / (4.0 * kPi)).margin(1e-12));
}

TEST_CASE("The float angle of a camera gives the pixel that the forms reckon with") {
  for (const ClosedFormInfo& info : closed_forms()) {
    if (info.model == kPhysical || info.effect == "soft_shadow" || info.effect == "glossy") continue;
    const ClosedForm form = info.make(1.0);
    CHECK(pixel_of(form.scene.camera) == Approx(camera_frame(form.scene.camera).pixel).epsilon(1e-14));
    const Profile& p = form.profile;
    CHECK(p.pixels.size() == static_cast<std::size_t>(form.scene.camera.width * form.scene.camera.height));
    CHECK(p.point_of.size() == p.pixels.size());
    CHECK(std::is_sorted(p.place.begin(), p.place.end()));
    for (const SampleMoments& m : p.pixels) CHECK((m.mean >= 0.0 && m.mean <= 1.0 && m.variance >= 0.0));
  }
}

TEST_CASE("Each effect has closed forms under both models, with names of their own") {
  std::set<std::string> names, kinds;
  for (const ClosedFormInfo& info : closed_forms()) {
    CHECK(names.insert(info.name()).second);
    kinds.insert(info.effect + (info.model == kPaper ? " paper" : " physical"));
  }
  CHECK(kinds.size() == 10);
  CHECK(names.count("drt.closed_form.soft_shadow.disc_antumbra.physical") == 1);
}
