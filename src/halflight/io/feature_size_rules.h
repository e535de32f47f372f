// Rules that give parts of a scene a feature size of their own, from a TOML file:
//
//   [[rule]]
//   material = "Floor*"       # or node = "Desk"; both may stand together
//   feature-size = "2cm"      # 0: exact shadows
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "halflight/base/result.h"

namespace halflight {

// Names may hold * for any run of characters; an empty one matches everything. A node's name stands
// for all that hangs below it too.
struct FeatureSizeRule {
  std::string material, node;
  float feature_size = 0.f;  // s, metres
};

// So many bytes of a name in a rule, and so many rules in a file.
inline constexpr std::size_t kLongestRuleName = 255;
inline constexpr std::size_t kMostRules = 1024;

// In the order of the file. Errors name the line.
Result<std::vector<FeatureSizeRule>> read_feature_size_rules(const std::filesystem::path& path);
// `where` names the text in messages.
Result<std::vector<FeatureSizeRule>> parse_feature_size_rules(std::string_view text,
                                                              const std::string& where);

}  // namespace halflight
