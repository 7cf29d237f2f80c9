// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault that is seeded on purpose is caught, by a verdict that tells of it.
#include "harness/faults.h"

#include <catch2/catch.hpp>

using namespace plumbline;

TEST_CASE("Each seeded fault is caught by a failing verdict") {
  Session session;
  for (const Fault& fault : all_faults()) {
    INFO(fault.name << ": " << fault.what);
    const FaultResult result = run_fault(session, fault, 1);
    INFO("caught by " << result.caught_by);
    CHECK(is_failure(result.verdict));
    CHECK(std::find(fault.expected.begin(), fault.expected.end(), result.verdict) != fault.expected.end());
  }
}
