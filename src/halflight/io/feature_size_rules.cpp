#include "halflight/io/feature_size_rules.h"

#include <fmt/format.h>
#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

#include "halflight/base/quantities.h"
#include "halflight/io/read_file.h"

namespace halflight {
namespace {

constexpr const char* kRemedy = "write [[rule]] with material or node, and feature-size = \"2cm\"";

tl::unexpected<Error> wrong(const std::filesystem::path& path, const toml::source_region& where,
                            std::string_view what) {
  return input_error(fmt::format("{}, line {}", what, where.begin.line), path.string(), kRemedy);
}

Result<float> to_feature_size(const toml::node& value) {
  if (const auto text = value.value_exact<std::string>()) {
    const Result<double> length = parse_length(*text);
    if (!length) return tl::unexpected(length.error());
    return static_cast<float>(*length);
  }
  const auto metres = value.value<double>();
  if (!metres || !std::isfinite(*metres) || *metres < 0.0)
    return input_error("feature-size is not a length", {}, kRemedy);
  return static_cast<float>(*metres);
}

Result<FeatureSizeRule> to_rule(const std::filesystem::path& path, const toml::table& table) {
  FeatureSizeRule rule;
  bool sized = false;
  for (const auto& [key, value] : table) {
    if (key == "material" || key == "node") {
      const auto name = value.value_exact<std::string>();
      if (!name || name->empty())
        return wrong(path, value.source(), fmt::format("{} is not a name", key.str()));
      (key == "material" ? rule.material : rule.node) = *name;
    } else if (key == "feature-size") {
      const Result<float> size = to_feature_size(value);
      if (!size) return wrong(path, value.source(), size.error().what);
      rule.feature_size = *size;
      sized = true;
    } else {
      return wrong(path, value.source(), fmt::format("unknown key '{}'", key.str()));
    }
  }
  if (!sized) return wrong(path, table.source(), "a rule has no feature-size");
  if (rule.material.empty() && rule.node.empty())
    return wrong(path, table.source(), "a rule has neither material nor node");
  return rule;
}

}  // namespace

Result<std::vector<FeatureSizeRule>> read_feature_size_rules(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const toml::parse_result parsed =
      toml::parse(std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
  if (!parsed) return wrong(path, parsed.error().source(), parsed.error().description());
  std::vector<FeatureSizeRule> rules;
  for (const auto& [key, value] : parsed.table()) {
    const toml::array* list = value.as_array();
    if (key != "rule" || !list)
      return wrong(path, value.source(), fmt::format("unknown key '{}'", key.str()));
    for (const toml::node& node : *list) {
      if (!node.is_table()) return wrong(path, node.source(), "a rule is not a table");
      Result<FeatureSizeRule> rule = to_rule(path, *node.as_table());
      if (!rule) return tl::unexpected(rule.error());
      rules.push_back(std::move(*rule));
    }
  }
  return rules;
}

}  // namespace halflight
