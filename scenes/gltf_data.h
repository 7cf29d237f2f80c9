// SPDX-License-Identifier: MIT
// The bytes of a glTF 2.0 file: its JSON with lines, its buffers, its images, and the numbers that accessors find in
// buffers. The only file that names tinygltf is gltf_data.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/json_document.h"

namespace plumbline {

struct GltfImage {
  std::filesystem::path path;  ///< of a file beside; empty where `content` holds it
  std::string content;
  std::string name;  ///< of the content: a file name whose ending tells the format
};

struct GltfData {
  JsonDocument document;
  std::vector<std::string> buffers;  ///< as long as they say at least
  std::vector<GltfImage> images;
};

/// Reads and checks what holds the bytes. `content` is text, or binary where it starts with "glTF".
/// Throws InputError with file, line and key path for what is cut short, missing, or no glTF 2.0.
GltfData read_gltf_data(const std::filesystem::path& path, const std::string& content);

/// The values of an accessor: count * components numbers.
struct GltfValues {
  std::size_t count = 0, components = 1;
  std::vector<double> values;
  double at(std::size_t i, std::size_t component = 0) const { return values[i * components + component]; }
};

/// The number that stands at `place` and is below `count`: the index of one of the `what`.
std::uint32_t gltf_index(const JsonPlace& place, std::size_t count, const char* what);

/// Reads the accessor whose number stands at `place`; it must be of `type` ("VEC3"). Integers become numbers from 0 or
/// -1 to 1 where they are normalized. Throws at the key that is wrong: out of range, of another type, not finite.
GltfValues read_accessor(const GltfData& data, const JsonPlace& place, const char* type);

}  // namespace plumbline
