// SPDX-License-Identifier: GPL-3.0-or-later
// The tests of profiles, on pictures that are drawn from known chances: how often they cry wolf, and what they see.
#include "harness/profile.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "harness/distributions.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr int kPoints = 12, kRows = 4;

/// A profile whose chances rise from a rare event to a sure one.
Profile ramp() {
  Profile profile;
  profile.width = kPoints, profile.height = kRows;
  for (int i = 0; i < kPoints; ++i) profile.place.push_back(i);
  for (int row = 0; row < kRows; ++row)
    for (int i = 0; i < kPoints; ++i) {
      const double p = i == 0 ? 0.0 : i == 1 ? 0.001 : i == kPoints - 1 ? 1.0 : 0.09 * i;
      profile.pixels.push_back(SampleMoments::chance(p));
      profile.point_of.push_back(static_cast<std::uint32_t>(i));
      profile.slope.push_back(p > 0.0 && p < 1.0 ? 0.1 : 0.0);
    }
  return profile;
}

/// Independent samples of chances that are `shift` larger than the profile says.
PictureMoments drawn(const Profile& profile, std::uint32_t frames, double shift, std::uint64_t seed) {
  PictureMoments picture{profile.width, profile.height, frames, {}, {}};
  for (std::size_t i = 0; i < profile.pixels.size(); ++i) {
    const SampleMoments& sample = profile.pixels[i];
    Random random(seed, name_hash("drawn"), i);
    std::uint32_t ones = 0;
    const double chance = sample.variance > 0.0 ? sample.mean + shift : sample.mean;
    for (std::uint32_t frame = 0; frame < frames; ++frame) ones += random.uniform() < chance;
    const double mean = static_cast<double>(ones) / frames;
    picture.mean.emplace_back(mean);
    picture.variance.emplace_back(mean * (1.0 - mean) * frames / (frames - 1.0));
  }
  return picture;
}

/// The distribution of a profile's sum of squares at what was found: uniform. (Its two-sided p-value would hide a wrong
/// size of the standard errors.)
double share_below(const ProfileResult& r) {
  return boost::math::cdf(boost::math::chi_squared(r.degrees), r.chi_square);
}

}  // namespace

TEST_CASE("Profiles of right renderers give statistics that are distributed as they should, and no alarm") {
  const Profile profile = ramp();
  std::vector<double> chi_square, common;
  double least = 1.0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const ProfileResult r = judge_profile(profile, drawn(profile, 300, 0.0, seed));
    REQUIRE(r.passed(kCaseLevel));
    CHECK(r.sure_pixels == 2 * kRows);
    CHECK(r.points.size() == kPoints - 3);  // two are sure, the rare one is joined
    chi_square.push_back(share_below(r)), common.push_back(boost::math::cdf(boost::math::normal(), r.common_z));
    least = std::min(least, r.p_worst);
  }
  CHECK(test_uniform(chi_square).kolmogorov_p > 1e-3);
  CHECK(test_uniform(common).kolmogorov_p > 1e-3);
  // The worst of 400 at 400 times its p: between once and a hundred times what is expected.
  CHECK(least > 0.01 / 400);
  CHECK(least < 10.0 / 400);
}

TEST_CASE("The bias that a profile says it would see is seen") {
  const Profile profile = ramp();
  const ProfileResult right = judge_profile(profile, drawn(profile, 2000, 0.0, 1));
  REQUIRE(right.detectable_size > 0.0);
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    seen += !judge_profile(profile, drawn(profile, 2000, 0.1 * right.detectable_size, 100 + seed)).passed(kCaseLevel);
  CHECK(seen >= 192);  // of 200 with a chance of at least 0.99 each: fewer once in 2,000 times
  // And it is no idle statement: a third of it is seldom seen.
  seen = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    seen += !judge_profile(profile, drawn(profile, 2000, 0.03 * right.detectable_size, seed)).passed(kCaseLevel);
  CHECK(seen < 10);
}

TEST_CASE("What no samples can give fails whatever the number of samples") {
  const Profile profile = ramp();
  const PictureMoments right = drawn(profile, 300, 0.0, 3);
  const auto wrong_of = [&](auto change) {
    PictureMoments picture = right;
    change(picture);
    const ProfileResult r = judge_profile(profile, picture);
    CHECK(r.passed(kCaseLevel) == (r.wrong_pixels == 0));
    return r.wrong_pixels;
  };
  CHECK(wrong_of([](PictureMoments&) {}) == 0);
  CHECK(wrong_of([](PictureMoments& p) { p.mean[0] = glm::dvec3(1e-5); }) == 1);  // sure
  CHECK(wrong_of([](PictureMoments& p) { p.mean[5].b += 1e-5; }) == 1);           // white is not white
  CHECK(wrong_of([](PictureMoments& p) { p.variance[5] *= 1.001; }) == 1);        // another variance than of 0 and 1
  CHECK(wrong_of([](PictureMoments& p) { p.variance[5].g = NAN; }) == 1);
  CHECK(wrong_of([](PictureMoments& p) { p.mean[5] = glm::dvec3(NAN); }) == 1);
  CHECK(wrong_of([](PictureMoments& p) {
          for (glm::dvec3& m : p.mean) m = glm::round(255.0 * m) / 255.0;
        }) > 10);
}

TEST_CASE("Samples that are the same in all pixels, or more even than chance, are found by the sum of squares") {
  const Profile profile = ramp();
  PictureMoments even = drawn(profile, 300, 0.0, 4);
  for (std::size_t i = 0; i < profile.pixels.size(); ++i) {
    even.mean[i] = glm::dvec3(profile.pixels[i].mean);
    even.variance[i] = even.mean[i] * (1.0 - even.mean[i]) * (300.0 / 299.0);
  }
  // Rows that repeat each other: as if a quarter of the samples had been taken.
  std::vector<double> p;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    PictureMoments picture = drawn(profile, 300, 0.0, 50 + seed);
    for (std::size_t i = 0; i < profile.pixels.size(); ++i) {
      picture.mean[i] = picture.mean[i % kPoints];
      picture.variance[i] = picture.variance[i % kPoints];
    }
    p.push_back(judge_profile(profile, picture).p_chi_square);
  }
  std::sort(p.begin(), p.end());
  CHECK(p[10] < 1e-4);
  CHECK(judge_profile(profile, even).p_chi_square < 1e-9);
}

TEST_CASE("Frames that share their time are judged by their number, with the covariances of intervals") {
  Profile profile;
  profile.width = kPoints, profile.height = 2;
  for (int i = 0; i < kPoints; ++i) {
    profile.place.push_back(i);
    profile.exposed.push_back({std::max(0.0, 0.09 * i - 0.2), std::min(1.0, 0.09 * i + 0.15)});
  }
  for (std::uint32_t i = 0; i < 2 * kPoints; ++i) {
    const Profile::Interval& w = profile.exposed[i % kPoints];
    profile.pixels.push_back(SampleMoments::chance(1.0 - (w.to - w.from)));
    profile.point_of.push_back(i % kPoints);
  }
  const auto film = [&](std::uint64_t seed, double length) {
    constexpr std::uint32_t kFrames = 400;
    PictureMoments picture{kPoints, 2, kFrames, std::vector<glm::dvec3>(2 * kPoints), {}};
    Random random(seed, name_hash("film"), 0);
    for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
      const double w = length * random.uniform();
      for (std::size_t i = 0; i < 2 * kPoints; ++i) {
        const Profile::Interval& interval = profile.exposed[i % kPoints];
        picture.mean[i] += glm::dvec3((w < interval.from || w >= interval.to) / 400.0);
      }
    }
    for (const glm::dvec3& m : picture.mean) picture.variance.push_back(m * (1.0 - m) * (400.0 / 399.0));
    return picture;
  };
  std::vector<double> chi_square;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const ProfileResult r = judge_profile(profile, film(seed, 1.0));
    REQUIRE(r.passed(kCaseLevel));
    chi_square.push_back(share_below(r));
  }
  CHECK(test_uniform(chi_square).kolmogorov_p > 1e-3);
  CHECK_FALSE(judge_profile(profile, film(1, 0.8)).passed(kCaseLevel));
}

TEST_CASE("Where pixels depend on each other each is judged by its own frames") {
  const Profile profile = ramp();
  const ProfileResult r = judge_profile(profile, drawn(profile, 2000, 0.0, 9), false);
  CHECK(r.passed(kCaseLevel));
  CHECK(r.points.size() == kRows * (kPoints - 3));  // a rare event has too few of its own
  CHECK(r.degrees == 0.0);
  CHECK_FALSE(judge_profile(profile, drawn(profile, 2000, 0.1, 9), false).passed(kCaseLevel));
}
