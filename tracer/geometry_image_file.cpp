// SPDX-License-Identifier: MIT
// Geometry images as OpenEXR files: the texels are the pixels, everything else is an attribute named plumbline:...
#include <bit>
#include <cstring>
#include <limits>

#include "scenes/error.h"
#include "scenes/image_file.h"
#include "tracer/geometry_image.h"

namespace plumbline {
namespace {

const std::string kPrefix = "plumbline:";
static_assert(sizeof(glm::vec4) == 4 * sizeof(float));

/// Reads attributes, and says of the first that is missing or wrong which file it is missing from.
class Attributes {
 public:
  Attributes(const Image& image, const std::filesystem::path& path) : image_(image), path_(path) {}

  template <class T>
  T get(const std::string& name) const {
    const auto found = image_.attributes.find(kPrefix + name);
    if (found == image_.attributes.end()) fail("has no attribute " + kPrefix + name);
    if (const T* value = std::get_if<T>(&found->second)) return *value;
    fail("has an attribute " + kPrefix + name + " of another type");
  }
  int integer(const std::string& name, int low, int high) const {
    const int value = get<int>(name);
    if (value < low || value > high) {
      fail("has " + kPrefix + name + " = " + std::to_string(value) + ", but it must lie from " + std::to_string(low) +
           " to " + std::to_string(high));
    }
    return value;
  }
  std::uint32_t count(const std::string& name) const {
    return static_cast<std::uint32_t>(integer(name, 0, std::numeric_limits<int>::max()));
  }
  template <class Enum>
  Enum choice(const std::string& name, Enum a, Enum b) const {
    const auto value = get<std::string>(name);
    if (value == name_of(a)) return a;
    if (value == name_of(b)) return b;
    fail("has " + kPrefix + name + " = " + value + ", but known are " + name_of(a) + " and " + name_of(b));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_.string() + " is not a geometry image of this version: it " + what +
                     "; write it anew with `plumbline bake`");
  }

 private:
  const Image& image_;
  const std::filesystem::path& path_;
};

}  // namespace

void write_geometry_image(const GeometryImage& image, const std::filesystem::path& path) {
  Image file;
  file.width = image.width, file.height = image.height;
  file.channels = {"R", "G", "B", "A"};
  file.pixels.resize(image.texels.size() * 4);
  std::memcpy(file.pixels.data(), image.texels.data(), image.texels.size() * sizeof(glm::vec4));
  const auto set = [&](const char* name, ImageAttribute value) { file.attributes[kPrefix + name] = std::move(value); };
  const auto set_count = [&](const char* name, std::uint32_t value) { set(name, static_cast<int>(value)); };
  set("version", kGeometryImageVersion);
  set("scene", image.scene_name);
  set("layout", std::string(name_of(image.options.layout)));
  set("bounds", std::string(name_of(image.options.bounds)));
  set("links", std::string(name_of(image.options.links)));
  set("transform_out", std::string(name_of(image.options.transform_out)));
  set("transform_list", std::string(name_of(image.options.transform_list)));
  set("asked_width", image.options.width);
  set("leaf_size", image.options.tree.leaf_size);
  set("tree_width", image.options.tree.width);
  set("split_long", image.options.tree.split_long);
  set_count("cell_count", image.cell_count);
  set("center_x", image.center.x);
  set("center_y", image.center.y);
  set("center_z", image.center.z);
  set("radius", image.radius);
  set("scale_exponent", image.scale_exponent);
  set_count("triangles", image.triangle_count);
  set_count("spheres", image.sphere_count);
  set_count("primitives", image.primitive_count);
  set_count("primitive_start", image.primitive_start);
  set_count("world_primitives", image.world_primitives);
  set_count("transform_start", image.transform_start);
  set_count("transforms", image.transform_count);
  set_count("copy_size", image.copy_size);
  set("payload_bits", image.payload_bits);
  write_exr(path, file);
}

GeometryImage read_geometry_image(const std::filesystem::path& path) {
  const Image file = read_image(path);
  const Attributes attributes(file, path);
  attributes.integer("version", kGeometryImageVersion, kGeometryImageVersion);
  if (file.channels != std::vector<std::string>{"R", "G", "B", "A"})
    attributes.fail("has other channels than R, G, B, A");

  GeometryImage image;
  image.options.layout = attributes.choice("layout", Layout::paper, Layout::compact);
  image.options.bounds = attributes.choice("bounds", Bounds::sphere, Bounds::aabb);
  image.options.links = attributes.choice("links", Links::threaded, Links::octant);
  image.options.transform_out = attributes.choice("transform_out", TransformOut::inverse, TransformOut::restore);
  image.options.transform_list = attributes.choice("transform_list", TransformList::tree, TransformList::root);
  image.options.width = attributes.integer("asked_width", 1, kMaxImageWidth);
  image.options.tree.leaf_size = attributes.get<int>("leaf_size");
  image.options.tree.width = attributes.get<int>("tree_width");
  image.options.tree.split_long = attributes.get<float>("split_long");
  image.scene_name = attributes.get<std::string>("scene");
  image.width = file.width, image.height = file.height;
  image.cell_count = attributes.count("cell_count");
  image.center = {attributes.get<float>("center_x"), attributes.get<float>("center_y"),
                  attributes.get<float>("center_z")};
  image.radius = attributes.get<float>("radius");
  image.scale_exponent = attributes.integer("scale_exponent", -300, 300);
  image.triangle_count = attributes.count("triangles");
  image.sphere_count = attributes.count("spheres");
  image.primitive_count = attributes.count("primitives");
  image.primitive_start = attributes.count("primitive_start");
  image.world_primitives = attributes.count("world_primitives");
  image.transform_start = attributes.count("transform_start");
  image.transform_count = attributes.count("transforms");
  image.primitive_stride = primitive_stride(image.options.layout, image.triangle_count > 0 || image.sphere_count == 0);
  image.copy_count = image.options.links == Links::octant ? 8 : 1;
  image.copy_size = attributes.count("copy_size");
  image.payload_bits = attributes.integer("payload_bits", 0, kMaxPayloadBits);
  image.texels.resize(static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height));
  std::memcpy(image.texels.data(), file.pixels.data(), image.texels.size() * sizeof(glm::vec4));

  const auto power_of_two = [](int n) {
    return n > 0 && n <= kMaxImageWidth && std::has_single_bit(static_cast<unsigned>(n));
  };
  if (!power_of_two(image.width) || !power_of_two(image.height)) attributes.fail("is not a power of two wide and high");
  const std::uint64_t cells = image.options.layout == Layout::paper ? image.texels.size() / 2 : image.texels.size();
  const std::uint64_t record_cells = image.options.layout == Layout::paper ? kTransformTexels / 2 : kTransformTexels;
  if (std::uint64_t{image.copy_count} * image.copy_size > image.primitive_start ||
      image.primitive_start + std::uint64_t{image.primitive_stride} * image.primitive_count > cells ||
      image.transform_start + std::uint64_t{image.transform_count} * record_cells > cells) {
    attributes.fail("has fewer texels than its attributes promise");
  }
  return image;
}

}  // namespace plumbline
