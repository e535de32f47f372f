#include "halflight/solve/settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace halflight {
namespace {

constexpr std::array<std::pair<LinkMaker, std::string_view>, 2> kLinkMakers{
    {{LinkMaker::refined, "refined"}, {LinkMaker::sampled, "sampled"}}};
constexpr std::array<std::pair<bool, std::string_view>, 2> kSwitch{{{false, "off"}, {true, "on"}}};

// Every option; what is named here is all that a checkpoint knows of them.
template <class Options, class Visit>
void for_each_setting(Options& o, const Visit& visit) {
  visit("feature-size", o.feature_size);
  visit("feature-size-rules", o.feature_size_rules);
  visit("feature-size-in-pixels", o.pixels);
  visit("importance", o.importance);
  visit("visibility", o.visibility);
  visit("visibility-pilot", o.visibility_pilot);
  visit("error", o.error);
  visit("links", o.links);
  visit("hierarchy", o.hierarchy);
  visit("intra-cluster", o.intra_cluster);
  visit("levels", o.levels);
  visit("most-links", o.most_links);
  visit("memory", o.memory);
}

template <class T, std::size_t n>
std::string_view name_in(const std::array<std::pair<T, std::string_view>, n>& table, T value) {
  for (const auto& [known, name] : table)
    if (known == value) return name;
  return {};
}
template <class T, std::size_t n>
bool find_in(const std::array<std::pair<T, std::string_view>, n>& table, std::string_view text,
             T& value) {
  for (const auto& [known, name] : table)
    if (name == text) {
      value = known;
      return true;
    }
  return false;
}

using Json = nlohmann::json;

bool from_json(const Json& j, float& v) {
  if (!j.is_number()) return false;
  v = j.get<float>();
  return std::isfinite(v);
}
Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }
bool from_json(const Json& j, Vec3& v) {
  return j.is_array() && j.size() == 3 && from_json(j[0], v.x) && from_json(j[1], v.y) &&
         from_json(j[2], v.z);
}
Json to_json(const FeatureSizeRule& r) { return {r.material, r.node, r.feature_size}; }
bool from_json(const Json& j, FeatureSizeRule& r) {
  if (!j.is_array() || j.size() != 3 || !j[0].is_string() || !j[1].is_string()) return false;
  r.material = j[0].get<std::string>();
  r.node = j[1].get<std::string>();
  return std::max(r.material.size(), r.node.size()) <= kLongestRuleName &&
         from_json(j[2], r.feature_size) && r.feature_size >= 0.f;
}
Json to_json(const ViewOfInterest& v) {
  const PlacedCamera& c = v.camera;
  return {to_json(c.position), to_json(c.forward), to_json(c.up), c.perspective,
          c.vertical_fov,      c.half_height,      v.width,       v.height};
}
bool from_json(const Json& j, ViewOfInterest& v) {
  constexpr int kLargestSide = 1 << 20;
  PlacedCamera& c = v.camera;
  if (!j.is_array() || j.size() != 8 || !from_json(j[0], c.position) ||
      !from_json(j[1], c.forward) || !from_json(j[2], c.up) || !j[3].is_boolean() ||
      !from_json(j[4], c.vertical_fov) || !from_json(j[5], c.half_height) || !j[6].is_number() ||
      !j[7].is_number())
    return false;
  c.perspective = j[3].get<bool>();
  const double width = j[6].get<double>(), height = j[7].get<double>();
  if (!(width >= 1.0 && width <= kLargestSide && height >= 1.0 && height <= kLargestSide))
    return false;
  v.width = static_cast<int>(width);
  v.height = static_cast<int>(height);
  return can_look(c);
}
Json to_json(const PixelFeatureSize& p) { return {to_json(p.view), p.pixels}; }
bool from_json(const Json& j, PixelFeatureSize& p) {
  return j.is_array() && j.size() == 2 && from_json(j[0], p.view) && from_json(j[1], p.pixels) &&
         p.pixels > 0.f;
}

std::string text_of(const std::vector<FeatureSizeRule>& rules) {
  Json list = Json::array();
  for (const FeatureSizeRule& r : rules) list.push_back(to_json(r));
  return list.dump(-1, ' ', true, Json::error_handler_t::replace);
}
template <class T>
std::string text_of(const std::optional<T>& value) {
  return value ? to_json(*value).dump() : "none";
}
bool parse(std::string_view text, std::vector<FeatureSizeRule>& rules) {
  const Json list = Json::parse(text, nullptr, false);
  if (!list.is_array() || list.size() > kMostRules) return false;
  rules.resize(list.size());
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!from_json(list[i], rules[i])) return false;
  return true;
}
template <class T>
bool parse(std::string_view text, std::optional<T>& value) {
  value.reset();
  if (text == "none") return true;
  const Json json = Json::parse(text, nullptr, false);
  return !json.is_discarded() && from_json(json, value.emplace());
}

template <class Number>
requires std::integral<Number> || std::floating_point<Number> std::string text_of(Number value) {
  return fmt::format("{}", value);
}
std::string text_of(bool value) { return std::string(name_in(kSwitch, value)); }
std::string text_of(VisibilityMode mode) { return std::string(name_of(mode)); }
std::string text_of(LinkMaker maker) { return std::string(name_in(kLinkMakers, maker)); }
std::string text_of(HierarchyKind kind) { return std::string(name_of(kind)); }

template <class Number>
requires std::integral<Number> || std::floating_point<Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto number = static_cast<double>(value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number) &&
         number >= 0.0;
}
bool parse(std::string_view text, bool& value) { return find_in(kSwitch, text, value); }
bool parse(std::string_view text, VisibilityMode& mode) {
  for (const NamedVisibilityMode& named : kVisibilityModes)
    if (named.name == text) {
      mode = named.mode;
      return true;
    }
  return false;
}
bool parse(std::string_view text, LinkMaker& maker) { return find_in(kLinkMakers, text, maker); }
bool parse(std::string_view text, HierarchyKind& kind) {
  for (const NamedHierarchy& h : kHierarchies)
    if (h.name == text) {
      kind = h.kind;
      return true;
    }
  return false;
}

}  // namespace

std::string to_text(const SolveOptions& options) {
  std::string text;
  for_each_setting(options, [&](std::string_view name, const auto& value) {
    text += fmt::format("{} {}\n", name, text_of(value));
  });
  return text;
}

std::optional<SolveOptions> parse_settings(std::string_view text) {
  SolveOptions options;
  bool valid = true;
  for_each_setting(options, [&](std::string_view name, auto& value) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    valid = valid && line.starts_with(name) && line.size() > name.size() &&
            parse(line.substr(name.size() + 1), value);
    text.remove_prefix(std::min(end + 1, text.size()));
  });
  constexpr int kMostLevels = 16;
  valid = valid && text.empty() && options.error > 0.f && options.error <= kLargestError &&
          options.levels >= 1 && options.levels <= kMostLevels;
  return valid ? std::optional(options) : std::nullopt;
}

std::string difference(const SolveOptions& there, const SolveOptions& here) {
  std::vector<std::string> values;
  for_each_setting(here, [&](std::string_view, const auto& v) { values.push_back(text_of(v)); });
  std::string found;
  std::size_t i = 0;
  for_each_setting(there, [&](std::string_view name, const auto& v) {
    const std::string& value = values[i++];
    if (found.empty() && text_of(v) != value)
      found = fmt::format("{} is {} there and {} here", name, text_of(v), value);
  });
  return found;
}

}  // namespace halflight
