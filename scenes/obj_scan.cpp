// SPDX-License-Identifier: MIT
#include "scenes/obj_scan.h"

#include <algorithm>
#include <array>
#include <map>

#include "scenes/error.h"

namespace plumbline {
namespace {

// Statements that say nothing about which surface is where.
constexpr std::array<std::string_view, 10> kHarmless = {"g",     "o",        "s",        "mg",         "lod",
                                                        "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// An index as it stands in a face, to be checked against the final number of its kind: OBJ files may name vertices
/// that follow.
struct Pending {
  long long index;
  std::size_t kind, line;
};

class Scanner {
 public:
  Scanner(const std::string& file, ObjScan& scan) : file_(file), scan_(scan) {}

  void line(const TextLine& line) {
    const std::string_view text = trimmed(line.text);
    if (text.empty() || text[0] == '#') return;
    check_text(file_, line);
    number_ = line.number;
    split(text);
    const std::string_view keyword = words_[0];
    if (keyword == "v") {
      coordinates({3, 4, 6, 7}, "v (vertex) takes 3 numbers, or 4, or 6 to 7 with a colour");
      ++counts_[0];
      if (words_.size() > 4) extra_.add(number_);
    } else if (keyword == "vt") {
      coordinates({1, 2, 3}, "vt (texture coordinate) takes 1 to 3 numbers");
      ++counts_[1];
    } else if (keyword == "vn") {
      coordinates({3}, "vn (normal) takes 3 numbers");
      ++counts_[2];
    } else if (keyword == "f") {
      face();
    } else if (keyword == "usemtl") {
      if (words_.size() < 2) no_name_.add(number_);
      // tinyobjloader tells of the statement where a blank follows, and only there.
      if (words_.size() >= 2) scan_.usemtl_lines.push_back(number_);
    } else if (keyword == "mtllib") {
      if (words_.size() < 2) no_name_.add(number_);
      if (words_.size() >= 2) scan_.libraries.push_back({std::string(trimmed(text.substr(keyword.size()))), number_});
    } else if (std::find(kHarmless.begin(), kHarmless.end(), keyword) == kHarmless.end()) {
      left_out_[shown(keyword)].add(number_);
    }
  }

  void finish() {
    for (const auto& [index, kind, line] : pending_) {
      if (index > counts_[kind]) out_of_range(index, kind, line);
    }
    extra_.report(scan_.warnings, file_, "a vertex has a weight or a colour: it is not used");
    no_corner_.report(scan_.warnings, file_, "a face without corners is left out");
    no_name_.report(scan_.warnings, file_, "a usemtl or mtllib statement without a name is left out");
    // Junk has a new keyword in each line: those that come first speak for the others.
    constexpr std::size_t kMost = 10;
    std::vector<std::pair<std::string, WarningTally>> sorted(left_out_.begin(), left_out_.end());
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.second.first_line < b.second.first_line; });
    for (std::size_t i = 0; i < std::min(kMost, sorted.size()); ++i) {
      sorted[i].second.report(scan_.warnings, file_, "statements " + sorted[i].first + " are not read");
    }
    if (sorted.size() > kMost) {
      scan_.warnings.push_back(file_ + ": " + std::to_string(sorted.size() - kMost) +
                               " other kinds of statements are not read");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, number_, message); }

  /// split_words, into a buffer that is kept.
  void split(std::string_view text) {
    words_.clear();
    for (std::size_t i = 0; i < text.size();) {
      const std::size_t end = std::min(text.find_first_of(" \t", i), text.size());
      words_.push_back(text.substr(i, end - i));
      i = std::min(text.find_first_not_of(" \t", end), text.size());
    }
  }

  void coordinates(std::initializer_list<std::size_t> allowed, const char* rule) const {
    const std::size_t count = words_.size() - 1;
    if (std::find(allowed.begin(), allowed.end(), count) == allowed.end()) {
      fail(std::string(rule) + "; here are " + std::to_string(count));
    }
    for (std::size_t i = 1; i < words_.size(); ++i) {
      if (!parse_float(words_[i])) fail("expected a finite number, found " + shown(words_[i]));
    }
  }

  void face() {
    if (words_.size() < 2) {
      no_corner_.add(number_);
      return;
    }
    for (std::size_t i = 1; i < words_.size(); ++i) corner(words_[i]);
    scan_.face_lines.push_back(number_);
  }

  /// v, v/vt, v//vn or v/vt/vn; an index left out after a slash counts as none.
  void corner(std::string_view word) {
    std::string_view rest = word;
    for (std::size_t kind = 0; kind < 3; ++kind) {
      const std::size_t slash = rest.find('/');
      const std::string_view digits = rest.substr(0, slash);
      if (!digits.empty()) {
        check(digits, kind, word);
      } else if (kind == 0) {
        fail("expected a vertex index, found " + shown(word));
      }
      if (slash == rest.npos) return;
      rest.remove_prefix(slash + 1);
    }
    fail("expected at most three indices, found " + shown(word));
  }

  void check(std::string_view digits, std::size_t kind, std::string_view word) {
    const auto index = parse_integer(digits);
    if (!index) fail("expected indices apart by slashes, found " + shown(word));
    if (*index == 0) fail("the index 0 in " + shown(word) + ": OBJ counts from 1");
    if (*index < -counts_[kind]) out_of_range(*index, kind, number_);
    if (*index > counts_[kind]) pending_.push_back({*index, kind, number_});
  }

  [[noreturn]] void out_of_range(long long index, std::size_t kind, std::size_t line) const {
    constexpr std::array<std::string_view, 3> kKinds = {"vertices", "texture coordinates", "normals"};
    throw InputError(file_, line,
                     "the index " + std::to_string(index) + " is out of range: there are " +
                         std::to_string(counts_[kind]) + " " + std::string(kKinds[kind]) +
                         (index < 0 ? " so far" : ""));
  }

  const std::string& file_;
  ObjScan& scan_;
  std::size_t number_ = 0;
  std::vector<std::string_view> words_;
  std::array<long long, 3> counts_{};  // vertices, texture coordinates, normals
  std::vector<Pending> pending_;
  WarningTally extra_, no_corner_, no_name_;
  std::map<std::string, WarningTally> left_out_;
};

}  // namespace

void check_text(const std::string& file, const TextLine& line) {
  for (const char c : line.text) {
    const auto code = static_cast<unsigned char>(c);
    if ((code < ' ' && c != '\t') || code == 0x7f) {
      throw InputError(file, line.number,
                       "a control character (code " + std::to_string(code) + "): this is not a text file");
    }
  }
}

ObjScan scan_obj(const std::string& file, const std::vector<TextLine>& lines) {
  ObjScan scan;
  Scanner scanner(file, scan);
  for (const TextLine& line : lines) scanner.line(line);
  scanner.finish();
  return scan;
}

}  // namespace plumbline
