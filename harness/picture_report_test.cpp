// SPDX-License-Identifier: GPL-3.0-or-later
// What a comparison leaves in a record, and the catalogue that an engine under test gets.
#include "harness/picture_report.h"

#include <catch2/catch.hpp>
#include <set>

#include "harness/densities.h"
#include "harness/drt_cases.h"
#include "scenes/random.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

/// Batches of grey noise from `level` to 1 above it.
std::vector<PictureMoments> noise(std::uint64_t seed, double level) {
  std::vector<PictureMoments> batches;
  for (std::uint32_t b = 0; b < 64; ++b) {
    PictureMoments moments{16, 16, 8, {}, {}};
    for (std::uint32_t i = 0; i < 256; ++i) {
      const double c = level + Random(seed, b, i).uniform();
      moments.mean.emplace_back(c, c, c);
      moments.variance.emplace_back(1.0, 1.0, 1.0);
    }
    batches.push_back(std::move(moments));
  }
  return batches;
}

}  // namespace

TEST_CASE("A comparison is recorded with its tests, their power and its pictures, and fails by an alarm",
          "[statistics]") {
  const TemporaryFolder folder;
  CaseRecord same, other;
  record_comparison(compare_pictures(noise(1, 0.5), noise(2, 0.5), {}), folder.path(), "same", same);
  CHECK(same.status == CaseStatus::passed);
  CHECK(same.message.find("would be seen with probability 0.99") != std::string::npos);
  REQUIRE(same.tables.size() == 1);
  CHECK(same.tables[0].rows.size() == 6);
  for (const auto& row : same.tables[0].rows) CHECK(row.size() == same.tables[0].columns.size());
  REQUIRE(same.pictures.size() == 6);
  for (const PictureRecord& picture : same.pictures)
    CHECK(std::filesystem::file_size(folder.path() / picture.path) > 100);

  record_comparison(compare_pictures(noise(1, 0.6), noise(2, 0.5), {}), folder.path(), "other", other);
  CHECK(other.status == CaseStatus::failed);
  CHECK(other.message.find("whole picture") != std::string::npos);
}

TEST_CASE("An engine under test gets each effect alone, all ten pairs and all together, within the level's budget",
          "[statistics]") {
  const EngineUnderTest engine = [](CaseContext&) { return MakePictureEngine(make_reference_engine); };
  std::vector<Case> cases = independent_cases(engine);
  for (Case& c : density_cases(reference_perturbations())) cases.push_back(std::move(c));
  for (Case& c : independent_cases(engine, {.name = "texture"})) cases.push_back(std::move(c));
  CHECK(cases.size() <= kMostComparisons);
  std::set<std::string> names;
  int pairs = 0;
  for (const Case& c : cases) {
    CHECK(names.insert(c.name).second);
    CHECK((c.feature == "shading" || c.feature == "combined" ||
           (c.name + ".").find("." + c.feature + ".") != std::string::npos));
    pairs += c.name.rfind("drt.pairs.", 0) == 0 && c.scene == "figure_1";
  }
  CHECK(pairs == 20);
  for (const char* name : {"drt.independent.soft_shadow.soft_shadow.physical", "drt.independent.texture.dof.dof.paper",
                           "drt.all.figure_1.paper", "drt.all.sphereflake_3.physical", "drt.convergence.glossy.glossy",
                           "drt.densities.reference.dof.physical"})
    CHECK(names.count(name) == 1);
}
