// SPDX-License-Identifier: MIT
// Random numbers keep SEMANTICS 7.1's promises: the shader's are those of C++, MD5 is RFC 1321's, no pixel reads a
// texel of noise twice, and nothing near anything else is alike.
#include "tracer/random_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>

#include "scenes/error.h"
#include "scenes/random.h"
#include "tracer/small_pass.h"

using namespace plumbline;

namespace {

constexpr int kSide = 64;
constexpr std::uint64_t kSeed = 0x9123456789abcdefull;

GlContext& context() {
  static GlContext instance;
  return instance;
}

ShaderText shader(const char* source, std::string_view main) {
  const std::array<std::string_view, 3> files{"pass_constants.glsl", "random.glsl", main};
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}, ShaderDefine{source, ""}};
  return compose_shader(files, defines);
}

/// What random_block() gives for (pixel, frame, ray, block); `bind_noise` binds a texture to unit 1.
std::vector<glm::vec4> blocks_for(
    const char* source, const std::vector<glm::vec4>& asked, const glm::ivec4& uniform,
    const std::function<void()>& bind_noise = [] {}) {
  const auto set = [&](const GlProgram& program) {
    program.set("u_random", uniform);
    program.set("u_noise", 1);
    bind_noise();
  };
  const std::vector<AnswerWords> words = run_small_pass(
      context(), {shader(source, "driver_random.frag.glsl"), kSide, kSide, false, set}, {kSide, kSide, asked});
  std::vector<glm::vec4> blocks;
  for (const AnswerWords& w : words) blocks.push_back(std::bit_cast<glm::vec4>(w));
  return blocks;
}

std::vector<glm::vec4> asked_blocks(const std::function<glm::vec4(Random&, int)>& made) {
  std::vector<glm::vec4> asked;
  for (int i = 0; i < kSide * kSide; ++i) {
    Random random(kSeed, 1, static_cast<std::uint64_t>(i));
    asked.push_back(made(random, i));
  }
  return asked;
}

bool is_random_number(float x) { return x >= 0.0f && x < 1.0f && x * 0x1p24f == std::floor(x * 0x1p24f); }

/// Standard deviations between a chi-square statistic of equally likely cells and its mean.
double excess(const std::vector<std::uint32_t>& cells, double count) {
  const double expected = count / static_cast<double>(cells.size()), freedom = static_cast<double>(cells.size()) - 1.0;
  double chi2 = 0.0;
  for (const std::uint32_t n : cells) chi2 += (n - expected) * (n - expected) / expected;
  return (chi2 - freedom) / std::sqrt(2.0 * freedom);
}

/// The largest excess over pairs of numbers of two sequences of blocks, in 16 x 16 cells, and of their lowest 4 bits.
double worst_pair(const std::function<std::pair<glm::vec4, glm::vec4>(std::uint32_t)>& blocks) {
  constexpr std::uint32_t kDraws = 1 << 15;
  std::vector<std::vector<std::uint32_t>> cells(32, std::vector<std::uint32_t>(256, 0));
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto [a, b] = blocks(i);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const auto x = static_cast<std::uint32_t>(a[j] * 0x1p24f), y = static_cast<std::uint32_t>(b[k] * 0x1p24f);
        ++cells[static_cast<std::size_t>(8 * j + 2 * k)][(x >> 20) * 16 + (y >> 20)];
        ++cells[static_cast<std::size_t>(8 * j + 2 * k + 1)][(x & 15) * 16 + (y & 15)];
      }
  }
  double worst = 0.0;
  for (const auto& pair : cells) worst = std::max(worst, excess(pair, kDraws));
  return worst;
}

}  // namespace

TEST_CASE("the shader's hash is the hash of C++, bit by bit", "[random]") {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, kSeed, ~std::uint64_t{0}}) {
    const auto asked = asked_blocks([](Random& random, int) {
      const auto any = [&](double largest) {
        return static_cast<float>(std::floor(std::exp2(random.uniform(0, largest))));
      };
      return glm::vec4(any(31), any(31), 1 + random.below(63), random.below(2000));
    });
    const auto got = blocks_for("RANDOM_HASH", asked, random_uniform(seed, 0, 0));
    int wrong = 0, outside = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const glm::uvec4 of(asked[i]);
      wrong += got[i] != hashed_block(seed, of.x, of.y, of.z, of.w);
      for (int k = 0; k < 4; ++k) outside += !is_random_number(got[i][k]);
    }
    CHECK(wrong == 0);
    CHECK(outside == 0);
  }
}

TEST_CASE("the shader's MD5 gives the digests of RFC 1321", "[random]") {
  const std::array<std::pair<std::string, std::string>, 5> suite{
      {{"", "d41d8cd98f00b204e9800998ecf8427e"},
       {"a", "0cc175b9c0f1b6a831c399e269772661"},
       {"abc", "900150983cd24fb0d6963f7d28e17f72"},
       {"message digest", "f96b697d7cb7938d525a2f31aaf161d0"},
       {"abcdefghijklmnopqrstuvwxyz", "c3fcd3d76192e4007dfb496cca67e13b"}}};
  InputTexels input{4, 5, std::vector<glm::vec4>(20)};
  for (std::size_t i = 0; i < suite.size(); ++i) {
    const std::string& message = suite[i].first;
    std::array<unsigned char, 64> bytes{};
    std::memcpy(bytes.data(), message.data(), message.size());
    bytes[message.size()] = 0x80;
    bytes[56] = static_cast<unsigned char>(8 * message.size());
    std::memcpy(&input.texels[4 * i], bytes.data(), bytes.size());
  }
  const auto digests = run_small_pass(context(), {shader("RANDOM_MD5", "ask_md5.frag.glsl"), 1, 5}, input);
  for (std::size_t i = 0; i < suite.size(); ++i) {
    std::string text;
    for (const std::uint32_t word : digests[i])
      for (int byte = 0; byte < 4; ++byte) {
        std::array<char, 3> digits{};
        std::snprintf(digits.data(), digits.size(), "%02x", (word >> (8 * byte)) & 255u);
        text += digits.data();
      }
    CHECK(text == suite[i].second);
  }
}

TEST_CASE("MD5 numbers are the upper bits of the digest of the six words", "[random]") {
  // printf '\x01\0\0\0\x02\0\0\0\x03\0\0\0\x04\0\0\0\x05\0\0\0\x06\0\0\0' | md5sum
  const std::array<std::uint32_t, 4> digest{0xdb536ce4u, 0x5aa108dcu, 0xf5c2b546u, 0xb0145ad9u};
  const auto asked = asked_blocks([](Random&, int) { return glm::vec4(1, 2, 3, 4); });
  const glm::vec4 got = blocks_for("RANDOM_MD5", asked, random_uniform((std::uint64_t{6} << 32) + 5, 0, 0))[0];
  for (int k = 0; k < 4; ++k) CHECK(got[k] == static_cast<float>(digest[static_cast<std::size_t>(k)] >> 8) * 0x1p-24f);
}

TEST_CASE("no pixel reads a texel of noise twice, and frames have layers of their own", "[random]") {
  constexpr std::uint32_t kLights = 5;
  // 63 * (3 + lights) = 504 blocks: a layer of 512 texels. Those of this image hold their own addresses.
  constexpr std::uint32_t kTexels = 512, kLayers = 8;
  std::vector<glm::vec4> addresses(kTexels * kLayers);
  for (std::size_t i = 0; i < addresses.size(); ++i) addresses[i] = glm::vec4(static_cast<float>(i));
  const GlTexture noise(context(), GL_RGBA32F, GL_RGBA, GL_FLOAT, 512, kLayers, addresses.data());
  constexpr std::uint32_t kBlocks = 63 * (3 + kLights);
  const auto asked = asked_blocks([](Random&, int i) {
    const auto which = static_cast<std::uint32_t>(i) % kBlocks, layer = static_cast<std::uint32_t>(i) / kBlocks;
    return glm::vec4(37 * layer, 100 + layer % kLayers, 1 + which % 63, which / 63);
  });
  const auto got = blocks_for("RANDOM_TEXTURE", asked, random_uniform(kSeed, kTexels, 100), [&] { noise.bind(1); });
  for (std::size_t first = 0; first + kBlocks <= got.size(); first += kBlocks) {
    std::vector<bool> seen(kTexels, false);
    std::uint32_t again = 0, elsewhere = 0;
    for (std::size_t i = first; i < first + kBlocks; ++i) {
      const auto address = static_cast<std::uint32_t>(got[i].x);
      elsewhere += address / kTexels != first / kBlocks % kLayers;
      again += seen[address % kTexels] ? 1u : 0u;
      seen[address % kTexels] = true;
    }
    CHECK(again == 0);
    CHECK(elsewhere == 0);
  }
}

TEST_CASE("the image of noise is large enough, holds its layers and is renewed", "[random]") {
  CHECK(NoiseImage(context(), kSeed, 100, 90, 1).texels() == 16384);
  CHECK(NoiseImage(context(), kSeed, 128, 128, 1).texels() == 16384);
  CHECK(NoiseImage(context(), kSeed, 3, 3, 1).texels() == 256);
  CHECK(NoiseImage(context(), kSeed, 3, 3, 2).texels() == 512);
  CHECK_THROWS_AS(NoiseImage(context(), kSeed, 65536, 65536, 1), InputError);
  for (const auto& [width, height] : {std::pair{3, 3}, std::pair{128, 64}}) {
    NoiseImage noise(context(), kSeed, width, height, 1);
    REQUIRE(noise.most_frames() >= 100);
    for (const std::uint32_t first : {0u, 50u, 7u}) {
      noise.go_to(first, first == 7u ? 100 : 3);
      // Of a pixel that is larger than the picture all texels are read: pixel numbers wrap.
      const auto asked = asked_blocks([&](Random&, int i) { return glm::vec4(i, first + 2, 1, 0); });
      const auto got =
          blocks_for("RANDOM_TEXTURE", asked, random_uniform(kSeed, noise.texels(), first), [&] { noise.bind(1); });
      std::vector<glm::vec4> layer(noise.texels());
      fill_noise_layer(kSeed, first + 2, layer);
      int wrong = 0, outside = 0;
      for (std::size_t i = 0; i < got.size(); ++i) {
        wrong += got[i] != layer[i % layer.size()];
        for (int k = 0; k < 4; ++k) outside += !is_random_number(got[i][k]);
      }
      CHECK(wrong == 0);
      CHECK(outside == 0);
    }
  }
}

TEST_CASE("a bit changed anywhere changes half the bits of every hashed number", "[random]") {
  constexpr int kDraws = 400;
  double least = 1.0, most = 0.0;
  for (int bit = 0; bit < 64 + 4 * 32; ++bit) {
    std::array<int, 96> flips{};
    for (int n = 0; n < kDraws; ++n) {
      Random random(kSeed, 2, static_cast<std::uint64_t>(n));
      std::uint64_t seed = random.bits() >> random.below(64);
      std::array<std::uint32_t, 4> of{random.below(1u << 20), random.below(4096), 1 + random.below(63),
                                      random.below(8)};
      const glm::vec4 before = hashed_block(seed, of[0], of[1], of[2], of[3]);
      if (bit < 64) seed ^= std::uint64_t{1} << bit;
      if (bit >= 64) of[static_cast<std::size_t>(bit / 32 - 2)] ^= 1u << (bit % 32);
      const glm::vec4 after = hashed_block(seed, of[0], of[1], of[2], of[3]);
      for (int k = 0; k < 4; ++k) {
        const std::uint32_t changed =
            static_cast<std::uint32_t>(before[k] * 0x1p24f) ^ static_cast<std::uint32_t>(after[k] * 0x1p24f);
        for (int at = 0; at < 24; ++at) flips[static_cast<std::size_t>(24 * k + at)] += (changed >> at) & 1;
      }
    }
    for (const int count : flips) {
      least = std::min(least, static_cast<double>(count) / kDraws);
      most = std::max(most, static_cast<double>(count) / kDraws);
    }
  }
  // 18,432 shares of a fair coin thrown 400 times: 5.5 standard deviations of 1/40.
  CHECK(least > 0.5 - 5.5 / 40.0);
  CHECK(most < 0.5 + 5.5 / 40.0);
}

TEST_CASE("numbers of neighbours are independent: pixels, frames, rays, blocks, seeds", "[random]") {
  using Numbers = std::function<glm::vec4(std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint64_t)>;
  const Numbers hash = [](std::uint32_t pixel, std::uint32_t frame, std::uint32_t ray, std::uint32_t block,
                          std::uint64_t seed) { return hashed_block(seed, pixel, frame, ray, block); };
  // Each statistic has 255 degrees of freedom; 32 are looked at; 6 standard deviations of so many are met by chance
  // once in some 10^5 runs.
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 0, 1, 0, 1), hash(i + 1, 0, 1, 0, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 0, 1, 0, 1), hash(i + 512, 0, 1, 0, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 0, 1, 0, 1), hash(i, 1, 1, 0, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(7, i, 1, 0, 1), hash(7, i + 1, 1, 0, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 3, 2, 2, 1), hash(i, 3, 3, 2, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 3, 1, 2, 1), hash(i, 3, 1, 3, 1)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 0, 1, 0, 1), hash(i, 0, 1, 0, 2)}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{hash(i, 0, 1, 0, i), hash(0, i, 1, 0, i)}; }) < 6.0);
  // Noise: within a layer and from layer to layer.
  std::vector<glm::vec4> layer(1 << 15), next(1 << 15);
  fill_noise_layer(kSeed, 0, layer);
  fill_noise_layer(kSeed, 1, next);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{layer[i], layer[(i + 1) % layer.size()]}; }) < 6.0);
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{layer[i], next[i]}; }) < 6.0);
  // The test can fail: a number that is the same as another one is found.
  CHECK(worst_pair([&](std::uint32_t i) { return std::pair{layer[i], layer[i]}; }) > 1000.0);
}

TEST_CASE("the numbers of frames' times are uniform and independent", "[random]") {
  std::vector<std::uint32_t> cells(256, 0);
  bool all_are_numbers = true;
  constexpr std::uint32_t kFrames = 1 << 15;
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    const double a = frame_time_number(kSeed, frame), b = frame_time_number(kSeed, frame + 1);
    all_are_numbers = all_are_numbers && is_random_number(static_cast<float>(a)) && a == static_cast<float>(a);
    ++cells[static_cast<std::size_t>(a * 16.0) * 16 + static_cast<std::size_t>(b * 16.0)];
  }
  CHECK(all_are_numbers);
  CHECK(excess(cells, kFrames) < 6.0);
  CHECK(frame_time_number(1, 0) != frame_time_number(2, 0));
}
