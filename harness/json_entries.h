// SPDX-License-Identifier: GPL-3.0-or-later
// Lists that people keep by hand: a JSON array of objects whose values are text or whole numbers.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace plumbline {

struct JsonEntry {
  std::string place;  ///< "FILE: entry 3", for errors
  std::map<std::string, std::string> texts;
  std::map<std::string, int> numbers;

  /// Empty, or 0, for a key that is not there. Throws InputError where the key has the other kind of value.
  std::string text(const std::string& key) const;
  int number(const std::string& key) const;
  /// Throws InputError: the place, and why.
  [[noreturn]] void refuse(const std::string& why) const;
};

/// Throws InputError for a file that cannot be read or is no such list, and for keys that are none of `keys`.
std::vector<JsonEntry> read_json_entries(const std::filesystem::path& file, const std::vector<std::string>& keys);

}  // namespace plumbline
