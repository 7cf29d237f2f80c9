// SPDX-License-Identifier: GPL-3.0-or-later
// Names, patterns and what is read from the command line.
#include "harness/catalogue.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "harness/bench.h"
#include "harness/explain.h"
#include "harness/hit_cases.h"
#include "scenes/error.h"

using namespace plumbline;

namespace {
std::vector<Case> catalogue() {
  CatalogueOptions options;
  options.scenes = own_scenes();
  for (ListedScene& s : placed_scenes()) options.scenes.push_back(std::move(s));
  options.whole = true;
  return make_catalogue(options);
}
}  // namespace

TEST_CASE("Case names are unique, dotted, and every case says what it proves") {
  std::set<std::string> names;
  for (const Case& c : catalogue()) {
    CHECK(names.insert(c.name).second);
    CHECK(c.name.find('.') != std::string::npos);
    CHECK(c.name.find(' ') == std::string::npos);
    CHECK(c.proves.size() > 20);
    // drt.closed_form.dof.edge_far.paper is of the feature dof; where several effects meet the feature is combined.
    if (c.name.starts_with("drt.") && c.feature != "shading" && c.feature != "combined")
      CHECK((c.name + ".").find("." + c.feature + ".") != std::string::npos);
    CHECK(std::any_of(features().begin(), features().end(), [&](const Feature& f) { return f.name == c.feature; }));
    // What questions the driver, or the reference itself, is no matter of the paper's.
    CHECK((c.feature == "driver" || c.name.starts_with("reference.") || !c.paper.empty()));
    CHECK((c.scene.empty() || axes_of(c).starts_with("scene=" + c.scene)));
  }
}

TEST_CASE("Every family is asked on every scene") {
  const std::vector<Case> cases = catalogue();
  for (const ListedScene& scene : own_scenes())
    for (const RayFamilyInfo& family : ray_families())
      CHECK(select_cases(cases, {"hits." + std::string(family.name) + "." + scene.name}).size() == 1);
}

TEST_CASE("Every scene of instances is asked both ways out of a transform, in every family") {
  const std::vector<Case> cases = catalogue();
  REQUIRE(placed_scenes().size() >= 8);
  std::uint64_t rays = 0;
  for (const Case& c : select_cases(cases, {"transforms.*"})) rays += c.rays;
  CHECK(rays >= 5'000'000);
  for (const ListedScene& scene : placed_scenes()) {
    for (const char* out : {"restore", "inverse"})
      for (const RayFamilyInfo& family : ray_families())
        CHECK(
            select_cases(cases, {std::string("transforms.") + out + "." + std::string(family.name) + "." + scene.name})
                .size() == 1);
    for (const char* kind : {"two_truths", "brute_force", "variants", "updates"})
      CHECK(select_cases(cases, {std::string("transforms.") + kind + "." + scene.name}).size() == 1);
  }
  for (const char* name : {"bundles.2.nested", "bundles.3.creature", "bundles.4.sphereflake_3",
                           "transforms.frames.walk", "transforms.drift", "transforms.bunnies"})
    CHECK(select_cases(cases, {name}).size() == 1);
}

TEST_CASE("Patterns select by prefix and by wildcard, and one that matches nothing is an error") {
  const std::vector<Case> cases = catalogue();
  CHECK(select_cases(cases, {}).size() == cases.size());
  CHECK(select_cases(cases, {"hits.camera"}).size() == own_scenes().size());
  CHECK(select_cases(cases, {"hits.camer"
                             "*"})
            .size() == own_scenes().size());
  CHECK(select_cases(cases, {"*.creature"}).size() > 10);
  CHECK_THROWS_AS(select_cases(cases, {"hits.camer"}), InputError);
  CHECK_THROWS_WITH(select_cases(cases, {"hits.camer"}), Catch::Contains("did you mean hits.camera"));
  CHECK_THROWS_WITH(select_cases(cases, {"bundels"}), Catch::Contains("did you mean bundles"));
  CHECK_THROWS_WITH(select_cases(cases, {"creature"}), Catch::Contains("did you mean '*.creature'"));
  CHECK_THROWS_AS(select_cases(cases, {"hits", "nothing.*"}), InputError);
}

TEST_CASE("A feature selects its cases, whatever they are called") {
  const std::vector<Case> cases = catalogue();
  for (const Feature& f : features()) {
    const auto count = std::count_if(cases.begin(), cases.end(), [&](const Case& c) { return c.feature == f.name; });
    if (count > 0) CHECK(select_cases(cases, {f.name}).size() >= static_cast<std::size_t>(count));
  }
  CHECK(select_cases(cases, {"bake"}).size() > select_cases(cases, {"bake.*"}).size());  // variants.all.* too
  CHECK(axes_of(select_cases(cases, {"bundles.2.nested"})[0]) == "scene=nested; bundle=2");
}

TEST_CASE("A ray printed for a replay reads back to the same bits") {
  const Ray ray{{0.1f, -0.0f, 1e-42f}, {1.0f / 3.0f, -3e37f, 0.0f}, 7.25f};
  const Ray back = parse_ray(ray_argument(ray));
  CHECK(ray_argument(back) == ray_argument(ray));
  CHECK(back.direction == ray.direction);
  CHECK(std::signbit(back.origin.y));
  CHECK(parse_ray("0,0,0,0,0,1").t_max == std::numeric_limits<float>::infinity());
  CHECK_THROWS_AS(parse_ray("0,0,0,0,1"), InputError);
  CHECK_THROWS_AS(parse_ray("0,0,0,0,0,1x"), InputError);
  CHECK_THROWS_AS(parse_ray(""), InputError);
}

TEST_CASE("Arguments are quoted where a shell would take them apart") {
  CHECK(quoted("sphereflake:4") == "sphereflake:4");
  CHECK(quoted("my scenes/it's.obj") == "'my scenes/it'\\''s.obj'");
}

TEST_CASE("The median of an even number of rounds lies between the middle two") {
  const Metric m = make_metric("a", "s", {4.0, 1.0, 2.0, 3.0});
  CHECK(m.median == 2.5);
  CHECK(m.min == 1.0);
  CHECK(m.max == 4.0);
  CHECK(m.rounds == 4);
}
