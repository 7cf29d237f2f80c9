// SPDX-License-Identifier: MIT
#include "scenes/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>

#include "scenes/error.h"
#include "scenes/output_file.h"

namespace plumbline {
namespace {

/// Larger images are refused before memory is asked for: 2^30 values are 4 GiB.
constexpr std::int64_t kMaxValues = std::int64_t{1} << 30;

/// OpenImageIO's messages end with a newline or have several lines; ours are one line.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (text.ends_with(' ')) text.pop_back();
  return text.empty() ? "no reason was given" : text;
}

std::string text_of(const std::string& text) { return text; }
std::string text_of(int number) { return std::to_string(number); }
std::string text_of(float number) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

/// Writes through a file beside the target that then takes its name, so that nobody sees half a file.
void write_whole(const std::filesystem::path& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                 const void* pixels) {
  const std::string name = path.string();
  const OutputTarget target = output_target(path);
  if (!target.replaceable)
    throw InputError(name + ": an image is not written to a device or a pipe; name a plain file");
  // The ending chooses the format, so the temporary name keeps it.
  std::string hidden = ".";
  hidden.append(path.stem().string()).append(".").append(std::to_string(::getpid())).append(path.extension().string());
  const std::filesystem::path temporary = target.path.parent_path() / hidden;
  const auto fail = [&](const std::string& reason) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw EnvironmentError(name + ": cannot be written: " + reason);
  };
  const auto output = OIIO::ImageOutput::create(temporary.string());
  if (!output) fail(one_line(OIIO::geterror()));
  if (!output->open(temporary.string(), spec)) fail(one_line(output->geterror()));
  if (!output->write_image(type, pixels)) fail(one_line(output->geterror()));
  if (!output->close()) fail(one_line(output->geterror()));
  std::error_code failure;
  std::filesystem::rename(temporary, target.path, failure);
  if (failure) fail(failure.message());
}

/// An image that has been opened, or has not; its pixels only where asked for.
Image read_opened(const std::unique_ptr<OIIO::ImageInput>& input, const std::string& name, bool with_pixels = true) {
  if (!input) throw InputError(name + ": not an image that can be read: " + one_line(OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  Image image;
  image.width = spec.width;
  image.height = spec.height;
  image.channels = spec.channelnames;
  image.is_integer = !spec.format.is_floating_point();
  if (image.width <= 0 || image.height <= 0 || image.channels.empty() || spec.depth > 1) {
    throw InputError(name + ": an image without pixels, or of volumes; use a plain image");
  }
  if (with_pixels) {
    const auto channels = static_cast<std::int64_t>(image.channels.size());
    if (image.height > kMaxValues / image.width / channels)
      throw InputError(name + ": larger than 2^30 values; scale the image down");
    image.pixels.resize(static_cast<std::size_t>(std::int64_t{image.width} * image.height * channels));
    if (!input->read_image(0, 0, 0, static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT,
                           image.pixels.data())) {
      throw InputError(name + ": cannot be read to its end: " + one_line(input->geterror()));
    }
  }
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string key = attribute.name().string();
    if (attribute.type() == OIIO::TypeString) {
      image.attributes[key] = std::string(attribute.get_string());
    } else if (attribute.type() == OIIO::TypeInt) {
      image.attributes[key] = attribute.get_int();
    } else if (attribute.type() == OIIO::TypeFloat) {
      image.attributes[key] = attribute.get_float();
    }
  }
  return image;
}

/// The file's name; throws where there is none to read.
std::string checked_name(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) throw InputError(name + ": no such file; check the path");
  if (!std::filesystem::is_regular_file(status)) throw InputError(name + ": not a plain file; name an image file");
  return name;
}

}  // namespace

Image read_image(const std::filesystem::path& path) {
  const std::string name = checked_name(path);
  return read_opened(OIIO::ImageInput::open(name), name);
}

Image read_image_header(const std::filesystem::path& path) {
  const std::string name = checked_name(path);
  return read_opened(OIIO::ImageInput::open(name), name, false);
}

Image read_image(std::string_view content, const std::string& name) {
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(content.data()), content.size());
  return read_opened(OIIO::ImageInput::open(name, nullptr, &memory), name);
}

void write_exr(const std::filesystem::path& path, const Image& image) {
  PLUMBLINE_ASSERT(image.width > 0 && image.height > 0 && !image.channels.empty());
  PLUMBLINE_ASSERT(image.pixels.size() == static_cast<std::size_t>(image.width) *
                                              static_cast<std::size_t>(image.height) * image.channels.size());
  if (path.extension() != ".exr") throw InputError(path.string() + ": an OpenEXR file must end in .exr");
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = image.channels;
  spec["compression"] = "zip";
  for (const auto& [key, value] : image.attributes) {
    std::visit([&, &name = key](const auto& v) { spec.attribute(name, v); }, value);
  }
  write_whole(path, spec, OIIO::TypeDesc::FLOAT, image.pixels.data());
}

void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb,
               const std::map<std::string, ImageAttribute>& attributes) {
  PLUMBLINE_ASSERT(width > 0 && height > 0 &&
                   rgb.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  if (path.extension() != ".png") throw InputError(path.string() + ": a PNG file must end in .png");
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
  spec["oiio:ColorSpace"] = "sRGB";
  for (const auto& [name, value] : attributes)
    std::visit([&, key = name](const auto& v) { spec.attribute(key, text_of(v)); }, value);
  write_whole(path, spec, OIIO::TypeDesc::UINT8, rgb.data());
}

float to_srgb(float linear) {
  const double x = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  return static_cast<float>(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055);
}

float from_srgb(float stored) {
  const double x = stored;
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

}  // namespace plumbline
