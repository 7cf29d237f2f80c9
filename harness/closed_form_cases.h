// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `drt.closed_form.*`: renderers against analysis, each effect alone.
#pragma once

#include "harness/catalogue.h"
#include "harness/closed_forms.h"

namespace plumbline {

/// A renderer that is examined.
struct PictureSource {
  std::string name;  ///< as reports show it: "reference", "tracer, hash"
  MakePictureEngine make;
  bool independent_pixels = true;  ///< false for the noise `texture` (SEMANTICS 7.1)
  double effort = 1.0;             ///< share of the samples asked for that it takes
};

/// The renderers of a run, made where the session is known.
using PictureSources = std::function<std::vector<PictureSource>(CaseContext&)>;

/// Those that the catalogue examines.
PictureSources picture_sources(const std::vector<ShaderPatch>& patches = {});

/// How many frames give every point at least that many samples. With motion blur all samples of a frame share their
/// time, and frames are slow: a quarter of that number.
std::uint32_t frames_for(const Profile& profile, std::uint64_t samples);

/// Renders all frames and tells of the share that is done.
PictureMoments render_profile(
    const ClosedForm& form, const PictureSource& source, std::uint64_t seed, std::uint32_t frames,
    const std::function<void(double)>& progress = [](double) {});

/// A case for each closed form, with so many samples for each point; all renderers are held to it and drawn over the
/// same curve.
std::vector<Case> closed_form_cases(const PictureSources& sources, std::uint64_t samples);

}  // namespace plumbline
