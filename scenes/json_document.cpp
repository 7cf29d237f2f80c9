// SPDX-License-Identifier: MIT
#include "scenes/json_document.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "scenes/error.h"
#include "scenes/near_words.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

constexpr std::size_t kDeepest = 512;

/// Where the parser has come to in the text.
struct Progress {
  std::size_t read = 0;  ///< characters
};

/// Hands out the characters of a text and counts them.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Progress* progress) : at_(at), progress_(progress) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    ++at_;
    ++progress_->read;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }
  friend bool operator!=(const CountingIterator& a, const CountingIterator& b) { return a.at_ != b.at_; }

 private:
  const char* at_;
  Progress* progress_;
};

/// Builds JsonValues from the parser's events. The lines come from how far the parser has read: to the last character
/// of a token, or one beyond the end of a number, which is still of its line where it is the line's end.
class Builder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  Builder(const std::string& file, std::string_view text, const Progress& progress)
      : file_(file), text_(text), progress_(progress) {}

  bool null() { return add(JsonValue::Kind::null); }
  bool boolean(bool value) {
    add(JsonValue::Kind::boolean);
    last_->boolean = value;
    return true;
  }
  bool number_integer(number_integer_t value) { return number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) { return number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) { return number(value); }
  bool string(string_t& value) {
    add(JsonValue::Kind::string);
    last_->text = std::move(value);
    return true;
  }
  bool binary(binary_t&) { return false; }
  bool start_object(std::size_t) { return open(JsonValue::Kind::object); }
  bool start_array(std::size_t) { return open(JsonValue::Kind::array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(string_t& key) {
    Level& level = open_.back();
    // Many keys are looked up by hash, few by going over them.
    constexpr std::size_t kFew = 16;
    bool is_new = true;
    if (level.value->keys.size() < kFew) {
      is_new = std::find(level.value->keys.begin(), level.value->keys.end(), key) == level.value->keys.end();
    } else {
      if (level.known.empty()) level.known.insert(level.value->keys.begin(), level.value->keys.end());
      is_new = level.known.insert(key).second;
    }
    key_line_ = line();
    if (!is_new) throw InputError(file_, key_line_, "the key " + shown(key) + " stands twice in one object");
    level.value->keys.push_back(std::move(key));
    return true;
  }
  template <class Exception>
  bool parse_error(std::size_t, const std::string&, const Exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ...": ours has the line.
    std::string what = error.what();
    if (const std::size_t start = what.find("syntax error"); start != std::string::npos) {
      what.erase(0, start);
    } else if (const std::size_t bracket = what.find("] "); bracket != std::string::npos) {
      what.erase(0, bracket + 2);
    }
    std::string clean;
    for (const char c : what.substr(0, 300)) clean += (c >= ' ' && c <= '~') ? c : '?';
    throw InputError(file_, line(), "not JSON: " + clean);
  }

  JsonValue root;

 private:
  struct Level {
    JsonValue* value;
    std::unordered_set<std::string> known;
  };

  /// The line of the last character that was read.
  std::size_t line() {
    const std::size_t last = progress_.read > 0 ? std::min(progress_.read, text_.size()) - 1 : 0;
    while (counted_ < last) newlines_ += text_[counted_++] == '\n' ? 1 : 0;
    return newlines_ + 1;
  }

  bool add(JsonValue::Kind kind) {
    if (open_.empty()) {
      last_ = &root;
    } else {
      last_ = &open_.back().value->items.emplace_back();
    }
    last_->kind = kind;
    const bool is_member = !open_.empty() && open_.back().value->kind == JsonValue::Kind::object;
    last_->line = is_member ? key_line_ : line();
    return true;
  }
  bool number(double value) {
    add(JsonValue::Kind::number);
    last_->number = value;
    return true;
  }
  bool open(JsonValue::Kind kind) {
    add(kind);
    if (open_.size() >= kDeepest)
      throw InputError(file_, last_->line, "nested deeper than " + std::to_string(kDeepest) + " levels");
    open_.push_back({last_, {}});
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& file_;
  std::string_view text_;
  const Progress& progress_;
  std::size_t counted_ = 0, newlines_ = 0, key_line_ = 1;
  std::vector<Level> open_;  ///< pointers stay good: only the innermost one's items grow
  JsonValue* last_ = nullptr;
};

}  // namespace

JsonDocument parse_json(const std::string& file, std::string_view text) {
  Progress progress;
  Builder builder(file, text, progress);
  const CountingIterator begin(text.data(), &progress), end(text.data() + text.size(), &progress);
  const bool done = nlohmann::json::sax_parse(begin, end, &builder, nlohmann::json::input_format_t::json, true, true);
  PLUMBLINE_ASSERT(done);
  auto root = std::make_unique<JsonValue>(std::move(builder.root));
  // Now that no array grows any more, everything can point at what is around it.
  std::vector<JsonValue*> waiting{root.get()};
  while (!waiting.empty()) {
    JsonValue* const value = waiting.back();
    waiting.pop_back();
    for (JsonValue& item : value->items) {
      item.around = value;
      if (!item.items.empty()) waiting.push_back(&item);
    }
  }
  return {file, std::move(root)};
}

std::string JsonPlace::path() const {
  const JsonValue* const around = value_->around;
  if (around == nullptr) return {};
  const std::string path = JsonPlace(*file_, *around).path();
  const auto index = static_cast<std::size_t>(value_ - around->items.data());
  if (around->kind == JsonValue::Kind::array) return path + "[" + std::to_string(index) + "]";
  const std::string& key = around->keys[index];
  const bool is_plain = !key.empty() && key.size() <= 64 && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '$';
  });
  if (!is_plain) return path + "[" + shown(key) + "]";
  return path.empty() ? key : path + "." + key;
}

std::string JsonPlace::message(const std::string& message) const {
  const std::string way = path();
  return file() + ":" + std::to_string(line()) + ": " + (way.empty() ? message : way + ": " + message);
}

void JsonPlace::fail(const std::string& message) const {
  const std::string way = path();
  throw InputError(file(), line(), way.empty() ? message : way + ": " + message);
}

void JsonPlace::fail_type(const char* wanted) const {
  static constexpr const char* kNames[] = {"null", "true or false", "a number", "a string", "an array", "an object"};
  fail(std::string("expected ") + wanted + ", found " + kNames[static_cast<std::size_t>(kind())]);
}

void JsonPlace::check_object() const {
  if (!is_object()) fail_type("an object");
}

void JsonPlace::allow(std::initializer_list<std::string_view> keys) const {
  check_object();
  for (std::size_t i = 0; i < size(); ++i) {
    if (std::find(keys.begin(), keys.end(), key(i)) != keys.end()) continue;
    std::string known;
    for (const std::string_view word : keys) known += (known.empty() ? "" : ", ") + std::string(word);
    at(i).fail("unknown key" + did_you_mean(key(i), keys) + "; known are " + known);
  }
}

std::optional<JsonPlace> JsonPlace::find(std::string_view wanted) const {
  if (!is_object()) return std::nullopt;
  for (std::size_t i = 0; i < size(); ++i) {
    if (key(i) == wanted) return at(i);
  }
  return std::nullopt;
}

JsonPlace JsonPlace::need(std::string_view wanted) const {
  check_object();
  const auto found = find(wanted);
  if (!found) fail("the key '" + std::string(wanted) + "' is missing");
  return *found;
}

JsonPlace JsonPlace::at(std::size_t i) const {
  PLUMBLINE_ASSERT(i < size());
  return {*file_, value_->items[i]};
}

void JsonPlace::check_array(std::size_t least, std::size_t most) const {
  if (!is_array()) fail_type("an array");
  if (size() >= least && size() <= most) return;
  const std::string wanted = least == most    ? std::to_string(least)
                             : size() < least ? "at least " + std::to_string(least)
                                              : "at most " + std::to_string(most);
  fail("expected " + wanted + (wanted == "1" || wanted.ends_with(" 1") ? " item" : " items") + ", found " +
       std::to_string(size()));
}

const std::string& JsonPlace::text() const {
  if (!is_string()) fail_type("a string");
  return value_->text;
}

bool JsonPlace::boolean() const {
  if (kind() != JsonValue::Kind::boolean) fail_type("true or false");
  return value_->boolean;
}

double JsonPlace::number() const {
  if (!is_number()) fail_type("a number");
  if (!(std::abs(value_->number) <= static_cast<double>(std::numeric_limits<float>::max())))
    fail("too large for a 32-bit number; scale the scene down");
  return value_->number;
}

namespace {
std::string shortest(double value) {
  const double rounded = std::round(value);
  if (rounded == value && std::abs(value) < 1e15) return std::to_string(static_cast<long long>(value));
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}
}  // namespace

double JsonPlace::number_between(double least, double most) const {
  const double value = number();
  if (!(value >= least && value <= most))
    fail("expected a number from " + shortest(least) + " to " + shortest(most) + ", found " + shortest(value));
  return value;
}

std::uint32_t JsonPlace::integer(std::uint32_t least, std::uint32_t most) const {
  if (!is_number()) fail_type("a whole number");
  const double value = value_->number;
  if (!(value >= least && value <= most && value == std::floor(value)))
    fail("expected a whole number from " + std::to_string(least) + " to " + std::to_string(most) + ", found " +
         shortest(value));
  return static_cast<std::uint32_t>(value);
}

glm::dvec3 JsonPlace::vector() const {
  if (!is_array()) fail_type("an array of 3 numbers");
  check_array(3, 3);
  glm::dvec3 vector;
  for (std::size_t i = 0; i < 3; ++i) vector[static_cast<glm::length_t>(i)] = at(i).number();
  return vector;
}

}  // namespace plumbline
