#include "halflight/io/json_cursor.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "halflight/io/scene_limits.h"

namespace halflight {

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
  if (!value_->is_object()) fail("this should be an object");
  const auto member = value_->find(key);
  if (member == value_->end()) return std::nullopt;
  return JsonCursor(*member, path_ + "/" + std::string(key));
}

JsonCursor JsonCursor::at(std::string_view key) const {
  std::optional<JsonCursor> member = find(key);
  if (!member) fail("'" + std::string(key) + "' is missing");
  return std::move(*member);
}

std::optional<JsonCursor> JsonCursor::extension(std::string_view name) const {
  const std::optional<JsonCursor> extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

std::size_t JsonCursor::size() const {
  if (!value_->is_array()) fail("this should be an array");
  return value_->size();
}

JsonCursor JsonCursor::operator[](std::size_t i) const {
  if (i >= size()) fail("there is no element " + std::to_string(i));
  return {(*value_)[i], path_ + "/" + std::to_string(i)};
}

double JsonCursor::number() const {
  if (!value_->is_number()) fail("this should be a number");
  return value_->get<double>();
}

float JsonCursor::finite_float() const {
  const float value = static_cast<float>(number());
  if (!std::isfinite(value)) fail("this number is too large");
  return value;
}

// Some exporters write whole numbers as 3.0. Above 2^53 a double no longer counts.
std::size_t JsonCursor::count() const {
  const double value = number();
  if (!(value >= 0.0) || value > 0x1p53 || value != std::floor(value))
    fail("this should be a whole number, not negative");
  return static_cast<std::size_t>(value);
}

std::size_t JsonCursor::index_below(std::size_t n, std::string_view of) const {
  const std::size_t index = count();
  if (index >= n)
    fail("there is no " + std::string(of) + " " + std::to_string(index) + ", only " +
         std::to_string(n));
  return index;
}

std::string JsonCursor::string() const {
  if (!value_->is_string()) fail("this should be a string");
  return value_->get<std::string>();
}

bool JsonCursor::boolean() const {
  if (!value_->is_boolean()) fail("this should be true or false");
  return value_->get<bool>();
}

float JsonCursor::float_or(std::string_view key, float fallback) const {
  const auto member = find(key);
  return member ? member->finite_float() : fallback;
}

std::size_t JsonCursor::count_or(std::string_view key, std::size_t fallback) const {
  const auto member = find(key);
  return member ? member->count() : fallback;
}

std::string JsonCursor::string_or(std::string_view key, std::string_view fallback) const {
  const auto member = find(key);
  return member ? member->string() : std::string(fallback);
}

std::string JsonCursor::name() const {
  std::string name = string_or("name", "");
  if (name.size() > kLongestName)
    at("name").fail("this has more than " + std::to_string(kLongestName) + " bytes",
                    "shorten the name");
  return name;
}

bool JsonCursor::boolean_or(std::string_view key, bool fallback) const {
  const auto member = find(key);
  return member ? member->boolean() : fallback;
}

void JsonCursor::fail(std::string_view what, std::string_view remedy) const {
  fail_reading(what, path_, remedy);
}

void JsonCursor::check_length(std::size_t n) const {
  if (size() != n) fail("this should hold " + std::to_string(n) + " numbers");
}

std::size_t array_size(const JsonCursor& object, std::string_view key) {
  const auto array = object.find(key);
  return array ? array->size() : 0;
}

}  // namespace halflight
