// SPDX-License-Identifier: MIT
// An inspected image as JSON.
#include <cmath>
#include <nlohmann/json.hpp>

#include "reports/format.h"
#include "reports/inspect_report.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number_or_null(std::uint32_t value) { return value == kNone ? Json(nullptr) : Json(value); }
Json text(const std::string& value) { return valid_utf8(value); }

Json to_json(const SpreadRecord& s) {
  if (s.count == 0) return {{"count", 0}};
  return {{"count", s.count},           {"mean", number(s.mean)}, {"min", number(s.min)},
          {"median", number(s.median)}, {"p99", number(s.p99)},   {"max", number(s.max)}};
}

Json to_json(const HistogramRecord& h) {
  return {{"name", text(h.name)}, {"unit", text(h.unit)}, {"first", h.first}, {"width", h.width}, {"counts", h.counts}};
}

Json to_json(const InspectedNodeRecord& n) {
  Json json = {{"region", n.region},
               {"number", n.number},
               {"x", n.x},
               {"y", n.y},
               {"parent", number_or_null(n.parent)},
               {"depth", n.depth},
               {"children", n.children},
               {"leaf", n.is_leaf},
               {"transform", number_or_null(n.transform)},
               {"behind", number_or_null(n.behind)},
               {"primitives", n.primitives},
               {"center", n.center},
               {"radius", number(n.radius)},
               {"chance", number(n.chance)},
               {"overlap", number(n.overlap)},
               {"slack", n.slack > 0.0 ? number(n.slack) : Json(nullptr)},
               {"visits", n.visits},
               {"hits", n.hits},
               {"primitive_tests", n.tests},
               {"cost", number(n.cost)}};
  if (n.half[0] > 0.0 || n.half[1] > 0.0 || n.half[2] > 0.0) json["half"] = n.half;
  if (std::isfinite(n.other_visits)) json["other_visits"] = n.other_visits;
  return json;
}

Json to_json(const InspectedRegionRecord& r);
Json to_json(const InspectedRayRecord& r);
Json to_json(const InspectedRays& r);
Json to_json(const PictureRecord& p);
Json to_json(const InspectedBake& b);

template <class T>
Json list(const std::vector<T>& items) {
  Json json = Json::array();
  for (const T& item : items) json.push_back(to_json(item));
  return json;
}

Json to_json(const InspectedRegionRecord& r) {
  return {{"name", text(r.name)},
          {"shown", r.shown},
          {"nodes", r.nodes},
          {"leaves", r.leaves},
          {"transforms", r.transforms},
          {"primitives", r.primitives},
          {"depth", r.depth},
          {"texels", r.texels},
          {"expected_steps", number(r.visits)},
          {"expected_primitive_tests", number(r.tests)}};
}

Json to_json(const InspectedRayRecord& r) {
  return {{"where", text(r.where)},   {"origin", r.origin},         {"direction", r.direction},
          {"steps", r.steps},         {"primitive_tests", r.tests}, {"transforms", r.transforms},
          {"answer", text(r.answer)}, {"replay", text(r.replay)}};
}

Json to_json(const InspectedRays& r) {
  return {{"name", r.name},
          {"what", text(r.what)},
          {"count", r.count},
          {"hits", r.hits},
          {"steps", to_json(r.steps)},
          {"primitive_tests", to_json(r.tests)},
          {"expected_steps", number(r.expected_steps)},
          {"expected_primitive_tests", number(r.expected_tests)},
          {"histogram", to_json(r.histogram)},
          {"longest", list(r.longest)}};
}

Json to_json(const PictureRecord& p) { return {{"path", p.path}, {"title", p.title}, {"caption", p.caption}}; }

Json to_json(const InspectedBake& b) {
  Json options = Json::object(), memory = Json::object();
  for (const auto& [name, value] : b.options) options[valid_utf8(name)] = text(value);
  for (const ShareRecord& share : b.memory) memory[share.name] = share.count;
  return {{"name", text(b.name)},
          {"source", text(b.source)},
          {"options", options},
          {"width", b.width},
          {"height", b.height},
          {"unit", number(b.unit)},
          {"fault_count", b.fault_count},
          {"nodes", b.nodes},
          {"leaves", b.leaves},
          {"primitives", b.primitives},
          {"transforms", b.transforms},
          {"depth", b.depth},
          {"copies", b.copies},
          {"expected_steps", number(b.expected_steps)},
          {"expected_primitive_tests", number(b.expected_tests)},
          {"expected_transforms", number(b.expected_transforms)},
          {"slack", to_json(b.slack)},
          {"overlap", to_json(b.overlap)},
          {"overlap_met", number(b.overlap_met)},
          {"texels", memory},
          {"histograms", list(b.histograms)},
          {"regions", list(b.regions)},
          {"rays", list(b.rays)},
          {"visits_by_depth", b.visits_by_depth},
          {"costliest", list(b.costliest)},
          {"outline_depth", b.kept_depth},
          {"outline", list(b.outline)},
          {"pictures", list(b.pictures)},
          {"bake_seconds", number(b.bake_seconds)},
          {"statistics_seconds", number(b.statistics_seconds)},
          {"trace_seconds", number(b.trace_seconds)}};
}

}  // namespace

std::string inspect_json(const InspectRecord& record) {
  Json json = {{"schema", InspectRecord::kSchemaVersion},
               {"version", text(record.version)},
               {"commit", text(record.commit)},
               {"command", text(record.command)},
               {"driver", text(record.driver)},
               {"camera", text(record.camera)},
               {"alike", record.are_alike}};
  json["bakes"] = list(record.bakes);
  for (std::size_t i = 0; i < record.bakes.size(); ++i) {
    Json faults = Json::array();
    for (const std::string& fault : record.bakes[i].faults) faults.push_back(text(fault));
    json["bakes"][i]["faults"] = std::move(faults);
  }
  return json.dump(1) + "\n";
}

}  // namespace plumbline
