// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of engines whose distributions are known: the level is kept, each kind of fault is seen by the family that
// is there for it, and power is as it is said.
#include "harness/compare_pictures.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "harness/convergence.h"
#include "harness/distributions.h"
#include "harness/independent.h"
#include "harness/picture_faults.h"
#include "scenes/generate.h"
#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr int kWidth = 24, kHeight = 16;

/// Pixels that see a light with a probability that grows to the right; the top row has no noise, the next a rare bright
/// event. What is wrong with it is chosen by its members.
class CoinEngine final : public PictureEngine {
 public:
  explicit CoinEngine(std::uint64_t seed) : seed_(seed) {}
  double bias = 0.0;        ///< of the light that is seen, a share
  double flat_error = 0.0;  ///< of pixels without noise
  bool rare = true;         ///< the second row has its rare event
  bool dimmed = false;      ///< half as bright, twice as often: the right mean
  bool neighbours_share = false;
  bool common_light = false;  ///< a frame's light varies for all of its pixels together

  const std::string& name() const override { return name_; }
  PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) override {
    PictureMoments moments{kWidth, kHeight, frames, {}, {}};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        double sum = 0.0, squares = 0.0;
        for (std::uint32_t f = first_frame; f < first_frame + frames; ++f) {
          const double c = sample(neighbours_share ? x / 2 * 2 : x, y, f, x);
          sum += c, squares += c * c;
        }
        const double mean = sum / frames;
        moments.mean.emplace_back(mean, 0.5 * mean, 0.25);
        const double variance = frames > 1 ? std::max(0.0, squares - sum * mean) / (frames - 1.0) : 0.0;
        moments.variance.emplace_back(y == 0 ? 0.0 : variance, y == 0 ? 0.0 : 0.25 * variance, 0.0);
      }
    return moments;
  }

 private:
  double sample(int draw_x, int y, std::uint32_t frame, int x) const {
    if (y == 0) return 0.5 + flat_error;
    Random random(seed_, frame, static_cast<std::uint64_t>(y * kWidth + draw_x));
    double light = 1.0 + bias;
    if (common_light) light *= 0.5 + Random(seed_, frame, 1u << 20).uniform();
    if (y == 1 && rare) return random.uniform() < 1.0 / 512.0 ? 100.0 * light : 0.0;
    const double chance = 0.5 * (x + 1) / (kWidth + 1.0);
    if (dimmed) return random.uniform() < 2.0 * chance ? 0.5 * light : 0.0;
    return random.uniform() < chance ? light : 0.0;
  }
  const std::string name_ = "coins";
  const std::uint64_t seed_;
};

PictureComparison compare(CoinEngine tested, std::uint64_t seed, CompareOptions options = {}) {
  CoinEngine truth(mix64(seed) + 1);
  truth.common_light = tested.common_light;
  options.seed = seed;
  return compare_pictures(take_batches(tested, 64, 4), take_batches(truth, 64, 4), options);
}

const TestFamily& family_of(const PictureComparison& result, const std::string& name) {
  for (const TestFamily& family : result.families)
    if (family.name == name) return family;
  FAIL("no family " + name);
  return result.families.front();
}

}  // namespace

TEST_CASE("Engines that agree raise no alarm, and the p-values of repetitions are uniform", "[statistics]") {
  for (const bool common_light : {false, true}) {  // frames whose pixels depend on each other, too
    std::vector<double> whole;
    int low = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      CoinEngine tested(seed);
      tested.common_light = common_light;
      const PictureComparison result = compare(tested, seed);
      CHECK_FALSE(result.alarm());
      whole.push_back(result.whole_student_p);
      low += family_of(result, "spread of p-values").p <= 0.05;
    }
    CHECK(test_uniform(whole).kolmogorov_p > 1e-3);
    CHECK(test_uniform(whole).anderson_p > 1e-3);
    CHECK(low <= 9);  // of 40 at a level of 0.05: 10 or more come once in 10,000 times
  }
}

TEST_CASE("Each kind of fault is seen by the tests that are there for it", "[statistics]") {
  CoinEngine brighter(1);
  brighter.bias = 0.4;
  CHECK(family_of(compare(brighter, 2), "whole picture").alarm());

  CoinEngine flat(1);
  flat.flat_error = 1e-6;
  CHECK(family_of(compare(flat, 3), "pixels").alarm());
  CompareOptions allowing;
  allowing.rounding.assign(kWidth * kHeight, glm::dvec3(1.1e-6));
  CHECK_FALSE(compare(flat, 3, allowing).alarm());

  CoinEngine dimmed(1);
  dimmed.dimmed = true;
  CHECK(family_of(compare(dimmed, 4), "variances").alarm());
  CHECK_FALSE(family_of(compare(dimmed, 4), "whole picture").alarm());

  CoinEngine sharing(1);
  sharing.neighbours_share = true;
  CHECK(family_of(compare(sharing, 5), "neighbours").alarm());
  CompareOptions promising_less;
  promising_less.pixels_independent = false;
  CHECK_FALSE(compare(sharing, 5, promising_less).alarm());
}

TEST_CASE("A pixel that is not a number is an alarm", "[statistics]") {
  CoinEngine one(1), other(2);
  std::vector<PictureMoments> tested = take_batches(one, 16, 4), truth = take_batches(other, 16, 4);
  tested[3].mean[100].y = std::nan("");
  CHECK(compare_pictures(tested, truth, {}).alarm());
}

TEST_CASE("Errors of either sign, each too small for its pixel, are seen in the spread of the p-values",
          "[statistics]") {
  CoinEngine one(1), other(2);
  std::vector<PictureMoments> tested = take_batches(one, 64, 4), truth = take_batches(other, 64, 4);
  for (PictureMoments& batch : tested)  // by one and a half deviations of a pixel's mean difference, signs mixed
    for (std::size_t i = 2 * kWidth; i < batch.mean.size(); ++i) {
      const double chance = 0.5 * (i % kWidth + 1) / (kWidth + 1.0);
      const double off = 1.5 * std::sqrt(2.0 * chance * (1.0 - chance) / 256.0);
      batch.mean[i].x += mix64(i) % 2 == 0 ? off : -off;
      batch.mean[i].y += 0.5 * (mix64(i) % 2 == 0 ? off : -off);
    }
  const PictureComparison result = compare_pictures(tested, truth, {});
  CHECK_FALSE(family_of(result, "pixels").alarm());
  CHECK_FALSE(family_of(result, "whole picture").alarm());
  CHECK(family_of(result, "spread of p-values").alarm());
}

TEST_CASE("A bias of the size that is said is seen as often as is said", "[statistics]") {
  // The whole picture's detectable bias, probability 0.99: of 30 at most 3 are missed, else once in 5,000 times.
  int seen = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CoinEngine plain(seed);
    CompareOptions options;
    options.most_flips = 1;
    const PictureComparison right = compare(plain, seed, options);
    // Its share of noise in blue, which has none: red and green carry all of the bias that is asked.
    CoinEngine biased(seed + 100);
    double light = 0.0;
    for (int x = 0; x < kWidth; ++x) light += 0.5 * (x + 1) / (kWidth + 1.0) * (kHeight - 2) / (kWidth * kHeight);
    light += 100.0 / 512.0 / kHeight;
    const double brightness = (right.mean_truth.x + right.mean_truth.y + right.mean_truth.z) / 3.0;
    biased.bias = right.whole_detectable * brightness / (0.5 * light);
    seen += family_of(compare(biased, seed, options), "whole picture").alarm();
  }
  CHECK(seen >= 27);
}

TEST_CASE("Faults of the renderer are seen, the renderer itself is not", "[statistics]") {
  const Scene scene = with_effects(load_scene("soft_shadow"));
  const Effects effects = effects_of(scene, {"aa", "soft_shadow", "dof"}, Effects::Model::physical);
  Depth depth;
  depth.width = 32, depth.height = 24, depth.frames = 2;
  depth.most_flips = 200;
  CHECK_FALSE(compare_engines(scene, effects, depth, 8, make_reference_engine, make_reference_engine).alarm());
  for (const PictureFault& seeded : picture_faults()) {
    const PictureChange& fault = seeded.change;
    // Eight bits drown in the noise of pixels that have some; a sharp picture has others.
    const bool in_eight_bits = fault.name == "eight_bits";
    if (!in_eight_bits && fault.name != "half_pixel" && fault.name != "noise_kept" && fault.name != "light_centre")
      continue;
    INFO(fault.name);
    const auto faulty = [&](const Scene& s, const PictureSettings& settings) {
      return changed_engine(fault, s, settings);
    };
    const Effects asked = in_eight_bits ? effects_of(scene, {}, Effects::Model::physical) : effects;
    CHECK(compare_engines(scene, asked, depth, 9, faulty, make_reference_engine).alarm());
  }
}

TEST_CASE("The error falls as 1/N, and a bias bends it", "[statistics]") {
  const ConvergenceDepth depth{6, 32, 1024};
  int outside = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CoinEngine tested(seed), reference(seed + 1000), truth(seed + 2000);
    tested.rare = reference.rare = truth.rare = false;
    const Convergence found = measure_convergence(tested, reference, truth, depth);
    CHECK(found.p > 1e-3);
    CHECK(std::fabs(found.slope + 1.0) < 0.15);
    outside += std::fabs(found.slope + 1.0) > found.interval;
  }
  CHECK(outside <= 1);  // at 99 %: two or more come in 0.6 % of all times
  CoinEngine biased(5), reference(6), truth(7);
  biased.rare = reference.rare = truth.rare = false;
  biased.bias = 0.2;
  const Convergence bent = measure_convergence(biased, reference, truth, depth);
  CHECK(bent.slope > -1.0 + bent.interval);
  CHECK(bent.p < kCaseLevel);
}
