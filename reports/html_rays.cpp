// SPDX-License-Identifier: MIT
// The rays of a run, packed for the page. Rays of one kind differ in their numbers alone, so each is stored as a
// sentence that many share (its numbers cut out) and the numbers: thousands of rays then fit into a page that opens at
// once.
//
// {"ids": [element id of a case...], "names": [its name...], "texts": [sentence...],
//  "rays": [[case, sentence, "numbers separated by spaces"]...]}
// A sentence is the ray's fields, one a line in the order of kFields; U+0001 stands where a number was cut out, U+0002
// and U+0003 for the ray's origin and direction again.
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "reports/format.h"
#include "reports/html_parts.h"

namespace plumbline::page {
namespace {

/// One line of printable text: the packing's own marks are control characters.
std::string line_of(std::string_view text) {
  std::string line = valid_utf8(text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return line;
}

void replace_first(std::string& text, const std::string& what, char mark) {
  if (what.empty()) return;
  if (const auto at = text.find(what); at != std::string::npos) text.replace(at, what.size(), 1, mark);
}

std::string number_text(double value) { return value == 0.0 || std::isnan(value) ? "" : value_text(value); }

/// The fields of a ray, one a line.
std::string fields_of(const RayRecord& ray) {
  const std::string origin = line_of(ray.origin), direction = line_of(ray.direction);
  std::string replay = line_of(ray.replay);
  replace_first(replay, origin, '\2');
  replace_first(replay, direction, '\3');
  std::string out;
  for (const std::string& field :
       {line_of(ray.verdict), std::to_string(ray.index), origin, direction, line_of(ray.t_max), line_of(ray.tracer),
        line_of(ray.reference), line_of(ray.exact), line_of(ray.reason), number_text(ray.margin),
        number_text(ray.bound), replay, line_of(ray.layer)})
    out += field + "\n";
  return out + address_of(line_of(ray.explanation));
}

/// Cuts every word that has a digit out of `text` into `numbers`.
std::string cut_numbers(std::string_view text, std::string& numbers) {
  const auto in_word = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '+' ||
           c == '-';
  };
  std::string sentence;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    bool has_digit = false;
    for (; end < text.size() && in_word(text[end]); ++end)
      has_digit = has_digit || (text[end] >= '0' && text[end] <= '9');
    if (end == i) {
      sentence += text[i++];
      continue;
    }
    if (has_digit) {
      std::string word(text.substr(i, end - i));
      const std::size_t sign = word[0] == '-' ? 1 : 0;
      const bool is_hex = word.compare(sign, 4, "0x1.") == 0 && word.size() > sign + 4;
      if (is_hex) word.erase(sign, 4);
      numbers += (numbers.empty() ? "" : " ") + word;
      sentence += is_hex ? '\4' : '\1';
    } else {
      sentence += text.substr(i, end - i);
    }
    i = end;
  }
  return sentence;
}

}  // namespace

std::string inside_script(std::string_view json) {
  // "</script" and "<!--" must not appear inside a script element; in JSON a '<' only occurs within strings.
  std::string safe;
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string packed_rays(const RunRecord& run, const std::vector<std::string>& ids) {
  nlohmann::ordered_json case_ids = nlohmann::ordered_json::array(), names = case_ids, texts = case_ids,
                         rays = case_ids;
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    if (run.cases[i].worst.empty()) continue;
    const std::size_t number = case_ids.size();
    case_ids.push_back(ids[i]);
    names.push_back(valid_utf8(run.cases[i].name));
    for (const RayRecord& ray : run.cases[i].worst) {
      std::string numbers;
      const std::string sentence = cut_numbers(fields_of(ray), numbers);
      const auto [found, is_new] = known.emplace(sentence, texts.size());
      if (is_new) texts.push_back(sentence);
      rays.push_back({number, found->second, numbers});
    }
  }
  const std::string json =
      nlohmann::ordered_json{{"ids", case_ids}, {"names", names}, {"texts", texts}, {"rays", rays}}.dump();
  return inside_script(json);
}

}  // namespace plumbline::page
