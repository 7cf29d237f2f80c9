// SPDX-License-Identifier: MIT
// See pixel_values.h.
#include "reports/pixel_values.h"

#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "reports/format.h"
#include "scenes/error.h"

namespace plumbline {

std::string values_script(const PixelValues& values, const std::string& picture, int width, int height) {
  PLUMBLINE_ASSERT(values.values.size() ==
                   static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * values.channels.size());
  std::string bytes;
  bytes.reserve(4 * values.values.size());
  for (const float value : values.values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(bits >> (8 * k) & 255u);
  }
  const nlohmann::ordered_json json{
      {"picture", picture},          {"width", width},        {"height", height},        {"unit", values.unit},
      {"channels", values.channels}, {"kinds", values.kinds}, {"float32", base64(bytes)}};
  return "plumbline_values(" + json.dump() + ")\n";
}

}  // namespace plumbline
