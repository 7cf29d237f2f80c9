// SPDX-License-Identifier: MIT
// Outward rounding and exact signs, at the places where plain arithmetic gives the wrong answer.
#include "tracer/tree_rounding.h"

#include <array>
#include <catch2/catch.hpp>

#include "scenes/random.h"

namespace plumbline {
namespace {

__extension__ typedef __int128 Wide;

TEST_CASE("sums are rounded outwards to float, and exact sums not at all", "[tree]") {
  REQUIRE(sum_up(1.0, 2.0) == 3.0f);
  REQUIRE(sum_down(1.0, 2.0) == 3.0f);
  REQUIRE(sum_up(1.0, -1.0) == 0.0f);
  const float after_one = std::nextafter(1.0f, 2.0f), before_one = std::nextafter(1.0f, 0.0f);
  // The double sum is exactly 1: only the error term tells.
  REQUIRE(1.0 + 0x1p-60 == 1.0);
  REQUIRE(sum_up(1.0, 0x1p-60) == after_one);
  REQUIRE(sum_down(1.0, 0x1p-60) == 1.0f);
  REQUIRE(sum_up(1.0, -0x1p-60) == 1.0f);
  REQUIRE(sum_down(1.0, -0x1p-60) == before_one);
  REQUIRE(sum_up(0.0, 1e-300) == std::numeric_limits<float>::denorm_min());
  REQUIRE(std::isinf(sum_up(3.4028234663852886e38, 1e30)));
}

TEST_CASE("the sign of a sum is exact where double gives zero or the wrong sign", "[tree]") {
  REQUIRE(exact_sign({}) == 0);
  const std::array<double, 3> cancels{1e200, 1.0, -1e200};
  REQUIRE((cancels[0] + cancels[1]) + cancels[2] == 0.0);
  REQUIRE(exact_sign(cancels) == 1);
  const std::array<double, 4> smallest{0x1p250, -0x1p-298, -0x1p250, 0x1p-297};
  REQUIRE(exact_sign(smallest) == 1);
  const std::array<double, 4> zero{0x1p250, -0x1p-298, -0x1p250, 0x1p-298};
  REQUIRE(exact_sign(zero) == 0);
  // Against 128-bit integers: nine terms of many sizes, and a tenth that cancels their sum but for its rounding.
  Random random(1, name_hash("exact_sign"), 0);
  int disagreements = 0, double_wrong = 0;
  for (int i = 0; i < 10000; ++i) {
    std::array<double, 10> terms;
    Wide sum = 0;
    for (int k = 0; k < 9; ++k) {
      const std::int64_t integer = static_cast<std::int64_t>(random.bits() >> 16) - (std::int64_t{1} << 47);
      const int shift = static_cast<int>(random.below(70));
      terms[k] = std::ldexp(static_cast<double>(integer), shift);
      sum += static_cast<Wide>(integer) * (static_cast<Wide>(1) << shift);
    }
    terms[9] = -static_cast<double>(sum);
    sum += static_cast<Wide>(terms[9]);
    const int sign = sum > 0 ? 1 : sum < 0 ? -1 : 0;
    double plain = 0.0;
    for (const double term : terms) plain += term;
    disagreements += exact_sign(terms) != sign;
    double_wrong += (plain > 0 ? 1 : plain < 0 ? -1 : 0) != sign;
  }
  REQUIRE(disagreements == 0);
  REQUIRE(double_wrong > 1000);  // else the test asks nothing
}

}  // namespace
}  // namespace plumbline
