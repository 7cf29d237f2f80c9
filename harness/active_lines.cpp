// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/active_lines.h"

#include <cctype>
#include <string_view>

#include "scenes/error.h"

namespace plumbline {
namespace {

using Macros = std::map<std::string, std::string, std::less<>>;

/// The value of a condition, by recursive descent: or, and, comparison, not.
class Condition {
 public:
  Condition(std::string_view text, const Macros& macros) : text_(text), macros_(macros) {}

  bool holds() {
    const bool value = either() != 0;
    blanks();
    if (at_ < text_.size()) refuse();
    return value;
  }

 private:
  [[noreturn]] void refuse() const {
    throw InputError("this condition of a shader is none that Plumbline reads: " + std::string(text_));
  }
  void blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (text_.substr(at_, 2) == "//") at_ = text_.size();
  }
  bool take(std::string_view sign) {
    blanks();
    if (text_.substr(at_, sign.size()) != sign) return false;
    at_ += sign.size();
    return true;
  }
  std::string word() {
    blanks();
    const std::size_t start = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
    if (at_ == start) refuse();
    return std::string(text_.substr(start, at_ - start));
  }
  long either() {
    long value = both();
    while (take("||")) {
      const long other = both();
      value = value != 0 || other != 0;
    }
    return value;
  }
  long both() {
    long value = compared();
    while (take("&&")) {
      const long other = compared();
      value = value != 0 && other != 0;
    }
    return value;
  }
  long compared() {
    const long value = single();
    if (take("==")) return value == single();
    if (take("!=")) return value != single();
    if (take("<=")) return value <= single();
    if (take(">=")) return value >= single();
    if (take("<")) return value < single();
    if (take(">")) return value > single();
    return value;
  }
  long single() {
    if (take("!")) return single() == 0;
    if (take("(")) {
      const long value = either();
      if (!take(")")) refuse();
      return value;
    }
    const std::string name = word();
    if (name == "defined") {
      const bool has_bracket = take("(");
      const bool is_defined = macros_.contains(word());
      if (has_bracket && !take(")")) refuse();
      return is_defined;
    }
    const auto macro = macros_.find(name);
    const std::string& number = macro == macros_.end() ? name : macro->second;
    if (std::isdigit(static_cast<unsigned char>(number[0])) == 0) return 0;  // as preprocessors have it
    return std::stol(number);
  }

  std::string_view text_;
  const Macros& macros_;
  std::size_t at_ = 0;
};

/// Takes the first word off a line.
std::string_view first_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  std::size_t end = 0;
  while (end < line.size() && (std::isalnum(static_cast<unsigned char>(line[end])) || line[end] == '_')) ++end;
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

/// One #if that is open: whether its text is compiled, and whether a branch of it has been.
struct Branch {
  bool is_on = false, was_on = false;
};

}  // namespace

ActiveLines active_lines(const ShaderText& shader) {
  ActiveLines lines;
  Macros macros;
  std::vector<Branch> open;
  std::vector<bool>* into = nullptr;
  std::size_t file = 0;
  for (std::size_t at = 0; at < shader.text.size();) {
    if (file < shader.starts.size() && at >= shader.starts[file]) into = &lines[shader.files[file++]];
    const std::size_t end = std::min(shader.text.find('\n', at), shader.text.size());
    std::string_view line = std::string_view(shader.text).substr(at, end - at);
    at = end + 1;
    const auto outer = [&] {  // of the #if at hand
      for (std::size_t i = 0; i + 1 < open.size(); ++i)
        if (!open[i].is_on) return false;
      return true;
    };
    const bool is_on = outer() && (open.empty() || open.back().is_on);
    if (into) into->push_back(is_on);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (!line.starts_with('#')) continue;
    line.remove_prefix(1);
    const std::string_view what = first_word(line);
    if (what == "ifdef" || what == "ifndef") {
      const bool holds = macros.contains(first_word(line)) == (what == "ifdef");
      open.push_back({holds, holds});
    } else if (what == "if") {
      const bool holds = is_on && Condition(line, macros).holds();
      open.push_back({holds, holds});
    } else if (what == "elif" || what == "else") {
      if (open.empty()) throw InputError("an #" + std::string(what) + " of a shader belongs to no #if");
      Branch& branch = open.back();
      branch.is_on = !branch.was_on && (what == "else" || (outer() && Condition(line, macros).holds()));
      branch.was_on = branch.was_on || branch.is_on;
    } else if (what == "endif") {
      if (open.empty()) throw InputError("an #endif of a shader belongs to no #if");
      open.pop_back();
    } else if (what == "define" && is_on) {
      const std::string name(first_word(line));
      line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
      macros[name] = line.empty() ? "1" : std::string(line);
    }
    // A directive that ends a branch or begins one is itself compiled where what is around it is.
  }
  return lines;
}

bool is_active(const ActiveLines& lines, const std::string& file, int line) {
  const auto found = lines.find(file);
  return found != lines.end() && line >= 1 && static_cast<std::size_t>(line) <= found->second.size() &&
         found->second[static_cast<std::size_t>(line) - 1];
}

}  // namespace plumbline
