// SPDX-License-Identifier: MIT
// The faces of an inspected image say what the record says, and the page is whole.
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "reports/inspect_parts.h"
#include "reports/inspect_report.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const char* const kNasty = "</script><b onload=\"x\">'&{{css}}";

InspectedBake example_bake(const std::string& name) {
  InspectedBake bake;
  bake.name = name, bake.source = "two_spheres";
  bake.width = 16, bake.height = 16;
  bake.options = {{"layout", "compact"}};
  bake.nodes = 3, bake.leaves = 2, bake.primitives = 2, bake.depth = 2;
  bake.expected_steps = 4.0, bake.expected_tests = 2.0 / 9.0;
  bake.overlap = {1, 0.25, 0.25, 0.25, 0.25, 0.25};
  bake.memory = {{"nodes", 3}, {"primitives", 4}, {"unused", 249}};
  bake.histograms = {{"leaves by depth", "leaves", 1, 1, {0, 2}}};
  bake.regions = {{"world", 1, 3, 2, 0, 2, 2, 8, 4.0, 0.2}};
  InspectedRays rays;
  rays.name = "lines", rays.what = "Random lines.", rays.count = 100, rays.hits = 20;
  rays.steps = {100, 3.5, 1, 4, 4, 4}, rays.tests = {100, 0.2, 0, 0, 1, 1};
  rays.expected_steps = 4.0, rays.expected_tests = kNan;
  rays.histogram = {"steps: lines", "rays", 0, 1, {0, 10, 0, 30, 60}};
  rays.longest = {{"0x1p+0,0x0p+0,0x0p+0", "0x1p+0,0x0p+0,0x0p+0", "line 7", 4, 1, 0, "miss", "./plumbline explain x"}};
  bake.rays = {rays};
  for (std::uint32_t i = 0; i < 3; ++i) {
    InspectedNodeRecord node;
    node.number = i, node.x = static_cast<int>(i);
    node.parent = i == 0 ? kNone : 0, node.depth = i == 0 ? 1 : 2, node.children = i == 0 ? 2 : 0;
    node.is_leaf = i > 0, node.primitives = i == 0 ? 2 : 1, node.radius = 1.5;
    node.overlap = i == 0 ? 0.25 : kNan, node.other_visits = kNan;
    node.visits = 100, node.hits = 50, node.cost = 150.0;
    bake.outline.push_back(node);
  }
  bake.costliest = {bake.outline[0]};
  bake.visits_by_depth = {0, 100, 200};
  return bake;
}

InspectRecord example(int bakes = 1) {
  InspectRecord record;
  record.version = "0.1.0", record.commit = "abc", record.command = "plumbline inspect x";
  for (int i = 0; i < bakes; ++i) record.bakes.push_back(example_bake(i == 0 ? "first" : "second"));
  return record;
}

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

}  // namespace

TEST_CASE("inspect report: JSON holds the record") {
  const auto json = nlohmann::json::parse(inspect_json(example()));
  CHECK(json["schema"] == 1);
  const auto& bake = json["bakes"][0];
  CHECK(bake["nodes"] == 3);
  CHECK(bake["texels"]["unused"] == 249);
  CHECK(bake["rays"][0]["steps"]["p99"] == 4.0);
  CHECK(bake["rays"][0]["expected_primitive_tests"].is_null());
  CHECK(bake["outline"].size() == 3);
  CHECK(bake["outline"][0]["parent"].is_null());
  CHECK(bake["outline"][1]["parent"] == 0);
  CHECK(bake["outline"][1]["overlap"].is_null());
  CHECK(bake["slack"] == nlohmann::json{{"count", 0}});
}

TEST_CASE("inspect report: the page is whole and loads nothing") {
  for (const int bakes : {1, 2}) {
    const std::string html = inspect_html(example(bakes));
    const std::string markup = html.substr(0, html.find("<script type=\"application/json\""));
    for (const char* element :
         {"section", "table", "ul", "ol",    "dl",     "figure", "div",  "span",  "p",  "svg", "td",
          "th",      "tr",    "li", "label", "select", "button", "text", "small", "h2", "h3"}) {
      INFO(element << " of " << bakes);
      const std::string open = std::string("<") + element;
      CHECK(occurrences(markup, open + ">") + occurrences(markup, open + " ") ==
            occurrences(markup, std::string("</") + element + ">"));
    }
    CHECK(occurrences(html, "http://") == occurrences(html, "http://www.w3.org/2000/svg"));
    for (const char* word : {"https://", "@import", "<script src", "fetch(", "{{"})
      CHECK(html.find(word) == std::string::npos);
  }
}

TEST_CASE("inspect report: packed nodes are what the script reads") {
  const auto packed = nlohmann::json::parse(page::packed_nodes(example(2)));
  REQUIRE(packed["bakes"].size() == 2);
  const auto& nodes = packed["bakes"][1]["nodes"];
  CHECK(nodes["parent"] == nlohmann::json({nullptr, 0, 0}));
  CHECK(nodes["center"].size() == 9);
  CHECK(nodes["overlap"] == nlohmann::json({0.25, nullptr, nullptr}));
  CHECK_FALSE(nodes.contains("half"));
  InspectRecord boxes = example();
  boxes.bakes[0].outline[1].half = {1.0, 2.0, 3.0};
  CHECK(nlohmann::json::parse(page::packed_nodes(boxes))["bakes"][0]["nodes"]["half"][4] == 2.0);
}

TEST_CASE("inspect report: hostile names stay text") {
  InspectRecord record = example();
  record.command = record.camera = record.driver = kNasty;
  InspectedBake& bake = record.bakes[0];
  bake.name = bake.source = bake.regions[0].name = bake.rays[0].longest[0].where = bake.rays[0].what = kNasty;
  bake.faults = {kNasty}, bake.fault_count = 1;
  const std::string html = inspect_html(record);
  CHECK(html.find("<b onload") == std::string::npos);
  CHECK(occurrences(html, "</script>") == 3);
  CHECK(nlohmann::json::parse(inspect_json(record))["bakes"][0]["source"] == kNasty);
}

TEST_CASE("inspect report: two images stand side by side, with what the second has over the first") {
  InspectRecord record = example(2);
  record.bakes[1].nodes = 6;
  const std::string text = inspect_text(record);
  CHECK_THAT(
      text,
      Contains("  nodes                         3                             6                             x 2\n"));
  CHECK_THAT(text, Contains("./plumbline explain x"));
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) CHECK(end - at <= 100);
  CHECK_THAT(inspect_html(record), Contains("second takes 1 times the steps of first"));
}
