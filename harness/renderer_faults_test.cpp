// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/renderer_faults.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "harness/depths.h"
#include "reports/example_run.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

const SeededRendererFault& fault_of(const std::string& name) {
  static const std::vector<SeededRendererFault> kFaults = renderer_faults();
  return *std::find_if(kFaults.begin(), kFaults.end(), [&](const auto& fault) { return fault.name == name; });
}

}  // namespace

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

TEST_CASE("The cases of a catalogue with a fault see it, and those of a sound one do not", "[renderer_faults]") {
  // Densities are the quickest: numbers alike in neighbouring pixels, and a lens sampled without the square root.
  for (const char* name : {"neighbours_share", "lens_no_root"}) {
    const SeededRendererFault& fault = fault_of(name);
    const std::string wanted = *std::find_if(fault.cases.begin(), fault.cases.end(),
                                             [](const std::string& c) { return c.starts_with("drt.densities."); });
    for (const bool faulty : {false, true}) {
      CatalogueOptions options = nightly_catalogue();
      if (faulty) options.fault = fault.fault;
      const Case asked = select_cases(make_catalogue(options), {wanted}).front();
      Session session;
      const TemporaryFolder folder;
      CaseContext context{session, 7, folder.path};
      CaseRecord record;
      asked.run(context, asked, record);
      INFO(name << ": " << record.message);
      CHECK((record.status == CaseStatus::failed) == faulty);
    }
  }
}

TEST_CASE("A fault that does not exist is refused by name", "[renderer_faults]") {
  const auto nothing = [](auto&&...) {};
  CHECK_THROWS_WITH(run_renderer_faults(1, {"colour"}, nothing, nothing),
                    Catch::Matchers::Contains("colour") && Catch::Matchers::Contains("--pictures"));
  CHECK_THROWS_AS(renderer_patch("noise_kept"), InputError);
}

}  // namespace plumbline
