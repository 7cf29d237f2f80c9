// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/mutants.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <map>

#include "tracer/embedded_shaders.h"

namespace plumbline {
namespace {

enum class Kind { name, number, sign };

struct Token {
  Kind kind = Kind::sign;
  std::size_t at = 0;
  std::string text;
};

bool is_name_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The operators of more than one character, longest first.
constexpr std::array<std::string_view, 23> kLongSigns{
    "<<=", ">>=", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "^^", "++",
    "--",  "+=",  "-=", "*=", "/=", "%=", "&=", "|=", "^=", "##", "//"};

/// Cuts a text into what mutates: names, numbers and operators.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<Token> tokens() {
    while (at_ < text_.size()) step();
    return std::move(tokens_);
  }

 private:
  void step() {
    const char c = text_[at_];
    if (c == '\n') is_line_start_ = true;
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++at_;
    } else if (text_.substr(at_, 2) == "//") {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (text_.substr(at_, 2) == "/*") {
      const std::size_t end = text_.find("*/", at_);
      at_ = end == std::string_view::npos ? text_.size() : end + 2;
    } else if (c == '#' && is_line_start_) {
      directive();
    } else {
      is_line_start_ = false;
      token();
    }
  }

  /// Of a macro the text is left for what follows; every other directive is passed over, and with #ifdef of an
  /// instrument all up to its #else or #endif.
  void directive() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::size_t at = at_ + 1;
    const std::string_view line = text_.substr(at_, end - at_);
    if (watched_ > 0) {
      watched_ += line.starts_with("#if") ? 1 : 0;
      watched_ -= line.starts_with("#endif") || (watched_ == 1 && line.starts_with("#else")) ? 1 : 0;
      at_ = end;
      return;
    }
    if (line == "#ifdef CAPTURE" || line == "#ifdef COUNT_VISITS") watched_ = 1;
    const auto blanks = [&] {
      while (at < end && (text_[at] == ' ' || text_[at] == '\t')) ++at;
    };
    blanks();
    if (text_.substr(at, 6) != "define") {
      at_ = end;
      return;
    }
    at += 6;
    blanks();
    while (at < end && is_name_part(text_[at])) ++at;
    if (at < end && text_[at] == '(') at = std::min(text_.find(')', at), end - 1) + 1;
    at_ = at;
    is_line_start_ = false;
  }

  void token() {
    const std::size_t start = at_;
    const char c = text_[at_];
    Kind kind = Kind::sign;
    if (is_name_start(c)) {
      kind = Kind::name;
      while (at_ < text_.size() && is_name_part(text_[at_])) ++at_;
    } else if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) {
      kind = Kind::number;
      // A sign belongs to a number behind the e of its exponent, and only there.
      const bool is_hex = text_.substr(at_, 2) == "0x";
      while (at_ < text_.size() && (is_name_part(text_[at_]) || text_[at_] == '.' ||
                                    (!is_hex && (text_[at_] == '-' || text_[at_] == '+') &&
                                     (text_[at_ - 1] == 'e' || text_[at_ - 1] == 'E'))))
        ++at_;
    } else {
      const auto* const sign = std::find_if(kLongSigns.begin(), kLongSigns.end(),
                                            [&](std::string_view s) { return text_.substr(at_, s.size()) == s; });
      at_ += sign == kLongSigns.end() ? 1 : sign->size();
    }
    if (watched_ == 0) tokens_.push_back({kind, start, std::string(text_.substr(start, at_ - start))});
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool is_line_start_ = true;
  int watched_ = 0;  ///< how many #if are open within that of an instrument, itself included
  std::vector<Token> tokens_;
};

/// What an operator becomes where it stands between two operands.
const std::map<std::string, std::pair<MutationRule, std::vector<std::string>>>& binary_changes() {
  using R = MutationRule;
  static const std::map<std::string, std::pair<MutationRule, std::vector<std::string>>> kChanges{
      {"<", {R::relational, {"<=", ">"}}}, {"<=", {R::relational, {"<"}}},  {">", {R::relational, {">=", "<"}}},
      {">=", {R::relational, {">"}}},      {"==", {R::relational, {"!="}}}, {"!=", {R::relational, {"=="}}},
      {"&&", {R::logical, {"||"}}},        {"||", {R::logical, {"&&"}}},    {"+", {R::arithmetic, {"-"}}},
      {"-", {R::arithmetic, {"+"}}},       {"*", {R::arithmetic, {"/"}}},   {"/", {R::arithmetic, {"*"}}},
      {"%", {R::arithmetic, {"/"}}},       {"++", {R::arithmetic, {"--"}}}, {"--", {R::arithmetic, {"++"}}},
      {"+=", {R::arithmetic, {"-="}}},     {"-=", {R::arithmetic, {"+="}}}, {"*=", {R::arithmetic, {"/="}}},
      {"/=", {R::arithmetic, {"*="}}},     {">>", {R::bitwise, {"<<"}}},    {"<<", {R::bitwise, {">>"}}},
      {"&", {R::bitwise, {"|"}}},          {"|", {R::bitwise, {"&"}}},      {"^", {R::bitwise, {"|"}}},
      {"&=", {R::bitwise, {"|="}}},        {"|=", {R::bitwise, {"&="}}},    {"^=", {R::bitwise, {"|="}}}};
  return kChanges;
}

/// Whether an operator behind this token stands between two operands.
bool ends_operand(const Token* token) {
  if (token == nullptr) return false;
  if (token->kind == Kind::number) return true;
  if (token->kind == Kind::name) return token->text != "return";
  return token->text == ")" || token->text == "]";
}

std::string change_of_number(const std::string& number) {
  const bool is_hex = number.starts_with("0x");
  const bool is_float = !is_hex && number.find_first_of(".eE") != std::string::npos;
  if (is_float) {
    double value = 0.0;
    std::from_chars(number.data(), number.data() + number.size(), value);
    return value == 0.0 ? "1.0" : "(2.0 * " + number + ")";
  }
  const bool is_unsigned = number.back() == 'u';
  std::uint32_t value = 0;
  const char* const end = number.data() + number.size() - (is_unsigned ? 1 : 0);
  std::from_chars(number.data() + (is_hex ? 2 : 0), end, value, is_hex ? 16 : 10);
  ++value;  // of 32 bits, so the largest becomes 0
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), is_hex ? "0x%x" : "%u", value);
  return text.data() + std::string(is_unsigned ? "u" : "");
}

bool is_swizzle(const std::string& name) {
  return name.size() <= 4 && name.find_first_not_of("xyzw") == std::string::npos;
}

/// Its components moved on by one; where all are the same, the next one instead of the first.
std::string change_of_swizzle(const std::string& swizzle) {
  static constexpr std::string_view kNext = "yxyz";  // of x, y, z, w: one that the vector has too
  std::string changed = swizzle.substr(1) + swizzle[0];
  if (changed == swizzle) changed[0] = kNext[std::string_view("xyzw").find(swizzle[0])];
  return changed;
}

}  // namespace

const char* name_of(MutationRule rule) {
  static constexpr std::array<const char*, 6> kNames{"relational", "logical",  "arithmetic",
                                                     "bitwise",    "constant", "swizzle"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::string name_of(const Mutant& m) {
  return m.file + ":" + std::to_string(m.line) + ":" + std::to_string(m.column) + ": " + m.before +
         (m.after.empty() ? " is dropped" : " becomes " + m.after);
}

ShaderPatch patch_of(const Mutant& m) { return {m.file, m.before, m.after, m.at}; }

std::vector<Mutant> mutants_of(std::string_view file, std::string_view text) {
  const std::vector<Token> tokens = Lexer(text).tokens();
  std::vector<Mutant> mutants;
  const auto add = [&](const Token& token, MutationRule rule, std::string after) {
    Mutant m{std::string(file), token.at, 1, 1, rule, token.text, std::move(after), {}};
    const std::size_t line_start = text.rfind('\n', token.at) + 1;  // npos + 1 is 0
    m.line += static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(token.at), '\n'));
    m.column += static_cast<int>(token.at - line_start);
    std::string_view line = text.substr(line_start, std::min(text.find('\n', token.at), text.size()) - line_start);
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    m.line_text = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    mutants.push_back(std::move(m));
  };
  bool in_layout = false;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    const Token* before = i > 0 ? &tokens[i - 1] : nullptr;
    if (token.text == "layout") in_layout = true;
    if (token.text == ")") in_layout = false;
    if (in_layout) continue;
    if (token.kind == Kind::number) {
      add(token, MutationRule::constant, change_of_number(token.text));
    } else if (token.kind == Kind::name) {
      if (before && before->text == "." && is_swizzle(token.text))
        add(token, MutationRule::swizzle, change_of_swizzle(token.text));
      if (token.text == "true" || token.text == "false")
        add(token, MutationRule::constant, token.text == "true" ? "false" : "true");
    } else if (token.text == "!") {
      add(token, MutationRule::logical, "");
    } else if (token.text == "~") {
      add(token, MutationRule::bitwise, "");
    } else if (token.text == "-" && !ends_operand(before)) {
      add(token, MutationRule::arithmetic, "");
    } else if (const auto found = binary_changes().find(token.text); found != binary_changes().end()) {
      for (const std::string& after : found->second.second) add(token, found->second.first, after);
    }
  }
  return mutants;
}

std::optional<std::string> exclusion_of(std::string_view file) {
  if (file.starts_with("driver_") || file.starts_with("ask_"))
    return "asks the driver or a test, and is no part of the tracer";
  if (file.starts_with("header_")) return "tells the dialect, and computes nothing";
  if (file == "brute_force.glsl") return "is what others are judged by: the loop over all primitives";
  if (file.starts_with("capture_") || file == "count_visits.glsl")
    return "watches the walk for explanations, and is in no production program";
  return std::nullopt;
}

std::vector<Mutant> all_mutants() {
  std::vector<Mutant> all;
  for (const EmbeddedShader& shader : embedded_shaders()) {
    if (exclusion_of(shader.name)) continue;
    std::vector<Mutant> own = mutants_of(shader.name, shader.text);
    all.insert(all.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
  }
  return all;
}

std::string feature_of(std::string_view file) {
  static const std::map<std::string_view, const char*> kFeatures{{"transform.glsl", "transforms"},
                                                                 {"change_space.glsl", "transforms"},
                                                                 {"bundle.glsl", "bundles"},
                                                                 {"bundle.frag.glsl", "bundles"},
                                                                 {"bundle_space.glsl", "bundles"},
                                                                 {"spread.frag.glsl", "bundles"},
                                                                 {"camera.frag.glsl", "dof"},
                                                                 {"light.frag.glsl", "shading"},
                                                                 {"scatter.frag.glsl", "glossy"},
                                                                 {"surface.glsl", "shading"},
                                                                 {"add_light.frag.glsl", "shading"},
                                                                 {"channels.frag.glsl", "shading"},
                                                                 {"accumulate.frag.glsl", "aa"},
                                                                 {"random.glsl", "aa"},
                                                                 {"elementary.glsl", "shading"},
                                                                 {"perturbation.glsl", "soft_shadow"},
                                                                 {"item.glsl", "aa"},
                                                                 {"unit.glsl", "shading"},
                                                                 {"count.frag.glsl", "shading"}};
  const auto found = kFeatures.find(file);
  return found == kFeatures.end() ? "hits" : found->second;
}

}  // namespace plumbline
