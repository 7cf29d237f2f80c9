// SPDX-License-Identifier: MIT
#include "scenes/gltf_data.h"

#include <tiny_gltf.h>

#include <cmath>
#include <cstring>

#include "scenes/error.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

/// tinygltf's messages have several lines and may quote a whole buffer; ours are one line.
std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text.substr(0, 240)) line += (c >= ' ' && c <= '~') ? c : ' ';
  while (line.ends_with(' ')) line.pop_back();
  return line.empty() ? "no reason was given" : line;
}

std::uint32_t word_at(const std::string& content, std::size_t at) {
  std::uint32_t word = 0;  // little-endian, as the format is
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(content[at + i]);
  return word;
}

/// The JSON chunk of a binary file, once all lengths in it have been checked: tinygltf's own check of the second
/// chunk's end is 8 bytes short.
std::string json_of_binary(const std::string& file, const std::string& content) {
  const auto fail = [&](const std::string& problem) { throw InputError(file, 1, "binary glTF: " + problem); };
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  if (content.size() < 20) fail("cut short: the header alone has 20 bytes");
  if (word_at(content, 4) != 2) fail("version " + std::to_string(word_at(content, 4)) + "; only 2 is read");
  const std::uint64_t length = word_at(content, 8), json_length = word_at(content, 12);
  if (length > content.size())
    fail("cut short: " + std::to_string(length) + " bytes were promised, there are " + std::to_string(content.size()));
  if (word_at(content, 16) != kJson) fail("the first chunk must be JSON");
  if (json_length == 0 || json_length % 4 != 0 || 20 + json_length > length)
    fail("the JSON chunk's length " + std::to_string(json_length) + " does not fit the file");
  const std::uint64_t end = 20 + json_length;
  if (end < length) {
    if (end + 8 > length) fail("cut short within the header of the second chunk");
    const std::uint64_t binary_length = word_at(content, end);
    if (word_at(content, end + 4) != kBinary) fail("the second chunk must be BIN");
    if (binary_length % 4 != 0 || end + 8 + binary_length > length)
      fail("the BIN chunk's length " + std::to_string(binary_length) + " does not fit the file");
  }
  std::string json = content.substr(20, json_length);
  const std::size_t nul = json.find('\0');
  if (nul != std::string::npos) fail("a NUL byte in the JSON chunk");
  return json;
}

/// "%20" is a blank.
std::string decoded(const std::string& uri) {
  std::string text;
  const auto digit = [&](std::size_t i) -> int {
    if (i >= uri.size()) return -1;
    const char c = uri[i];
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0) {
      text += static_cast<char>(16 * digit(i + 1) + digit(i + 2));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

bool is_data(const std::string& uri) { return uri.starts_with("data:"); }

/// Every item of these arrays must be an object: what tinygltf leaves out would shift the numbers of those behind.
void check_arrays(const JsonPlace& root) {
  for (const char* const key : {"buffers", "bufferViews", "accessors", "images", "textures", "materials", "meshes",
                                "nodes", "scenes", "cameras", "animations", "skins", "samplers"}) {
    const auto array = root.find(key);
    if (!array) continue;
    array->check_array();
    for (std::size_t i = 0; i < array->size(); ++i) array->at(i).check_object();
  }
}

void check_files(const JsonPlace& root, const std::filesystem::path& folder) {
  const auto buffers = root.find("buffers");
  for (std::size_t i = 0; buffers && i < buffers->size(); ++i) {
    const JsonPlace buffer = buffers->at(i);
    const double length = buffer.need("byteLength").number();
    if (!(length >= 1.0 && length == std::floor(length))) buffer.need("byteLength").fail("expected a number of bytes");
    const auto uri = buffer.find("uri");
    if (!uri || is_data(uri->text())) continue;
    const std::filesystem::path path = folder / decoded(uri->text());
    std::error_code failure;
    if (!std::filesystem::is_regular_file(path, failure)) uri->fail("no such file: " + shown(path.string(), 200));
    const std::uintmax_t size = std::filesystem::file_size(path, failure);
    if (failure || static_cast<double>(size) < length)
      uri->fail("cut short: 'byteLength' promises " + std::to_string(static_cast<std::uint64_t>(length)) +
                " bytes, the file has " + std::to_string(size));
  }
}

/// tinygltf forms a pointer into the buffer before it asks whether the view fits: views of images are checked first.
void check_image_views(const JsonPlace& root) {
  const auto images = root.find("images"), views = root.find("bufferViews"), buffers = root.find("buffers");
  for (std::size_t i = 0; images && i < images->size(); ++i) {
    const auto index = images->at(i).find("bufferView");
    if (!index) continue;
    if (!views || !buffers) index->fail("the file has no bufferViews, or no buffers");
    const JsonPlace view = views->at(gltf_index(*index, views->size(), "bufferViews"));
    const JsonPlace buffer = view.need("buffer");
    const double length = buffers->at(gltf_index(buffer, buffers->size(), "buffers")).need("byteLength").number();
    const auto offset = view.find("byteOffset");
    const double end = view.need("byteLength").number_between(1.0, 4294967295.0) +
                       (offset ? offset->number_between(0.0, 4294967295.0) : 0.0);
    if (!(end <= length)) view.fail("reaches beyond its buffer");
  }
}

void read_images(GltfData& data, tinygltf::Model& model, const std::filesystem::path& folder) {
  const auto images = JsonPlace(data.document).find("images");
  for (std::size_t i = 0; images && i < images->size(); ++i) {
    const JsonPlace place = images->at(i);
    const auto uri = place.find("uri"), mime = place.find("mimeType");
    GltfImage image;
    std::string type = mime ? mime->text() : model.images[i].mimeType;
    if (uri && !is_data(uri->text())) {
      image.path = folder / decoded(uri->text());
    } else {
      if (uri) {
        image.content.assign(model.images[i].image.begin(), model.images[i].image.end());
        type = uri->text().substr(0, uri->text().find(';'));
      }
      image.name = data.document.file + "#image" + std::to_string(i) + (type.ends_with("jpeg") ? ".jpg" : ".png");
    }
    data.images.push_back(std::move(image));
  }
}

struct View {
  const std::string* buffer = nullptr;
  std::size_t offset = 0, length = 0, stride = 0;  ///< stride 0: tightly packed
};

std::size_t read_size(const JsonPlace& object, const char* key, std::size_t otherwise) {
  const auto place = object.find(key);
  return place ? place->integer(0, 0xffffffffu) : otherwise;
}

View view_at(const GltfData& data, const JsonPlace& index) {
  const auto views = JsonPlace(data.document).find("bufferViews");
  if (!views) index.fail("the file has no bufferViews");
  const JsonPlace place = views->at(gltf_index(index, views->size(), "bufferViews"));
  View view;
  const JsonPlace buffer = place.need("buffer");
  view.buffer = &data.buffers[gltf_index(buffer, data.buffers.size(), "buffers")];
  view.offset = read_size(place, "byteOffset", 0);
  view.length = place.need("byteLength").integer(1, 0xffffffffu);
  view.stride = read_size(place, "byteStride", 0);
  if (view.offset > view.buffer->size() || view.length > view.buffer->size() - view.offset)
    place.fail("reaches beyond its buffer of " + std::to_string(view.buffer->size()) + " bytes");
  return view;
}

/// How numbers of a component type are stored.
struct Component {
  int type = 0;
  std::size_t size = 0;
  double largest = 1.0;  ///< what normalized integers are divided by
};
constexpr Component kComponents[] = {{5120, 1, 127.0},   {5121, 1, 255.0},        {5122, 2, 32767.0},
                                     {5123, 2, 65535.0}, {5125, 4, 4294967295.0}, {5126, 4, 1.0}};

double read_component(const char* at, int type) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case 5120:
      return as(std::int8_t{});
    case 5121:
      return as(std::uint8_t{});
    case 5122:
      return as(std::int16_t{});
    case 5123:
      return as(std::uint16_t{});
    case 5125:
      return as(std::uint32_t{});
    default:
      return as(0.0f);
  }
}

}  // namespace

GltfData read_gltf_data(const std::filesystem::path& path, const std::string& content) {
  const std::string file = path.string();
  const bool is_binary = content.starts_with("glTF");
  const std::string json = is_binary ? json_of_binary(file, content) : content;
  GltfData data;
  data.document = parse_json(file, json);  // bounds the depth too: tinygltf goes down by recursion
  const JsonPlace root(data.document);
  const std::string& version = root.need("asset").need("version").text();
  if (!version.starts_with("2.")) root.need("asset").need("version").fail("glTF 2 is read, this is " + shown(version));
  check_arrays(root);
  check_files(root, path.parent_path());
  check_image_views(root);

  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  // Images stay as they are: those of buffer views are taken from there when the views have been checked.
  loader.SetImageLoader(
      [](tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
         void*) {
        if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
        return true;
      },
      nullptr);
  bool is_read = false;
  try {
    const std::string folder = path.parent_path().string();
    is_read = is_binary ? loader.LoadBinaryFromMemory(
                              &model, &error, &warning, reinterpret_cast<const unsigned char*>(content.data()),
                              static_cast<unsigned>(content.size()), folder, tinygltf::NO_REQUIRE)
                        : loader.LoadASCIIFromString(&model, &error, &warning, json.data(),
                                                     static_cast<unsigned>(json.size()), folder, tinygltf::NO_REQUIRE);
  } catch (const std::exception& exception) {
    error += exception.what();
  }
  const auto buffers = root.find("buffers");
  const std::size_t buffer_count = buffers ? buffers->size() : 0;
  // Buffers come first and in their order: where they end is what was wrong.
  if (model.buffers.size() < buffer_count) buffers->at(model.buffers.size()).fail("cannot be read: " + one_line(error));
  if (!is_read || !error.empty())
    throw InputError(file, 1, "tinygltf cannot read it: " + one_line(error.empty() ? warning : error));
  for (std::size_t i = 0; i < buffer_count; ++i) {
    const auto& bytes = model.buffers[i].data;
    if (bytes.size() < static_cast<std::size_t>(buffers->at(i).need("byteLength").number()))
      buffers->at(i).fail("shorter than its 'byteLength'");
    data.buffers.emplace_back(bytes.begin(), bytes.end());
  }
  read_images(data, model, path.parent_path());
  const auto images = root.find("images");
  for (std::size_t i = 0; i < data.images.size(); ++i) {
    const auto view_place = images->at(i).find("bufferView");
    if (!view_place) continue;
    const View view = view_at(data, *view_place);
    data.images[i].content = view.buffer->substr(view.offset, view.length);
  }
  return data;
}

std::uint32_t gltf_index(const JsonPlace& place, std::size_t count, const char* what) {
  if (count == 0) place.fail(std::string("out of range: there are no ") + what);
  const double value = place.number();
  if (!(value >= 0.0 && value == std::floor(value))) place.fail(std::string("expected a number of the ") + what);
  if (!(value < static_cast<double>(count)))
    place.fail("out of range: there are " + std::to_string(count) + " " + what + ", numbered from 0");
  return static_cast<std::uint32_t>(value);
}

GltfValues read_accessor(const GltfData& data, const JsonPlace& index, const char* type) {
  const auto accessors = JsonPlace(data.document).find("accessors");
  if (!accessors) index.fail("the file has no accessors");
  const std::uint32_t number = gltf_index(index, accessors->size(), "accessors");
  const JsonPlace place = accessors->at(number);
  if (place.need("type").text() != type)
    index.fail("accessor " + std::to_string(number) + " is of " + shown(place.need("type").text()) + ", expected " +
               type);
  if (const auto sparse = place.find("sparse")) sparse->fail("sparse accessors are not read; store all values");
  const auto view_place = place.find("bufferView");
  if (!view_place) place.fail("an accessor without 'bufferView' has no values");
  const View view = view_at(data, *view_place);
  const JsonPlace component_place = place.need("componentType");
  const std::uint32_t component_type = component_place.integer(0, 0xffffu);
  const Component* component = nullptr;
  for (const Component& known : kComponents)
    if (known.type == static_cast<int>(component_type)) component = &known;
  if (component == nullptr) component_place.fail("unknown; known are 5120 to 5123, 5125 and 5126");
  const auto normalized_place = place.find("normalized");
  const bool is_normalized = normalized_place && normalized_place->boolean() && component_type != 5126;

  GltfValues result;
  result.components = std::strcmp(type, "SCALAR") == 0 ? 1 : static_cast<std::size_t>(type[3] - '0');
  result.count = place.need("count").integer(1, 1u << 30);
  const std::size_t offset = read_size(place, "byteOffset", 0), size = result.components * component->size;
  const std::size_t stride = view.stride == 0 ? size : view.stride;
  if (stride < size) view_place->fail("its 'byteStride' is shorter than one value");
  if (offset > view.length || size > view.length - offset ||
      (result.count - 1) > (view.length - offset - size) / stride)
    place.fail("reaches beyond its buffer view of " + std::to_string(view.length) + " bytes");

  result.values.resize(result.count * result.components);
  const char* const first = view.buffer->data() + view.offset + offset;
  for (std::size_t i = 0; i < result.count; ++i) {
    for (std::size_t c = 0; c < result.components; ++c) {
      double value = read_component(first + i * stride + c * component->size, component->type);
      if (!std::isfinite(value)) place.fail("value " + std::to_string(i) + " is not a finite number");
      // The most negative integer and the next one both stand for -1.
      if (is_normalized) value = std::max(value / component->largest, -1.0);
      result.values[i * result.components + c] = value;
    }
  }
  return result;
}

}  // namespace plumbline
