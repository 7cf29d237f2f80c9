// SPDX-License-Identifier: MIT
// The values behind a picture's colours, in a file beside the picture, so that the page can name the value of a single
// pixel. 8-bit colours are no values, and a page opened from a disk may not even read those.
//
// The file is a script, as a page opened from a disk may load no other data:
//   plumbline_values({"picture": "pictures/a.png", "width": 64, "height": 48, "unit": "linear colour",
//                     "channels": ["R", "G", "B"], "kinds": [], "float32": "..."})
// "float32" is width * height * channels little-endian 32-bit floats, row by row from the top, in base64: every bit.
// That is 16 kB per channel of 64 x 48 pixels; above kMostValuePixels none is written, and the page says so.
#pragma once

#include <string>
#include <vector>

namespace plumbline {

inline constexpr int kMostValuePixels = 128 * 128;

struct PixelValues {
  std::string unit;                   ///< "linear colour", "steps"; empty where values are kinds
  std::vector<std::string> channels;  ///< "R", "G", "B"; one empty name for a single value
  std::vector<std::string> kinds;     ///< where a value is the number of a kind: the kinds' names
  std::vector<float> values;          ///< width * height * channels, the channels of a pixel together; may be empty
};

/// The script's text. `picture` is the picture's path in its record.
std::string values_script(const PixelValues& values, const std::string& picture, int width, int height);

}  // namespace plumbline
