// SPDX-License-Identifier: GPL-3.0-or-later
// Shards: every case in one of them, the driver in all, costs about even.
#include "harness/shards.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

using namespace plumbline;

TEST_CASE("Shards cut the catalogue into parts of about the same cost, the driver is questioned by each") {
  CatalogueOptions options;
  options.scenes = own_scenes();
  for (ListedScene& s : placed_scenes()) options.scenes.push_back(std::move(s));
  options.whole = true;
  const std::vector<Case> cases = make_catalogue(options);
  double total = 0.0, dearest = 0.0;
  for (const Case& c : cases) {
    CHECK(cost_of(c) > 0.0);
    total += cost_of(c), dearest = std::max(dearest, cost_of(c));
  }
  for (const int shards : {2, 4, 7}) {
    std::map<std::string, int> times;
    for (int shard = 1; shard <= shards; ++shard) {
      double cost = 0.0;
      for (const Case& c : shard_of(cases, shard, shards)) ++times[c.name], cost += cost_of(c);
      CHECK(cost < total / shards + dearest + 1.0);
      CHECK(cost > total / shards - dearest - 1.0);
    }
    CHECK(times.size() == cases.size());
    for (const auto& [name, count] : times) CHECK(count == (name.starts_with("driver.") ? shards : 1));
  }
}

TEST_CASE("What was measured comes back as the cost, in proportion to the rays") {
  Case c;
  c.name = "hits.camera.creature", c.family = "camera", c.rays = 16384;
  const double cost = cost_of(c);
  c.rays *= 3;
  CHECK(cost_of(c) == Approx(3.0 * cost));
  c.name = "hits.camera.never_measured";
  CHECK(cost_of(c) > 0.0);
  RunRecord run;
  for (const char* family : {"camera", "chords"}) {
    CaseRecord& record = run.cases.emplace_back();
    record.name = std::string("hits.") + family + ".cube", record.family = family;
    record.seconds = 2.0, record.rays = 100;
  }
  CHECK(costs_text(run).ends_with("\nhits.cube 2 100\n"));
}
