// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/json_entries.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {

std::string JsonEntry::text(const std::string& key) const {
  if (numbers.contains(key)) refuse("\"" + key + "\" is text");
  const auto found = texts.find(key);
  return found == texts.end() ? std::string() : found->second;
}

int JsonEntry::number(const std::string& key) const {
  if (texts.contains(key)) refuse("\"" + key + "\" is a whole number");
  const auto found = numbers.find(key);
  return found == numbers.end() ? 0 : found->second;
}

void JsonEntry::refuse(const std::string& why) const { throw InputError(place + ": " + why); }

std::vector<JsonEntry> read_json_entries(const std::filesystem::path& file, const std::vector<std::string>& keys) {
  const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
  std::string known;
  for (const std::string& key : keys) known += (known.empty() ? "" : ", ") + key;
  if (!json.is_array()) throw InputError(file.string() + ": expected a JSON array of objects with the keys " + known);
  std::vector<JsonEntry> list;
  for (const auto& object : json) {
    JsonEntry& entry = list.emplace_back();
    entry.place = file.string() + ": entry " + std::to_string(list.size() - 1);
    if (!object.is_object()) entry.refuse("expected an object");
    for (const auto& [key, value] : object.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        entry.refuse("there is no key \"" + key + "\"; keys are " + known);
      if (value.is_string())
        entry.texts[key] = value.get<std::string>();
      else if (value.is_number_integer())
        entry.numbers[key] = value.get<int>();
      else
        entry.refuse("\"" + key + "\" is neither text nor a whole number");
    }
  }
  return list;
}

}  // namespace plumbline
