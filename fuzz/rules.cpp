// Feature-size rules in TOML.
#include "fuzz_target.h"
#include "halflight/io/feature_size_rules.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  const auto rules = parse_feature_size_rules(fuzz::text_of(data, size), "rules.toml");
  if (!rules) {
    fuzz::require_clear(rules.error());
    return 0;
  }
  for (const FeatureSizeRule& rule : *rules) {
    fuzz::require(!rule.material.empty() || !rule.node.empty(), "a rule is about something");
    fuzz::require(std::isfinite(rule.feature_size) && rule.feature_size >= 0.f, "sizes are sizes");
  }
  return 0;
}
