// SPDX-License-Identifier: MIT
#include "scenes/text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "scenes/error.h"

namespace plumbline {

std::string read_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) throw InputError(name + ": no such file; check the path");
  if (std::filesystem::is_directory(status)) throw InputError(name + ": this is a folder; name a file in it");
  if (!std::filesystem::is_regular_file(status)) throw InputError(name + ": not a plain file; copy it to one");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(name + ": cannot be opened; check its permissions");
  std::string text;
  text.resize(std::filesystem::file_size(path));
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file || static_cast<std::size_t>(file.gcount()) != text.size())
    throw InputError(name + ": cannot be read to its end");
  if (text.empty()) throw InputError(name, 1, "the file is empty");
  return text;
}

std::string read_text_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::string text = read_file(path);
  const std::size_t nul = text.find('\0');
  if (nul != std::string::npos) {
    std::string before = text.substr(0, nul) + " ";
    throw InputError(name, split_lines(before, false).back().number, "a NUL byte: this is not a text file");
  }
  return text;
}

std::vector<TextLine> split_lines(std::string& text, bool join) {
  std::vector<TextLine> lines;
  std::size_t start = 0, number = 1, first_number = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\n' && text[i] != '\r') continue;
    const std::size_t end = i;
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') ++i;
    ++number;
    const bool is_comment = trimmed(std::string_view(text).substr(start, end - start)).starts_with('#');
    if (join && end > start && text[end - 1] == '\\' && !is_comment) {
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(end) - 1, text.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                ' ');
      continue;
    }
    lines.push_back({std::string_view(text).substr(start, end - start), first_number});
    start = i + 1;
    first_number = number;
  }
  if (start < text.size()) lines.push_back({std::string_view(text).substr(start), first_number});
  return lines;
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = line.find_first_not_of(" \t"); i != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", i), line.size());
    words.push_back(line.substr(i, end - i));
    i = line.find_first_not_of(" \t", end);
  }
  return words;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<float> parse_float(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  float value = 0.0f;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say on which side: only a negative exponent or a leading zero makes a number too small.
    const std::string_view digits = word.substr(word.starts_with('-') ? 1 : 0);
    const bool small =
        word.find("e-") != word.npos || word.find("E-") != word.npos || digits[0] == '0' || digits[0] == '.';
    return small ? std::optional<float>(0.0f) : std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long long> parse_integer(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc()) return std::nullopt;
  return value;
}

std::string shown(std::string_view word, std::size_t most) {
  std::string text = "'";
  for (const char c : word.substr(0, most)) text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (word.size() > most ? "...'" : "'");
}

void WarningTally::report(std::vector<std::string>& warnings, const std::string& file,
                          const std::string& message) const {
  if (count == 0) return;
  std::string text = file + ":" + std::to_string(first_line) + ": " + message;
  if (count > 1) text += " (" + std::to_string(count) + " in all)";
  warnings.push_back(text);
}

}  // namespace plumbline
