// SPDX-License-Identifier: GPL-3.0-or-later
// Faults on purpose: named, one-place changes to a geometry image or a shader. A harness is worth what it catches.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/layers.h"
#include "harness/session.h"
#include "tracer/shader_source.h"

namespace plumbline {

struct Fault {
  std::string name;               ///< "sphere_shrunk"
  std::string what;               ///< one sentence
  std::function<Scene()> scene;   ///< that it is seeded in
  std::vector<Verdict> expected;  ///< the verdicts that may tell of it
  /// Changes the image in one place; empty: the image is left as it is.
  std::function<void(GeometryImage&, const Stage&)> change_image;
  std::vector<ShaderPatch> patches;          ///< empty: the shader is left as it is
  TransformOut out = TransformOut::restore;  ///< the variant that it is seeded in
  int bundle = 1;                            ///< more: rays that walk together, held against each alone
};

/// Every seeded fault, in a fixed order.
std::vector<Fault> all_faults();

struct FaultResult {
  std::string name, what;
  std::string caught_by;             ///< "hits.chords: 12 of 65536 rays tracer_wrong"; empty: nothing caught it
  Verdict verdict = Verdict::agree;  ///< the failing verdict that told of it
  Layer layer = Layer::none;         ///< of the first ray that failed, as its explanation names it
  std::string sentence;              ///< where that ray was lost
};

/// Seeds one fault and runs the ray families against it until one fails. With an unchanged tracer the same rays pass:
/// that is asked first.
FaultResult run_fault(Session& session, const Fault& fault, std::uint64_t seed);

std::vector<FaultResult> run_faults(std::uint64_t seed,
                                    const std::function<void(double, const std::string&)>& progress);

}  // namespace plumbline
