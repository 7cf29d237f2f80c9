// SPDX-License-Identifier: MIT
// Explanations as JSON. Floats are written so that they read back to the same bits; a NaN loses its payload.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "reports/assets.h"
#include "reports/explanation.h"
#include "reports/format.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "plumbline explanation";

Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}
Json id(std::uint32_t value) { return value == kNoNumber ? Json() : Json(value); }
template <typename T, std::size_t N>
Json numbers(const std::array<T, N>& values) {
  Json out = Json::array();
  for (const T value : values) out.push_back(number(static_cast<double>(value)));
  return out;
}

Json to_json(const PrimitiveStepRecord& p) {
  return {{"primitive", id(p.primitive)},
          {"stored", p.stored},
          {"outcome", p.outcome},
          {"sphere", p.is_sphere},
          {"last", p.is_last},
          {"resolved", p.resolved},
          {"t", number(p.t)},
          {"t_world", number(p.t_world)},
          {"t_low", number(p.t_low)},
          {"nearest_before", number(p.nearest_before)},
          {"nearest_after", number(p.nearest_after)},
          {"weights", numbers(p.weights)},
          {"numbers", numbers(p.numbers)}};
}

Json to_json(const SpaceStepRecord& s) {
  return {{"kind", s.kind},
          {"node", id(s.node)},
          {"space", id(s.space)},
          {"copy", s.copy},
          {"o", numbers(s.o)},
          {"d", numbers(s.d)},
          {"t_scale", number(s.t_scale)},
          {"t_shift", number(s.t_shift)},
          {"t_low", number(s.t_low)},
          {"bound", number(s.bound)}};
}

Json to_json(const StepRecord& s);
Json to_json(const AncestorRecord& a);
Json to_json(const ShapeRecord& s);
Json to_json(const MarkRecord& m);

template <typename Record>
Json list(const std::vector<Record>& records) {
  Json out = Json::array();
  for (const Record& record : records) out.push_back(to_json(record));
  return out;
}

/// Keys whose value is the default one are left out where there are many of them.
Json to_json(const StepRecord& s) {
  Json out = {{"number", s.number}, {"cell", s.cell}, {"x", s.x},           {"y", s.y},
              {"node", id(s.node)}, {"test", s.test}, {"reason", s.reason}, {"bound", number(s.bound)}};
  const auto add = [&](const char* key, float value) {
    if (!(value == 0.0f) || std::signbit(value)) out[key] = number(value);
  };
  const auto flag = [&](const char* key, bool value) {
    if (value) out[key] = true;
  };
  if (s.space != kNoNumber) out["space"] = s.space;
  if (s.copy != kNoNumber) out["copy"] = s.copy;
  if (s.next != kNoNumber) out["next"] = s.next;
  add("distance2", s.distance2), add("radius2", s.radius2), add("foot", s.foot);
  add("line_distance2", s.line_distance2), add("enter", s.enter), add("leave", s.leave), add("word", s.word);
  if (s.link != std::array<float, 2>{}) out["link"] = numbers(s.link);
  if (!s.primitives.empty()) out["primitives"] = list(s.primitives);
  if (!s.changes.empty()) out["changes"] = list(s.changes);
  flag("again", s.again), flag("ended", s.ended), flag("on_chain", s.on_chain), flag("notable", s.notable);
  return out;
}

Json to_json(const AncestorRecord& a) {
  return {{"space", id(a.space)},         {"cell", a.cell},    {"x", a.x}, {"y", a.y}, {"node", a.node},
          {"transform", id(a.transform)}, {"step", id(a.step)}};
}

Json to_json(const FaultRecord& f) {
  return {{"kind", f.kind},
          {"step", id(f.step)},
          {"space", id(f.space)},
          {"cell", id(f.cell)},
          {"node", id(f.node)},
          {"transform", id(f.transform)},
          {"x", f.x},
          {"y", f.y},
          {"shortfall", number(f.shortfall)},
          {"as_baked", f.as_baked}};
}

Json to_json(const ShapeRecord& s) {
  Json out = {{"role", s.role}, {"label", s.label}, {"step", id(s.step)}};
  if (s.is_ellipse) {
    out["ellipse"] = {number(s.x), number(s.y), number(s.rx), number(s.ry), number(s.angle)};
  } else {
    Json& points = out["points"] = Json::array();
    for (const auto& point : s.points) points.push_back(numbers(point));
  }
  return out;
}

Json to_json(const MarkRecord& m) { return {{"role", m.role}, {"label", m.label}, {"x", number(m.x)}}; }

Json to_json(const SliceRecord& s) {
  return {{"length", number(s.length)},
          {"shapes", list(s.shapes)},
          {"marks", list(s.marks)},
          {"left_out", s.left_out},
          {"not_cut", s.not_cut}};
}

Json to_json(const ComparisonRecord& c) {
  return {{"with", c.with},
          {"step_by_step", c.step_by_step},
          {"note", c.note},
          {"same", c.same},
          {"sentence", c.sentence},
          {"first", c.first ? to_json(*c.first) : Json()},
          {"second", c.second ? to_json(*c.second) : Json()},
          {"second_answer", c.second_answer}};
}

// ---- Reading ----

/// A value and the way to it, so that an error names the place.
struct Place {
  const Json& json;
  const std::string& file;
  std::string path;

  [[noreturn]] void refuse(const std::string& expected) const {
    throw InputError(file + ": " + (path.empty() ? "the whole" : path) + ": expected " + expected +
                     "; this walk was not written by `plumbline explain --json` of this version, or was changed");
  }
  bool has(const char* key) const { return json.is_object() && json.contains(key) && !json[key].is_null(); }
  Place at(const char* key) const {
    const std::string inner = path.empty() ? std::string(key) : path + "." + key;
    if (!json.is_object() || !json.contains(key)) throw InputError(file + ": " + inner + " is missing");
    return {json[key], file, inner};
  }
  std::vector<Place> items(const char* key) const {
    if (!has(key)) return {};
    const Place list = at(key);
    if (!list.json.is_array()) list.refuse("a list");
    std::vector<Place> places;
    for (std::size_t i = 0; i < list.json.size(); ++i)
      places.push_back({list.json[i], file, list.path + "[" + std::to_string(i) + "]"});
    return places;
  }
  std::string text(const char* key) const {
    const Place p = at(key);
    if (!p.json.is_string()) p.refuse("text");
    return p.json.get<std::string>();
  }
  bool flag(const char* key) const {
    if (!has(key)) return false;
    if (!at(key).json.is_boolean()) at(key).refuse("true or false");
    return at(key).json.get<bool>();
  }
  /// kNoNumber where the key is null or left out.
  std::uint32_t id(const char* key) const {
    if (!has(key)) return kNoNumber;
    const Place p = at(key);
    if (!p.json.is_number_unsigned() || p.json.get<std::uint64_t>() > kNoNumber) p.refuse("a number below 2^32");
    return p.json.get<std::uint32_t>();
  }
  int small(const char* key) const {
    const std::uint32_t value = id(key);
    if (value > 1u << 20) at(key).refuse("a texel's coordinate");
    return static_cast<int>(value);
  }
  double real() const {
    if (json.is_number()) return json.get<double>();
    if (json == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (json == "inf") return std::numeric_limits<double>::infinity();
    if (json == "-inf") return -std::numeric_limits<double>::infinity();
    refuse("a number, or \"nan\", \"inf\", \"-inf\"");
  }
  float single(const char* key) const { return has(key) ? static_cast<float>(at(key).real()) : 0.0f; }
  template <std::size_t N>
  std::array<float, N> singles(const char* key) const {
    std::array<float, N> values{};
    if (!has(key)) return values;
    const std::vector<Place> list = items(key);
    if (list.size() != N) at(key).refuse(std::to_string(N) + " numbers");
    for (std::size_t i = 0; i < N; ++i) values[i] = static_cast<float>(list[i].real());
    return values;
  }
};

PrimitiveStepRecord primitive_of(const Place& p) {
  PrimitiveStepRecord out;
  out.primitive = p.id("primitive");
  out.stored = p.id("stored");
  out.outcome = p.text("outcome");
  out.is_sphere = p.flag("sphere"), out.is_last = p.flag("last"), out.resolved = p.flag("resolved");
  out.t = p.single("t"), out.t_world = p.single("t_world"), out.t_low = p.single("t_low");
  out.nearest_before = p.single("nearest_before"), out.nearest_after = p.single("nearest_after");
  out.weights = p.singles<2>("weights");
  out.numbers = p.singles<4>("numbers");
  return out;
}

SpaceStepRecord change_of(const Place& p) {
  SpaceStepRecord out;
  out.kind = p.text("kind");
  out.node = p.id("node"), out.space = p.id("space"), out.copy = p.id("copy");
  out.o = p.singles<3>("o"), out.d = p.singles<3>("d");
  out.t_scale = p.single("t_scale"), out.t_shift = p.single("t_shift");
  out.t_low = p.single("t_low"), out.bound = p.single("bound");
  return out;
}

StepRecord step_of(const Place& p) {
  StepRecord out;
  out.number = p.id("number");
  out.again = p.flag("again"), out.ended = p.flag("ended");
  out.on_chain = p.flag("on_chain"), out.notable = p.flag("notable");
  out.space = p.id("space"), out.cell = p.id("cell"), out.copy = p.id("copy"), out.node = p.id("node");
  out.next = p.id("next");
  out.x = p.small("x"), out.y = p.small("y");
  out.test = p.text("test"), out.reason = p.text("reason");
  out.bound = p.single("bound"), out.distance2 = p.single("distance2"), out.radius2 = p.single("radius2");
  out.foot = p.single("foot"), out.line_distance2 = p.single("line_distance2");
  out.enter = p.single("enter"), out.leave = p.single("leave"), out.word = p.single("word");
  out.link = p.singles<2>("link");
  for (const Place& item : p.items("primitives")) out.primitives.push_back(primitive_of(item));
  for (const Place& item : p.items("changes")) out.changes.push_back(change_of(item));
  return out;
}

}  // namespace

std::string explanation_to_json(const ExplanationRecord& r) {
  Json answers = Json::array();
  for (const auto& [who, text] : r.answers) answers.push_back({{"who", who}, {"text", text}});
  Json out = {
      {"format", kFormat},
      {"schema_version", ExplanationRecord::kVersion},
      {"version", r.version},
      {"driver", r.driver},
      {"scene", r.scene},
      {"command", r.command},
      {"image", r.image},
      {"shape", r.shape},
      {"bounds", r.bounds},
      {"ray", {{"origin", r.ray[0]}, {"direction", r.ray[1]}, {"t_max", r.ray[2]}}},
      {"verdict", r.verdict},
      {"reason", r.reason},
      {"layer", r.layer},
      {"sentence", r.sentence},
      {"answers", std::move(answers)},
      {"crossings", r.crossings},
      {"truth", {{"primitive", id(r.truth_primitive)}, {"instance", id(r.truth_instance)}, {"t", number(r.truth_t)}}},
      {"chain", list(r.chain)},
      {"fault", to_json(r.fault)},
      {"walk",
       {{"start", to_json(r.start)},
        {"total_steps", r.total_steps},
        {"skipped", r.skipped},
        {"driver_agrees", r.driver_agrees},
        {"steps", list(r.steps)}}},
      {"slice", to_json(r.slice)}};
  if (r.against) out["against"] = to_json(*r.against);
  return out.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

ExplanationRecord explanation_from_json(std::string_view text, const std::string& file) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(file + ": not JSON from byte " + std::to_string(error.byte) +
                     " on; give a walk that `plumbline explain --json` wrote");
  }
  const Place p{json, file, ""};
  if (!json.is_object() || !p.has("format") || json["format"] != kFormat)
    throw InputError(file + ": no walk; give one that `plumbline explain --json` wrote");
  if (json.value("schema_version", Json()) != ExplanationRecord::kVersion)
    throw InputError(file + ": of another version of the format; write it again with this plumbline");
  ExplanationRecord r;
  r.driver = p.text("driver"), r.scene = p.text("scene");
  r.image = p.text("image"), r.shape = p.text("shape"), r.bounds = p.text("bounds");
  const Place ray = p.at("ray");
  r.ray = {ray.text("origin"), ray.text("direction"), ray.text("t_max")};
  for (const Place& answer : p.items("answers")) r.answers.emplace_back(answer.text("who"), answer.text("text"));
  const Place walk = p.at("walk");
  r.start = change_of(walk.at("start"));
  for (const Place& step : walk.items("steps")) r.steps.push_back(step_of(step));
  r.total_steps = walk.id("total_steps");
  r.driver_agrees = walk.flag("driver_agrees");
  return r;
}

std::string_view explanation_schema() { return asset("explanation.schema.json"); }

}  // namespace plumbline
