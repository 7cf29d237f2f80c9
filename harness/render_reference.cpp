// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/render_reference.h"

namespace plumbline {

PictureFile picture_file(const ReferencePicture& rendered) {
  PictureFile picture;
  picture.width = rendered.width, picture.height = rendered.height;
  picture.frames = rendered.frames;
  picture.mean = rendered.mean;
  picture.variance = rendered.variance;
  picture.primitive = rendered.primitive;
  picture.instance = rendered.instance;
  picture.depth.assign(rendered.depth.begin(), rendered.depth.end());
  for (const glm::dvec3& normal : rendered.normal) picture.normal.emplace_back(normal);
  return picture;
}

}  // namespace plumbline
