// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `driver.*`: what the GL implementation itself gets wrong, asked before anything else.
#include "tracer/driver_cases.h"
#include "harness/catalogue.h"

namespace plumbline {

std::vector<Case> driver_cases() {
  std::vector<Case> cases;
  for (const DriverCase& asked : all_driver_cases()) {
    Case c;
    c.name = "driver." + asked.name;
    c.feature = "driver";
    c.proves = asked.what;
    c.run = [asked](CaseContext& context, const Case&, CaseRecord& record) {
      const DriverResult result = run_driver_case(context.session.context(), asked);
      // A sentence for people first, then the numbers.
      record.message = result.found ? "not so here: " + asked.what + " " + result.detail : result.detail;
      if (result.found && asked.tolerated) record.message += "; the tracer is written around it";
      record.figures.push_back({"fault found", "", result.found ? 1.0 : 0.0});
      // A fault that the tracer is written around is named, and fails nothing; one that it relies on not being there
      // fails.
      if (result.found && !asked.tolerated) record.status = CaseStatus::failed;
    };
    cases.push_back(std::move(c));
  }
  return cases;
}

}  // namespace plumbline
