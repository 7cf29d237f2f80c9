// SPDX-License-Identifier: GPL-3.0-or-later
// That the closed forms can fail: renderers broken on purpose, each found at the number of samples that a run takes by
// default, with a seed that was not chosen for it.
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>

#include "harness/closed_form_cases.h"
#include "harness/distributions.h"

using namespace plumbline;

namespace {

constexpr std::uint64_t kSamples = 1 << 14;  ///< of each point: the default of a run
constexpr auto kPaper = Effects::Model::paper, kPhysical = Effects::Model::physical;

/// The renderer's own numbers, or what a fault makes of them.
class FaultySource final : public RandomSource {
 public:
  std::function<Draw(Draw)> asked = [](Draw draw) { return draw; };
  std::function<double(std::uint32_t dimension, double)> number = [](std::uint32_t, double u) { return u; };
  std::function<double(double)> of_time = [](double w) { return w; };

  explicit FaultySource(std::uint64_t seed) : own_(seed) {}
  void fill(const Draw& first, std::span<double> numbers) const override {
    own_.fill(asked(first), numbers);
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = number(first.dimension + i, numbers[i]);
  }
  double time(std::uint32_t frame) const override { return of_time(own_.time(frame)); }

 private:
  PhiloxSource own_;
};

/// One place that is changed: in what is rendered, or in its numbers.
struct Broken {
  std::function<void(Scene&)> scene = [](Scene&) {};
  std::function<void(FaultySource&)> numbers = [](FaultySource&) {};
};

const ClosedFormInfo& form_of(const std::string& effect, const std::string& scene, Effects::Model model) {
  static const std::vector<ClosedFormInfo> all = closed_forms();
  for (const ClosedFormInfo& info : all)
    if (info.effect == effect && info.scene == scene && info.model == model) return info;
  throw std::runtime_error("no closed form " + effect + "." + scene);
}

/// Forms are integrals: each is made once.
const ClosedForm& made(const ClosedFormInfo& info) {
  static std::map<std::string, ClosedForm> known;
  const auto [at, is_new] = known.try_emplace(info.name());
  if (is_new) at->second = info.make(1.0);
  return at->second;
}

/// What a broken renderer's profile is worth.
ProfileResult examined(const ClosedFormInfo& info, const Broken& broken, std::uint64_t seed,
                       std::uint64_t samples = kSamples) {
  const ClosedForm& form = made(info);
  ClosedForm rendered = form;
  broken.scene(rendered.scene);
  FaultySource numbers(seed);
  broken.numbers(numbers);
  const PictureSource source{"broken", [&](const Scene& scene, const PictureSettings& settings) {
                               ReferenceSettings own;
                               own.effects = settings.effects;
                               own.time = settings.time;
                               return reference_engine(scene, own, &numbers);
                             }};
  return judge_profile(form.profile, render_profile(rendered, source, seed, frames_for(form.profile, samples)));
}

constexpr std::uint64_t kSeeds[] = {11, 12};

/// Found under each seed; the right renderer passes under the same (the test below).
void check_found(const ClosedFormInfo& info, const Broken& broken) {
  for (const std::uint64_t seed : kSeeds) {
    CAPTURE(info.name(), seed);
    CHECK_FALSE(examined(info, broken, seed).passed(kCaseLevel));
  }
}

Broken in_scene(std::function<void(Scene&)> change) {
  return {std::move(change), [](FaultySource&) {}};
}
Broken in_numbers(std::function<void(FaultySource&)> change) {
  return {[](Scene&) {}, std::move(change)};
}

}  // namespace

TEST_CASE("The right renderer passes under the seeds that find the broken ones") {
  for (const ClosedFormInfo& info : closed_forms()) {
    if (info.scene.starts_with("disc") || info.scene == "grazing") continue;  // integrals of seconds; see the cases
    for (const std::uint64_t seed : kSeeds) {
      CAPTURE(info.name(), seed);
      CHECK(examined(info, {}, seed).passed(kCaseLevel));
    }
  }
}

TEST_CASE("The right renderer's statistics over many seeds are distributed as they should") {
  std::vector<double> chi_square, common;
  for (const ClosedFormInfo* info :
       {&form_of("soft_shadow", "half_plane", kPhysical), &form_of("dof", "edge_far", kPaper),
        &form_of("glossy", "step", kPaper), &form_of("aa", "slanted_bars", kPaper)})
    for (std::uint64_t seed = 100; seed < 150; ++seed) {
      const ProfileResult r = examined(*info, {}, seed, 1 << 11);
      CHECK(r.passed(kCaseLevel));
      chi_square.push_back(boost::math::cdf(boost::math::chi_squared(r.degrees), r.chi_square));
      common.push_back(boost::math::cdf(boost::math::normal(), r.common_z));
    }
  for (const std::vector<double>& p : {chi_square, common}) {
    const UniformTest spread = test_uniform(p);
    CHECK(spread.kolmogorov_p > 1e-3);
    CHECK(spread.anderson_p > 1e-3);
  }
}

TEST_CASE("Found: a light's radius off by 3 %") {
  for (const float factor : {0.97f, 1.03f})
    for (const auto model : {kPaper, kPhysical})
      check_found(form_of("soft_shadow", "half_plane", model),
                  in_scene([=](Scene& scene) { scene.lights[0].radius *= factor; }));
}

TEST_CASE("Found: an aperture off by 3 %") {
  for (const float factor : {0.97f, 1.03f})
    for (const auto model : {kPaper, kPhysical})
      for (const char* const scene : {"edge_before", "edge_far"})
        check_found(form_of("dof", scene, model), in_scene([=](Scene& s) { s.camera.aperture *= factor; }));
}

TEST_CASE("Found: a glossiness off by 5 %") {
  for (const float factor : {0.95f, 1.05f})
    for (const auto model : {kPaper, kPhysical})
      check_found(form_of("glossy", "step", model), in_scene([=](Scene& s) { s.effects.glossy *= factor; }));
}

TEST_CASE("Found: a cube for a ball or a disc") {
  const Broken cube = in_scene([](Scene& scene) { scene.effects.model = kPaper; });
  check_found(form_of("soft_shadow", "half_plane", kPhysical), cube);
  check_found(form_of("soft_shadow", "disc_antumbra", kPhysical), cube);
  check_found(form_of("glossy", "step", kPhysical), cube);
  check_found(form_of("dof", "edge_before", kPhysical), cube);
}

TEST_CASE("Found: the ball's surface for the ball") {
  const Broken surface = in_numbers([](FaultySource& numbers) {
    // The third number of a light or of a normal is the cube of the distance from the centre.
    numbers.number = [](std::uint32_t d, double u) { return d == 7 || d == 10 ? 1.0 - 0x1p-24 : u; };
  });
  check_found(form_of("soft_shadow", "half_plane", kPhysical), surface);
  check_found(form_of("glossy", "step", kPhysical), surface);
}

TEST_CASE("Found: a lens disc sampled by its radius, without the square root") {
  check_found(form_of("dof", "edge_before", kPhysical), in_numbers([](FaultySource& numbers) {
                numbers.number = [](std::uint32_t d, double u) { return d == 2 ? u * u : u; };
              }));
}

TEST_CASE("Found: a focus off by 2 %") {
  for (const auto model : {kPaper, kPhysical})
    check_found(form_of("dof", "edge_before", model), in_scene([](Scene& s) { s.camera.focus *= 1.02f; }));
  // An edge in focus is crossed by samples of no pixel, or of one that is known not to.
  const ProfileResult blurred =
      examined(form_of("dof", "edge_in_focus", kPhysical), in_scene([](Scene& s) { s.camera.focus *= 1.2f; }), 11);
  CHECK(blurred.wrong_pixels > 0);
}

TEST_CASE("Found: pixels shifted by a half") {
  for (const char* const scene : {"slanted_bars", "far_stripes"})
    for (const std::uint32_t axis : {0u, 1u}) {
      if (axis == 0 && std::string(scene) == "far_stripes") continue;  // the same in every column
      check_found(form_of("aa", scene, kPaper), in_numbers([=](FaultySource& numbers) {
                    numbers.number = [=](std::uint32_t d, double u) { return d == axis ? u - 0.5 : u; };
                  }));
    }
  // With a lens, without anti-aliasing: the camera's frame itself.
  check_found(form_of("dof", "edge_before", kPhysical), in_scene([](Scene& scene) {
                const auto shift =
                    static_cast<float>(0.5 * pixel_of(scene.camera) * 2.0);  // of a pixel where things are sharp
                scene.camera.from.x += shift, scene.camera.at.x += shift;
              }));
}

TEST_CASE("Found: places in a pixel that are not uniform") {
  check_found(form_of("aa", "slanted_bars", kPaper), in_numbers([](FaultySource& numbers) {
                // A tent for a box.
                numbers.number = [](std::uint32_t d, double u) {
                  return d == 0 ? (u < 0.5 ? std::sqrt(0.5 * u) : 1.0 - std::sqrt(0.5 * (1.0 - u))) : u;
                };
              }));
}

TEST_CASE("Found: a shutter that shows its first half alone, or lags") {
  const ClosedFormInfo& bar = form_of("motion_blur", "moving_bar", kPaper);
  check_found(bar, in_numbers([](FaultySource& numbers) { numbers.of_time = [](double w) { return 0.5 * w; }; }));
  check_found(bar,
              in_scene([](Scene& scene) { scene.camera.shutter_open -= 0.05f, scene.camera.shutter_close -= 0.05f; }));
  check_found(bar, in_scene([](Scene& scene) { scene.effects.motion_blur = false; }));
}

TEST_CASE("Found: shadow rays towards the light's centre") {
  const Broken centre = in_scene([](Scene& s) { s.effects.soft_shadows = false; });
  for (const auto model : {kPaper, kPhysical}) check_found(form_of("soft_shadow", "half_plane", model), centre);
  check_found(form_of("soft_shadow", "disc_antumbra", kPhysical), centre);
}

TEST_CASE("Found: noise that is not renewed, or the same in all pixels") {
  const Broken stale = in_numbers([](FaultySource& numbers) { numbers.asked = [](Draw d) { return d.frame = 0, d; }; });
  const Broken shared =
      in_numbers([](FaultySource& numbers) { numbers.asked = [](Draw d) { return d.x = d.y = 0, d; }; });
  check_found(form_of("aa", "slanted_bars", kPhysical), stale);
  check_found(form_of("soft_shadow", "half_plane", kPhysical), stale);
  check_found(form_of("dof", "edge_behind", kPaper), stale);
  check_found(form_of("glossy", "step", kPaper), stale);
  // The same noise in all pixels is one sample of each point taken 36 times; where one number decides all points
  // alike, as in a lens, chance may hide it, and tests of the densities must find it.
  check_found(form_of("aa", "slanted_bars", kPhysical), shared);
  check_found(form_of("soft_shadow", "half_plane", kPhysical), shared);
}

TEST_CASE("What a profile says it would see it sees: a light's radius, once and a half of that") {
  const ClosedFormInfo& info = form_of("soft_shadow", "half_plane", kPhysical);
  const ClosedForm form = with_slope(info);
  const PictureSource source{"reference", make_reference_engine};
  const double size = judge_profile(form.profile, render_profile(form, source, 1, 400)).detectable_size;
  CHECK((size > 0.005 && size < 0.05));
  for (const std::uint64_t seed : {21u, 22u, 23u, 24u, 25u}) {
    ClosedForm off = form;
    off.scene.lights[0].radius *= static_cast<float>(1.0 + 1.5 * size);
    CHECK_FALSE(judge_profile(form.profile, render_profile(off, source, seed, 400)).passed(kCaseLevel));
  }
}
