// SPDX-License-Identifier: MIT
// Image files: float images with named channels and attributes to and from OpenEXR without loss, pictures to PNG,
// textures from whatever OpenImageIO reads. The only file that names OpenImageIO is image_file.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace plumbline {

using ImageAttribute = std::variant<std::string, int, float>;

/// A float image in memory, row 0 at the top, channels interleaved.
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< "R", "G", "B", "A" or any other names
  std::vector<float> pixels;          ///< width * height * channels.size()
  std::map<std::string, ImageAttribute> attributes;
  bool is_integer = false;  ///< of a file read: its values were integers, scaled to [0, 1]

  std::size_t channel_count() const { return channels.size(); }
};

/// Reads an image file of any format. R, G, B, A come first and in this order; other channels follow as in the file.
/// Throws InputError for a file that is missing, a folder, truncated, or no image.
Image read_image(const std::filesystem::path& path);
/// The same without the pixels, to look before memory is asked for.
Image read_image_header(const std::filesystem::path& path);
/// An image from the content of a file, whose name tells the format by its ending.
Image read_image(std::string_view content, const std::string& name);

/// Writes OpenEXR, 32-bit float, ZIP: every bit of every value comes back by read_image, and every attribute but empty
/// strings.
/// The file appears whole or not at all. Throws EnvironmentError where it cannot be written.
void write_exr(const std::filesystem::path& path, const Image& image);

/// Writes an 8-bit RGB PNG from sRGB bytes, width * height * 3; attributes become its texts. Throws as write_exr does.
void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb,
               const std::map<std::string, ImageAttribute>& attributes = {});

/// sRGB's transfer functions (IEC 61966-2-1): linear to stored and back, both in [0, 1].
float to_srgb(float linear);
float from_srgb(float stored);

}  // namespace plumbline
