// SPDX-License-Identifier: MIT
// The nodes of inspected images, packed for the page's script: a list for each field, and numbers with five digits.
//
//   {"colors": ["#rrggbb"...], "alike": true, "bakes": [{"name": "...", "regions": ["world"...], "nodes": {
//     "region": [...], "number": [...], "x": ..., "y", "parent" (null: a root), "depth", "children", "leaf" (0 or 1),
//     "transform" (null: none), "primitives", "center" (three for each node), "half" (boxes: three for each; else
//     null), "radius", "visits", "hits", "tests", "cost", "slack" (0: none), "overlap" (null: none), "other" (null:
//     none)}}]}
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "reports/color.h"
#include "reports/format.h"
#include "reports/inspect_parts.h"

namespace plumbline::page {
namespace {

/// Text in quotes; no "<" is left that could end the script element.
std::string quoted_text(const std::string& text) {
  std::string json = nlohmann::json(valid_utf8(text)).dump();
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
  return json;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
}
std::string number(std::uint32_t value) { return value == kNone ? "null" : std::to_string(value); }
std::string number(std::uint64_t value) { return std::to_string(value); }
std::string number(int value) { return std::to_string(value); }

class Packer {
 public:
  explicit Packer(const InspectedBake& bake) : bake_(bake) {}

  std::string pack() {
    bool boxes = false;
    for (const InspectedNodeRecord& n : bake_.outline) boxes = boxes || n.half[0] > 0.0 || n.half[1] > 0.0;
    using Node = const InspectedNodeRecord&;
    field("region", [](Node n) { return number(n.region); });
    field("number", [](Node n) { return number(n.number); });
    field("x", [](Node n) { return number(n.x); });
    field("y", [](Node n) { return number(n.y); });
    field("parent", [](Node n) { return number(n.parent); });
    field("depth", [](Node n) { return number(n.depth); });
    field("children", [](Node n) { return number(n.children); });
    field("leaf", [](Node n) { return number(n.is_leaf ? 1 : 0); });
    field("transform", [](Node n) { return number(n.transform); });
    field("primitives", [](Node n) { return number(n.primitives); });
    const auto three = [](const std::array<double, 3>& v) {
      return number(v[0]) + "," + number(v[1]) + "," + number(v[2]);
    };
    field("center", [&](Node n) { return three(n.center); });
    if (boxes) field("half", [&](Node n) { return three(n.half); });
    field("radius", [](Node n) { return number(n.radius); });
    field("visits", [](Node n) { return number(n.visits); });
    field("hits", [](Node n) { return number(n.hits); });
    field("tests", [](Node n) { return number(n.tests); });
    field("cost", [](Node n) { return number(n.cost); });
    field("slack", [](Node n) { return number(n.slack); });
    field("overlap", [](Node n) { return number(n.overlap); });
    field("other", [](Node n) { return number(n.other_visits); });
    std::string regions;
    for (const InspectedRegionRecord& region : bake_.regions)
      regions += (regions.empty() ? "" : ",") + quoted_text(region.name);
    return "{\"name\":" + quoted_text(bake_.name) + ",\"regions\":[" + regions + "],\"nodes\":{" + fields_ + "}}";
  }

 private:
  template <class Value>
  void field(const char* name, const Value& value) {
    fields_ += (fields_.empty() ? "\"" : ",\"") + std::string(name) + "\":[";
    for (std::size_t i = 0; i < bake_.outline.size(); ++i) {
      if (i > 0) fields_ += ',';
      fields_ += value(bake_.outline[i]);
    }
    fields_ += ']';
  }

  const InspectedBake& bake_;
  std::string fields_;
};

}  // namespace

std::string packed_nodes(const InspectRecord& record) {
  constexpr int kColors = 33;
  std::string json = "{\"colors\":[";
  for (int i = 0; i < kColors; ++i) json += (i > 0 ? ",\"" : "\"") + hex_color(value_color(i / (kColors - 1.0))) + "\"";
  json += std::string("],\"alike\":") + (record.are_alike ? "true" : "false") + ",\"bakes\":[";
  for (std::size_t i = 0; i < record.bakes.size(); ++i) json += (i > 0 ? "," : "") + Packer(record.bakes[i]).pack();
  return json + "]}";
}

}  // namespace plumbline::page
