// SPDX-License-Identifier: MIT
// The bake: every variant is sound when walked on the CPU, bounds hold what they should, files keep every bit.
#include "tracer/geometry_image.h"

#include <unistd.h>

#include <bit>
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/image_file.h"
#include "tracer/verify.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

std::vector<BakeOptions> all_layouts() {
  std::vector<BakeOptions> all;
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      for (const Links links : {Links::octant, Links::threaded}) {
        BakeOptions options;
        options.layout = layout, options.bounds = bounds, options.links = links;
        all.push_back(options);
      }
    }
  }
  return all;
}

std::string described(const BakeOptions& o) {
  return std::string(name_of(o.layout)) + " " + name_of(o.bounds) + " " + name_of(o.links) + " leaf " +
         std::to_string(o.tree.leaf_size);
}

bool same_bits(const GeometryImage& a, const GeometryImage& b) {
  return a.width == b.width && a.height == b.height && a.texels.size() == b.texels.size() &&
         std::memcmp(a.texels.data(), b.texels.data(), a.texels.size() * sizeof(glm::vec4)) == 0;
}

/// A folder of this test's own, removed with everything in it.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plumbline_image_" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

Scene one_triangle() {
  Scene scene;
  scene.name = "one_triangle";
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.push_back({{0, 1, 2}});
  scene.materials.emplace_back();
  return scene;
}

}  // namespace

TEST_CASE("every variant of a bake is sound", "[image]") {
  for (const char* name : {"sphereflake", "creature", "tetra"}) {
    const Scene scene = generate_scene(name, std::string(name) == "sphereflake" ? 2 : 0);
    for (BakeOptions options : all_layouts()) {
      for (const int leaf_size : {1, 4, 8}) {
        options.tree.leaf_size = leaf_size;
        options.tree.split_long = leaf_size == 8 ? 0.2f : 0.0f;
        const GeometryImage image = bake(scene, options);
        INFO(name << " " << described(options));
        CHECK(certify(image).is_sound());
        CHECK(image.triangle_count == scene.triangles.size());
        CHECK(image.sphere_count == scene.spheres.size());
        CHECK(image.primitive_count >= scene.primitive_count());
        CHECK(image.copy_count == (options.links == Links::octant ? 8u : 1u));
      }
    }
  }
}

TEST_CASE("an empty scene and a scene of one primitive are baked", "[image]") {
  for (const BakeOptions& options : all_layouts()) {
    INFO(described(options));
    const GeometryImage empty = bake(Scene{}, options);
    CHECK(certify(empty).is_sound());
    CHECK(empty.primitive_count == 0);
    const GeometryImage one = bake(one_triangle(), options);
    CHECK(certify(one).is_sound());
    CHECK(one.primitive_count == 1);
  }
}

TEST_CASE("the certificate finds a broken link in every layout", "[image]") {
  const Scene scene = generate_scene("creature");
  for (const BakeOptions& options : all_layouts()) {
    const GeometryImage sound = bake(scene, options);
    INFO(described(options));
    // The root's way out: a longer one leaves out its neighbour's place; the root's way in, where the layout has one.
    GeometryImage broken = sound;
    if (options.layout == Layout::compact) {
      broken.texels[0].w = std::bit_cast<float>(std::bit_cast<std::uint32_t>(sound.texels[0].w) + 1u);
    } else {
      broken.texels[static_cast<std::size_t>(sound.width)].x += 2.0f / static_cast<float>(sound.width);
    }
    CHECK_FALSE(certify(broken).is_sound());
  }
}

TEST_CASE("compact words are at least the squared radius, and hardly more", "[image]") {
  const Scene scene = generate_scene("sphereflake", 2);
  BakeOptions options;
  options.links = Links::threaded;
  const SceneTree trees = build_scene_tree(scene, options.tree);
  const SphereTree& tree = trees.world;
  const GeometryImage image = bake(scene, trees, options);
  // Threaded copies keep the tree's own depth-first order, so both can be walked side by side.
  std::vector<std::uint32_t> stack{0};
  std::size_t at = 0;
  while (!stack.empty()) {
    const TreeNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    for (std::uint32_t i = node.child_count; i-- > 0;) stack.push_back(node.first_child + i);
    const glm::vec4 texel = image.texels[at++];
    CHECK(glm::vec3(texel) == node.center);
    const double packed = std::sqrt(std::abs(static_cast<double>(texel.w)));
    CHECK(packed > node.radius);
    CHECK((texel.w < 0.0f) == node.is_leaf());
    // Padding: 2^-17 of the scene and 2^-12 of the longest edge below (at most its diameter); packing: one step of the
    // bits that are left.
    const double padded = node.radius * (1.0 + 0x1p-11) + 0x1p-17 * image.radius;
    CHECK(packed <= padded * (1.0 + std::ldexp(1.0, image.payload_bits - 23)));
  }
  CHECK(std::bit_cast<std::uint32_t>(image.texels[at].w) == kEndWord);
}

TEST_CASE("extreme scales are brought near 1 by an exact power of two", "[image]") {
  const Scene scene = generate_scene("tetra", 3);
  const GeometryImage plain = bake(scene);
  CHECK(plain.scale_exponent == 0);
  for (const int exponent : {-100, 100}) {
    Scene scaled = scene;
    for (glm::vec3& p : scaled.positions)
      p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
    const GeometryImage image = bake(scaled);
    INFO("scaled by 2^" << exponent);
    CHECK(image.scale_exponent != 0);
    CHECK(image.radius >= 0.5f);
    CHECK(image.radius <= 1.0f);
    CHECK(certify(image).is_sound());
    // Corner for corner the same triangles, but for the factor.
    const float factor = std::ldexp(1.0f, exponent + image.scale_exponent);
    std::size_t same = 0;
    for (std::uint32_t i = 0; i < image.primitive_count * image.primitive_stride; ++i) {
      const glm::vec3 a(image.texels[image.primitive_start + i]), b(plain.texels[plain.primitive_start + i]);
      same += a == b * factor;
    }
    CHECK(same == image.primitive_count * image.primitive_stride);
  }
}

TEST_CASE("images grow by powers of two and refuse what cannot be", "[image]") {
  BakeOptions options;
  options.width = 16;
  const GeometryImage image = bake(generate_scene("creature"), options);
  CHECK(std::has_single_bit(static_cast<unsigned>(image.width)));
  CHECK(std::has_single_bit(static_cast<unsigned>(image.height)));
  const std::size_t needed = image.primitive_start + std::size_t{image.primitive_stride} * image.primitive_count;
  CHECK(image.texels.size() >= needed);
  CHECK(image.texels.size() < 2 * needed);
  CHECK(bake(one_triangle()).width == 512);

  for (const int width : {0, -512, 8, 500, 32768}) {
    options.width = width;
    CHECK_THROWS_AS(bake(one_triangle(), options), InputError);
  }
  Scene broken = one_triangle();
  broken.positions[1].x = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(bake(broken), InputError);
  broken.positions[1].x = std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(bake(broken), InputError);
}

TEST_CASE("a geometry image comes back from its file bit for bit", "[image]") {
  const Folder folder;
  const auto path = folder.path / "tree.exr";
  for (const char* name : {"sphereflake", "creature"}) {
    for (const BakeOptions& options : all_layouts()) {
      const GeometryImage image = bake(generate_scene(name, std::string(name) == "sphereflake" ? 2 : 0), options);
      write_geometry_image(image, path);
      const GeometryImage back = read_geometry_image(path);
      INFO(name << " " << described(options));
      CHECK(same_bits(image, back));
      CHECK(back.scene_name == image.scene_name);
      CHECK(described(back.options) == described(image.options));
      CHECK(back.options.tree.width == image.options.tree.width);
      CHECK(back.options.tree.split_long == image.options.tree.split_long);
      CHECK(back.cell_count == image.cell_count);
      CHECK(back.center == image.center);
      CHECK(back.radius == image.radius);
      CHECK(back.scale_exponent == image.scale_exponent);
      CHECK(back.triangle_count == image.triangle_count);
      CHECK(back.sphere_count == image.sphere_count);
      CHECK(back.primitive_count == image.primitive_count);
      CHECK(back.primitive_start == image.primitive_start);
      CHECK(back.primitive_stride == image.primitive_stride);
      CHECK(back.copy_count == image.copy_count);
      CHECK(back.copy_size == image.copy_size);
      CHECK(back.payload_bits == image.payload_bits);
      CHECK(certify(back).is_sound());
    }
  }
}

TEST_CASE("files that are no geometry image are refused with a reason", "[image]") {
  const Folder folder;
  const auto path = folder.path / "other.exr";
  CHECK_THROWS_AS(read_geometry_image(path), InputError);  // missing
  CHECK_THROWS_AS(read_geometry_image(folder.path), InputError);
  std::ofstream(path) << "not an image";
  CHECK_THROWS_AS(read_geometry_image(path), InputError);

  Image foreign;
  foreign.width = foreign.height = 16;
  foreign.channels = {"R", "G", "B", "A"};
  foreign.pixels.assign(16 * 16 * 4, 0.5f);
  write_exr(path, foreign);
  CHECK_THROWS_WITH(read_geometry_image(path), Contains("plumbline:version"));

  const GeometryImage image = bake(one_triangle());
  write_geometry_image(image, path);
  Image changed = read_image(path);
  const auto refuses = [&](const char* attribute, ImageAttribute value, const char* reason) {
    Image copy = changed;
    copy.attributes[attribute] = std::move(value);
    write_exr(path, copy);
    CHECK_THROWS_WITH(read_geometry_image(path), Contains(reason));
  };
  refuses("plumbline:version", kGeometryImageVersion + 1, "newer");
  refuses("plumbline:layout", std::string("octree"), "octree");
  refuses("plumbline:radius", 3, "another type");
  refuses("plumbline:primitives", 1 << 30, "contradicts itself");
  refuses("plumbline:payload_bits", 31, "payload_bits");
  changed.attributes.erase("plumbline:copy_size");
  write_exr(path, changed);
  CHECK_THROWS_WITH(read_geometry_image(path), Contains("copy_size"));
}
