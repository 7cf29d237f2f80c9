// SPDX-License-Identifier: MIT
#include "scenes/rendered_picture.h"

#include <cmath>

#include "scenes/camera.h"
#include "scenes/error.h"

namespace plumbline {

void complete_picture_request(const Camera& camera, int& width, int& height, std::uint32_t first_frame,
                              std::uint32_t frames, double time) {
  constexpr int kLargestSide = 65536;
  constexpr std::uint64_t kMostPixels = 1u << 26;  // sums and channels of a pixel take some 200 bytes
  if (width == 0 && height == 0) width = camera.width, height = camera.height;
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
    throw InputError("a picture has 1 to 65536 pixels each way");
  if (std::uint64_t(width) * std::uint64_t(height) > kMostPixels)
    throw InputError("a picture has at most 2^26 pixels (8192 x 8192)");
  if (frames < 1) throw InputError("a picture needs at least one frame");
  if (std::uint64_t{first_frame} + frames > 0x7fffffffu) throw InputError("frames are numbered up to 2^31 - 1");
  if (!std::isfinite(time)) throw InputError("the time of a picture must be finite");
}

void require_lens_before_focus(const Camera& camera) {
  if (!(static_cast<double>(camera.aperture) < focus_distance(camera)))
    throw InputError("camera: 'aperture' must be less than the distance of what is sharp");
}

}  // namespace plumbline
