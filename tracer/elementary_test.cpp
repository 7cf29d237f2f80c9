// SPDX-License-Identifier: MIT
// elementary.glsl keeps the bounds that it states, on dense sets of arguments, against long double.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "scenes/random.h"
#include "tracer/small_pass.h"

using namespace plumbline;

namespace {

constexpr int kSide = 512;                       // of the passes, pixels
constexpr std::uint64_t kCount = kSide * kSide;  // arguments of a pass
constexpr long double kU = 0x1p-24L;             // the u of elementary.glsl
constexpr long double kHalfTurn = 3.14159265358979323846264338327950288L;

/// What the functions give for arguments (turn, of the cube root, of the power: x, y), or those that `question` asks.
std::vector<glm::vec4> values_for(const std::vector<glm::vec4>& arguments,
                                  std::string_view question = "driver_elementary.frag.glsl") {
  static GlContext context;
  const std::array<std::string_view, 3> files{"pass_constants.glsl", "elementary.glsl", question};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}};
  const std::vector<AnswerWords> words =
      run_small_pass(context, {.fragment = compose_shader(files, defines), .width = kSide, .height = kSide},
                     {kSide, kSide, arguments});
  std::vector<glm::vec4> values;
  for (const AnswerWords& w : words) values.push_back(std::bit_cast<glm::vec4>(w));
  return values;
}

std::vector<glm::vec4> arguments(const std::function<glm::vec4(Random&, std::uint64_t)>& made) {
  std::vector<glm::vec4> all;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    Random random(name_hash("elementary functions"), 0, i);
    all.push_back(made(random, i));
  }
  return all;
}

/// The truth of power() as elementary.glsl defines it.
long double true_power(long double x, long double y) { return y == 0.0L ? 1.0L : x == 0.0L ? 0.0L : std::pow(x, y); }

/// Its bound at x > 0.
long double power_bound(long double x, long double y) {
  return true_power(x, y) * (2.0L + 4.0L * y * std::abs(std::log(x))) * kU;
}

/// Errors as shares of their bounds: the largest, and where.
struct Worst {
  long double share = 0.0L;
  std::uint64_t beyond = 0;
  glm::vec4 at{0.0f};
  /// NaN counts as beyond.
  void take(long double error, long double bound, const glm::vec4& argument) {
    if (!(error <= bound)) ++beyond;
    if (!(error <= share * bound)) share = error / bound, at = argument;
  }
};

void check(const Worst& worst, long double least) {
  INFO("worst: " << static_cast<double>(worst.share) << " of the bound, at " << std::hexfloat << worst.at.x << " "
                 << worst.at.y << " " << worst.at.z << " " << worst.at.w);
  CHECK(worst.beyond == 0);
  CHECK(worst.share > least);  // a bound ten times too wide would say little
}

}  // namespace

TEST_CASE("cosine and sine of turns are within 2 units of 2^-24, and exact at quarters", "[elementary]") {
  // Every 64th multiple of 2^-24, shifted at random; near the borders of quarters and eighths each one.
  const auto asked = arguments([](Random& random, std::uint64_t i) {
    if (i < 8 * 1024) {
      const auto k = static_cast<std::int64_t>(((i / 1024) << 21) + i % 1024) - 512;
      return glm::vec4(static_cast<float>(k & 0xffffff) * 0x1p-24f, 0.0f, 0.0f, 0.0f);
    }
    return glm::vec4(static_cast<float>(64 * i + random.below(64)) * 0x1p-24f, 0.0f, 0.0f, 0.0f);
  });
  const auto got = values_for(asked);
  Worst cosine, sine;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const long double angle = 2.0L * kHalfTurn * static_cast<long double>(asked[i].x);
    cosine.take(std::abs(static_cast<long double>(got[i].x) - std::cos(angle)), 2.0L * kU, asked[i]);
    sine.take(std::abs(static_cast<long double>(got[i].y) - std::sin(angle)), 2.0L * kU, asked[i]);
    const float quarter = 4.0f * asked[i].x;
    if (quarter == std::floor(quarter)) {
      const int which = static_cast<int>(quarter);
      CHECK(got[i].x == (which == 0 ? 1.0f : which == 2 ? -1.0f : 0.0f));
      CHECK(got[i].y == (which == 1 ? 1.0f : which == 3 ? -1.0f : 0.0f));
    }
  }
  check(cosine, 0.2L);
  check(sine, 0.2L);
}

TEST_CASE("cube roots are within 2 units of 2^-24", "[elementary]") {
  // Multiples of 2^-24, as random numbers are; all magnitudes; 0 and 1.
  const auto asked = arguments([](Random& random, std::uint64_t i) {
    float x = static_cast<float>(64 * i + random.below(64)) * 0x1p-24f;
    if (i % 4 == 1) x = static_cast<float>(std::exp2(random.uniform(-100.0, 0.0)));
    if (i % 4 == 2) x = static_cast<float>(i) * 0x1p-24f;
    if (i == 0) x = 0.0f;
    if (i == 3) x = 1.0f;
    return glm::vec4(0.0f, x, 0.0f, 0.0f);
  });
  const auto got = values_for(asked);
  Worst worst;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const long double truth = std::cbrt(static_cast<long double>(asked[i].y));
    worst.take(std::abs(static_cast<long double>(got[i].z) - truth), 2.0L * kU * truth, asked[i]);
  }
  check(worst, 0.2L);
  CHECK(got[0].z == 0.0f);
  CHECK(got[3].z == 1.0f);
}

TEST_CASE("powers are within the bound that grows with the logarithm of the result alone", "[elementary]") {
  const auto asked = arguments([](Random& random, std::uint64_t i) {
    const double y = i % 3 == 0 ? random.uniform(0.0, 200.0) : std::exp2(random.uniform(-10.0, 20.0));
    double x = random.uniform();
    if (i % 4 == 1) x = 1.0 - std::exp2(random.uniform(-24.0, 0.0));  // highlights: near 1
    if (i % 4 == 2) x = std::exp2(random.uniform(-126.0, 0.0));
    if (i % 64 == 3) x = 1.0 + 0x1p-23 * random.below(9);
    return glm::vec4(0.0f, 0.0f, static_cast<float>(x), static_cast<float>(y));
  });
  const auto got = values_for(asked);
  Worst worst, absolute, vanishing;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const long double x = asked[i].z, y = asked[i].w;
    const long double truth = true_power(x, y), error = std::abs(static_cast<long double>(got[i].w) - truth);
    if (truth < 0x1p-125L) {
      vanishing.take(std::abs(static_cast<long double>(got[i].w)), 0x1p-125L, asked[i]);
      continue;
    }
    worst.take(error, power_bound(x, y), asked[i]);
    if (x <= 1.0L) absolute.take(error, 2.5L * kU, asked[i]);
  }
  check(worst, 0.2L);
  check(absolute, 0.2L);
  CHECK(vanishing.beyond == 0);
}

TEST_CASE("logarithms are within 3 units of themselves, powers of 2 within 2", "[elementary]") {
  const auto asked = arguments([](Random& random, std::uint64_t i) {
    double x = std::exp2(random.uniform(-126.0, 1.0));
    if (i % 4 == 1) x = random.uniform(0.5, 1.0 + 0x1p-20);
    if (i % 4 == 2) x = 1.0 - std::exp2(random.uniform(-24.0, -1.0));
    return glm::vec4(static_cast<float>(x), static_cast<float>(random.uniform(-126.0, 127.0)), 0.0f, 0.0f);
  });
  const auto got = values_for(asked, "ask_logarithms.frag.glsl");
  Worst logarithm, power;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const long double log = std::log2(static_cast<long double>(asked[i].x));
    const long double exp = std::exp2(static_cast<long double>(asked[i].y));
    logarithm.take(std::abs(static_cast<long double>(got[i].x) - log), 3.0L * kU * std::abs(log), asked[i]);
    power.take(std::abs(static_cast<long double>(got[i].y) - exp), 2.0L * kU * exp, asked[i]);
  }
  check(logarithm, 0.5L);
  check(power, 0.5L);
}

TEST_CASE("powers of 0 and of 1, and to the power of 0", "[elementary]") {
  const std::array<float, 8> bases{0.0f, 1.0f, 0.5f, 0x1p-126f, 1.0f - 0x1p-24f, 1.0f + 0x1p-20f, 0.25f, 0.9f};
  const std::array<float, 8> exponents{0.0f, 1.0f, 2.0f, 0.5f, 1e9f, 1e-9f, 3.4e38f, 0x1p-126f};
  const auto asked =
      arguments([&](Random&, std::uint64_t i) { return glm::vec4(0.0f, 0.0f, bases[i % 8], exponents[i / 8 % 8]); });
  const auto got = values_for(asked);
  for (std::size_t i = 0; i < 64; ++i) {
    const float x = asked[i].z, y = asked[i].w, v = got[i].w;
    INFO(x << " to the power of " << y << " is " << v);
    const long double truth = true_power(x, y);
    if (x == 0.0f) {
      CHECK(v == (y == 0.0f ? 1.0f : 0.0f));
    } else if (x == 1.0f || y == 0.0f) {
      CHECK(v == 1.0f);
    } else if (truth > 0x1p-125L && truth < 0x1p127L) {
      CHECK(std::abs(static_cast<long double>(v) - truth) <= power_bound(x, y));
    } else {
      CHECK((truth < 1.0L ? v <= 0x1p-125f : v >= 0x1p127f));
    }
  }
}
