// SPDX-License-Identifier: MIT
// The driver cases ask what they claim to ask: on the drivers that we know, the known faults are found and no others.
#include "tracer/driver_cases.h"

#include <catch2/catch.hpp>
#include <set>

#include "scenes/error.h"

using namespace plumbline;

TEST_CASE("the driver has no fault that the production shader relies on not being there", "[driver]") {
  GlContext context;
  for (const DriverCase& asked : all_driver_cases()) {
    const DriverResult result = run_driver_case(context, asked);
    INFO(asked.name << ": " << result.detail);
    CHECK((!result.found || asked.tolerated));
    CHECK(result.found == (result.wrong > 0));
    CHECK(result.pixels > 0);
  }
}

TEST_CASE("Mesa 22.3 is found to cap loops, to clobber values, to rewrite sums and to flush denormals", "[driver]") {
  GlContext context;
  if (context.version().find("Mesa 22.3") == std::string::npos) {
    WARN("this driver is " << context.version() << ": its faults are not known beforehand");
    return;
  }
  std::set<std::string> found;
  for (const DriverCase& asked : all_driver_cases()) {
    if (run_driver_case(context, asked).found) found.insert(asked.name);
  }
  CHECK(found == std::set<std::string>{"loop_cap", "clobbered_value", "plain_sum", "denormals"});
}

TEST_CASE("names of driver cases are unique, and unknown ones are refused", "[driver]") {
  GlContext context;
  std::set<std::string> names;
  for (const DriverCase& asked : all_driver_cases()) CHECK(names.insert(asked.name).second);
  CHECK_THROWS_AS(run_driver_case(context, DriverCase{"no_such_case", "", false}), InputError);
}
