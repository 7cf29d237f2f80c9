// SPDX-License-Identifier: MIT
// glTF 2.0 files: small ones made here, text and binary, against what they say; and one error for each way to break
// one.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/image_file.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

std::string base64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? kDigits[three >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Collects buffer views and accessors over one buffer.
class Buffers {
 public:
  template <class T>
  int add(const std::vector<T>& values, int component_type, const std::string& type, std::size_t components,
          const std::string& more = "") {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    const std::string added = bytes_of(values);
    views_ += (views_.empty() ? "" : ", ") + std::string("{\"buffer\": 0, \"byteOffset\": ") +
              std::to_string(bytes_.size()) + ", \"byteLength\": " + std::to_string(added.size()) + "}";
    accessors_ += (accessors_.empty() ? "" : ", ") + std::string("{\"bufferView\": ") + std::to_string(count_) +
                  ", \"componentType\": " + std::to_string(component_type) + ", \"type\": \"" + type +
                  "\", \"count\": " + std::to_string(values.size() / components) + more + "}";
    bytes_ += added;
    return count_++;
  }
  /// The members of a file's root, the buffer within the text.
  std::string json(bool is_inline = true) const {
    std::string buffer = "{\"byteLength\": " + std::to_string(bytes_.size());
    if (is_inline) buffer += ", \"uri\": \"data:application/octet-stream;base64," + base64(bytes_) + "\"";
    return "\"buffers\": [" + buffer + "}],\n\"bufferViews\": [" + views_ + "],\n\"accessors\": [" + accessors_ + "]";
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_, views_, accessors_;
  int count_ = 0;
};

const std::string kAsset = "\"asset\": {\"version\": \"2.0\"},\n";

/// One triangle as mesh 0: accessor 0 positions, accessor 1 indices of 16 bits.
Buffers triangle_buffers() {
  Buffers buffers;
  buffers.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3", 3);
  buffers.add<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
  return buffers;
}
const std::string kMesh =
    R"("meshes": [{"name": "tri", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}])";

std::string file_of(const Buffers& buffers, const std::string& rest) {
  return "{" + kAsset + buffers.json() + ",\n" + rest + "}";
}

Scene read_text(const std::string& text, const std::string& name = "scene.gltf") {
  const TemporaryFolder folder;
  return read_scene(folder.write(name, text));
}

std::string error_of(const std::string& text, const std::string& name = "scene.gltf") {
  const TemporaryFolder folder;
  try {
    read_scene(folder.write(name, text));
  } catch (const InputError& error) {
    std::string message = error.what();
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 1000);
    const std::size_t at = message.find(name);
    return at == std::string::npos ? message : message.substr(at);
  }
  return "";
}

void check_error(const std::string& text, const std::string& start) {
  INFO(text.substr(0, 1500));
  const std::string message = error_of(text);
  CHECK(message.substr(0, start.size()) == start);
}

std::string word(std::uint32_t value) { return bytes_of(std::vector<std::uint32_t>{value}); }

/// A binary file of these chunks.
std::string binary_of(std::string json, std::string bytes) {
  while (json.size() % 4 != 0) json += ' ';
  while (bytes.size() % 4 != 0) bytes += '\0';
  std::string chunks = word(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
  if (!bytes.empty()) chunks += word(static_cast<std::uint32_t>(bytes.size())) + std::string("BIN\0", 4) + bytes;
  return "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

}  // namespace

TEST_CASE("glTF: nodes nest, share meshes, and are what matrix or TRS say") {
  const Scene scene = read_text(file_of(triangle_buffers(), kMesh + R"(,
    "nodes": [
      {"name": "root", "translation": [10, 0, 0], "children": [1, 2], "mesh": 0},
      {"name": "a", "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 3, 4], "mesh": 0},
      {"name": "a", "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 5, 6, 7, 1], "mesh": 0},
      {"name": "not shown", "mesh": 0}],
    "scenes": [{"nodes": [0]}], "scene": 0)"));
  REQUIRE(scene.nodes.size() == 4);
  CHECK(scene.nodes[0].name == "root");
  CHECK(scene.nodes[1].name == "root/geometry");
  CHECK(scene.nodes[2].name == "root/a");
  CHECK(scene.nodes[3].name == "root/a.2");
  CHECK(scene.nodes[0].part == kNone);
  REQUIRE(scene.parts.size() == 1);
  CHECK(scene.parts[0].name == "tri");
  CHECK(scene.triangles.size() == 1);
  CHECK(placed_count(scene) == 3);
  CHECK(glm::length(transform_point(to_world(scene, 2), {1, 1, 1}) - glm::dvec3(7, 2, 4)) < 1e-6);
  CHECK(transform_point(to_world(scene, 3), {1, 1, 1}) == glm::dvec3(16, 5, 8));
  CHECK_FALSE(scene.has_camera);
  // Without scenes, all nodes that have no parent are shown.
  CHECK(read_text(file_of(triangle_buffers(), kMesh + R"(, "nodes": [{"mesh": 0}, {"children": [0]}, {"mesh": 0}])"))
            .nodes.size() == 3);
}

TEST_CASE("glTF: triangles, strips and fans, with indices of all widths and without") {
  const std::vector<float> square{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const auto corners_of = [&](int mode, int indices, bool has_indices) {
    Buffers buffers;
    buffers.add(square, 5126, "VEC3", 3);
    if (indices == 5121) buffers.add<std::uint8_t>({0, 1, 2, 3}, indices, "SCALAR", 1);
    if (indices == 5123) buffers.add<std::uint16_t>({0, 1, 2, 3}, indices, "SCALAR", 1);
    if (indices == 5125) buffers.add<std::uint32_t>({0, 1, 2, 3}, indices, "SCALAR", 1);
    const Scene scene = read_text(file_of(
        buffers, R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": )" + std::to_string(mode) +
                     (has_indices ? ", \"indices\": 1" : "") + "}]}], \"nodes\": [{\"mesh\": 0}]"));
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (const Triangle& triangle : scene.triangles) corners.push_back(triangle.position);
    return corners;
  };
  using Corners = std::vector<std::array<std::uint32_t, 3>>;
  for (const int indices : {5121, 5123, 5125}) {
    CHECK(corners_of(5, indices, true) == Corners{{0, 1, 2}, {1, 3, 2}});
    CHECK(corners_of(6, indices, true) == Corners{{1, 2, 0}, {2, 3, 0}});
  }
  CHECK(corners_of(5, 5121, false) == Corners{{0, 1, 2}, {1, 3, 2}});
  // Every triangle of a strip faces one way: up.
  CHECK(
      error_of(file_of(triangle_buffers(), R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 1}]}],
    "nodes": [{"mesh": 0}])"))
          .find("nothing to trace: no triangle or sphere was found; ") != std::string::npos);
  CHECK(
      error_of(file_of(triangle_buffers(), R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 7}]}],
    "nodes": [{"mesh": 0}])"))
          .find("meshes[0].primitives[0].mode: expected a whole number from 0 to 6, found 7") != std::string::npos);
}

TEST_CASE("glTF: normals, texture coordinates, materials and textures") {
  Buffers buffers;
  buffers.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3", 3);
  buffers.add<float>({0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f}, 5126, "VEC3", 3);
  buffers.add<std::uint8_t>({0, 255, 51, 0, 255, 255}, 5121, "VEC2", 2, ", \"normalized\": true");
  const TemporaryFolder folder;
  write_png(folder.path() / "red blue.png", 2, 1, std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255});
  std::ifstream file(folder.path() / "red blue.png", std::ios::binary);
  const std::string png((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const Scene scene = read_scene(folder.write("scene.gltf", file_of(buffers, R"(
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "material": 0},
                               {"attributes": {"POSITION": 0}, "material": 1}, {"attributes": {"POSITION": 0}}]}],
    "materials": [
      {"name": "painted", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.5,
        "baseColorTexture": {"index": 0}}},
      {"name": "mirror", "pbrMetallicRoughness": {"roughnessFactor": 0, "baseColorTexture": {"index": 1}}}],
    "textures": [{"source": 0}, {"source": 1}],
    "images": [{"uri": "red%20blue.png"}, {"uri": "data:image/png;base64,)" + base64(png) +
                                                                                 R"("}],
    "nodes": [{"mesh": 0}])")));
  REQUIRE(scene.triangles.size() == 3);
  const Triangle& t = scene.triangles[0];
  CHECK(scene.normals[t.normal[2]] == glm::vec3(0, 0.6f, 0.8f));
  CHECK(scene.texcoords[t.texcoord[0]] == glm::vec2(0, 0));  // v goes down in glTF, up in a Scene
  CHECK(scene.texcoords[t.texcoord[1]] == glm::vec2(0.2f, 1));
  CHECK(scene.triangles[1].normal[0] == kNone);
  const Material& painted = scene.materials[t.material];
  CHECK(painted.name == "painted");
  CHECK(painted.color == glm::vec3(0.5f, 0.25f, 1));
  CHECK(painted.specular == Approx(0.02));
  CHECK(painted.diffuse == Approx(0.98));
  CHECK(painted.shine == Approx(2.0 / 0.0625 - 2.0));
  const Material& mirror = scene.materials[scene.triangles[1].material];
  CHECK(mirror.specular == 1.0f);
  CHECK(mirror.diffuse == 0.0f);
  REQUIRE(scene.textures.size() == 2);
  for (const Texture& texture : scene.textures) {
    REQUIRE((texture.width == 2 && texture.height == 1));
    CHECK(texture.texels[0] == glm::vec3(1, 0, 0));
    CHECK(texture.texels[1] == glm::vec3(0, 0, 1));
  }
  CHECK(scene.materials[scene.triangles[2].material].diffuse == 1.0f);
  CHECK(scene.source.patches == 1);
  CHECK(scene.source.polygons == 2);
}

TEST_CASE("glTF: the camera spans from edge to edge, lights stand where their nodes do") {
  const Scene scene = read_text(file_of(triangle_buffers(), kMesh + R"(,
    "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "aspectRatio": 1.5, "znear": 0.1}},
                {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}}],
    "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "color": [1, 0.5, 0], "intensity": 100}, {"type": "directional"}]}},
    "nodes": [{"mesh": 0}, {"camera": 1}, {"camera": 0, "translation": [0, 0, 5], "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476]},
      {"translation": [0.5, 0.5, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"extensions": {"KHR_lights_punctual": {"light": 1}}}])"));
  REQUIRE(scene.has_camera);
  CHECK(scene.camera.width == 768);
  CHECK(scene.camera.height == 512);
  const CameraFrame frame = camera_frame(scene.camera);
  CHECK(glm::length(frame.forward - glm::dvec3(-1, 0, 0)) < 1e-6);  // -z turned a quarter about y
  CHECK(glm::length(frame.up - glm::dvec3(0, 1, 0)) < 1e-6);
  // The upper edge of the picture lies half a pixel above the centre of row 0.
  const glm::dvec3 edge(camera_ray(frame, frame.centre_x, -0.5).direction);
  CHECK(glm::dot(edge, frame.up) / glm::dot(edge, frame.forward) == Approx(std::tan(0.5)).epsilon(1e-6));
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].position == glm::vec3(0.5f, 0.5f, 3));
  // 3 away from the middle of the triangle's ball.
  CHECK(scene.lights[0].color.x == Approx(100.0 / (3.141592653589793 * 9.0)).epsilon(1e-6));
  CHECK(scene.lights[0].color.y == Approx(0.5 * scene.lights[0].color.x));
  CHECK(scene.warnings.size() == 2);
}

TEST_CASE("glTF: animations of translation, rotation and scale, steps, splines") {
  Buffers buffers = triangle_buffers();
  buffers.add<float>({0, 1, 2}, 5126, "SCALAR", 1);                                             // 2
  buffers.add<float>({0, 0, 0, 2, 0, 0, 2, 4, 0}, 5126, "VEC3", 3);                             // 3
  buffers.add<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 32767, 0}, 5122, "VEC4", 4,  // 4
                            ", \"normalized\": true");
  buffers.add<float>({9, 9, 9, 1, 1, 1, 9, 9, 9, 9, 9, 9, 3, 3, 3, 9, 9, 9, 9, 9, 9, 5, 5, 5, 9, 9, 9}, 5126, "VEC3",
                     3);  // 5
  const Scene scene =
      read_text(file_of(buffers, kMesh + R"(, "nodes": [{"mesh": 0, "translation": [7, 7, 7]}, {"mesh": 0}],
    "animations": [
      {"samplers": [{"input": 2, "output": 3}, {"input": 2, "output": 4}, {"input": 2, "output": 5, "interpolation": "CUBICSPLINE"},
                    {"input": 2, "output": 3, "interpolation": "STEP"}],
       "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}, {"sampler": 1, "target": {"node": 0, "path": "rotation"}},
                    {"sampler": 2, "target": {"node": 0, "path": "scale"}}, {"sampler": 3, "target": {"node": 1, "path": "translation"}}]},
      {"samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}])"));
  REQUIRE(scene.animation.size() == 2);
  const Animation& smooth = scene.animation[0];
  CHECK(scene.nodes[0].transform.translation == glm::vec3(0, 0, 0));
  CHECK(transform_at(smooth, 1.5).translation == glm::vec3(2, 2, 0));
  const Transform half = transform_at(smooth, 0.5);  // a quarter turn about z, twice as large
  CHECK(glm::length(transform_vector(to_double(half), {1, 0, 0}) - glm::dvec3(0, 2, 0)) < 1e-6);
  CHECK(smooth.scale.size() == 3);
  CHECK(smooth.scale[2].value == glm::dvec3(5));
  const Animation& steps = scene.animation[1];
  CHECK(transform_at(steps, 0.999999).translation == glm::vec3(0, 0, 0));
  CHECK(transform_at(steps, 1.0).translation == glm::vec3(2, 0, 0));
  CHECK(transform_at(steps, std::nextafter(2.0, 0.0)).translation == glm::vec3(2, 0, 0));
  CHECK(transform_at(steps, 2.0).translation == glm::vec3(2, 4, 0));
  CHECK(scene.warnings.size() == 2);  // the spline, and what is animated twice
}

TEST_CASE("Binary glTF reads as the text does, and is refused wherever it is cut") {
  const Buffers buffers = triangle_buffers();
  const std::string rest = kMesh + ", \"nodes\": [{\"mesh\": 0}]";
  const std::string whole = binary_of("{" + kAsset + buffers.json(false) + ", " + rest + "}", buffers.bytes());
  const Scene scene = read_text(whole, "scene.glb");
  CHECK(scene.positions == read_text(file_of(buffers, rest)).positions);
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::string message = error_of(whole.substr(0, size), "scene.glb");
    INFO(size << " " << message);
    CHECK(message.starts_with("scene.glb:1:"));
  }
  // Lengths that lie: every byte of the headers, changed to several values.
  const std::size_t second = 20 + whole.find("BIN") - 4 - 20;
  for (const std::size_t at : {std::size_t{4}, std::size_t{8}, std::size_t{9}, std::size_t{12}, std::size_t{13},
                               std::size_t{15}, std::size_t{16}, second, second + 1, second + 3, second + 4}) {
    for (const int change : {1, 4, 8, 64, 128, 255}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] + change);
      const std::string message = error_of(changed, "scene.glb");
      INFO(at << " " << change << " " << message);
      CHECK((message.empty() || message.starts_with("scene.glb:")));
    }
  }
}

TEST_CASE("A BIN chunk that ends 4 or 8 bytes beyond the file is refused, which tinygltf does not do") {
  const Buffers buffers = triangle_buffers();
  const std::string rest = kMesh + ", \"nodes\": [{\"mesh\": 0}]";
  const std::string whole = binary_of("{" + kAsset + buffers.json(false) + ", " + rest + "}", buffers.bytes());
  for (const char more : {4, 8}) {
    std::string longer = whole;
    longer[whole.find("BIN") - 4] = static_cast<char>(longer[whole.find("BIN") - 4] + more);
    CHECK(error_of(longer, "scene.glb").starts_with("scene.glb:1: binary glTF: the BIN chunk's length"));
  }
}

TEST_CASE("Malformed glTF: one error with line and key for each mistake") {
  const Buffers good = triangle_buffers();
  const std::string node = ", \"nodes\": [{\"mesh\": 0}]";
  const auto with = [&](const std::string& rest) { return file_of(good, rest); };
  check_error("{\"asset\": {\"version\": \"1.0\"}}", "scene.gltf:1: asset.version: glTF 2 is read, this is '1.0'");
  check_error("{}", "scene.gltf:1: the key 'asset' is missing");
  check_error("{" + kAsset + "\"nodes\": [{\n}", "scene.gltf:3: not JSON");
  check_error("{" + kAsset + "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]}",
              "scene.gltf:2: extensionsRequired[0]: the file needs the extension 'KHR_draco_mesh_compression'");
  check_error("{" + kAsset + "\"meshes\": [3]}", "scene.gltf:2: meshes[0]: expected an object");
  check_error("{" + kAsset + "\"nodes\": [{}]}", "scene.gltf: nothing to trace");
  check_error("{" + kAsset + "\"x\": " + std::string(600, '[') + std::string(600, ']') + "}",
              "scene.gltf:2: nested deeper");

  // Buffers.
  check_error("{" + kAsset + "\"buffers\": [{\"byteLength\": 4,\n\"uri\": \"none.bin\"}]}",
              "scene.gltf:3: buffers[0].uri: no such file: ");
  check_error("{" + kAsset + "\"buffers\": [{\"uri\": \"data:application/octet-stream;base64,AAAA\"}]}",
              "scene.gltf:2: buffers[0]: the key 'byteLength' is missing");
  check_error(
      "{" + kAsset + "\"buffers\": [{\"byteLength\": 400, \"uri\": \"data:application/octet-stream;base64,AAAA\"}]}",
      "scene.gltf:2: buffers[0]: cannot be read: ");
  check_error("{" + kAsset + "\"buffers\": [{\"byteLength\": 4}]}", "scene.gltf:2: buffers[0]: cannot be read: ");
  check_error("{" + kAsset + "\"buffers\": [{\"byteLength\": -4, \"uri\": \"x\"}]}",
              "scene.gltf:2: buffers[0].byteLength");
  const TemporaryFolder folder;
  folder.write("short.bin", "abc");
  CHECK_THROWS_WITH(
      read_scene(folder.write("a.gltf", "{" + kAsset + "\"buffers\": [{\"byteLength\": 4, \"uri\": \"short.bin\"}]}")),
      Catch::Contains("buffers[0].uri: cut short: 'byteLength' promises 4 bytes, the file has 3"));

  // Views and accessors.
  const auto accessor = [&](const std::string& views, const std::string& accessors) {
    return "{" + kAsset + "\"buffers\": [{\"byteLength\": 36, \"uri\": \"data:application/octet-stream;base64," +
           base64(std::string(36, '\0')) + "\"}],\n\"bufferViews\": [" + views + "],\n\"accessors\": [" + accessors +
           "],\n\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], \"nodes\": [{\"mesh\": 0}]}";
  };
  const std::string view = "{\"buffer\": 0, \"byteLength\": 36}",
                    floats = "{\"bufferView\": 0, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 3}";
  check_error(accessor(view, floats), "scene.gltf: nothing to trace");  // all zeros: no area
  check_error(accessor("{\"buffer\": 1, \"byteLength\": 36}", floats),
              "scene.gltf:3: bufferViews[0].buffer: out of range: there are 1 buffers");
  check_error(accessor("{\"buffer\": 0, \"byteLength\": 37}", floats),
              "scene.gltf:3: bufferViews[0]: reaches beyond its");
  check_error(accessor("{\"buffer\": 0, \"byteOffset\": 4294967295, \"byteLength\": 36}", floats),
              "scene.gltf:3: bufferViews[0]: reaches beyond its buffer of 36 bytes");
  check_error(accessor("{\"buffer\": 0, \"byteLength\": 36, \"byteStride\": 4}", floats),
              "scene.gltf:4: accessors[0].bufferView: its 'byteStride' is shorter than one value");
  check_error(accessor(view, "{\"bufferView\": 0, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 4}"),
              "scene.gltf:4: accessors[0]: reaches beyond its buffer view of 36 bytes");
  check_error(accessor(view, "{\"bufferView\": 0, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 1000000000}"),
              "scene.gltf:4: accessors[0]: reaches beyond its buffer view");
  check_error(
      accessor(view,
               "{\"bufferView\": 0, \"byteOffset\": 36, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 1}"),
      "scene.gltf:4: accessors[0]: reaches beyond its buffer view");
  check_error(accessor(view, "{\"bufferView\": 2, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 3}"),
              "scene.gltf:4: accessors[0].bufferView: out of range: there are 1 bufferViews");
  check_error(accessor(view, "{\"bufferView\": -1, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": 3}"),
              "scene.gltf:4: accessors[0].bufferView: expected a number of the bufferViews");
  check_error(accessor(view, "{\"componentType\": 5126, \"type\": \"VEC3\", \"count\": 3}"),
              "scene.gltf:4: accessors[0]: an accessor without 'bufferView' has no values");
  check_error(accessor(view, "{\"bufferView\": 0, \"componentType\": 5124, \"type\": \"VEC3\", \"count\": 3}"),
              "scene.gltf:4: accessors[0].componentType: unknown");
  check_error(accessor(view, "{\"bufferView\": 0, \"componentType\": 5126, \"type\": \"VEC4\", \"count\": 2}"),
              "scene.gltf:5: meshes[0].primitives[0].attributes.POSITION: accessor 0 is of 'VEC4', expected VEC3");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Buffers broken;
    broken.add<float>({0, 0, 0, 1, bad, 0, 0, 1, 0}, 5126, "VEC3", 3);
    broken.add<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
    check_error(file_of(broken, kMesh + node), "scene.gltf:4: accessors[0]: value 1 is not a finite number");
  }

  // Meshes and nodes.
  Buffers outside;
  outside.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3", 3);
  outside.add<std::uint16_t>({0, 1, 3}, 5123, "SCALAR", 1);
  check_error(file_of(outside, kMesh + node),
              "scene.gltf:5: meshes[0].primitives[0].indices: index 2 is out of range: there are 3 vertices");
  check_error(with(R"("meshes": [{"primitives": [{"attributes": {"POSITION": 5}}]}])" + node),
              "scene.gltf:5: meshes[0].primitives[0].attributes.POSITION: out of range: there are 2 accessors");
  check_error(with(R"("meshes": [{"primitives": [{"attributes": {}}]}])" + node),
              "scene.gltf:5: meshes[0].primitives[0].attributes: the key 'POSITION' is missing");
  check_error(with(R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}])" + node),
              "scene.gltf:5: meshes[0].primitives[0].material: out of range: there are no materials");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 1}])"),
              "scene.gltf:5: nodes[0].mesh: out of range: there are 1 meshes");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": "0"}])"), "scene.gltf:5: nodes[0].mesh: expected a number");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "children": [1]}])"),
              "scene.gltf:5: nodes[0].children[0]: out of range: there are 1 nodes");
  check_error(
      with(kMesh + R"(, "nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}], "scenes": [{"nodes": [0]}])"),
      "scene.gltf:5: nodes[1].children[0]: node 0 is reached twice: a cycle, or a node with two parents");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "children": [0]}], "scenes": [{"nodes": [0]}])"),
              "scene.gltf:5: nodes[0].children[0]: node 0 is reached twice");
  check_error(with(kMesh + R"(, "nodes": [{"children": [2]}, {"children": [2]}, {"mesh": 0}])"),
              "scene.gltf:5: nodes[1].children[0]: node 2 is reached twice");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0}], "scenes": [{"nodes": [1]}])"),
              "scene.gltf:5: scenes[0].nodes[0]: out of range: there are 1 nodes");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 3)"),
              "scene.gltf:5: scene: out of range: there are 1 scenes");
  check_error(with(kMesh + ", \"nodes\": [{\"mesh\": 0,\n\"scale\": [1, 0, 1]}]"),
              "scene.gltf:6: nodes[0].scale: a scale of 0");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "rotation": [0, 0, 0, 0]}])"),
              "scene.gltf:5: nodes[0].rotation: a quaternion must not be zero");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "matrix": [1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}])"),
              "scene.gltf:5: nodes[0].matrix: the matrix is singular in 32 bits");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "matrix": [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}])"),
              "scene.gltf:5: nodes[0].matrix[3]: the last row must be 0 0 0 1");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "translation": [1, 2]}])"),
              "scene.gltf:5: nodes[0].translation: expected 3 items, found 2");

  // Images.
  const auto image = [&](const std::string& view_number) {
    return file_of(
        good, kMesh + node + ",\n\"images\": [{\"mimeType\": \"image/png\", \"bufferView\": " + view_number + "}]");
  };
  check_error(image("5"), "scene.gltf:6: images[0].bufferView: out of range: there are 2 bufferViews");
  check_error(accessor("{\"buffer\": 0, \"byteOffset\": 30, \"byteLength\": 36}",
                       floats + "], \"images\": [{\"mimeType\": \"image/png\", \"bufferView\": 0}"),
              "scene.gltf:3: bufferViews[0]: reaches beyond its buffer");

  // Animation, camera, lights.
  Buffers moving = triangle_buffers();
  moving.add<float>({0, 1, 1}, 5126, "SCALAR", 1);
  moving.add<float>({1, 1, 1, 0, 0, 0, 1, 1, 1}, 5126, "VEC3", 3);
  moving.add<float>({0, 1, 2}, 5126, "SCALAR", 1);
  const auto animated = [&](const std::string& sampler, const std::string& path, const std::string& more = "") {
    return file_of(moving, kMesh + ", \"nodes\": [{\"mesh\": 0" + more + "}],\n\"animations\": [{\"samplers\": [" +
                               sampler + "], \"channels\": [{\"sampler\": 0, \"target\": {\"node\": 0, \"path\": \"" +
                               path + "\"}}]}]");
  };
  check_error(animated(R"({"input": 2, "output": 3})", "translation"),
              "scene.gltf:6: animations[0].samplers[0].input: the times of keyframes must ascend");
  check_error(animated(R"({"input": 4, "output": 3})", "scale"),
              "scene.gltf:5: node 'node.0': its animated matrix is singular");
  check_error(animated(R"({"input": 4, "output": 3})", "rotation"),
              "scene.gltf:6: animations[0].samplers[0].output: accessor 3");
  check_error(animated(R"({"input": 4, "output": 3})", "turn"),
              "scene.gltf:6: animations[0].channels[0].target.path: expected");
  check_error(animated(R"({"input": 4, "output": 0, "interpolation": "CUBICSPLINE"})", "translation"),
              "scene.gltf:6: animations[0].samplers[0].output: expected 9 values for 3 times, found 3");
  check_error(animated(R"({"input": 4, "output": 3, "interpolation": "NEAREST"})", "translation"),
              "scene.gltf:6: animations[0].samplers[0].interpolation: expected");
  check_error(animated(R"({"input": 9, "output": 3})", "translation"),
              "scene.gltf:6: animations[0].samplers[0].input: out of range");
  check_error(animated(R"({"input": 4, "output": 3})", "translation",
                       R"(, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])"),
              "scene.gltf:6: animations[0].channels[0].target.path: an animated node must not have a matrix");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "camera": 0}])"),
              "scene.gltf:5: nodes[0].camera: the file has no cameras");
  check_error(
      with(
          kMesh +
          R"(, "nodes": [{"mesh": 0, "camera": 0}], "cameras": [{"type": "perspective", "perspective": {"yfov": 4, "znear": 1}}])"),
      "scene.gltf:5: cameras[0].perspective.yfov: expected an angle");
  check_error(with(kMesh + R"(, "nodes": [{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}])"),
              "scene.gltf:5: nodes[0].extensions.KHR_lights_punctual: the file has no lights");
}

TEST_CASE("A glTF file with any byte changed is read or refused in one line, never worse") {
  Buffers buffers = triangle_buffers();
  buffers.add<float>({0, 1}, 5126, "SCALAR", 1);
  buffers.add<float>({0, 0, 0, 2, 0, 0}, 5126, "VEC3", 3);
  const std::string rest =
      kMesh + R"(, "nodes": [{"mesh": 0, "children": [1]}, {"mesh": 0, "scale": [1, 2, 3], "camera": 0}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}], "images": [{"bufferView": 0, "mimeType": "image/png"}],
    "animations": [{"samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
    "scenes": [{"nodes": [0]}])";
  const std::string text = file_of(buffers, rest);
  const std::string binary = binary_of("{" + kAsset + buffers.json(false) + ", " + rest + "}", buffers.bytes());
  CHECK(read_text(text).warnings.size() == 1);  // the image is none
  std::size_t read = 0;
  for (const auto& [whole, name] : {std::pair{text, "scene.gltf"}, {binary, "scene.glb"}}) {
    for (std::uint64_t i = 0; i < 1200; ++i) {
      Random random(11, name_hash(name), i);
      std::string changed = whole;
      const char* const likely = "0123456789 -.e,:[]{}\"ab";
      for (std::uint32_t n = 0; n < 1 + random.below(2); ++n) {
        changed[random.below(static_cast<std::uint32_t>(whole.size()))] =
            random.below(4) == 0 ? static_cast<char>(random.below(256)) : likely[random.below(23)];
      }
      INFO(name << " " << i);
      read += error_of(changed, name).empty() ? 1 : 0;
    }
  }
  CHECK(read > 100);
}

TEST_CASE("A glTF file as a part of a scene file is placed with its nodes") {
  const TemporaryFolder folder;
  folder.write("thing.gltf", file_of(triangle_buffers(),
                                     kMesh + R"(, "nodes": [{"name": "n", "mesh": 0, "translation": [1, 2, 3]}])"));
  const Scene scene = read_scene(folder.write("scene.json", R"({"parts": {"thing": "thing.gltf"},
    "nodes": [{"name": "a", "part": "thing"}, {"name": "b", "part": "thing", "transform": {"scale": 2}}]})"));
  CHECK(scene.triangles.size() == 1);
  REQUIRE(scene.nodes.size() == 4);
  CHECK(scene.nodes[3].name == "b/n");
  CHECK(transform_point(to_world(scene, 3), {0, 0, 0}) == glm::dvec3(2, 4, 6));
}
