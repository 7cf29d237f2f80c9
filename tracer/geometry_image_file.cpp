// SPDX-License-Identifier: MIT
// Geometry images as OpenEXR files: the texels are the pixels, everything else is an attribute named plumbline:...
#include <bit>
#include <cstring>
#include <limits>

#include "scenes/error.h"
#include "scenes/image_file.h"
#include "tracer/geometry_image.h"
#include "tracer/verify.h"

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
  template <class T>
  T get(const std::string& name, const T& otherwise) const {
    return image_.attributes.contains(kPrefix + name) ? get<T>(name) : otherwise;
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
  [[noreturn]] void fail_as_newer(int version) const {
    throw InputError(path_.string() + " was written by a newer Plumbline: its format is " + std::to_string(version) +
                     ", this one reads " + std::to_string(kGeometryImageVersion) +
                     "; use that, or bake the scene anew");
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
  set_count("lights", image.light_count);
  set_count("copy_size", image.copy_size);
  set("payload_bits", image.payload_bits);
  write_exr(path, file);
}

namespace {

/// What the attributes tell, the texels not yet.
GeometryImage read_attributes(const Image& header, const Attributes& attributes) {
  const int version = attributes.get<int>("version");
  if (version > kGeometryImageVersion) attributes.fail_as_newer(version);
  attributes.integer("version", kGeometryImageVersion, kGeometryImageVersion);
  if (header.channels != std::vector<std::string>{"R", "G", "B", "A"} || header.is_integer)
    attributes.fail("has other channels than the floats R, G, B, A");
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
  image.scene_name = attributes.get<std::string>("scene", std::string());  // an empty one is not written
  image.width = header.width, image.height = header.height;
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
  image.light_count = attributes.count("lights");
  image.primitive_stride = primitive_stride(image.options.layout, image.triangle_count > 0 || image.sphere_count == 0);
  image.copy_count = image.options.links == Links::octant ? 8 : 1;
  image.copy_size = attributes.count("copy_size");
  image.payload_bits = attributes.integer("payload_bits", 0, kMaxPayloadBits);
  return image;
}

}  // namespace

GeometryImage read_geometry_image(const std::filesystem::path& path) {
  // Everything that the header tells is checked before memory is asked for.
  const Image header = read_image_header(path);
  const Attributes attributes(header, path);
  GeometryImage image = read_attributes(header, attributes);
  if (const std::vector<std::string> errors = attribute_errors(image); !errors.empty())
    attributes.fail("contradicts itself: " + errors[0]);
  // Deflate makes data smaller by 1032 times at most.
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  constexpr std::uint64_t kMostDeflated = 1032;
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height) * sizeof(glm::vec4);
  if (!failure && bytes > kMostDeflated * size)
    attributes.fail("is " + std::to_string(size) + " bytes long, too short for the " + std::to_string(image.width) +
                    " x " + std::to_string(image.height) + " texels that its header promises: it is truncated");
  const Image file = read_image(path);
  if (file.pixels.size() != 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    attributes.fail("changed while it was read");
  image.texels.resize(file.pixels.size() / 4);
  std::memcpy(image.texels.data(), file.pixels.data(), image.texels.size() * sizeof(glm::vec4));
  return image;
}

}  // namespace plumbline
