// SPDX-License-Identifier: MIT
// Image files: EXR keeps every bit and attribute, PNG every byte, and files that are no images are refused.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/error.h"
#include "scenes/image_file.h"
#include "scenes/random.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

/// Random bits as floats: denormals, infinities and NaN with payloads among them.
Image random_image(int width, int height, std::vector<std::string> channels) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = std::move(channels);
  Random random(1, 2, 3);
  for (std::size_t i = 0; i < static_cast<std::size_t>(width * height) * image.channels.size(); ++i) {
    image.pixels.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32)));
  }
  image.pixels[0] = -0.0f;
  return image;
}

std::size_t different_bits(const std::vector<float>& a, const std::vector<float>& b) {
  std::size_t count = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    count += std::bit_cast<std::uint32_t>(a[i]) == std::bit_cast<std::uint32_t>(b[i]) ? 0 : 1;
  }
  return count;
}

}  // namespace

TEST_CASE("EXR keeps every bit of every float, names and attributes") {
  const TemporaryFolder folder;
  Image image = random_image(67, 33, {"R", "G", "B", "A"});
  image.attributes["plumbline:layout"] = std::string("compact, with \"quotes\" and a\nline break");
  image.attributes["plumbline:cells"] = 1'234'567'890;
  image.attributes["plumbline:negative"] = -5;
  image.attributes["plumbline:radius"] = 0.1f;
  write_exr(folder.path() / "a.exr", image);
  const Image back = read_image(folder.path() / "a.exr");
  CHECK(back.width == 67);
  CHECK(back.height == 33);
  CHECK(back.channels == image.channels);
  CHECK_FALSE(back.is_integer);
  CHECK(different_bits(image.pixels, back.pixels) == 0);
  for (const auto& [name, value] : image.attributes) {
    INFO(name);
    REQUIRE(back.attributes.count(name) == 1);
    CHECK((back.attributes.at(name) == value));
  }
  // Nothing is left beside it.
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("EXR keeps channels of any name, each with its values") {
  const TemporaryFolder folder;
  const Image image = random_image(5, 4, {"steps", "R", "primitive"});
  write_exr(folder.path() / "a.exr", image);
  const Image back = read_image(folder.path() / "a.exr");
  REQUIRE(back.channels.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto found = std::find(back.channels.begin(), back.channels.end(), image.channels[c]);
    REQUIRE(found != back.channels.end());
    const auto at = static_cast<std::size_t>(found - back.channels.begin());
    for (std::size_t i = 0; i < 20; ++i) {
      CHECK(std::bit_cast<std::uint32_t>(back.pixels[3 * i + at]) ==
            std::bit_cast<std::uint32_t>(image.pixels[3 * i + c]));
    }
  }
}

TEST_CASE("PNG keeps every byte") {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 16 * 16 * 3; ++i) bytes.push_back(static_cast<std::uint8_t>(i * 7));
  write_png(folder.path() / "a.png", 16, 16, bytes);
  const Image back = read_image(folder.path() / "a.png");
  CHECK(back.is_integer);
  REQUIRE(back.pixels.size() == bytes.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) wrong += std::lround(back.pixels[i] * 255.0f) == bytes[i] ? 0 : 1;
  CHECK(wrong == 0);
}

TEST_CASE("Files that are no images are refused, targets that cannot be written are reported") {
  const TemporaryFolder folder;
  Image image = random_image(64, 64, {"R", "G", "B", "A"});
  write_exr(folder.path() / "whole.exr", image);
  std::string bytes(std::filesystem::file_size(folder.path() / "whole.exr"), '\0');
  std::ifstream(folder.path() / "whole.exr", std::ios::binary)
      .read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  for (const double part : {0.0, 0.001, 0.01, 0.3, 0.9, 0.999}) {
    INFO(part);
    CHECK_THROWS_AS(
        read_image(folder.write("cut.exr", std::string_view(bytes).substr(
                                               0, static_cast<std::size_t>(part * static_cast<double>(bytes.size()))))),
        InputError);
  }
  CHECK_THROWS_AS(read_image(folder.write("text.exr", "this is text")), InputError);
  CHECK_THROWS_AS(read_image(folder.write("text.png", "this is text")), InputError);
  CHECK_THROWS_AS(read_image(folder.path() / "missing.exr"), InputError);
  CHECK_THROWS_AS(read_image(folder.path()), InputError);
  CHECK_THROWS_AS(write_exr(folder.path() / "a.jpg", image), InputError);
  CHECK_THROWS_AS(write_exr(folder.path() / "no" / "such" / "folder.exr", image), EnvironmentError);
  // A folder of that name stands in the way: nothing is written beside it, and nothing is gone.
  std::filesystem::create_directories(folder.path() / "taken.exr" / "in");
  CHECK_THROWS_AS(write_exr(folder.path() / "taken.exr", image), InputError);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    CHECK(entry.path().filename().string().front() != '.');
  }
}

TEST_CASE("sRGB there and back") {
  for (int i = 0; i <= 255; ++i) CHECK(std::lround(to_srgb(from_srgb(static_cast<float>(i) / 255.0f)) * 255.0f) == i);
  CHECK(to_srgb(-1.0f) == 0.0f);
  CHECK(to_srgb(2.0f) == Approx(1.0f));
}
