// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/renderer_faults.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "harness/depths.h"
#include "reports/example_run.h"
#include "scenes/error.h"

namespace plumbline {

TEST_CASE("Every fault of pictures names cases of a nightly, and changes something", "[renderer_faults]") {
  const std::vector<Case> nightly = make_catalogue(nightly_catalogue());
  std::set<std::string> names;
  for (const SeededRendererFault& fault : renderer_faults()) {
    INFO(fault.name);
    CHECK(names.insert(fault.name).second);
    CHECK((!fault.fault.patches.empty() || fault.fault.edit));
    for (const std::string& name : fault.cases) CHECK(select_cases(nightly, {name}).size() == 1);
  }
  CHECK(names.size() == 16);
}

// That they pass without a fault, every run of the catalogue shows.
TEST_CASE("A case of a catalogue with a fault sees it", "[renderer_faults]") {
  const SeededRendererFault fault = renderer_faults({"neighbours_share"}).front();
  const auto wanted = std::find(fault.cases.begin(), fault.cases.end(), "drt.densities.tracer_hash.soft_shadow.paper");
  REQUIRE(wanted != fault.cases.end());
  CatalogueOptions options = nightly_catalogue();
  options.fault = fault.fault;
  const Case asked = select_cases(make_catalogue(options), {*wanted}).front();
  Session session;
  const TemporaryFolder folder;
  CaseContext context{session, 7, folder.path};
  CaseRecord record;
  asked.run(context, asked, record);
  INFO(record.message);
  CHECK(record.status == CaseStatus::failed);
}

TEST_CASE("A fault that does not exist is refused by name", "[renderer_faults]") {
  CHECK(renderer_faults({"aperture", "highlight"}).size() == 2);
  CHECK_THROWS_WITH(renderer_faults({"colour"}),
                    Catch::Matchers::Contains("colour") && Catch::Matchers::Contains("--pictures"));
  CHECK_THROWS_WITH(renderer_faults({"apertur"}), Catch::Matchers::Contains("did you mean aperture?"));
  CHECK_THROWS_AS(renderer_patch("noise_kept"), InputError);
}

}  // namespace plumbline
