// SPDX-License-Identifier: MIT
// Each case is a shader, a texture it reads, and the same computation on the CPU.
#include "tracer/driver_cases.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <limits>

#include "scenes/error.h"
#include "scenes/random.h"
#include "tracer/random_numbers.h"
#include "tracer/small_pass.h"

namespace plumbline {
namespace {

constexpr int kSide = 64;  // pixels of every answer, width and height
constexpr std::uint64_t kSeed = name_hash("driver cases");

using Words = AnswerWords;
using Picture = InputTexels;

struct Question {
  DriverCase asked;
  const char* shader;
  bool float_target;
  std::function<Picture()> input;
  /// Whether the answer for pixel i of the picture is right, and what it should have been.
  std::function<bool(const Picture&, std::size_t, const Words&, Words&)> check;
};

std::uint32_t word(float x) { return std::bit_cast<std::uint32_t>(x); }
float number(std::uint32_t bits) { return std::bit_cast<float>(bits); }

/// A picture whose texel i is made(random numbers of i).
Picture picture(const std::function<glm::vec4(Random&)>& made) {
  Picture p{kSide, kSide, {}};
  for (std::uint64_t i = 0; i < std::uint64_t{kSide} * kSide; ++i) {
    Random random(kSeed, 0, i);
    p.texels.push_back(made(random));
  }
  return p;
}
Picture no_picture() { return {1, 1, {glm::vec4(0.0f)}}; }

/// Numbers of moderate size and either sign.
glm::vec4 moderate(Random& random) {
  glm::vec4 v;
  for (int i = 0; i < 4; ++i)
    v[i] = static_cast<float>(std::exp2(random.uniform(-8.0, 8.0)) * (random.below(2) == 0 ? 1.0 : -1.0));
  return v;
}

/// Any bits but NaN; every fourth number is a denormal, a zero of either sign, or an infinity.
glm::vec4 any_bits(Random& random) {
  glm::vec4 v;
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t bits = static_cast<std::uint32_t>(random.bits());
    const std::uint32_t sign = bits & 0x80000000u;
    const std::uint32_t kinds[] = {sign | (bits & 0x007fffffu), sign, sign | 0x7f800000u, sign | 1u};
    v[i] = random.below(4) == 0 ? number(kinds[random.below(4)])
                                : number((bits & 0x7f800000u) == 0x7f800000u ? bits ^ 0x40000000u : bits);
  }
  return v;
}

/// A check for answers that are right in every bit of `words` words.
auto exactly(std::function<Words(const Picture&, std::size_t)> expected) {
  return [expected](const Picture& input, std::size_t i, const Words& got, Words& wanted) {
    wanted = expected(input, i);
    return got == wanted;
  };
}

Words bits_of(const glm::vec4& v) { return {word(v.x), word(v.y), word(v.z), word(v.w)}; }

Picture chains() {
  return picture([](Random& random) {
    return glm::vec4(1 + random.below(3), random.below(16), 5 + random.below(30), random.below(5) == 0 ? -1.0f : 1.0f);
  });
}

Words follow_chain(const Picture& input, std::size_t i) {
  int at = static_cast<int>(i % kSide) * 7 + static_cast<int>(i / kSide) * 13;
  std::uint32_t sum = 0, rounds = 0;
  glm::vec4 value;
  do {
    do {
      value = input.texels[static_cast<std::size_t>(at)];
      at += static_cast<int>(value.x);
    } while (value.w > 0.0f);
    sum = sum * 3 + static_cast<std::uint32_t>(value.y);
    ++rounds;
  } while (rounds <= static_cast<std::uint32_t>(value.z));
  return {sum, static_cast<std::uint32_t>(at), rounds, 0};
}

/// a * b - c * d in exact arithmetic, rounded to double once: the products are exact in double.
double difference_of_products(const glm::vec4& v) {
  return static_cast<double>(v.x) * v.y - static_cast<double>(v.z) * v.w;
}

/// Whether `got` is within `ulps` units in the last place of `exact`.
bool near(float got, double exact, double ulps) { return std::abs(got - exact) <= ulps * 0x1p-23 * std::abs(exact); }

std::vector<Question> questions() {
  std::vector<Question> all;
  all.push_back({{"loop_cap", "A loop runs as often as it is told to, be it 200,000 times.", true},
                 "driver_loop_cap.frag.glsl",
                 false,
                 no_picture,
                 exactly([](const Picture&, std::size_t i) {
                   return Words{200000 + static_cast<std::uint32_t>(i % kSide), 200000, 0, 0};
                 })});
  all.push_back(
      {{"clobbered_value",
        "A value computed in an inner loop keeps for a pixel that leaves it while its neighbours go on.", true},
       "driver_clobbered_value.frag.glsl",
       false,
       chains,
       exactly(follow_chain)});
  all.push_back(
      {{"guarded_value", "The same, written as the production shader writes it: leaving before changing.", false},
       "driver_guarded_value.frag.glsl",
       false,
       chains,
       exactly(follow_chain)});
  all.push_back(
      {{"texel_bits", "A float texel keeps its bits, denormals, infinities and the sign of zero included.", false},
       "driver_texel_bits.frag.glsl",
       false,
       [] { return picture(any_bits); },
       exactly([](const Picture& input, std::size_t i) { return bits_of(input.texels[i]); })});
  all.push_back({{"float_target_bits", "A float written to a float target is read back bit by bit.", true},
                 "driver_float_target.frag.glsl",
                 true,
                 [] { return picture(any_bits); },
                 exactly([](const Picture& input, std::size_t i) { return bits_of(input.texels[i]); })});
  all.push_back(
      {{"wide_texture",
        "Each texel of a texture 16384 wide is found by its number, and by coordinates through its middle.", false},
       "driver_wide_texture.frag.glsl",
       false,
       [] {
         Picture p{16384, 2, {}};
         for (int i = 0; i < 2 * 16384; ++i) p.texels.emplace_back(static_cast<float>(i), 0.0f, 0.0f, 0.0f);
         return p;
       },
       exactly([](const Picture&, std::size_t i) {
         const float value = static_cast<float>(i * 8 + (i & 7));
         return Words{word(value), word(value), 0, 0};
       })});
  all.push_back(
      {{"integer_bits", "Integers become floats of the same bits and return unchanged; shifts keep the sign.", false},
       "driver_integer_bits.frag.glsl",
       false,
       [] { return picture(any_bits); },
       exactly([](const Picture& input, std::size_t i) {
         const std::uint32_t bits = word(input.texels[i].x);
         return Words{bits, word(static_cast<float>(bits & 0x7fffffu)),
                      static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) >> 23), bits | 0x80000000u};
       })});
  all.push_back(
      {{"products",
        "Products and sums are each rounded on their own: a * b - c * d is minus c * d - a * b, bit by bit.", false},
       "driver_products.frag.glsl",
       false,
       [] { return picture(moderate); },
       exactly([](const Picture& input, std::size_t i) {
         const glm::vec4 v = input.texels[i];
         const float xy = v.x * v.y, zw = v.z * v.w, xw = v.x * v.w;
         return Words{word(xy - zw), word(zw - xy), word((xy + zw) + xw), word(xy)};
       })});
  all.push_back({{"nan_comparisons", "Every comparison with NaN is false, but `not equal`.", false},
                 "driver_nan.frag.glsl",
                 false,
                 [] { return picture(moderate); },
                 exactly([](const Picture&, std::size_t) {
                   return Words{32u + 64u, 0, 0, 0};
                 })});
  all.push_back(
      {{"denormals", "Arithmetic keeps denormal numbers; a driver that flushes them to zero is allowed to.", true},
       "driver_denormals.frag.glsl",
       false,
       [] {
         return picture([](Random& random) {
           return glm::vec4(number(random.below(0x7fffff) + 1), 0x1p20f,
                            static_cast<float>(random.uniform(1.0, 2.0)) * 0x1p-126f, 0.0f);
         });
       },
       exactly([](const Picture& input, std::size_t i) {
         const glm::vec4 v = input.texels[i];
         return bits_of(glm::vec4(v.x * v.y, v.x + v.x, v.z * 0.25f, 1.0f));
       })});
  all.push_back({{"plain_sum", "(a + b) - a is computed as written, not replaced by b.", true},
                 "driver_plain_sum.frag.glsl",
                 false,
                 [] { return picture(moderate); },
                 exactly([](const Picture& input, std::size_t i) {
                   const glm::vec4 v = input.texels[i];
                   const float sum = v.x + v.y;
                   return Words{word(sum - v.x), 0, 0, 0};
                 })});
  all.push_back(
      {{"exact_arithmetic",
        "The error-free sums and products that far rays and edge-on triangles rest on are error-free.", false},
       "driver_exact.frag.glsl",
       false,
       [] {
         return picture([](Random& random) {
           glm::vec4 v = moderate(random);
           // Every other pixel: two products that differ in the last places alone.
           if (random.below(2) == 0) v.w = static_cast<float>(static_cast<double>(v.x) * v.y / v.z);
           return v;
         });
       },
       [](const Picture& input, std::size_t i, const Words& got, Words& wanted) {
         const glm::vec4 v = input.texels[i];
         const float sum = v.x + v.y, product = v.x * v.y;
         const float sum_error = static_cast<float>(static_cast<double>(v.x) + v.y - sum);
         const float product_error = static_cast<float>(static_cast<double>(v.x) * v.y - product);
         const double difference = difference_of_products(v);
         const float a = v.x * v.z, b = v.y * v.z, of_products = a + b;
         const float products_error = static_cast<float>(static_cast<double>(a) + b - of_products);
         wanted = {word(sum_error), word(product_error), word(static_cast<float>(difference)), word(products_error)};
         return number(got[0]) == sum_error && number(got[1]) == product_error &&
                near(number(got[2]), difference, 2.0) && number(got[3]) == products_error;
       }});
  all.push_back(
      {{"division",
        "A reciprocal and a square root are rounded once, a quotient is off by one unit in the last place at most.",
        false},
       "driver_division.frag.glsl",
       false,
       [] { return picture(moderate); },
       [](const Picture& input, std::size_t i, const Words& got, Words& wanted) {
         const glm::dvec4 v(input.texels[i]);
         const glm::dvec3 exact(1.0 / v.x, v.y / v.x, std::sqrt(std::abs(v.x)));
         wanted = {word(static_cast<float>(exact.x)), word(static_cast<float>(exact.y)),
                   word(static_cast<float>(exact.z)), 0};
         return near(number(got[0]), exact.x, 0.5) && near(number(got[1]), exact.y, 1.0) &&
                near(number(got[2]), exact.z, 0.5);
       }});
  all.push_back(
      {{"elementary", "Cosines, sines, cube roots and powers, made of sums and products, keep their bounds.", false},
       "driver_elementary.frag.glsl",
       false,
       [] {
         return picture([](Random& random) {
           const auto fraction = [&] { return static_cast<float>(random.below(1u << 24)) * 0x1p-24f; };
           return glm::vec4(fraction(), fraction(), fraction(), static_cast<float>(random.uniform(0.0, 100.0)));
         });
       },
       [](const Picture& input, std::size_t i, const Words& got, Words& wanted) {
         const glm::dvec4 v(input.texels[i]);
         const double angle = 2.0 * std::acos(-1.0) * v.x;
         const glm::dvec4 exact(std::cos(angle), std::sin(angle), std::cbrt(v.y), std::pow(v.z, v.w));
         wanted = bits_of(glm::vec4(exact));
         // The bounds of elementary.glsl: absolute for the first two and for powers.
         return std::abs(number(got[0]) - exact.x) <= 0x1p-23 && std::abs(number(got[1]) - exact.y) <= 0x1p-23 &&
                near(number(got[2]), exact.z, 1.0) && std::abs(number(got[3]) - exact.w) <= 2.5 * 0x1p-24;
       }});
  all.push_back({{"hash", "Random numbers hashed in a shader are those that the same hash gives in C++.", false},
                 "driver_random.frag.glsl",
                 false,
                 [] {
                   return picture([](Random& random) {
                     return glm::vec4(random.below(1u << 24), random.below(1u << 24), 1 + random.below(63),
                                      random.below(100));
                   });
                 },
                 exactly([](const Picture& input, std::size_t i) {
                   const glm::uvec4 of(input.texels[i]);
                   return bits_of(hashed_block(kSeed, of.x, of.y, of.z, of.w));
                 })});
  return all;
}

std::string hexadecimal(const Words& words) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%08x %08x %08x %08x", words[0], words[1], words[2], words[3]);
  return text.data();
}

DriverResult ask(GlContext& context, const Question& question) {
  const InputTexels input = question.input();
  const std::array<std::string_view, 5> files{"pass_constants.glsl", "exact.glsl", "elementary.glsl", "random.glsl",
                                              question.shader};
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}, ShaderDefine{"RANDOM_HASH", ""}};
  const auto set = [](const GlProgram& program) { program.set("u_random", random_uniform(kSeed, 0, 0)); };
  const std::vector<AnswerWords> answers =
      run_small_pass(context, {compose_shader(files, defines), kSide, kSide, question.float_target, set}, input);

  DriverResult result;
  result.pixels = answers.size();
  for (std::size_t i = 0; i < answers.size(); ++i) {
    Words wanted{};
    if (question.check(input, i, answers[i], wanted)) continue;
    if (result.wrong++ > 0) continue;
    result.expected = hexadecimal(wanted), result.got = hexadecimal(answers[i]);
  }
  result.found = result.wrong > 0;
  result.detail = !result.found ? "as it should be"
                                : std::to_string(result.wrong) + " of " + std::to_string(result.pixels) +
                                      " pixels wrong; the first expects " + result.expected + " and gets " + result.got;
  return result;
}

}  // namespace

std::vector<DriverCase> all_driver_cases() {
  std::vector<DriverCase> cases;
  for (const Question& question : questions()) cases.push_back(question.asked);
  return cases;
}

DriverResult run_driver_case(GlContext& context, const DriverCase& asked) {
  for (const Question& question : questions()) {
    if (question.asked.name == asked.name) return ask(context, question);
  }
  throw InputError("there is no driver case " + asked.name);
}

}  // namespace plumbline
