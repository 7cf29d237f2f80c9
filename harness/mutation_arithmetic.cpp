// SPDX-License-Identifier: GPL-3.0-or-later
// Files that compute something by themselves, against C++: the questions to the driver that run them, digests of MD5,
// texels of noise, and sums of samples.
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "harness/mutation_oracles.h"
#include "scenes/random.h"
#include "tracer/accumulator.h"
#include "tracer/driver_cases.h"
#include "tracer/random_numbers.h"
#include "tracer/small_pass.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants of arithmetic");

/// A driver case as an oracle of the file that it runs.
MutationOracle driver_oracle(GlContext& context, const char* name, std::vector<std::string_view> files) {
  MutationOracle oracle;
  oracle.name = std::string("driver.") + name;
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}, ShaderDefine{"RANDOM_HASH", ""}};
  oracle.programs.push_back(active_lines(compose_shader(files, defines)));
  oracle.ask = [&context, name](const Mutant&) {
    DriverCase asked;
    asked.name = name;
    const DriverResult result = run_driver_case(context, asked);
    return result.found ? result.detail : std::string();
  };
  return oracle;
}

ShaderText random_shader(const char* source, std::string_view main) {
  const std::array<std::string_view, 3> files{"pass_constants.glsl", "random.glsl", main};
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}, ShaderDefine{source, ""}};
  return compose_shader(files, defines);
}

/// One block of MD5 (RFC 1321): its constants from the sine, its rounds as loops.
std::array<std::uint32_t, 4> md5_block(const std::array<std::uint32_t, 16>& message) {
  static constexpr std::array<std::array<int, 4>, 4> kTurns{
      {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}}};
  static constexpr std::array<std::uint32_t, 4> kStart{0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u};
  auto [a, b, c, d] = kStart;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const std::uint32_t round = i / 16;
    const std::uint32_t mixed = round == 0   ? (b & c) | (~b & d)
                                : round == 1 ? (b & d) | (c & ~d)
                                : round == 2 ? b ^ c ^ d
                                             : c ^ (b | ~d);
    const std::uint32_t word = round == 0 ? i : round == 1 ? 5 * i + 1 : round == 2 ? 3 * i + 5 : 7 * i;
    const auto constant = static_cast<std::uint32_t>(std::floor(std::abs(std::sin(i + 1.0)) * 0x1p32));
    const std::uint32_t sum = a + mixed + message[word % 16] + constant;
    a = d, d = c, c = b;
    b += std::rotl(sum, kTurns[round][i % 4]);
  }
  return {kStart[0] + a, kStart[1] + b, kStart[2] + c, kStart[3] + d};
}

/// Digests of messages of any 16 words (such as texels carry: no bits of a NaN).
MutationOracle digests(GlContext& context) {
  constexpr int kMessages = 64;
  InputTexels input{4, kMessages, std::vector<glm::vec4>(4 * kMessages)};
  std::vector<AnswerWords> expected;
  for (std::uint64_t i = 0; i < kMessages; ++i) {
    Random random(kSeed, 1, i);
    std::array<std::uint32_t, 16> message{};
    for (std::size_t k = 0; k < 16; ++k) {
      do message[k] = static_cast<std::uint32_t>(random.bits());
      while ((message[k] & 0x7f800000u) == 0x7f800000u);
      input.texels[4 * i + k / 4][static_cast<int>(k % 4)] = std::bit_cast<float>(message[k]);
    }
    expected.push_back(md5_block(message));
  }
  MutationOracle oracle;
  oracle.name = "random.digests";
  const ShaderText shader = random_shader("RANDOM_MD5", "ask_md5.frag.glsl");
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input, expected](const Mutant&) -> std::string {
    const auto got = run_small_pass(context, {shader, 1, kMessages}, input);
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (got[i] != expected[i]) return "message " + std::to_string(i) + " has another digest than in C++";
    return {};
  };
  return oracle;
}

constexpr int kSide = 32;  ///< of the passes below, pixels

/// (pixel, frame, ray, block) of any draw.
InputTexels draws() {
  InputTexels input{kSide, kSide, {}};
  for (std::uint64_t i = 0; i < kSide * kSide; ++i) {
    Random random(kSeed, 2, i);
    const auto any = [&](double largest) {
      return static_cast<float>(std::floor(std::exp2(random.uniform(0.0, largest))));
    };
    input.texels.emplace_back(any(31), any(31), 1 + random.below(63), random.below(2000));
  }
  return input;
}

/// Numbers are the upper 24 bits of the words of hash or digest.
MutationOracle numbers(GlContext& context, const char* source, const char* name) {
  const InputTexels input = draws();
  std::vector<glm::vec4> expected;
  for (const glm::vec4& texel : input.texels) {
    const glm::uvec4 of(texel);
    if (std::string_view(source) == "RANDOM_HASH") {
      expected.push_back(hashed_block(kSeed, of.x, of.y, of.z, of.w));
      continue;
    }
    const auto words = md5_block({of.x, of.y, of.z, of.w, static_cast<std::uint32_t>(kSeed),
                                  static_cast<std::uint32_t>(kSeed >> 32), 0x80u, 0, 0, 0, 0, 0, 0, 0, 192, 0});
    expected.emplace_back();
    for (std::size_t k = 0; k < 4; ++k)
      expected.back()[static_cast<int>(k)] = static_cast<float>(words[k] >> 8) * 0x1p-24f;
  }
  MutationOracle oracle;
  oracle.name = name;
  const ShaderText shader = random_shader(source, "driver_random.frag.glsl");
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input, expected](const Mutant&) -> std::string {
    const auto set = [](const GlProgram& program) { program.set("u_random", random_uniform(kSeed, 0, 0)); };
    const auto got = run_small_pass(context, {shader, kSide, kSide, false, set}, input);
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (std::bit_cast<glm::vec4>(got[i]) != expected[i])
        return "the numbers of draw " + std::to_string(i) + " are others in C++";
    return {};
  };
  return oracle;
}

/// The image of noise: a layer for each frame, and no texel twice for one pixel.
MutationOracle noise(GlContext& context) {
  // Texels hold their own addresses; the draws of 63 rays in 65 blocks fill a layer but for one texel.
  constexpr int kNoiseSide = 96;
  constexpr std::uint32_t kTexels = 4096, kLayers = 2, kDraws = 63 * 65, kFirst = 100;
  std::vector<glm::vec4> addresses(kTexels * kLayers);
  for (std::size_t i = 0; i < addresses.size(); ++i) addresses[i] = glm::vec4(static_cast<float>(i));
  // 4096 x 2 texels, and 128 x 64, whose rows are no layers.
  InputTexels input{kNoiseSide, kNoiseSide, {}};
  for (std::uint32_t i = 0; i < kNoiseSide * kNoiseSide; ++i) {
    const std::uint32_t which = i % kDraws, layer = i / kDraws % kLayers;
    input.texels.emplace_back(37 * layer, kFirst + layer, 1 + which % 63, which / 63);
  }
  MutationOracle oracle;
  oracle.name = "random.noise";
  const ShaderText shader = random_shader("RANDOM_TEXTURE", "driver_random.frag.glsl");
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input, addresses](const Mutant&) -> std::string {
    for (const int width : {4096, 128}) {
      const GlTexture texels(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, width, static_cast<int>(addresses.size()) / width,
                             addresses.data());
      const auto set = [&](const GlProgram& program) {
        program.set("u_random", random_uniform(kSeed, kTexels, kFirst));
        program.set("u_noise", 1);
        texels.bind(1);
      };
      const auto got = run_small_pass(context, {shader, kNoiseSide, kNoiseSide, false, set}, input);
      for (std::uint32_t layer = 0; layer < kLayers; ++layer) {
        std::vector<bool> seen(kTexels, false);
        for (std::uint32_t i = layer * kDraws; i < (layer + 1) * kDraws; ++i) {
          const auto address = static_cast<std::uint32_t>(std::bit_cast<glm::vec4>(got[i]).x);
          if (address / kTexels != layer) return "draw " + std::to_string(i) + " reads the layer of another frame";
          if (seen[address % kTexels]) return "draw " + std::to_string(i) + " reads a texel again";
          seen[address % kTexels] = true;
        }
      }
    }
    return {};
  };
  return oracle;
}

/// Sums of samples that lose a careless sum, and of some that are not finite.
MutationOracle sums(GlContext& context) {
  constexpr int kWidth = 8, kHeight = 2, kFrames = 1201, kLanes = 5, kBlocks = 24;  // beyond a chunk of 1024
  using Make = float (*)(Random&, int frame);
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  static constexpr std::array<Make, 16> kMake{
      [](Random& r, int) { return static_cast<float>(r.uniform()); },
      [](Random& r, int) { return static_cast<float>(r.uniform(-1.0, 1.0)); },
      [](Random&, int) { return 0.1f; },
      [](Random& r, int) { return 1.0f + 0x1p-20f * static_cast<float>(r.below(64)); },
      [](Random&, int f) { return f == 777 ? 0.7f + 0x1p-23f : 0.7f; },
      [](Random& r, int f) { return f == 0 ? 1e9f : static_cast<float>(1.0 + 1e-3 * r.uniform()); },
      [](Random& r, int f) { return f == 1024 ? 1e9f : static_cast<float>(1e-3 * r.uniform()); },
      [](Random& r, int) { return static_cast<float>(std::exp2(r.uniform(-40.0, 40.0))); },
      [](Random& r, int f) { return static_cast<float>((f % 2 == 0 ? 1e15 : -1e15) + r.uniform()); },
      [](Random&, int f) { return f % 2 == 0 ? 1e-15f : 1e15f; },
      [](Random& r, int) { return static_cast<float>(r.uniform(3.0e38, 3.4e38)); },
      [](Random&, int f) { return f % 3 == 0 ? -3.4e38f : 3.4e38f; },
      [](Random&, int f) { return f == 3 ? kInfinite : 0.25f; },
      [](Random&, int f) { return f == 1100 ? -kInfinite : 0.25f; },
      [](Random&, int f) { return f == 0 ? std::bit_cast<float>(0x7fc00001u) : 0.25f; },
      [](Random&, int f) { return f == 5   ? kInfinite
                                  : f == 7 ? -kInfinite
                                           : 0.25f; }};
  constexpr int kEndless = 2;  ///< of this series one walk finds no end, in a second picture
  auto values = std::make_shared<std::vector<std::vector<glm::vec3>>>(kMake.size());
  for (std::size_t s = 0; s < kMake.size(); ++s) {
    std::array<Random, 3> random{Random(kSeed, 3, 3 * s), Random(kSeed, 3, 3 * s + 1), Random(kSeed, 3, 3 * s + 2)};
    // In y negated, in z another series: channels are apart.
    const std::size_t other = (s + 5) % kMake.size();
    for (int f = 0; f < kFrames; ++f)
      (*values)[s].emplace_back(kMake[s](random[0], f), -kMake[s](random[1], f), kMake[other](random[2], f));
  }
  MutationOracle oracle;
  oracle.name = "sums";
  oracle.programs.push_back(active_lines(accumulate_shader()));
  oracle.ask = [&context, values](const Mutant&) -> std::string {
    for (const bool is_endless : {false, true}) {
      Accumulator accumulator(context, kWidth, kHeight);
      for (int first = 0, count = 1; first < kFrames; first += count) {
        RenderBatch batch;
        batch.tile_width = kWidth, batch.tile_height = kHeight;
        batch.lanes = first == 0 ? 1 : kLanes;  // the first frame comes alone
        batch.blocks = first == 0 ? 1 : std::min(int{kBlocks}, (kFrames - first) / kLanes);
        count = batch.lanes * batch.blocks;
        batch.first_frame = static_cast<std::uint32_t>(first);
        batch.columns = kWidth * batch.lanes, batch.rows = kHeight * batch.blocks;
        std::vector<glm::vec4> texels;
        for (int row = 0; row < batch.rows; ++row)
          for (int column = 0; column < batch.columns; ++column) {
            const int x = column / batch.lanes, y = row % kHeight;
            const int f = first + row / kHeight * batch.lanes + column % batch.lanes;
            const int s = y * kWidth + x;
            texels.emplace_back((*values)[static_cast<std::size_t>(s)][static_cast<std::size_t>(f)],
                                is_endless && s == kEndless && f == 9 ? 1.0f : 0.0f);
          }
        const GlTexture texture(context, GL_RGBA32F, GL_RGBA, GL_FLOAT, batch.columns, batch.rows, texels.data());
        accumulator.add(texture, batch);
      }
      const AccumulatedMoments moments = accumulator.read();
      for (std::size_t s = 0; s < values->size(); ++s)
        for (int k = 0; k < 3; ++k) {
          long double sum = 0.0L, sizes = 0.0L, squares = 0.0L;
          for (const glm::vec3& v : (*values)[s]) sum += v[k], sizes += std::abs(v[k]);
          const long double mean = sum / kFrames;
          for (const glm::vec3& v : (*values)[s]) squares += (v[k] - mean) * (v[k] - mean);
          const auto exact = static_cast<double>(mean), variance = static_cast<double>(squares / (kFrames - 1));
          const double got = moments.mean[s][k], spread = moments.variance[s][k];
          const std::string what = "series " + std::to_string(s) + ", channel " + std::to_string(k) + ": ";
          if (is_endless && s == kEndless ? !std::isnan(got)
              : std::isnan(exact)         ? !std::isnan(got)
              : std::isinf(exact)
                  ? got != exact
                  : !(std::abs(got - exact) <= static_cast<double>(0x1p-24L * sizes / kFrames + 0x1p-110L)))
            return what + "the mean is " + std::to_string(got) + ", not " + std::to_string(exact);
          if (std::isfinite(exact) && !(is_endless && s == kEndless) && variance < 0x1p114 &&
              !(std::abs(spread - variance) <= 0x1p-22 * variance))
            return what + "the variance is " + std::to_string(spread) + ", not " + std::to_string(variance);
        }
    }
    return {};
  };
  return oracle;
}

ShaderText elementary_shader(std::string_view question) {
  const std::array<std::string_view, 3> files{"pass_constants.glsl", "elementary.glsl", question};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}};
  return compose_shader(files, defines);
}

/// elementary.glsl keeps the bounds that it states, where functions are worst and at the ends of their ranges.
MutationOracle elementary(GlContext& context) {
  constexpr int kPixels = 128;
  constexpr long double kU = 0x1p-24L, kTurn = 6.28318530717958647692528676655900577L;
  InputTexels input{kPixels, kPixels, {}};
  for (std::uint32_t i = 0; i < kPixels * kPixels; ++i) {
    Random random(kSeed, 4, i);
    glm::vec4 v;
    // Turns: all around the odd eighths, where the sums are longest; else anywhere.
    const std::uint32_t eighth = 2 * (i / 2048) + 1;
    v.x = static_cast<float>(i < 8192 ? (eighth << 21) + i % 2048 - 1024 : random.below(1u << 24)) * 0x1p-24f;
    v.y = static_cast<float>(random.below(1u << 24)) * 0x1p-24f;
    if (i % 4 == 1) v.y = static_cast<float>(std::exp2(random.uniform(-100.0, 0.0)));
    if (i < 2) v.y = static_cast<float>(i);
    v.z = static_cast<float>(random.uniform());
    if (i % 4 == 1) v.z = static_cast<float>(1.0 - std::exp2(random.uniform(-24.0, 0.0)));
    if (i % 4 == 2) v.z = static_cast<float>(std::exp2(random.uniform(-126.0, 0.0)));
    if (i % 64 == 3) v.z = static_cast<float>(1.0 + 0x1p-23 * random.below(9));
    if (i % 64 == 7) v.z = 0.0f;
    v.w = static_cast<float>(i % 3 == 0 ? random.uniform(0.0, 200.0) : std::exp2(random.uniform(-10.0, 20.0)));
    if (i % 128 == 71 || i % 128 == 72) v.w = 0.0f;
    if (i % 128 == 5 || i % 128 == 67) v.w = 3.4e38f;
    input.texels.push_back(v);
  }
  MutationOracle oracle;
  oracle.name = "elementary.dense";
  const ShaderText shader = elementary_shader("driver_elementary.frag.glsl");
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input](const Mutant&) -> std::string {
    const auto words = run_small_pass(context, {shader, kPixels, kPixels}, input);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const glm::vec4 got = std::bit_cast<glm::vec4>(words[i]), v = input.texels[i];
      const long double x = v.z, y = v.w, angle = kTurn * static_cast<long double>(v.x);
      const auto beyond = [](float value, long double truth, long double bound) {
        return !(std::abs(static_cast<long double>(value) - truth) <= bound);
      };
      const std::string at = " of argument " + std::to_string(i) + " is beyond its bound";
      if (beyond(got.x, std::cos(angle), 2.0L * kU) || beyond(got.y, std::sin(angle), 2.0L * kU)) return "a turn" + at;
      const long double root = std::cbrt(static_cast<long double>(v.y));
      if (beyond(got.z, root, 2.0L * kU * root)) return "the cube root" + at;
      const long double power = y == 0.0L ? 1.0L : x == 0.0L ? 0.0L : std::pow(x, y);
      if (power < 0x1p-125L) {
        if (beyond(got.w, 0.0L, 0x1p-125L)) return "a power that vanishes" + at;
      } else if (power < 0x1p127L) {
        const long double scale = x == 0.0L || y == 0.0L ? 0.0L : 2.0L + 4.0L * y * std::abs(std::log(x));
        if (beyond(got.w, power, power * scale * kU)) return "the power" + at;
      } else if (!(got.w >= 0x1p127f)) {
        return "a power that overflows" + at;
      }
    }
    return {};
  };
  return oracle;
}

/// log_2 and exp_2 alone: power() hides an error of either behind the other's bound.
MutationOracle logarithms(GlContext& context) {
  constexpr int kPixels = 128;
  constexpr long double kU = 0x1p-24L;
  InputTexels input{kPixels, kPixels, {}};
  for (std::uint32_t i = 0; i < kPixels * kPixels; ++i) {
    Random random(kSeed, 5, i);
    const double x = i % 2 == 0 ? random.uniform(0.5, 1.0) : std::exp2(random.uniform(-126.0, 0.0));
    input.texels.emplace_back(x, random.uniform(-126.0, 127.0), 0.0f, 0.0f);
  }
  MutationOracle oracle;
  oracle.name = "elementary.logarithms";
  const ShaderText shader = elementary_shader("ask_logarithms.frag.glsl");
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input](const Mutant&) -> std::string {
    const auto words = run_small_pass(context, {shader, kPixels, kPixels}, input);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const glm::vec4 got = std::bit_cast<glm::vec4>(words[i]), v = input.texels[i];
      const long double log = std::log2(static_cast<long double>(v.x)), exp = std::exp2(static_cast<long double>(v.y));
      if (!(std::abs(static_cast<long double>(got.x) - log) <= 3.0L * kU * std::abs(log)))
        return "the logarithm of argument " + std::to_string(i) + " is beyond its bound";
      if (!(std::abs(static_cast<long double>(got.y) - exp) <= 2.0L * kU * exp))
        return "the power of two of argument " + std::to_string(i) + " is beyond its bound";
    }
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> arithmetic_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  oracles.push_back(driver_oracle(context, "exact_arithmetic", {"exact.glsl"}));
  oracles.push_back(driver_oracle(context, "elementary", {"elementary.glsl"}));
  oracles.push_back(elementary(context));
  oracles.push_back(logarithms(context));
  oracles.push_back(numbers(context, "RANDOM_HASH", "random.hash"));
  oracles.push_back(digests(context));
  oracles.push_back(numbers(context, "RANDOM_MD5", "random.md5"));
  oracles.push_back(noise(context));
  oracles.push_back(sums(context));
  return oracles;
}

}  // namespace plumbline
