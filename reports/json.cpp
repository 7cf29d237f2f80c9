// SPDX-License-Identifier: MIT
// See json.h.
#include "reports/json.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "reports/assets.h"
#include "reports/files.h"
#include "reports/sha256.h"
#include "reports/summary.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "plumbline results";
constexpr std::string_view kJournalFormat = "plumbline journal";

// ---- Writing ----

Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json to_json(const VerdictCounts& counts) {
  Json out = Json::object();
  for (const std::string& name : verdicts_in_order(counts)) out[name] = counts.at(name);
  return out;
}

Json to_json(const RayRecord& ray) {
  Json out = {{"verdict", ray.verdict},       {"index", ray.index},         {"origin", ray.origin},
              {"direction", ray.direction},   {"t_max", ray.t_max},         {"tracer", ray.tracer},
              {"reference", ray.reference},   {"exact", ray.exact},         {"reason", ray.reason},
              {"margin", number(ray.margin)}, {"bound", number(ray.bound)}, {"replay", ray.replay}};
  if (!ray.layer.empty()) out["layer"] = ray.layer;
  if (!ray.explanation.empty()) out["explanation"] = ray.explanation;
  return out;
}

Json to_json(const PictureRecord& picture) {
  Json out = {{"path", picture.path},   {"title", picture.title},   {"caption", picture.caption},
              {"width", picture.width}, {"height", picture.height}, {"explain", picture.explain}};
  if (!picture.values.empty()) out["values"] = picture.values;
  if (!picture.scale.colors.empty())
    out["scale"] = {{"low", number(picture.scale.low)},
                    {"high", number(picture.scale.high)},
                    {"unit", picture.scale.unit},
                    {"colors", picture.scale.colors}};
  if (!picture.legend.empty()) {
    Json& entries = out["legend"] = Json::array();
    for (const LegendEntry& entry : picture.legend)
      entries.push_back({{"label", entry.label}, {"color", entry.color}, {"pixels", entry.pixels}});
  }
  return out;
}

Json to_json(const Figure& figure) {
  Json out = {{"name", figure.name}, {"unit", figure.unit}, {"value", number(figure.value)}};
  if (figure.rounds > 0) {
    out["low"] = number(figure.low);
    out["high"] = number(figure.high);
    out["rounds"] = figure.rounds;
  }
  return out;
}

Json to_json(const TableRecord& table) {
  return {{"title", table.title}, {"columns", table.columns}, {"rows", table.rows}};
}

Json to_json(const DriverFinding& finding) {
  return {{"name", finding.name}, {"found", finding.found}, {"detail", finding.detail}};
}

Json to_json(const CaseRecord& record);

template <typename Record>
Json list(const std::vector<Record>& records) {
  Json out = Json::array();
  for (const Record& record : records) out.push_back(to_json(record));
  return out;
}

Json to_json(const CaseRecord& record) {
  Json out = {{"name", record.name},
              {"feature", record.feature},
              {"scene", record.scene},
              {"family", record.family},
              {"proves", record.proves},
              {"paper", record.paper},
              {"status", status_name(outcome(record))},
              {"message", record.message},
              {"seed", std::to_string(record.seed)},
              {"rays", record.rays},
              {"verdicts", to_json(record.verdicts)},
              {"seconds", number(record.seconds)},
              {"trace_seconds", number(record.trace_seconds)},
              {"max_margin_ratio", number(record.max_margin_ratio)},
              {"replay", record.replay},
              {"worst", list(record.worst)},
              {"pictures", list(record.pictures)},
              {"figures", list(record.figures)}};
  if (!record.tables.empty()) out["tables"] = list(record.tables);
  return out;
}

Json header_to_json(const RunRecord& run, std::string_view format) {
  Json out = {{"format", format},
              {"schema_version", RunRecord::kSchemaVersion},
              {"version", run.version},
              {"commit", run.commit},
              {"command", run.command},
              {"seed", std::to_string(run.seed)},
              {"started", run.started},
              {"seconds", number(run.seconds)},
              {"machine", run.machine},
              {"libraries", run.libraries},
              {"driver",
               {{"renderer", run.driver_renderer}, {"version", run.driver_version}, {"findings", list(run.findings)}}},
              {"planned_cases", run.planned_cases}};
  if (run.shard.of > 0)
    out["shard"] = {{"number", run.shard.number},
                    {"of", run.shard.of},
                    {"whole_cases", run.shard.whole_cases},
                    {"whole", run.shard.whole}};
  return out;
}

// ---- The digest: the last key, over the text as it is without it ----

constexpr std::string_view kDigestKey = ",\n \"digest\": \"sha256:";
constexpr std::string_view kDigestEnd = "\"\n}\n", kTextEnd = "\n}\n";

std::string with_digest(std::string text) {
  const std::string digest = sha256(text);
  text.resize(text.size() - kTextEnd.size());
  return text.append(kDigestKey).append(digest).append(kDigestEnd);
}

/// Whether the digest that `text` ends with is that of the rest.
bool digest_holds(std::string_view text) {
  const std::size_t at = text.rfind(kDigestKey);
  return at != std::string_view::npos && with_digest(std::string(text.substr(0, at)).append(kTextEnd)) == text;
}

std::string text_of(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// ---- Reading ----

/// A value and the way to it, so that an error names the place: "results.json: cases[3].rays: ...".
struct Node {
  const Json& json;
  const std::string& place;  ///< file, or file:line
  std::string path;

  [[noreturn]] void refuse(const std::string& expected) const {
    throw InputError(place + ": " + (path.empty() ? "the whole" : path) + ": expected " + expected +
                     "; this file was not written by this version of plumbline, or was changed; run again");
  }
  Node operator[](const char* key) const {
    if (!json.is_object()) refuse("an object");
    const auto found = json.find(key);
    std::string inner = path.empty() ? std::string(key) : path + "." + key;
    if (found == json.end()) Node{json, place, inner}.refuse("this key");
    return {*found, place, std::move(inner)};
  }
  bool has(const char* key) const { return json.is_object() && json.contains(key); }
  std::vector<Node> items() const {
    if (!json.is_array()) refuse("a list");
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < json.size(); ++i)
      nodes.push_back({json[i], place, path + "[" + std::to_string(i) + "]"});
    return nodes;
  }
  std::string text() const {
    if (!json.is_string()) refuse("text");
    return json.get<std::string>();
  }
  bool boolean() const {
    if (!json.is_boolean()) refuse("true or false");
    return json.get<bool>();
  }
  std::uint64_t count() const {
    if (!json.is_number_unsigned()) refuse("a whole number of at least 0");
    return json.get<std::uint64_t>();
  }
  int small_count() const {
    const std::uint64_t value = count();
    if (value > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) refuse("a whole number below 2^31");
    return static_cast<int>(value);
  }
  double real() const {
    if (json.is_number()) return json.get<double>();
    if (json == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (json == "inf") return std::numeric_limits<double>::infinity();
    if (json == "-inf") return -std::numeric_limits<double>::infinity();
    refuse("a number, or \"nan\", \"inf\", \"-inf\"");
  }
  std::uint64_t seed() const {
    const std::string digits = text();
    std::uint64_t value = 0;
    bool fits = !digits.empty();
    for (const char c : digits) {
      const auto digit = static_cast<std::uint64_t>(c - '0');
      fits = fits && c >= '0' && c <= '9' && value <= (std::numeric_limits<std::uint64_t>::max() - digit) / 10;
      if (!fits) refuse("a string of decimal digits below 2^64");
      value = value * 10 + digit;
    }
    if (!fits) refuse("a string of decimal digits below 2^64");
    return value;
  }
};

VerdictCounts verdicts_of(const Node& node) {
  if (!node.json.is_object()) node.refuse("an object");
  VerdictCounts counts;
  for (const auto& [name, count] : node.json.items())
    counts[name] = Node{count, node.place, node.path + "." + name}.count();
  return counts;
}

RayRecord ray_of(const Node& node) {
  RayRecord ray;
  ray.verdict = node["verdict"].text();
  ray.index = node["index"].count();
  ray.origin = node["origin"].text();
  ray.direction = node["direction"].text();
  ray.t_max = node["t_max"].text();
  ray.tracer = node["tracer"].text();
  ray.reference = node["reference"].text();
  ray.exact = node["exact"].text();
  ray.reason = node["reason"].text();
  ray.margin = node["margin"].real();
  ray.bound = node["bound"].real();
  ray.replay = node["replay"].text();
  // Runs of before they were there lack them.
  if (node.has("layer")) ray.layer = node["layer"].text();
  if (node.has("explanation")) ray.explanation = node["explanation"].text();
  return ray;
}

PictureRecord picture_of(const Node& node) {
  PictureRecord picture;
  picture.path = node["path"].text();
  picture.title = node["title"].text();
  picture.caption = node["caption"].text();
  picture.width = node["width"].small_count();
  picture.height = node["height"].small_count();
  picture.explain = node["explain"].text();
  if (node.has("values")) picture.values = node["values"].text();
  if (node.has("scale")) {
    const Node scale = node["scale"];
    picture.scale.low = scale["low"].real();
    picture.scale.high = scale["high"].real();
    picture.scale.unit = scale["unit"].text();
    for (const Node& color : scale["colors"].items()) picture.scale.colors.push_back(color.text());
  }
  if (node.has("legend"))
    for (const Node& entry : node["legend"].items())
      picture.legend.push_back({entry["label"].text(), entry["color"].text(), entry["pixels"].count()});
  return picture;
}

Figure figure_of(const Node& node) {
  Figure figure;
  figure.name = node["name"].text();
  figure.unit = node["unit"].text();
  figure.value = node["value"].real();
  if (node.has("rounds")) {
    figure.low = node["low"].real();
    figure.high = node["high"].real();
    figure.rounds = node["rounds"].small_count();
  }
  return figure;
}

TableRecord table_of(const Node& node) {
  TableRecord table;
  table.title = node["title"].text();
  for (const Node& column : node["columns"].items()) table.columns.push_back(column.text());
  for (const Node& row : node["rows"].items()) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const Node& cell : row.items()) cells.push_back(cell.text());
    if (cells.size() != table.columns.size()) row.refuse("a list as long as \"columns\"");
  }
  return table;
}

CaseStatus status_of(const Node& node) {
  const std::string name = node.text();
  for (const CaseStatus status : {CaseStatus::passed, CaseStatus::failed, CaseStatus::error, CaseStatus::skipped})
    if (name == status_name(status)) return status;
  node.refuse("\"passed\", \"failed\", \"error\" or \"skipped\"");
}

CaseRecord case_of(const Node& node) {
  CaseRecord record;
  record.name = node["name"].text();
  record.feature = node["feature"].text();
  record.scene = node["scene"].text();
  record.family = node["family"].text();
  record.proves = node["proves"].text();
  record.paper = node["paper"].text();
  record.status = status_of(node["status"]);
  record.message = node["message"].text();
  record.seed = node["seed"].seed();
  record.rays = node["rays"].count();
  record.verdicts = verdicts_of(node["verdicts"]);
  record.seconds = node["seconds"].real();
  record.trace_seconds = node["trace_seconds"].real();
  record.max_margin_ratio = node["max_margin_ratio"].real();
  record.replay = node["replay"].text();
  for (const Node& ray : node["worst"].items()) record.worst.push_back(ray_of(ray));
  for (const Node& picture : node["pictures"].items()) record.pictures.push_back(picture_of(picture));
  for (const Node& figure : node["figures"].items()) record.figures.push_back(figure_of(figure));
  if (node.has("tables"))
    for (const Node& table : node["tables"].items()) record.tables.push_back(table_of(table));
  return record;
}

RunRecord header_of(const Node& node, std::string_view format) {
  if (!node.has("format") || !node.json["format"].is_string() || node.json["format"] != std::string(format))
    throw InputError(node.place + ": this is no file of plumbline's (its \"format\" is not \"" + std::string(format) +
                     "\"); give the folder that a run wrote");
  const std::uint64_t schema = node["schema_version"].count();
  if (schema != RunRecord::kSchemaVersion)
    throw InputError(node.place + ": has schema version " + std::to_string(schema) + ", this plumbline reads version " +
                     std::to_string(RunRecord::kSchemaVersion) +
                     "; use the plumbline that wrote it (\"version\" in the file), or run again");
  RunRecord run;
  run.version = node["version"].text();
  run.commit = node["commit"].text();
  run.command = node["command"].text();
  run.seed = node["seed"].seed();
  run.started = node["started"].text();
  run.seconds = node["seconds"].real();
  run.machine = node["machine"].text();
  const Node libraries = node["libraries"];
  if (!libraries.json.is_object()) libraries.refuse("an object");
  for (const auto& [name, version] : libraries.json.items())
    run.libraries[name] = Node{version, node.place, "libraries." + name}.text();
  const Node driver = node["driver"];
  run.driver_renderer = driver["renderer"].text();
  run.driver_version = driver["version"].text();
  for (const Node& finding : driver["findings"].items())
    run.findings.push_back({finding["name"].text(), finding["found"].boolean(), finding["detail"].text()});
  run.planned_cases = node["planned_cases"].count();
  if (node.has("shard")) {
    const Node shard = node["shard"];
    run.shard = {shard["number"].small_count(), shard["of"].small_count(), shard["whole_cases"].count(),
                 shard["whole"].text()};
  }
  return run;
}

Json parsed(std::string_view text, const std::string& place) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(place + ": not JSON from byte " + std::to_string(error.byte) +
                     " on; the file is truncated or not ours; run again, or use `run --resume`");
  }
}

}  // namespace

std::string run_to_json(const RunRecord& run) {
  const RunSummary total = summarize(run);
  Json out = header_to_json(run, kFormat);
  out["summary"] = {{"cases", total.cases},
                    {"passed", total.passed},
                    {"failed", total.failed},
                    {"errors", total.errors},
                    {"skipped", total.skipped},
                    {"unfinished", total.unfinished},
                    {"ok", total.ok()},
                    {"rays", total.rays},
                    {"without_verdict", total.without_verdict},
                    {"verdicts", to_json(total.verdicts)}};
  out["cases"] = list(run.cases);
  return with_digest(text_of(out, 1) + "\n");
}

RunRecord run_from_json(std::string_view text, const std::string& file) {
  const Json json = parsed(text, file);
  const Node node{json, file, ""};
  RunRecord run = header_of(node, kFormat);
  for (const Node& record : node["cases"].items()) run.cases.push_back(case_of(record));
  // Runs of before it was there have none.
  if (node.has("digest") && !digest_holds(text))
    throw InputError(file +
                     ": was changed since it was written: its digest does not hold; take the file that the run " +
                     "wrote, or run again");
  return run;
}

bool has_digest(std::string_view text) { return text.rfind(kDigestKey) != std::string_view::npos; }

std::string run_header_to_json(const RunRecord& run) { return text_of(header_to_json(run, kJournalFormat), -1); }

RunRecord run_header_from_json(std::string_view line, const std::string& file, std::size_t line_number) {
  const std::string place = file + ":" + std::to_string(line_number);
  const Json json = parsed(line, place);
  return header_of({json, place, ""}, kJournalFormat);
}

std::string case_to_json(const CaseRecord& record) { return text_of(to_json(record), -1); }

CaseRecord case_from_json(std::string_view line, const std::string& file, std::size_t line_number) {
  const std::string place = file + ":" + std::to_string(line_number);
  const Json json = parsed(line, place);
  return case_of({json, place, ""});
}

void write_results(const RunRecord& run, const std::filesystem::path& file) { write_text(file, run_to_json(run)); }

RunRecord read_results(const std::filesystem::path& file) { return run_from_json(read_text(file), file.string()); }

std::string_view results_schema() { return asset("results.schema.json"); }

}  // namespace plumbline
