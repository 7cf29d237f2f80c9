// SPDX-License-Identifier: GPL-3.0-or-later
// The reference renderer's picture as the file writers want it.
#pragma once

#include "harness/picture_file.h"
#include "reference/renderer.h"

namespace plumbline {

PictureFile picture_file(const ReferencePicture& rendered);

}  // namespace plumbline
