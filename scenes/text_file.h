// SPDX-License-Identifier: MIT
// A text file as a whole in memory, and its numbers, read with errors that name file and line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

/// One line: without its end, and its number from 1. Lines end with LF, CR LF or CR.
struct TextLine {
  std::string_view text;
  std::size_t number = 1;
};

/// The whole file, of any bytes. Throws InputError for what is missing, a folder, not a plain file, unreadable or
/// empty.
std::string read_file(const std::filesystem::path& path);

/// The whole file. Throws InputError for what is missing, a folder, not a plain file, unreadable, empty, or no text (a
/// NUL byte), with the line where there is one.
std::string read_text_file(const std::filesystem::path& path);

/// The lines of a text. A backslash at the end of a line joins it with the next, where `join` is set: both become
/// spaces in `text`, and the line keeps its first number.
std::vector<TextLine> split_lines(std::string& text, bool join);

/// The words of a line, apart by blanks and tabs.
std::vector<std::string_view> split_words(std::string_view line);

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// A decimal number that a float can hold: nullopt for anything else, "nan" and "inf" and 1e39 included. Too small is
/// 0.
std::optional<float> parse_float(std::string_view word);
/// A whole number of at most 64 bits.
std::optional<long long> parse_integer(std::string_view word);

/// A word for a message: quoted, at most `most` characters, without control characters.
std::string shown(std::string_view word, std::size_t most = 32);

/// Counts what befell a file many times, to say it once: "file:12: MESSAGE (7 in all)".
struct WarningTally {
  std::size_t count = 0, first_line = 0;
  void add(std::size_t line) {
    if (count++ == 0) first_line = line;
  }
  void report(std::vector<std::string>& warnings, const std::string& file, const std::string& message) const;
};

}  // namespace plumbline
