// SPDX-License-Identifier: MIT
// Files that are no sound geometry images: each is refused with a reason, and none costs memory or time.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <fstream>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/image_file.h"
#include "scenes/random.h"
#include "tracer/verify.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

/// A folder of this test's own, removed with everything in it.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plumbline_image_file_" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}
void write_content(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

/// Puts 32 bits, the lowest byte first.
void put(std::string& content, std::size_t at, std::uint32_t value) { std::memcpy(&content[at], &value, 4); }

}  // namespace

TEST_CASE("a file of a newer format says that it is newer", "[verify]") {
  const Folder folder;
  const auto path = folder.path / "tree.exr";
  write_geometry_image(bake(generate_scene("cube")), path);
  Image file = read_image(path);
  file.attributes["plumbline:version"] = kGeometryImageVersion + 1;
  file.attributes.erase("plumbline:layout");  // it may lack what this version has
  write_exr(path, file);
  CHECK_THROWS_WITH(read_geometry_image(path),
                    Contains("newer") && Contains(std::to_string(kGeometryImageVersion + 1)));
  CHECK_THROWS_AS(read_geometry_image(path), InputError);
}

TEST_CASE("attributes that contradict one another are refused", "[verify]") {
  const Folder folder;
  const auto path = folder.path / "tree.exr";
  const GeometryImage image = bake(load_scene("nested"));
  write_geometry_image(image, path);
  const Image file = read_image(path);
  CHECK(certify(read_geometry_image(path)).is_sound());
  const std::pair<const char*, ImageAttribute> lies[] = {{"payload_bits", 3},
                                                         {"payload_bits", 24},
                                                         {"payload_bits", -1},
                                                         {"copy_size", 0},
                                                         {"copy_size", 1 << 30},
                                                         {"primitives", 1 << 24},
                                                         {"primitive_start", 7},
                                                         {"transform_start", 1},
                                                         {"transforms", 1 << 25},
                                                         {"world_primitives", 1 << 20},
                                                         {"radius", -1.0f},
                                                         {"center_x", std::numeric_limits<float>::infinity()},
                                                         {"scale_exponent", 1000},
                                                         {"triangles", -1},
                                                         {"cell_count", std::string("many")},
                                                         {"links", std::string("threaded")},
                                                         {"asked_width", 0}};
  for (const auto& [name, value] : lies) {
    Image copy = file;
    copy.attributes[std::string("plumbline:") + name] = value;
    write_exr(path, copy);
    INFO(name);
    // What the sizes alone do not contradict, the certificate does.
    bool is_refused = false;
    try {
      is_refused = !certify(read_geometry_image(path)).is_sound();
    } catch (const InputError&) {
      is_refused = true;
    }
    CHECK(is_refused);
  }
}

TEST_CASE("truncated files, and headers that promise what is not there, are refused at once", "[verify]") {
  const Folder folder;
  const auto path = folder.path / "tree.exr", broken = folder.path / "broken.exr";
  write_geometry_image(bake(generate_scene("creature")), path);
  const std::string content = content_of(path);
  for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999}) {
    write_content(broken, content.substr(0, static_cast<std::size_t>(share * static_cast<double>(content.size()))));
    INFO("the first " << share);
    CHECK_THROWS_AS(read_geometry_image(broken), InputError);
  }
  // The header's data window claims 16384 x 16384 texels, or two thousand million.
  const std::size_t window = content.find("dataWindow") + std::strlen("dataWindow") + 1 + std::strlen("box2i") + 1 + 4;
  for (const std::uint32_t last : {16383u, 0x7ffffff0u}) {
    std::string huge = content;
    put(huge, window + 8, last), put(huge, window + 12, last);
    write_content(broken, huge);
    const auto start = std::chrono::steady_clock::now();
    CHECK_THROWS_AS(read_geometry_image(broken), InputError);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));
  }
}

TEST_CASE("files with bytes that changed are refused, or come back as an image that can be judged", "[verify]") {
  const Folder folder;
  const auto path = folder.path / "tree.exr";
  BakeOptions options;
  options.width = 16;
  const GeometryImage image = bake(generate_scene("cube"), options);
  write_geometry_image(image, path);
  const std::string content = content_of(path);
  std::size_t refused = 0, unsound = 0, same = 0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    Random random(1, 2, trial);
    std::string broken = content;
    broken[random.below(static_cast<std::uint32_t>(broken.size()))] ^= static_cast<char>(1u << random.below(8));
    write_content(path, broken);
    try {
      const GeometryImage back = read_geometry_image(path);
      ++(certify(back).is_sound() ? same : unsound);
    } catch (const InputError&) {
      ++refused;
    }
  }
  WARN(refused << " refused, " << unsound << " unsound, " << same << " sound all the same");
  CHECK(refused > 50);
  CHECK(refused + unsound + same == 300);
}

TEST_CASE("other images are refused", "[verify]") {
  const Folder folder;
  const auto path = folder.path / "other.exr";
  Image foreign;
  foreign.width = foreign.height = 16;
  foreign.channels = {"Z"};
  foreign.pixels.assign(16 * 16, 0.5f);
  write_exr(path, foreign);
  CHECK_THROWS_WITH(read_geometry_image(path), Contains("plumbline:version"));
  const std::vector<std::uint8_t> white(16 * 16 * 3, 255);
  write_png(folder.path / "white.png", 16, 16, white);
  CHECK_THROWS_AS(read_geometry_image(folder.path / "white.png"), InputError);
  write_content(path, "v/1\x01" + std::string(100, '\xff'));
  CHECK_THROWS_AS(read_geometry_image(path), InputError);
}
