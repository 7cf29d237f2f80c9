// SPDX-License-Identifier: MIT
// Means and variances keep the bounds that accumulator.h states, however many the frames and whatever the samples.
#include "tracer/accumulator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "scenes/random.h"

using namespace plumbline;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

GlContext& context() {
  static GlContext instance;
  return instance;
}

/// The sample of a pixel in a frame.
using Samples = std::function<glm::vec4(int x, int y, std::uint32_t frame)>;

struct Tile {
  int x = 0, y = 0, width = 1, height = 1;
};

/// Adds `frames` samples of each pixel of a tile, in batches of lanes * blocks.
void add_frames(Accumulator& to, const Samples& samples, const Tile& tile, std::uint32_t frames, int lanes,
                int blocks) {
  for (std::uint32_t first = 0; first < frames;) {
    RenderBatch batch;
    batch.tile_x = tile.x, batch.tile_y = tile.y, batch.tile_width = tile.width, batch.tile_height = tile.height;
    batch.lanes = std::min(lanes, static_cast<int>(frames - first));
    batch.blocks = std::min(blocks, static_cast<int>(frames - first) / batch.lanes);
    batch.first_frame = first;
    batch.columns = tile.width * batch.lanes + 3;  // some may be left over
    batch.rows = tile.height * batch.blocks;
    std::vector<glm::vec4> texels(static_cast<std::size_t>(batch.columns * batch.rows), glm::vec4(kNan));
    for (int b = 0; b < batch.blocks; ++b)
      for (int y = 0; y < tile.height; ++y)
        for (int x = 0; x < tile.width; ++x)
          for (int l = 0; l < batch.lanes; ++l)
            texels[static_cast<std::size_t>((b * tile.height + y) * batch.columns + x * batch.lanes + l)] =
                samples(tile.x + x, tile.y + y, first + static_cast<std::uint32_t>(b * batch.lanes + l));
    const GlTexture texture(context(), GL_RGBA32F, GL_RGBA, GL_FLOAT, batch.columns, batch.rows, texels.data());
    to.add(texture, batch);
    first += static_cast<std::uint32_t>(batch.lanes * batch.blocks);
  }
}

struct Series {
  const char* name;
  std::function<double(Random&, std::uint32_t frame)> value;
  bool has_variance = true;  ///< differences of samples are within what the variance can bear
};

/// Samples that lose a careless sum.
std::vector<Series> nasty_series() {
  return {
      {"uniform", [](Random& r, std::uint32_t) { return r.uniform(); }},
      {"of either sign", [](Random& r, std::uint32_t) { return r.uniform(-1.0, 1.0); }},
      {"equal", [](Random&, std::uint32_t) { return 0.1; }},
      {"zero", [](Random&, std::uint32_t) { return 0.0; }},
      {"noise of 2^-20 on 1", [](Random& r, std::uint32_t) { return 1.0 + 0x1p-20 * r.uniform(); }},
      {"one differs by a unit in the last place",
       [](Random&, std::uint32_t f) { return f == 77777 ? 0.7 + 0x1p-24 : 0.7; }},
      {"the first is an outlier", [](Random& r, std::uint32_t f) { return f == 0 ? 1e9 : 1.0 + 1e-3 * r.uniform(); }},
      {"the first of a chunk is an outlier",
       [](Random& r, std::uint32_t f) { return f == 1024 ? 1e9 : 1e-3 * r.uniform(); }},
      {"rare outliers", [](Random& r, std::uint32_t) { return r.below(10000) == 0 ? 1e8 : 1e-3 * r.uniform(); }},
      {"of all sizes", [](Random& r, std::uint32_t) { return std::exp2(r.uniform(-40.0, 40.0)); }},
      {"a ramp", [](Random&, std::uint32_t f) { return 1.0 + f; }},
      {"large ones that cancel", [](Random& r, std::uint32_t f) { return (f % 2 == 0 ? 1e15 : -1e15) + r.uniform(); }},
      {"small and large in turn", [](Random&, std::uint32_t f) { return f % 2 == 0 ? 1e-15 : 1e15; }},
      {"as large as floats can be", [](Random& r, std::uint32_t) { return r.uniform(3.0e38, 3.4e38); }, false},
      {"the largest floats of either sign", [](Random&, std::uint32_t f) { return f % 3 == 0 ? -3.4e38 : 3.4e38; },
       false},
      {"tiny", [](Random& r, std::uint32_t) { return 0x1p-80 * r.uniform(); }, false},
  };
}

std::vector<std::vector<float>> sampled(const std::vector<Series>& all, std::uint32_t frames) {
  std::vector<std::vector<float>> values(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    Random random(1, name_hash("nasty"), s);
    for (std::uint32_t f = 0; f < frames; ++f) values[s].push_back(static_cast<float>(all[s].value(random, f)));
  }
  return values;
}

/// Series s stands in pixel (s % 4, s / 4), in all channels: as it is, negated, and halved.
Samples samples_of(const std::vector<std::vector<float>>& values) {
  return [&values](int x, int y, std::uint32_t f) {
    const float v = values[static_cast<std::size_t>(y * 4 + x)][f];
    return glm::vec4(v, -v, 0.5f * v, 0.0f);
  };
}

bool same_bits(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::dvec3)) == 0;
}

}  // namespace

TEST_CASE("sums of 100,000 nasty samples lose nothing", "[accumulator]") {
  constexpr std::uint32_t kFrames = 100000;
  const std::vector<Series> series = nasty_series();
  const auto values = sampled(series, kFrames);
  Accumulator accumulator(context(), 4, 4);
  add_frames(accumulator, samples_of(values), {0, 0, 4, 4}, kFrames, 64, 60);
  const AccumulatedMoments moments = accumulator.read();
  REQUIRE(moments.frames == kFrames);
  REQUIRE(moments.variance.size() == 16);
  for (std::size_t s = 0; s < series.size(); ++s) {
    INFO(series[s].name);
    long double sum = 0.0L, sum_of_sizes = 0.0L, squares = 0.0L;
    for (const float v : values[s]) sum += v, sum_of_sizes += std::abs(v);
    const long double mean = sum / kFrames;
    for (const float v : values[s]) squares += (v - mean) * (v - mean);
    const long double variance = squares / (kFrames - 1);
    const auto bound = static_cast<double>(0x1p-24L * sum_of_sizes / kFrames + 0x1p-110L);
    CHECK(std::abs(moments.mean[s].x - static_cast<double>(mean)) <= bound);
    CHECK(std::abs(moments.mean[s].y + static_cast<double>(mean)) <= bound);
    CHECK(std::abs(moments.mean[s].z - static_cast<double>(mean / 2)) <= bound);
    if (!series[s].has_variance) continue;
    const auto exact = static_cast<double>(variance);
    CHECK(std::abs(moments.variance[s].x - exact) <= 0x1p-22 * exact);
    CHECK(std::abs(moments.variance[s].y - exact) <= 0x1p-22 * exact);
    CHECK(std::abs(moments.variance[s].z - exact / 4) <= 0x1p-22 * exact / 4);
    if (std::string_view(series[s].name) == "equal" || std::string_view(series[s].name) == "zero") {
      CHECK(moments.mean[s].x == static_cast<double>(values[s][0]));
      CHECK(moments.variance[s] == glm::dvec3(0.0));
    }
  }
  CHECK(moments.variance[14].x == HUGE_VAL);
}

TEST_CASE("means and variances do not depend on how frames are put into batches", "[accumulator]") {
  constexpr std::uint32_t kFrames = 2500;
  const auto values = sampled(nasty_series(), kFrames);
  AccumulatedMoments expected;
  for (const auto& [lanes, blocks] : {std::pair{1, 1}, std::pair{7, 3}, std::pair{128, 20}, std::pair{1, 64}}) {
    Accumulator accumulator(context(), 4, 4);
    add_frames(accumulator, samples_of(values), {0, 0, 4, 4}, kFrames, lanes, blocks);
    const AccumulatedMoments moments = accumulator.read();
    if (expected.mean.empty()) expected = moments;
    CHECK(moments.frames == kFrames);
    CHECK(same_bits(moments.mean, expected.mean));
    CHECK(same_bits(moments.variance, expected.variance));
    CHECK(same_bits(accumulator.read().mean, expected.mean));
  }
}

TEST_CASE("the variance is unbiased: of two samples it is half of their squared difference", "[accumulator]") {
  Accumulator accumulator(context(), 1, 1);
  const Samples samples = [](int, int, std::uint32_t f) { return glm::vec4(f == 0 ? 1.0f : 4.0f, 2.0f, f, 0.0f); };
  add_frames(accumulator, samples, {}, 1, 1, 1);
  CHECK(accumulator.read().frames == 1);
  CHECK(accumulator.read().mean[0] == glm::dvec3(1.0, 2.0, 0.0));
  CHECK(accumulator.read().variance.empty());
  accumulator.clear();
  add_frames(accumulator, samples, {}, 2, 2, 1);
  CHECK(accumulator.read().mean[0] == glm::dvec3(2.5, 2.0, 0.5));
  CHECK(accumulator.read().variance[0] == glm::dvec3(4.5, 0.0, 0.5));
}

TEST_CASE("NaN and infinity stay in the mean of their channel alone", "[accumulator]") {
  // Pixel x has a sample that is not finite in frame 0, in frame 1, or in frame 1500, which is of a later chunk.
  const std::vector<std::uint32_t> when{0, 1, 1500};
  const auto with = [&](float first, float second) -> Samples {
    return [&when, first, second](int x, int, std::uint32_t f) {
      const std::uint32_t at = when[static_cast<std::size_t>(x)];
      return glm::vec4(f == at ? first : f == 2000 ? second : 0.25f, 0.75f, 3.0f, 0.0f);
    };
  };
  struct Known {
    float first, second;
    double mean;
  };
  for (const Known& known : {Known{kInfinity, 0.25f, HUGE_VAL}, Known{-kInfinity, 0.25f, -HUGE_VAL},
                             Known{kInfinity, kInfinity, HUGE_VAL}, Known{kInfinity, -kInfinity, NAN},
                             Known{kNan, 0.25f, NAN}, Known{kNan, kInfinity, NAN}, Known{-kInfinity, kNan, NAN}}) {
    Accumulator accumulator(context(), 3, 1);
    add_frames(accumulator, with(known.first, known.second), {0, 0, 3, 1}, 2100, 16, 8);
    const AccumulatedMoments moments = accumulator.read();
    for (std::size_t x = 0; x < 3; ++x) {
      INFO(known.first << " in frame " << when[x] << " and " << known.second);
      CHECK((std::isnan(known.mean) ? std::isnan(moments.mean[x].x) : moments.mean[x].x == known.mean));
      CHECK(std::isnan(moments.variance[x].x));
      CHECK(moments.mean[x].y == 0.75);
      CHECK(moments.mean[x].z == 3.0);
      CHECK(moments.variance[x].y == 0.0);
    }
  }
}

TEST_CASE("a walk without an end makes its pixel NaN, in all channels", "[accumulator]") {
  Accumulator accumulator(context(), 2, 2);
  const Samples samples = [](int x, int y, std::uint32_t f) {
    return glm::vec4(1.0f, 2.0f, 3.0f, x == 1 && y == 0 && f == 3 ? 2.0f : 0.0f);
  };
  add_frames(accumulator, samples, {0, 0, 2, 2}, 1100, 5, 20);
  const AccumulatedMoments moments = accumulator.read();
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      CHECK(std::isnan(moments.mean[i][k]) == (i == 1));
      CHECK(std::isnan(moments.variance[i][k]) == (i == 1));
    }
}

TEST_CASE("tiles of different numbers of frames make one picture", "[accumulator]") {
  Accumulator accumulator(context(), 5, 3);
  const Samples samples = [](int x, int y, std::uint32_t f) { return glm::vec4(x, y, f % 2, 0.0f); };
  CHECK(accumulator.read().frames == 0);
  add_frames(accumulator, samples, {0, 0, 3, 2}, 1030, 20, 10);
  add_frames(accumulator, samples, {3, 0, 2, 2}, 8, 4, 1);
  CHECK(accumulator.read().frames == 0);
  CHECK(accumulator.read().mean[4] == glm::dvec3(4.0, 0.0, 0.5));
  CHECK(std::isnan(accumulator.read().mean[10].x));
  add_frames(accumulator, samples, {0, 2, 3, 1}, 6, 2, 1);
  add_frames(accumulator, samples, {3, 2, 2, 1}, 6, 1, 3);
  const AccumulatedMoments moments = accumulator.read();
  CHECK(moments.frames == 6);
  for (std::size_t i = 0; i < 15; ++i) {
    CHECK(moments.mean[i] == glm::dvec3(i % 5, i / 5, 0.5));
    const double n = i / 5 == 2 ? 6.0 : i % 5 < 3 ? 1030.0 : 8.0;
    CHECK(moments.variance[i].z == Approx(0.25 * n / (n - 1.0)).epsilon(1e-12));
  }
  accumulator.clear();
  CHECK(accumulator.read().frames == 0);
}

TEST_CASE("the shader that sums up compiles in GLSL ES 3.00", "[accumulator]") {
  const GlProgram program(context(), link_program(context(), probe_vertex_shader(GlslDialect::es_300),
                                                  accumulate_shader(GlslDialect::es_300)));
}
