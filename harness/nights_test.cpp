// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated nights: a bias too small for one is found by thirty, noise is not; a slower case is found, a slower night
// is not.
#include "harness/nights.h"

#include <boost/math/distributions/normal.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "reports/database.h"
#include "scenes/random.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

/// Normal with mean 0 and variance 1.
double normal(std::uint64_t seed) { return z_of_p((static_cast<double>(mix64(seed) >> 11) + 0.5) * 0x1p-53); }

RunRecord night(int day, std::uint64_t seed) {
  RunRecord run;
  char started[32];
  std::snprintf(started, sizeof started, "2026-%02d-%02dT03:00:00Z", 1 + day / 28, 1 + day % 28);
  run.started = started, run.seed = seed, run.machine = "one", run.driver_renderer = "two";
  return run;
}

/// Thirty nights of cases with a z and a p each, moved by `shift` standard deviations: what the last one finds.
std::vector<PooledFigure> thirty_nights(const std::filesystem::path& file, double shift, std::size_t cases) {
  History history(file);
  RunRecord run;
  for (int day = 0; day < 30; ++day) {
    run = night(day, static_cast<std::uint64_t>(day) + 1);
    for (std::size_t c = 0; c < cases; ++c) {
      CaseRecord& record = run.cases.emplace_back();
      record.name = "drt.case_" + std::to_string(c);
      const std::uint64_t seed = mix64(static_cast<std::uint64_t>(day) * 1000 + c);
      const double one_sided = normal(seed + 1) + shift;
      record.figures = {{"mean", kUnitZ, normal(seed) - shift},
                        {"spread", kUnitP, cdf(complement(boost::math::normal_distribution<double>(), one_sided))},
                        {"rays", "", 1e9}};
    }
    history.append_run(run);
  }
  return pooled_figures(run, history);
}

/// The shift that one night alone finds as often as not, at the level of a sum over one night.
double detectable_in_one_night(std::size_t figures) { return z_of_p(0.5 * pooled({0.0}, true, figures).threshold); }

}  // namespace

TEST_CASE("Thirty nights find a bias of half of what one night can detect, and nothing where there is none") {
  const TemporaryFolder folder;
  constexpr std::size_t kCases = 20, kFigures = 2 * kCases;
  const double half = 0.5 * detectable_in_one_night(kFigures);
  CHECK(half > 1.5);
  for (const PooledFigure& f : thirty_nights(folder.path() / "none.sqlite", 0.0, kCases)) {
    CHECK(f.nights == 30);
    CHECK_FALSE(f.found());
  }
  const auto biased = thirty_nights(folder.path() / "biased.sqlite", half, kCases);
  REQUIRE(biased.size() == kFigures);
  for (const PooledFigure& f : biased) {
    INFO(f.case_name << " " << f.figure << " z " << f.z);
    CHECK(f.found());
  }
  // One night alone does not, but for the few that chance helps: each finds with probability Q(half) < 0.02.
  std::size_t found_by_one = 0;
  for (std::size_t c = 0; c < 1000; ++c) found_by_one += pooled({normal(c) - half}, true, kFigures).found();
  CHECK(found_by_one < 50);
}

TEST_CASE("A seed that is repeated is no new night, and NaN is found") {
  const TemporaryFolder folder;
  History history(folder.path() / "history.sqlite");
  RunRecord run;
  for (int day = 0; day < 8; ++day) {
    run = night(day, day < 5 ? 7 : static_cast<std::uint64_t>(day));
    CaseRecord& record = run.cases.emplace_back();
    record.name = "drt.case";
    record.figures = {{"mean", kUnitZ, 2.0}};
    history.append_run(run);
  }
  const auto figures = pooled_figures(run, history);  // seeds 7 (days 0 to 4, and 7), 5, 6
  REQUIRE(figures.size() == 1);
  CHECK(figures[0].nights == 3);
  CHECK(figures[0].z == Approx(2.0 * std::sqrt(3.0)));
  run.cases[0].figures[0].value = std::numeric_limits<double>::quiet_NaN();
  CHECK(pooled_figures(run, history)[0].found());
  CHECK(pooled({z_of_p(0.0), 0.0}, false, 9).found());
  CHECK_FALSE(pooled({z_of_p(1.0), 0.0}, false, 9).found());
}

TEST_CASE("A case that became slower is found, a slow night, noise and another machine are not") {
  const TemporaryFolder folder;
  History history(folder.path() / "history.sqlite");
  constexpr int kCases = 40;
  const auto timed = [&](int day, double whole_night, double first_case) {
    RunRecord run = night(day, static_cast<std::uint64_t>(day));
    for (int c = 0; c < kCases; ++c) {
      CaseRecord& record = run.cases.emplace_back();
      record.name = "hits.case_" + std::to_string(c);
      const double noise = 0.03 * normal(static_cast<std::uint64_t>(day) * 1000 + static_cast<std::uint64_t>(c));
      record.seconds = (1.0 + c) * whole_night * (c == 0 ? first_case : 1.0) * std::exp(noise);
    }
    return run;
  };
  const auto slower = [&](const RunRecord& run) {
    RunChanges changes;
    find_slower(run, history, changes);
    return changes;
  };
  for (int day = 0; day < 4; ++day) history.append_run(timed(day, 1.0, 1.0));
  CHECK(slower(timed(40, 1.0, 9.0)).slower.empty());  // too few runs to know what is usual
  for (int day = 4; day < 30; ++day) history.append_run(timed(day, day % 7 == 0 ? 1.8 : 1.0, 1.0));
  CHECK(slower(timed(41, 1.0, 1.0)).slower.empty());
  const RunChanges slow_night = slower(timed(42, 2.0, 1.0));
  CHECK(slow_night.slower.empty());
  CHECK(slow_night.night_speed == Approx(2.0).epsilon(0.05));
  const RunChanges slow_case = slower(timed(43, 2.0, 1.5));
  REQUIRE(slow_case.slower.size() == 1);
  CHECK(slow_case.slower[0].name == "hits.case_0");
  CHECK(slow_case.slower[0].seconds / slow_case.slower[0].usual == Approx(1.5).epsilon(0.15));
  CHECK(slow_case.slower[0].runs == 30);
  RunRecord elsewhere = timed(44, 1.0, 1.5);
  elsewhere.machine = "another";
  CHECK(slower(elsewhere).slower.empty());
}
