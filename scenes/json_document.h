// SPDX-License-Identifier: MIT
// A JSON file in memory, every value with its line, and errors that name file, line and key path:
// "walk.json:12: nodes[2].transform.scale: ...". The only file that names nlohmann-json in scenes is
// json_document.cpp.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

struct JsonValue {
  enum class Kind { null, boolean, number, string, array, object };
  Kind kind = Kind::null;
  std::size_t line = 1;  ///< from 1: where the value starts; of an object's member, where its key stands
  bool boolean = false;
  double number = 0.0;
  std::string text;
  std::vector<JsonValue> items;       ///< of an array, or an object's in the order of the file
  std::vector<std::string> keys;      ///< of an object, as long as items
  const JsonValue* around = nullptr;  ///< what holds this one; null at the root
};

struct JsonDocument {
  std::string file;                       ///< for messages
  std::unique_ptr<const JsonValue> root;  ///< on the heap: values point at what is around them
};

/// Parses a JSON text in which comments (`//` and `/* */`) may stand. Throws InputError for what is no JSON, for a key
/// that stands twice in one object, for numbers beyond double, and for nesting deeper than 512.
JsonDocument parse_json(const std::string& file, std::string_view text);

/// A value of a document, which must outlive it and stay where it is.
class JsonPlace {
 public:
  explicit JsonPlace(const JsonDocument& document) : JsonPlace(document.file, *document.root) {}

  const JsonValue& value() const { return *value_; }
  JsonValue::Kind kind() const { return value_->kind; }
  bool is_string() const { return kind() == JsonValue::Kind::string; }
  bool is_array() const { return kind() == JsonValue::Kind::array; }
  bool is_object() const { return kind() == JsonValue::Kind::object; }
  bool is_number() const { return kind() == JsonValue::Kind::number; }
  const std::string& file() const { return *file_; }
  std::size_t line() const { return value_->line; }
  /// As "nodes[2].transform.scale"; empty at the root.
  std::string path() const;
  /// Throws InputError "file:line: path: message".
  [[noreturn]] void fail(const std::string& message) const;
  /// "file:line: path: message", for warnings.
  std::string message(const std::string& message) const;

  /// Throws unless this is an object whose keys are among these; a key that looks like one of them is told so.
  void allow(std::initializer_list<std::string_view> keys) const;
  /// Members of an object.
  std::optional<JsonPlace> find(std::string_view key) const;
  JsonPlace need(std::string_view key) const;
  /// Items of an array, members of an object.
  std::size_t size() const { return value_->items.size(); }
  JsonPlace at(std::size_t i) const;
  /// Key of member i of an object.
  const std::string& key(std::size_t i) const { return value_->keys[i]; }

  // Each of these throws where the value is of another type or out of range.
  void check_object() const;
  /// An array of `least` to `most` items.
  void check_array(std::size_t least = 0, std::size_t most = static_cast<std::size_t>(-1)) const;
  const std::string& text() const;
  bool boolean() const;
  /// A number that a float can hold, as a double.
  double number() const;
  double number_between(double least, double most) const;
  std::uint32_t integer(std::uint32_t least, std::uint32_t most) const;
  glm::dvec3 vector() const;

 private:
  JsonPlace(const std::string& file, const JsonValue& value) : file_(&file), value_(&value) {}
  [[noreturn]] void fail_type(const char* wanted) const;

  const std::string* file_;
  const JsonValue* value_;
};

}  // namespace plumbline
