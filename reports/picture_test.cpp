// SPDX-License-Identifier: MIT
// Colours that mean what they say: an even scale, primitives told apart, no verdict hidden.
#include "reports/picture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "reports/example_run.h"
#include "reports/files.h"
#include "reports/summary.h"
#include "scenes/image_file.h"
#include "scenes/scene.h"

namespace plumbline {

TEST_CASE("picture: lightness of the value scale rises evenly") {
  // Lightness is 0.24 + 0.72 v by design. Rounding to 8 bits moves it by at most half a code: near black, where a code
  // is widest in OKLab, that is below 0.004.
  for (int i = 0; i <= 100; ++i) {
    INFO(i);
    CHECK(std::fabs(lightness_of(value_color(i / 100.0)) - (0.24 + 0.72 * i / 100.0)) < 0.004);
  }
  CHECK(value_color(-3.0) == value_color(0.0));
  CHECK(value_color(7.0) == value_color(1.0));
  CHECK(value_color(std::nan("")) == kNoValue);
}

TEST_CASE("picture: known colours") {
  CHECK(oklch(1.0, 0.0, 0.0) == Rgb{255, 255, 255});
  CHECK(oklch(0.0, 0.0, 0.0) == Rgb{0, 0, 0});
  // sRGB red is (0.62796, 0.25768, 29.234 degrees) in OKLCh; its chroma lies on the border of what can be shown.
  const Rgb red = oklch(0.62796, 0.25768, 29.234);
  CHECK(red[0] >= 254);
  CHECK(red[1] <= 8);
  CHECK(red[2] <= 8);
  CHECK(std::fabs(lightness_of({255, 0, 0}) - 0.62796) < 1e-4);
  CHECK(hex_color({1, 171, 255}) == "#01abff");
}

TEST_CASE("picture: colours are shown as a screen shows linear light") {
  const std::vector<glm::dvec3> colors = {{0.0, 1.0, 0.5}, {-1.0, 7.0, 0.0}};
  const Picture picture = paint_colors(colors, 2, 1);
  CHECK(picture.pixels[0] == Rgb{0, 255, 188});  // IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354
  CHECK(picture.pixels[1] == Rgb{0, 255, 0});
}

TEST_CASE("picture: primitives and verdicts are told apart") {
  std::set<Rgb> colors;
  for (std::uint32_t i = 0; i < 1000; ++i) colors.insert(primitive_color(i));
  CHECK(colors.size() > 950);
  CHECK(primitive_color(17) == primitive_color(17));
  const auto& infos = verdict_infos();
  for (const auto& a : infos)
    for (const auto& b : infos)
      if (a.name != b.name) CHECK(verdict_color(a.name) != verdict_color(b.name));
}

TEST_CASE("picture: values are coloured between their extremes, what is no value apart") {
  const std::vector<float> values = {2.0f, 4.0f, 3.0f, std::nanf(""), INFINITY, 2.0f};
  const Picture picture = paint_values(values, 3, 2, "steps");
  CHECK(picture.pixels[0] == value_color(0.0));
  CHECK(picture.pixels[1] == value_color(1.0));
  CHECK(picture.pixels[2] == value_color(0.5));
  CHECK(picture.pixels[3] == kNoValue);
  CHECK(picture.pixels[4] == kNoValue);
  CHECK(picture.scale.low == 2.0);
  CHECK(picture.scale.high == 4.0);
  CHECK(picture.scale.unit == "steps");
  REQUIRE(picture.legend.size() == 1);
  CHECK(picture.legend[0].pixels == 2);
  const Picture fixed_range = paint_values(values, 3, 2, "steps", {.low = 0.0, .high = 8.0});
  CHECK(fixed_range.pixels[1] == value_color(0.5));
  const std::vector<float> none(4, std::nanf("")), same(4, 7.0f);
  CHECK(paint_values(none, 2, 2, "m").legend[0].pixels == 4);
  CHECK(paint_values(same, 2, 2, "m").pixels[3] == value_color(0.0));
}

TEST_CASE("picture: one lost pixel is seen, and the grave one over the harmless") {
  const std::vector<std::string> names = {"tie", "agree", "tracer_wrong"};
  std::vector<std::uint8_t> verdicts(32 * 32, 1);
  verdicts[10 * 32 + 10] = 2;
  verdicts[10 * 32 + 12] = 0;  // its disc reaches the pixel of the grave one
  verdicts[0] = 0;
  const Picture picture = paint_verdicts(verdicts, names, {}, 32, 32, 2);
  const auto at = [&](int x, int y) { return picture.pixels[static_cast<std::size_t>(y * 32 + x)]; };
  CHECK(at(10, 10) == verdict_color("tracer_wrong"));
  CHECK(at(12, 10) == verdict_color("tracer_wrong"));
  CHECK(at(13, 10) == verdict_color("tie"));
  CHECK(at(10, 12) == verdict_color("tracer_wrong"));
  CHECK(at(12, 12) == verdict_color("tie"));
  CHECK(at(20, 20) == verdict_color("agree"));
  CHECK(at(1, 1) == verdict_color("tie"));
  REQUIRE(picture.legend.size() == 3);
  CHECK(picture.legend[0].label == "agree");
  CHECK(picture.legend[0].pixels == 32 * 32 - 3);
  CHECK(picture.legend[2].label == "tracer_wrong");
  CHECK(picture.legend[2].pixels == 1);
}

TEST_CASE("picture: brightness darkens the hit map, misses stay apart") {
  const std::vector<std::uint32_t> primitives = {5, 5, kNone, 6};
  const std::vector<float> brightness = {1.0f, 0.1f, 1.0f, 1.0f};
  const Picture picture = paint_primitives(primitives, brightness, 2, 2);
  CHECK(picture.pixels[0] == primitive_color(5));
  CHECK(lightness_of(picture.pixels[1]) < 0.75 * lightness_of(picture.pixels[0]));
  CHECK(picture.pixels[2] == kNoValue);
  CHECK(picture.legend[0].pixels == 1);
}

TEST_CASE("picture: the file holds the pixels") {
  TemporaryFolder folder;
  const std::vector<float> values = {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f};
  const Picture picture = paint_values(values, 3, 2, "steps");
  const PictureRecord record = save_picture(picture, folder.path, "a/b c:d", "Steps", "Cells.");
  CHECK(record.path == "pictures/a_b_c_d.png");
  CHECK(record.width == 3);
  CHECK(record.scale.high == 5.0);
  const Image image = read_image(folder.path / record.path);
  REQUIRE(image.width == 3);
  REQUIRE(image.height == 2);
  REQUIRE(image.channel_count() == 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    CHECK(std::lround(image.pixels[i] * 255.0f) == picture.pixels[i / 3][i % 3]);
}

TEST_CASE("picture: the values are kept to the last bit, of small pictures alone") {
  TemporaryFolder folder;
  const std::vector<glm::dvec3> colors = {{0.1, 2.5, 0.0}, {1.0, 0.5, std::nan("")}};
  const Picture picture = paint_colors(colors, 2, 1);
  CHECK(picture.pixels[0] == Rgb{89, 255, 0});  // sRGB of 0.1 is 0.3492
  CHECK(picture.pixels[1] == kNoValue);
  REQUIRE(picture.legend.size() == 2);
  CHECK(picture.legend[0].label == "brighter than shown");
  const PictureRecord record = save_picture(picture, folder.path, "pair", "Tracer", "");
  CHECK(record.values == "pictures/pair.values.js");
  // 0.1f is 3dcccccd, 2.5f 40200000, 1.0f 3f800000, 0.5f 3f000000, NaN 7fc00000: little-endian, in base64.
  CHECK(read_text(folder.path / record.values) ==
        "plumbline_values({\"picture\":\"pictures/pair.png\",\"width\":2,\"height\":1,\"unit\":\"linear "
        "colour\",\"channels\":[\"R\",\"G\",\"B\"],\"kinds\":[],\"float32\":"
        "\"zczMPQAAIEAAAAAAAACAPwAAAD8AAMB/\"})\n");
  const std::vector<float> most(kMostValuePixels, 1.0f), more(kMostValuePixels + 1, 1.0f);
  CHECK_FALSE(save_picture(paint_values(most, 128, 128, "m"), folder.path, "most", "", "").values.empty());
  CHECK(save_picture(paint_values(more, kMostValuePixels + 1, 1, "m"), folder.path, "more", "", "").values.empty());
  CHECK(
      save_picture(paint_primitives(std::vector<std::uint32_t>{1}, {}, 1, 1), folder.path, "p", "", "").values.empty());
}

TEST_CASE("Signed values are blue below zero, orange above, and alike in size") {
  const std::vector<float> values{-9.0f, -2.0f, 0.0f, 2.0f, std::numeric_limits<float>::quiet_NaN(), 4.0f};
  const Picture picture = paint_signed(values, 3, 2, "sigmas", 4.0);
  CHECK(picture.pixels[0] == signed_color(-1.0));
  CHECK(picture.pixels[1][2] > picture.pixels[1][0]);
  CHECK(picture.pixels[3][0] > picture.pixels[3][2]);
  CHECK(std::abs(lightness_of(picture.pixels[1]) - lightness_of(picture.pixels[3])) < 0.03);
  CHECK(lightness_of(picture.pixels[2]) > 0.9);
  CHECK(picture.pixels[4] == kNoValue);
  CHECK((picture.scale.low == -4.0 && picture.scale.high == 4.0));
  CHECK((picture.legend.size() == 1 && picture.legend[0].pixels == 1));
}

}  // namespace plumbline
