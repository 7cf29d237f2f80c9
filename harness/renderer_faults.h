// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of distributed ray tracing, seeded into the production renderer one at a time, and the cases of a nightly that
// must see them, at the nightly's depth.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "harness/catalogue.h"

namespace plumbline {

struct SeededRendererFault {
  std::string name;  ///< "light_radius"
  std::string what;  ///< one sentence
  RendererFault fault;
  std::vector<std::string> cases;  ///< of the nightly; one of them must fail
};

/// Every fault, in a fixed order; or those of these names. Throws InputError for a name that no fault has.
std::vector<SeededRendererFault> renderer_faults(const std::vector<std::string>& only = {});
/// The only patch of the fault of this name.
ShaderPatch renderer_patch(const std::string& name);

/// What a case said of a fault.
struct RendererFaultWitness {
  std::string name;  ///< of the case
  bool caught = false;
  std::string message;  ///< its record's
};
struct RendererFaultResult {
  std::string name, what;
  std::vector<RendererFaultWitness> witnesses;  ///< one for each of its cases
  double seconds = 0.0;
  bool caught() const;
};

/// All cases of the faults on the renderer as it is ("sound": none may fail), then fault by fault. Each result is
/// handed to `ended` as it comes.
void run_renderer_faults(std::uint64_t seed, std::vector<SeededRendererFault> faults,
                         const std::function<void(double, const std::string&)>& progress,
                         const std::function<void(const RendererFaultResult&)>& ended);

}  // namespace plumbline
