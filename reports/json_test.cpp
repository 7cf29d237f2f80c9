// SPDX-License-Identifier: MIT
// results.json keeps everything, obeys its schema, and refuses what is not its own.
#include "reports/json.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "reports/example_run.h"
#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

bool obeys_schema(const Json& document) {
  const Json schema_text = Json::parse(results_schema());
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_text), schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  const bool valid = validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), &results);
  valijson::ValidationResults::Error error;
  while (results.popError(error)) UNSCOPED_INFO(error.description);
  return valid;
}

/// A run in which every field differs from its default.
RunRecord full_run() {
  RunRecord run = example_run();
  run.shard = {2, 5, 99, "all that was asked"};
  CaseRecord& record = run.cases.back();
  record.figures = {{"ratio", "1", 0.5}, {"time", "s", std::numeric_limits<double>::quiet_NaN(), -1.0, 2.0, 5}};
  record.pictures = {{"pictures/a.png",
                      "A",
                      "what",
                      8,
                      9,
                      {0.0, std::numeric_limits<double>::infinity(), "steps", {"#000000", "#ffffff"}},
                      {{"tie", "#56b4e9", 12}},
                      "plumbline explain a --pixel",
                      "pictures/a.values.js"}};
  record.worst[0].margin = 0x1.23456789abcdep-30;
  record.worst[0].bound = -std::numeric_limits<double>::infinity();
  return run;
}

void check_refused(const std::string& text, const std::string& expected) {
  INFO(text.substr(0, 200));
  CHECK_THROWS_MATCHES(run_from_json(text, "results.json"), InputError,
                       Catch::Matchers::Predicate<InputError>(
                           [&](const InputError& e) {
                             UNSCOPED_INFO(e.what());
                             return std::string(e.what()).starts_with("results.json") &&
                                    std::string(e.what()).find(expected) != std::string::npos;
                           },
                           "names the file and says " + expected));
}

/// The full run with one change.
std::string changed(const std::function<void(Json&)>& change) {
  Json json = Json::parse(run_to_json(full_run()));
  change(json);
  return json.dump();
}

}  // namespace

TEST_CASE("json: everything comes back") {
  const RunRecord run = full_run();
  const std::string text = run_to_json(run);
  const RunRecord back = run_from_json(text, "results.json");
  CHECK(run_to_json(back) == text);
  CHECK(back.seed == 17446744073709551557ull);
  REQUIRE(back.cases.size() == run.cases.size());
  const CaseRecord &a = run.cases.back(), &b = back.cases.back();
  CHECK(a.seed == b.seed);
  CHECK(a.verdicts == b.verdicts);
  CHECK(a.worst[0].margin == b.worst[0].margin);
  CHECK(b.worst[0].bound == -std::numeric_limits<double>::infinity());
  CHECK(a.worst[0].origin == b.worst[0].origin);
  CHECK(std::isnan(b.figures[1].value));
  CHECK(b.figures[1].rounds == 5);
  CHECK(std::isinf(b.pictures[0].scale.high));
  CHECK(b.pictures[0].scale.colors.size() == 2);
  CHECK(b.pictures[0].legend[0].pixels == 12);
  CHECK(b.pictures[0].values == "pictures/a.values.js");
  CHECK(back.findings[0].found);
  CHECK(back.libraries == run.libraries);
}

TEST_CASE("json: the keys that others rely on") {
  const Json json = Json::parse(run_to_json(full_run()));
  for (const char* key : {"version", "commit", "seed", "driver", "summary", "cases"}) CHECK(json.contains(key));
  for (const char* key : {"renderer", "version", "findings"}) CHECK(json["driver"].contains(key));
  for (const char* key : {"cases", "passed", "failed", "rays", "verdicts"}) CHECK(json["summary"].contains(key));
  for (const char* key : {"name", "feature", "scene", "status", "rays", "verdicts", "seconds", "replay"})
    CHECK(json["cases"][0].contains(key));
  CHECK(json["summary"]["failed"] == 3);
  CHECK(json["seed"] == "17446744073709551557");
}

TEST_CASE("json: results obey the schema, broken ones do not") {
  const Json good = Json::parse(run_to_json(full_run()));
  REQUIRE(obeys_schema(good));
  REQUIRE(obeys_schema(Json::parse(run_to_json(RunRecord{}))));
  const auto broken = [&](const std::function<void(Json&)>& change) {
    Json json = good;
    change(json);
    return !obeys_schema(json);
  };
  CHECK(broken([](Json& j) { j.erase("seed"); }));
  CHECK(broken([](Json& j) { j["seed"] = 12; }));
  CHECK(broken([](Json& j) { j["schema_version"] = 2; }));
  CHECK(broken([](Json& j) { j["surprise"] = 1; }));
  CHECK(broken([](Json& j) { j["cases"][0]["status"] = "fine"; }));
  CHECK(broken([](Json& j) { j["cases"][0]["rays"] = -1; }));
  CHECK(broken([](Json& j) { j["cases"][0]["seconds"] = "soon"; }));
  CHECK(broken([](Json& j) { j["summary"]["verdicts"]["tie"] = 1.5; }));
  CHECK(broken([](Json& j) { j["cases"].back()["worst"][0].erase("replay"); }));
  CHECK(broken([](Json& j) { j["cases"].back()["pictures"][0]["legend"][0]["color"] = "red"; }));
  CHECK(broken([](Json& j) { j["driver"]["findings"][0]["found"] = "yes"; }));
}

TEST_CASE("json: every key of the schema is described, and every described key is written") {
  const Json schema = Json::parse(results_schema());
  const Json written = Json::parse(run_to_json(full_run()));
  std::size_t keys = 0;
  const std::function<void(const Json&)> check = [&](const Json& node) {
    if (node.is_array())
      for (const Json& item : node) check(item);
    if (!node.is_object()) return;
    if (node.contains("properties") && node["properties"].is_object()) {
      for (const auto& [name, property] : node["properties"].items()) {
        ++keys;
        INFO(name);
        CHECK((property.contains("description") || property.contains("$ref")));
        CHECK(written.dump().find("\"" + name + "\":") != std::string::npos);
      }
    }
    for (const auto& [name, child] : node.items()) check(child);
  };
  check(schema);
  CHECK(keys > 70);
}

TEST_CASE("json: text that is no UTF-8 does not stop a report") {
  RunRecord run = full_run();
  run.cases.back().message = kNastyText;
  const RunRecord back = run_from_json(run_to_json(run), "results.json");
  CHECK(back.cases.back().message.find("</script><b a=\"1\" c='2'>&amp; \x01\x1b[31m \xef\xbf\xbd") == 0);
}

TEST_CASE("json: foreign, broken and newer files are refused with what to do") {
  const std::string good = run_to_json(full_run());
  check_refused("", "truncated");
  check_refused(good.substr(0, good.size() / 2), "truncated");
  check_refused("[1, 2]", "no file of plumbline's");
  check_refused("{\"format\": 3}", "no file of plumbline's");
  check_refused(std::string("\x89PNG\r\n\x1a\n\0\0", 10), "not JSON");
  check_refused(changed([](Json& j) { j["schema_version"] = 2; }), "use the plumbline that wrote it");
  check_refused(changed([](Json& j) { j["cases"][3]["rays"] = -4; }), "cases[3].rays: expected a whole number");
  check_refused(changed([](Json& j) { j["cases"][3]["rays"] = 1.5; }), "cases[3].rays");
  check_refused(changed([](Json& j) { j["cases"][2].erase("name"); }), "cases[2].name: expected this key");
  check_refused(changed([](Json& j) { j["cases"][2]["status"] = "fine"; }), "cases[2].status");
  check_refused(changed([](Json& j) { j["seed"] = "18446744073709551616"; }),
                "seed: expected a string of decimal digits below 2^64");
  check_refused(changed([](Json& j) { j["seed"] = ""; }), "seed");
  check_refused(changed([](Json& j) { j["seconds"] = "soon"; }), "seconds");
  check_refused(changed([](Json& j) { j["libraries"] = 1; }), "libraries");
  check_refused(changed([](Json& j) { j["seed"] = "1"; }), "digest does not hold");
  CHECK(run_from_json(changed([](Json& j) { j.erase("digest"), j["added_later"] = 1; }), "results.json").cases.size() ==
        full_run().cases.size());
  CHECK(run_from_json(changed([](Json& j) { j.erase("digest"), j["seed"] = "18446744073709551615"; }), "f").seed ==
        18446744073709551615ull);
}

TEST_CASE("json: deep nesting is refused, not a crash") { check_refused(std::string(100000, '['), "truncated"); }

TEST_CASE("json: files are whole or not there") {
  TemporaryFolder folder;
  const auto file = folder.path / "deep" / "results.json";
  write_results(full_run(), file);
  CHECK(run_to_json(read_results(file)) == run_to_json(full_run()));
  CHECK_THROWS_AS(read_results(folder.path / "none.json"), InputError);
  CHECK_THROWS_AS(read_results(folder.path), InputError);
  write_text(folder.path / "empty", "");
  CHECK_THROWS_AS(read_results(folder.path / "empty"), InputError);
  CHECK(read_text(folder.path / "empty").empty());
  CHECK_THROWS_AS(write_results(full_run(), folder.path / "empty" / "results.json"), EnvironmentError);
  CHECK_THROWS_AS(write_text(folder.path, "x"), InputError);
}

}  // namespace plumbline
