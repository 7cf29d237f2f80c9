// SPDX-License-Identifier: MIT
// Explanations: the document obeys its schema and reads back to the same walk; the page holds it safely.
#include "reports/explanation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "scenes/error.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;
using Catch::Matchers::Contains;

bool obeys_schema(const Json& document) {
  const Json schema_text = Json::parse(explanation_schema());
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

/// An explanation in which every field differs from its default.
ExplanationRecord full_explanation() {
  ExplanationRecord r;
  r.scene = "</script><b>scene", r.command = "./plumbline explain x --ray=1", r.version = "0.1.0";
  r.driver = "llvmpipe", r.image = "baked now", r.shape = "compact", r.bounds = "sphere";
  r.ray = {"0x1p+0,0x1p+0,0x1p+0", "0x1p+0,0x0p+0,0x0p+0", "inf"};
  r.verdict = "tracer_wrong", r.reason = "because", r.layer = "bounds", r.sentence = "sphere of node 57 <rejected> it";
  r.answers = {{"tracer", "miss"}, {"exact", "hit 3"}};
  r.crossings = {"triangle 3 at t = 2"};
  r.truth_primitive = 3, r.truth_instance = 4, r.truth_t = 2.5;
  StepRecord step;
  step.number = 1, step.again = true, step.space = 2, step.cell = 9, step.x = 9, step.y = 1, step.copy = 5;
  step.node = 7, step.test = "missed", step.reason = "miss", step.bound = INFINITY;
  step.distance2 = 0x1.234568p-20f, step.radius2 = -0.0f, step.foot = NAN, step.line_distance2 = 0x1p-149f;
  step.enter = 1.5f, step.leave = -INFINITY, step.word = 0.1f, step.link = {0.25f, 0.75f};
  PrimitiveStepRecord primitive;
  primitive.primitive = 3, primitive.stored = 8, primitive.outcome = "outside", primitive.is_sphere = true;
  primitive.is_last = true, primitive.resolved = true, primitive.t = 0.3f, primitive.t_world = 0.7f;
  primitive.t_low = -0.1f, primitive.nearest_before = 3.0f, primitive.nearest_after = 2.0f;
  primitive.weights = {0.1f, 0.2f}, primitive.numbers = {1.0f, 2.0f, 3.0f, 4.1f};
  step.primitives = {primitive};
  step.changes = {{"left", 2, kNoNumber, 5, {1, 2, 3}, {4, 5, 6}, 2.0f, 3.0f, -1.0f, 8.0f}};
  step.ended = true, step.next = 10, step.on_chain = true, step.notable = true;
  r.start = {"started", kNoNumber, kNoNumber, 5, {1, 2, 3.3f}, {4, 5, 6}, 1.0f, 0.0f, 0.0f, INFINITY};
  r.steps = {step};
  r.total_steps = 12, r.skipped = 4, r.driver_agrees = false;
  r.chain = {{2, 9, 7, 9, 1, 6, 0}, {kNoNumber, 1, 0, 1, 0, kNoNumber, kNoNumber}};
  r.fault = {"bounds", 0, 2, 9, 7, kNoNumber, 9, 1, 3.1e-4, "no"};
  r.slice.length = 2.0;
  r.slice.shapes = {{"fault", "node 7", 0, true, 1, 2, 3, 4, 0.5, {}},
                    {"truth", "primitive 3", kNoNumber, false, 0, 0, 0, 0, 0, {{0, 1}, {2, 3}}}};
  r.slice.marks = {{"truth", "primitive 3 at t = 2.5", 5.0}};
  r.slice.left_out = 1, r.slice.not_cut = 2;
  r.against = ComparisonRecord{"variant leaf_1", true, "step by step", false, "step 1 differs", step, {}, "miss"};
  return r;
}

}  // namespace

TEST_CASE("explanation: the document obeys its schema, a broken one does not") {
  CHECK(obeys_schema(Json::parse(explanation_to_json(full_explanation()))));
  Json good = Json::parse(explanation_to_json(full_explanation()));
  const auto broken = [&](auto change) {
    Json json = good;
    change(json);
    return !obeys_schema(json);
  };
  CHECK(broken([](Json& j) { j["schema_version"] = 2; }));
  CHECK(broken([](Json& j) { j.erase("walk"); }));
  CHECK(broken([](Json& j) { j["layer"] = "weather"; }));
  CHECK(broken([](Json& j) { j["walk"]["steps"][0]["reason"] = "no reason"; }));
  CHECK(broken([](Json& j) { j["walk"]["steps"][0]["stranger"] = 1; }));
  const Json reasons = Json::parse(explanation_schema())["definitions"]["step"]["properties"]["reason"]["enum"];
  CHECK(reasons == Json(kWalkReasons));
}

TEST_CASE("explanation: a walk reads back bit for bit, and what is none is refused") {
  const ExplanationRecord r = full_explanation();
  const ExplanationRecord back = explanation_from_json(explanation_to_json(r), "walk.json");
  CHECK(back.ray == r.ray);
  CHECK(back.shape == r.shape);
  REQUIRE(back.steps.size() == 1);
  const StepRecord &a = r.steps[0], &b = back.steps[0];
  CHECK(b.distance2 == a.distance2);
  CHECK(std::signbit(b.radius2));
  CHECK(std::isnan(b.foot));
  CHECK(b.line_distance2 == a.line_distance2);
  CHECK(b.leave == a.leave);
  CHECK(b.word == a.word);
  CHECK(b.link == a.link);
  CHECK(b.primitives.at(0).numbers == a.primitives[0].numbers);
  CHECK(b.changes.at(0).o == a.changes[0].o);
  CHECK((b.again && b.ended && b.next == 10 && b.space == 2 && b.copy == 5));
  // The whole again: what is written of a walk that was read is what was written first.
  CHECK(Json::parse(explanation_to_json(back))["walk"]["steps"] ==
        Json::parse(explanation_to_json(r))["walk"]["steps"]);
  const auto refused = [](const std::string& text) {
    CHECK_THROWS_MATCHES(explanation_from_json(text, "walk.json"), InputError,
                         Catch::Matchers::Predicate<InputError>(
                             [](const InputError& e) { return std::string(e.what()).starts_with("walk.json: "); }));
  };
  refused("");
  refused("[]");
  refused("{\"format\": \"plumbline results\"}");
  for (const char* change : {"schema_version", "walk", "ray", "shape"}) {
    Json json = Json::parse(explanation_to_json(r));
    json[change] = Json::array();
    refused(json.dump());
  }
  Json json = Json::parse(explanation_to_json(r));
  json["walk"]["steps"][0]["number"] = -1;
  refused(json.dump());
}

TEST_CASE("explanation: the page is self-contained, and text in it stays text") {
  const std::string html = explanation_html(full_explanation());
  CHECK_THAT(html, Contains("sphere of node 57 &lt;rejected&gt; it") && Contains("Layer: <b>bounds</b>"));
  CHECK_THAT(html, !Contains("</script><b>scene"));
  // Nothing comes from elsewhere: the only addresses are names of formats.
  for (std::size_t at = 0; (at = html.find("http", at)) != std::string::npos; ++at)
    CHECK(html.compare(at, 17, "http://www.w3.org") == 0);
  for (const char* mark : {"{{", "src=", "@import", "url("}) CHECK_THAT(html, !Contains(mark));
}

}  // namespace plumbline
