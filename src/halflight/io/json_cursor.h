// A checked view of a JSON document: every access says where the document is wrong.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "halflight/io/read_failure.h"

namespace halflight {

// One value and its path ("room.gltf/meshes/3/primitives/0"). The document must outlive it.
// Members throw ReadFailure when the value is not of the type asked for.
class JsonCursor {
 public:
  JsonCursor(const nlohmann::json& value, std::string path)
      : value_(&value), path_(std::move(path)) {}

  const std::string& path() const { return path_; }

  JsonCursor at(std::string_view key) const;                   // must be there
  std::optional<JsonCursor> find(std::string_view key) const;  // may be missing
  bool has(std::string_view key) const { return find(key).has_value(); }
  // extensions/NAME
  std::optional<JsonCursor> extension(std::string_view name) const;

  std::size_t size() const;  // of an array
  JsonCursor operator[](std::size_t i) const;

  double number() const;
  float finite_float() const;
  std::size_t count() const;  // a whole number >= 0
  std::size_t index_below(std::size_t n, std::string_view of) const;
  std::string string() const;
  bool boolean() const;

  // Members with defaults.
  float float_or(std::string_view key, float fallback) const;
  std::size_t count_or(std::string_view key, std::size_t fallback) const;
  std::string string_or(std::string_view key, std::string_view fallback) const;
  std::string name() const;  // of at most kLongestName; empty when it has none
  bool boolean_or(std::string_view key, bool fallback) const;
  // Exactly N finite numbers into `numbers`; left alone when the member is missing.
  template <class Numbers>
  bool read_numbers(std::string_view key, int n, Numbers& numbers) const {
    const std::optional<JsonCursor> array = find(key);
    if (!array) return false;
    array->check_length(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) numbers[i] = (*array)[static_cast<std::size_t>(i)].finite_float();
    return true;
  }

  [[noreturn]] void fail(std::string_view what,
                         std::string_view remedy = "export the scene again") const;

 private:
  void check_length(std::size_t n) const;

  const nlohmann::json* value_;
  std::string path_;
};

// The elements of an array member; none when the member is missing.
std::size_t array_size(const JsonCursor& object, std::string_view key);

}  // namespace halflight
