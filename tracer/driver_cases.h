// SPDX-License-Identifier: MIT
// Questions to the driver: small shaders with known answers. A tracer can't be more right than what it runs on, so
// every run of the harness asks these first, and a report names what was found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/gl_context.h"

namespace plumbline {

struct DriverCase {
  std::string name;  ///< stable: "loop_cap"
  std::string what;  ///< what a driver without the fault does, in one sentence
  bool tolerated =
      false;  ///< the production shader is written around this fault; the others it relies on not being there
};

struct DriverResult {
  bool found = false;         ///< the driver has the fault
  std::uint64_t pixels = 0;   ///< answers compared
  std::uint64_t wrong = 0;    ///< of them, other than expected
  std::string expected, got;  ///< the first wrong pixel's four words, in hexadecimal; empty where nothing is wrong
  std::string detail;         ///< one line for a report
};

/// All questions, in a fixed order.
std::vector<DriverCase> all_driver_cases();

/// Asks one of all_driver_cases(). Throws EnvironmentError where the driver refuses the shader.
DriverResult run_driver_case(GlContext& context, const DriverCase& asked);

}  // namespace plumbline
